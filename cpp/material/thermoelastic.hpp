// SPDX-License-Identifier: Apache-2.0
// Elasticity that depends on temperature [degrees C]: thermal strain, and Young's modulus and Poisson's ratio by it.
//
// A point keeps the temperature of its last increment. From there to the temperature of this one the elastic strain
// stays, and the stress follows the moduli: stress = C(now) S(before) stress before. The thermal strain of the change
// is no strain of the law: each normal component is less by expansion(now) - expansion(before).
#pragma once

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

// c0 + c1 d + c2 d^2, d = t - start, in the row that holds t; the first and the last row go on. Owner: LawData.
struct TemperatureCurve {
  static constexpr int columns = 4;

  const double* rows = nullptr;  // (n_rows, 4): start [degrees C], c0, c1, c2
  int n_rows = 0;

  PRESSWORK_DEVICE bool given() const { return n_rows > 0; }
  PRESSWORK_DEVICE void look_up(double t, double& value, double& slope) const {
    int i = 0;
    while (i + 1 < n_rows && t > rows[columns * (i + 1)]) ++i;
    const double *row = rows + columns * i, d = t - row[0];
    value = row[1] + d * (row[2] + d * row[3]);
    slope = row[2] + 2.0 * d * row[3];
  }
  PRESSWORK_DEVICE double at(double t) const {
    double value, slope;
    look_up(t, value, slope);
    return value;
  }
  Pack at(Pack t) const {
    Pack value;
    for (int lane = 0; lane < pack_width; ++lane) value.set(lane, at(t[lane]));
    return value;
  }
  template <int N>
  Dual<double, N> at(const Dual<double, N>& t) const {
    double value, slope;
    look_up(t.value, value, slope);
    return t.chain(value, slope);
  }
};

struct Thermoelastic {
  TemperatureCurve expansion;     // thermal strain
  TemperatureCurve young_factor;  // Young's modulus over that of the law
  TemperatureCurve poisson;       // in place of that of the law

  PRESSWORK_DEVICE bool active() const { return expansion.given() || young_factor.given() || poisson.given(); }
  template <class T>
  PRESSWORK_DEVICE T young_factor_at(T temperature) const {
    return young_factor.given() ? young_factor.at(temperature) : T(1.0);
  }
  template <class T>
  PRESSWORK_DEVICE T poisson_at(double otherwise, T temperature) const {
    return poisson.given() ? poisson.at(temperature) : T(otherwise);
  }
  template <class T>
  PRESSWORK_DEVICE T strain(T before, T now) const {
    return expansion.given() ? expansion.at(now) - expansion.at(before) : T(0.0);
  }
};

}  // namespace presswork
