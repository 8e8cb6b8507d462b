// SPDX-License-Identifier: Apache-2.0
// The faces of a sector of cyclic symmetry in a cycle with a lane a thread (explicit/space/cyclic_ties.hpp): two
// passes, one when nodes have moved, one when they have the forces of their elements.
//
//   lead_node   the second node of a pair goes where the first would be, turned by the angle of the sector
//   give_back   its force is the first node's
//
// A node on the axis is no pair; so each pair is a lane.
#pragma once

#include "device/nodes.hpp"
#include "device/tools.hpp"
#include "explicit/space/turn_about_z.hpp"

namespace presswork::device {

struct Ties {
  int n = 0;        // no ties: nothing else is set
  const int* pair;  // (n, 2)
  double cosine, sine;
  double* fastest;  // (chunks): squares of the largest speeds

  PRESSWORK_DEVICE int chunks() const { return (n + chunk - 1) / chunk; }
};

// Gives the square of the speed of the second node of pair i.
PRESSWORK_INLINE double lead_node(const Ties& ties, const Nodes<double>& nodes, int i) {
  const std::size_t first = ties.pair[2 * std::size_t(i)], last = ties.pair[2 * std::size_t(i) + 1];
  double* to = nodes.motion + 8 * last;
  explicit_dynamics::turn_about_z(nodes.motion + 8 * first, ties.cosine, ties.sine, to);
  explicit_dynamics::turn_about_z(nodes.position + 4 * first, ties.cosine, ties.sine, nodes.position + 4 * last);
  return to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
}

PRESSWORK_INLINE void give_back(const Ties& ties, const Nodes<double>& nodes, int i) {
  const std::size_t first = ties.pair[2 * std::size_t(i)], last = ties.pair[2 * std::size_t(i) + 1];
  double *to = nodes.internal_force + freedoms * first, *from = nodes.internal_force + freedoms * last, back[3];
  explicit_dynamics::turn_about_z(from, ties.cosine, -ties.sine, back);
  for (int k = 0; k < 3; ++k) to[k] += back[k], from[k] = 0.0;
}

}  // namespace presswork::device
