// SPDX-License-Identifier: Apache-2.0
// Von Mises plasticity that hardens with strain rate, softens with temperature, and is heated by its own plastic work.
//
//   flow stress      s(p, r, T) = h(p) R(r) S(T)          (Johnson & Cook 1983 with ludwik and johnson_cook)
//   h                isotropic hardening (hardening.hpp), R the factor of rate (rate.hpp)
//   S                1 - T*^m, T* = (T - T_ref)/(T_melt - T_ref) between 0 and 1; 1 without a melting temperature
//   temperature      dT = k q dp, k = fraction of plastic work turned to heat / (density heat capacity); no conduction
//
// Backward Euler in stress, rate and temperature at once: with q = q_t - 3G dp known from dp alone, the end of the
// increment is one scalar equation
//   q_t - 3G dp = h(p + dp) R(dp/dt) S(T + k (q_t - 3G dp) dp),
// solved by Newton inside a bracket.
#pragma once

#include "material/rate.hpp"
#include "material/von_mises.hpp"

namespace presswork {

struct Softening {
  double reference = 0.0, melting = 0.0, exponent = 1.0;  // [degrees]; no softening unless melting > reference

  bool active() const { return melting > reference; }
  template <class T>
  void evaluate(T temperature, T& factor, T& slope) const {
    factor = T(1.0);
    slope = T(0.0);
    if (!active()) return;
    const double inverse = 1.0 / (melting - reference);
    T share = (temperature - T(reference)) * T(inverse);
    share = smaller(larger(share, T(1e-12)), T(1.0));  // an exponent below 1 has no slope at 0
    T loss = power(share, exponent);
    factor = T(1.0) - loss;
    slope = T(-exponent * inverse) * loss / share;
  }
};

struct AdiabaticMises {
  VonMises mises;  // elasticity and hardening; its integrator is not used
  Rate rate;
  Softening softening;
  double start = 0.0;    // temperature where the rise is 0 [degrees]
  double heating = 0.0;  // k above [degree/MPa]
};

namespace adiabatic_mises {

// dp of the equation above; rise is that at t, and at t+dt on return.
template <class T, class M>
T solve_plastic_increment(const AdiabaticMises& law, T eqps, T q_trial, T over, T slope, double dt, M plastic,
                          T& rise) {
  const double g3 = 3.0 * law.mises.shear_modulus(), inverse_dt = 1.0 / dt;
  T low(0.0), high = select(plastic, q_trial * T(1.0 / g3), T(0.0));
  T dp = select(plastic, over / (T(g3) + slope), T(0.0));
  for (int iteration = 0; iteration < 60; ++iteration) {
    T hard, hard_slope, rate, rate_slope, soft, soft_slope, q = q_trial - T(g3) * dp;
    law.mises.hardening.evaluate(eqps + dp, hard, hard_slope);
    law.rate.evaluate(dp * T(inverse_dt), rate, rate_slope);
    law.softening.evaluate(T(law.start) + rise + T(law.heating) * q * dp, soft, soft_slope);
    T residual = q - hard * rate * soft;
    T size = larger(residual, -residual);
    auto open = both(plastic, size > T(1e-11) * q_trial);
    if (!any(open)) break;
    low = select(residual > T(0.0), dp, low);
    high = select(residual > T(0.0), high, dp);
    T steepness = T(g3) + (hard_slope * rate + hard * rate_slope * T(inverse_dt)) * soft +
                  hard * rate * soft_slope * T(law.heating) * (q - T(g3) * dp);
    T next = dp + residual / steepness;
    auto inside = both(next > low, next < high);
    next = select(inside, next, T(0.5) * (low + high));
    dp = select(open, next, dp);
  }
  rise += T(law.heating) * (q_trial - T(g3) * dp) * dp;
  return dp;
}

}  // namespace adiabatic_mises

// Advance one material point by a strain increment in the time dt [s]; rise: of temperature since the start [degrees].
template <class T>
void update_adiabatic_mises(const AdiabaticMises& law, const T strain[4], double dt, PointState<T>& point, T& rise) {
  const double G = law.mises.shear_modulus(), K = law.mises.bulk_modulus();
  // 1. elastic predictor
  T volume = strain[0] + strain[1] + strain[2];
  T mean = von_mises::mean_of(point.stress) + T(K) * volume;
  T s[4];
  von_mises::deviator_of(point.stress, s);
  for (int i = 0; i < 3; ++i) s[i] += T(2.0 * G) * (strain[i] - volume * T(1.0 / 3));
  s[3] += T(G) * strain[3];
  T q = von_mises::effective_of(s);
  // 2. admissible? At rest the factor of rate is 1.
  T flow, slope, soft, soft_slope;
  law.mises.hardening.evaluate(point.eqps, flow, slope);
  law.softening.evaluate(T(law.start) + rise, soft, soft_slope);
  flow = flow * soft;
  auto plastic = q > flow;
  // 3. return
  T scale(1.0);
  if (any(plastic)) {
    T dp = adiabatic_mises::solve_plastic_increment(law, point.eqps, q, q - flow, slope * soft, dt, plastic, rise);
    scale = T(1.0) - T(3.0 * G) * dp / larger(q, T(1e-300));
    point.eqps += dp;
  }
  for (int i = 0; i < 3; ++i) point.stress[i] = scale * s[i] + mean;
  point.stress[3] = scale * s[3];
}

}  // namespace presswork
