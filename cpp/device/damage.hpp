// SPDX-License-Identifier: Apache-2.0
// Damage at the points of a block in the device's cycle: a pass of its own after the elements have advanced, with the
// criteria of material/damage.hpp, in double precision, as explicit/point_damage.hpp does it.
#pragma once

#include <cstddef>

#include "material/damage.hpp"

namespace presswork::device {

struct Criterion {
  Damage law;
  double temperature;  // where none is given [degrees C]
  int rise;            // row of the rise of temperature behind the first of the stress; -1: there is none
  double* value;       // (points, n)
};

// Of point k the stress begins in row first + k rows of the state; components 3 are sum and difference of the normal
// stresses, and shear. eqps: row of the equivalent plastic strain behind the first of the stress.
struct DamageOfBlock {
  int n_criteria = 0;  // none: nothing else is set
  int first, rows, points, components, eqps;
  const Criterion* criterion;
  double* flowed;  // (points, n): equivalent plastic strain up to which damage is counted
};

// One element after a cycle of dt [s], whose process takes `slower` times as long.
template <class Elements>
PRESSWORK_DEVICE void advance_damage(const Elements& of, double dt, int i) {
  const DamageOfBlock& own = of.damage;
  const std::size_t n = of.n;
  for (int k = 0; k < own.points; ++k) {
    const auto row = [&](int r) {
      return double(of.state[(std::size_t(own.first) + std::size_t(k) * own.rows + r) * n + i]);
    };
    double& before = own.flowed[k * n + i];
    const double now = row(own.eqps), strain = now - before;
    if (!(strain > 0.0)) continue;
    before = now;
    double stress[6];
    for (int c = 0; c < own.components; ++c) stress[c] = row(c);
    if (own.components == 3) {
      const double sum = stress[0], difference = stress[1];
      stress[0] = 0.5 * (sum + difference), stress[1] = 0.5 * (sum - difference);
    }
    damage::Point<double> point =
        own.components == 3 ? damage::measure_stress<3>(stress) : damage::measure_stress<6>(stress);
    point.rate = strain / (dt * of.slower);
    for (int c = 0; c < own.n_criteria; ++c) {
      const Criterion& criterion = own.criterion[c];
      point.temperature = of.temperature ? double(of.temperature[k * n + i]) : criterion.temperature;
      if (criterion.rise >= 0) point.temperature += row(criterion.rise);
      criterion.value[k * n + i] += criterion.law.per_strain(point) * strain;
    }
  }
}

}  // namespace presswork::device
