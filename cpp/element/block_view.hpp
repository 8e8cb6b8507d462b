// SPDX-License-Identifier: Apache-2.0
// What a kernel of 2D solids sees of one block of cells.
#pragma once

#include "element/umat_response.hpp"

namespace presswork {

// Views of one block of cells; arrays are C-contiguous. q is the rule's number of points.
struct BlockView {
  int n_cells;
  const int* connectivity;  // (n_cells, nodes)
  const double* points;     // (n_points, 2) at t [mm]
  const double* increment;  // (n_points, 2) displacement since t [mm]
  bool axisymmetric;
  double depth;               // plane strain [mm]
  const double* stress_n;     // (n_cells, q, 4) [MPa]
  const double* eqps_n;       // (n_cells, q)
  const double* hourglass_n;  // (n_cells, 2) [N], one_point only
  double hourglass_fraction;
  double* stress;
  double* eqps;
  double* hourglass;
  double* volume;     // (n_cells, q) [mm3] at t+dt
  double* force;      // (n_packs, 2 nodes, pack_width) [N]
  double* stiffness;  // (n_packs, 2 nodes, 2 nodes, pack_width) [N/mm], or null
  bool symmetric;     // keep the symmetric part of the stiffness
  // of a law from a shared library
  const double* user_n = nullptr;  // (n_cells, q, n_state + UmatHistory::size)
  double* user = nullptr;
  int first_cell = 0;          // of the block in the mesh
  UmatPlace when = {};         // stage, increment and times
  UmatFault* fault = nullptr;  // (n_packs)
};

}  // namespace presswork
