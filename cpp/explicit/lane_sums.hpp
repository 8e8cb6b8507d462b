// SPDX-License-Identifier: Apache-2.0
// What a tool does to points of the sheet, summed up over eight lanes whatever the SIMD width: the sums do not depend
// on it.
#pragma once

#include <algorithm>
#include <limits>

#include "explicit/exact_sum.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

struct ContactSums {
  double friction = 0.0, damping = 0.0, squeeze = 0.0;  // work lost; work of pressure on the change of thickness
  double force[3] = {};                                 // on the sheet [N]
  int lost = std::numeric_limits<int>::max();           // a point that has gone through: the first in number

  PRESSWORK_DEVICE ContactSums& operator+=(const ContactSums& other) {
    friction += other.friction, damping += other.damping, squeeze += other.squeeze;
    for (int i = 0; i < 3; ++i) force[i] += other.force[i];
    lost = other.lost < lost ? other.lost : lost;
    return *this;
  }
};

struct LaneSums {
  static constexpr int group = 8;
  enum Row { friction, damping, squeeze, force };  // and two more of force
  double row[6][group] = {};
  int lost = std::numeric_limits<int>::max();

  // x is that of the points from a slot on.
  void add(Row r, int slot, Pack x) {
    for (int lane = 0; lane < pack_width; ++lane) row[r][slot % group + lane] += x[lane];
  }
  void add_force(const Pack force_of[3], int slot) {
    const Pack rounding(force_rounding);
    for (int i = 0; i < 3; ++i) add(static_cast<Row>(force + i), slot, (force_of[i] + rounding) - rounding);
  }
  ContactSums sum_up() const {
    double sum[6] = {};
    for (int r = 0; r < 6; ++r)
      for (double lane : row[r]) sum[r] += lane;
    return {sum[friction], sum[damping], sum[squeeze], {sum[force], sum[force + 1], sum[force + 2]}, lost};
  }
};

}  // namespace presswork::explicit_dynamics
