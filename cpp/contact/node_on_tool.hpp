// SPDX-License-Identifier: Apache-2.0
// Force of a tool in space on a node that touches it, friction by return mapping, and the consistent tangent; the law
// is described in src/presswork/interaction/space_touch.py. The tangent is d(-force)/dx, row by row.
#pragma once

#include <cmath>

#include "contact/vectors.hpp"

namespace presswork::contact {

struct NodeOnTool {
  double push, slope;  // normal force [N] and its derivative by the gap [N/mm]
  const double* normal;
  const double *rise, *bend;  // derivatives of the gap (3) and, row by row, of the normal (3, 3) by the node's place
};

inline void push_node(const NodeOnTool& at, double force[3], double tangent[9]) {
  for (int i = 0; i < 3; ++i) {
    force[i] = at.push * at.normal[i];
    for (int j = 0; j < 3; ++j)
      tangent[3 * i + j] = -at.slope * at.normal[i] * at.rise[j] - at.push * at.bend[3 * i + j];
  }
}

// pulled: the friction that the increment began with, less that of the spring `hanging` [N/mm] over the node's way [N].
// limit: the largest friction that the law allows [N]; by_push: its derivative by the push. Adds to the tangent.
inline void rub_node(const NodeOnTool& at, double hanging, const double pulled[3], double limit, double by_push,
                     double friction[3], double tangent[9]) {
  const double* n = at.normal;
  // 1. elastic trial in the tangent plane
  const double out = dot(n, pulled);
  double trial[3], turned[3], slopes[3][3];
  for (int i = 0; i < 3; ++i) trial[i] = pulled[i] - out * n[i], turned[i] = dot(at.bend + 3 * i, pulled);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      slopes[i][j] = -hanging * ((i == j) - n[i] * n[j]) - n[i] * turned[j] - out * at.bend[3 * i + j];
  const double size = std::sqrt(dot(trial, trial));
  if (!(size > limit)) {
    for (int i = 0; i < 3; ++i) {
      friction[i] = trial[i];
      for (int j = 0; j < 3; ++j) tangent[3 * i + j] -= slopes[i][j];
    }
    return;
  }
  // 2. it slides: shortened to the limit
  const double kept = limit / size, by_gap = by_push * at.slope;
  double along[3];
  for (int i = 0; i < 3; ++i) along[i] = trial[i] / size, friction[i] = limit * along[i];
  for (int j = 0; j < 3; ++j) {
    const double lengthens = along[0] * slopes[0][j] + along[1] * slopes[1][j] + along[2] * slopes[2][j];
    for (int i = 0; i < 3; ++i)
      tangent[3 * i + j] -= along[i] * by_gap * at.rise[j] + kept * (slopes[i][j] - along[i] * lengthens);
  }
}

}  // namespace presswork::contact
