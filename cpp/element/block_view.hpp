// SPDX-License-Identifier: Apache-2.0
// What a kernel of solids sees of one block of cells.
#pragma once

#include "element/umat_response.hpp"

namespace presswork {

// Views of one block of cells; arrays are C-contiguous. q is the rule's number of points, d the dimension, c the number
// of stress components: 4 in the plane (xx, yy, zz, xy), 6 in space (xx, yy, zz, xy, yz, zx).
struct BlockView {
  int n_cells;
  const int* connectivity;  // (n_cells, nodes)
  const double* points;     // (n_points, d) at t [mm]
  const double* increment;  // (n_points, d) displacement since t [mm]
  bool axisymmetric;
  double depth;               // plane strain [mm]
  const double* stress_n;     // (n_cells, q, c) [MPa]
  const double* eqps_n;       // (n_cells, q)
  const double* hourglass_n;  // (n_cells, 2) [N], one_point only
  double hourglass_fraction;
  double* stress;
  double* eqps;
  double* hourglass;
  double* volume;     // (n_cells, q) [mm3] at t+dt
  double* force;      // (n_packs, d nodes, pack_width) [N]
  double* stiffness;  // (n_packs, d nodes, d nodes, pack_width) [N/mm], or null
  bool symmetric;     // keep the symmetric part of the stiffness
  // of a law from a shared library
  const double* user_n = nullptr;  // (n_cells, q, n_state + UmatHistory::size)
  double* user = nullptr;
  int first_cell = 0;          // of the block in the mesh
  UmatPlace when = {};         // stage, increment and times
  UmatFault* fault = nullptr;  // (n_packs)
};

}  // namespace presswork
