// SPDX-License-Identifier: Apache-2.0
// The threaded loop over the triangles of a part in the one-step solver.
#pragma once

#include <vector>

#include "element/inverse_membrane.hpp"

namespace presswork {

inline constexpr int most_inverse_layers = 16;

struct InverseBlock {
  int n;
  const int* triangles;     // (n, 3)
  const double* share;      // (n): part of the triangle that counts; 1/2 where quadrilaterals are cut both ways
  const double* axes;       // (n, 2, 3): unit vectors in the triangle's plane
  const double* edges;      // (n, 2, 2): final edges 01 and 02 (columns) in them [mm]
  const double* curvature;  // (n, 3): xx, yy, xy in them [1/mm]
  const double* bases;      // (n_nodes, 2, 3): tangent vectors along which a node's equilibrium is asked
  const double* blank;      // (n_nodes, 2) [mm]
  const double* formed;     // (n, layers, 4): what each layer has gone through: strain free of stress, plastic strain
  double thickness;         // [mm]
  std::vector<double> height, weight;
};

// Fill force (n, 3, 3) in space and, unless null, stiffness (packs, 6, 6, lanes): derivative of the forces along the
// bases by the places in the blank. Returns the lowest index of a triangle that lies turned over in the blank, or -1.
int evaluate_inverse(const InverseBlock& block, const DeformationLaw& law, double* force, double* stiffness);

}  // namespace presswork
