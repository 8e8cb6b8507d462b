// SPDX-License-Identifier: Apache-2.0
// The flow stress of a law: hardening x rate x softening, or one law of all three (hot_hardening.hpp).
#pragma once

#include "material/hot_hardening.hpp"
#include "material/rate.hpp"
#include "material/tabulated_hardening.hpp"
#include "material/thermal.hpp"

namespace presswork {

// A law of flow: what the solver needs besides the yield function.
struct Flow {
  Hardening hardening;
  Rate rate;
  Thermal thermal;
  HotHardening hot;  // where it is active: in place of hardening, rate and softening
  // in place of the formula, for doubles and packs of them; the explicit loop's
  bool tabulated = false;
  TabulatedHardening table = {};

  template <class T>
  struct Point {
    T stress, by_dp, by_value;  // flow stress, and its slopes by dp and by the value of the yield function, which heats
  };

  // Flow stress at p_n + dp over the time dt, from the temperature of the start; value: of the yield function.
  template <class T>
  PRESSWORK_CALLED void evaluate(T p_n, T dp, T value, double dt, T temperature, Point<T>& out) const {
    if (hot.active()) return evaluate_hot(p_n, dp, value, dt, temperature, out);
    out.by_value = T(0.0);
    harden(p_n + dp, out.stress, out.by_dp);
    if (rate.active()) {
      T factor, slope;
      rate.evaluate(dp * T(1.0 / dt), factor, slope);
      out.by_dp = out.by_dp * factor + out.stress * slope * T(1.0 / dt);
      out.stress = out.stress * factor;
    }
    if (!thermal.softening.active()) return;
    const auto soft = thermal.softening.at(temperature + T(thermal.heating) * value * dp);
    const T steepness = out.stress * soft.slope * T(thermal.heating);
    out.by_dp = out.by_dp * soft.factor + steepness * value;
    out.by_value = steepness * dp;
    out.stress = out.stress * soft.factor;
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate_hot(T p_n, T dp, T value, double dt, T temperature, Point<T>& out) const {
    HotPoint<T> point;
    const T heating(thermal.heating);
    hot.evaluate(p_n + dp, dp * T(1.0 / dt), temperature + heating * value * dp, point);
    out.stress = point.stress;
    out.by_dp = point.by_strain + point.by_rate * T(1.0 / dt) + point.by_temperature * heating * value;
    out.by_value = point.by_temperature * heating * dp;
  }
  PRESSWORK_DEVICE bool depends_on_rate() const { return rate.active() || hot.active(); }
  // By the formula, or from the table.
  template <class T>
  PRESSWORK_DEVICE void harden(T p, T& flow, T& slope) const {
    if constexpr (is_of_doubles<T>)
      if (tabulated) return table.evaluate(p, flow, slope);
    hardening.evaluate(p, flow, slope);
  }
  // At rest and without a rise.
  template <class T>
  PRESSWORK_DEVICE void at_rest(T p, T temperature, T& flow, T& slope) const {
    if (hot.active()) return at_rate(p, T(0.0), temperature, flow, slope);
    harden(p, flow, slope);
    if (!thermal.softening.active()) return;
    const T factor = thermal.softening.at(temperature).factor;
    flow = flow * factor, slope = slope * factor;
  }
  // At a constant rate and without a rise.
  template <class T>
  PRESSWORK_DEVICE void at_rate(T p, T plastic_rate, T temperature, T& flow, T& slope) const {
    if (hot.active()) {
      HotPoint<T> point;
      hot.evaluate(p, plastic_rate, temperature, point);
      flow = point.stress, slope = point.by_strain;
      return;
    }
    T factor, unused;
    at_rest(p, temperature, flow, slope);
    rate.evaluate(plastic_rate, factor, unused);
    flow = flow * factor, slope = slope * factor;
  }
};

}  // namespace presswork
