// SPDX-License-Identifier: Apache-2.0
// Von Mises plasticity that hardens with strain rate, softens with temperature, and is heated by its own plastic work.
//
//   flow stress      s(p, r, T) = h(p) R(r) S(T)          (Johnson & Cook 1983 with ludwik and johnson_cook)
//   h                isotropic hardening, from a table (tabulated_hardening.hpp), R the factor of rate (rate.hpp)
//   S                softening by the temperature, which rises by dT = k q dp (thermal.hpp)
//
// Backward Euler in stress, rate and temperature at once: with q = q_t - 3G dp known from dp alone, the end of the
// increment is one scalar equation
//   q_t - 3G dp = h(p + dp) R(dp/dt) S(T + k (q_t - 3G dp) dp),
// solved by Newton inside a bracket.
#pragma once

#include "material/rate.hpp"
#include "material/tabulated_hardening.hpp"
#include "material/thermal.hpp"
#include "material/von_mises.hpp"

namespace presswork {

struct AdiabaticMises {
  VonMises mises;  // elasticity and hardening; its integrator is not used
  Rate rate;
  Thermal thermal;
  TabulatedHardening hardening;  // that of mises

  static constexpr int rise = 1;  // of temperature since the start [degrees], in the state behind eqps
  static constexpr int state_size(int n) { return n + 2; }
};

// Hardening at an equivalent plastic strain, and the piece of the table that it was found in.
template <class T>
struct HardeningPoint {
  TabulatedHardening::Piece<T> piece;
  T x, flow, slope;

  HardeningPoint(const TabulatedHardening& table, T eqps) : x(larger(eqps, T(0.0)) + T(table.shift())) {
    table.find(x, piece);
    flow = piece.value(x);
    slope = piece.slope(x);
  }
  // The same further on by dp.
  void move(const TabulatedHardening& table, T dp) {
    x = x + dp;
    if (any(either(x<piece.left, x> piece.left + piece.width))) table.find(x, piece);
    flow = piece.value(x);
    slope = piece.slope(x);
  }
};

namespace adiabatic_mises {

constexpr double tolerance = 1e-10;  // of the flow stress

// dp of the equation above, from a first guess; hard, soft_n, temperature: at t. heat: by which the temperature rises.
template <class T, class M>
T solve_plastic_increment(const AdiabaticMises& law, HardeningPoint<T> hard, const Softening::Point<T>& soft_n,
                          T q_trial, T temperature, T dp, double dt, M plastic, T& heat) {
  const double g3 = 3.0 * law.mises.shear_modulus(), inverse_dt = 1.0 / dt;
  T low(0.0), high = select(plastic, q_trial * T(1.0 / g3), T(0.0)), moved(0.0);
  dp = select(plastic, dp, T(0.0));
  for (int iteration = 0; iteration < 60; ++iteration) {
    T rate, rate_slope;
    const T q = q_trial - T(g3) * dp;
    hard.move(law.hardening, dp - moved);
    moved = dp;
    law.rate.evaluate(dp * T(inverse_dt), rate, rate_slope);
    const auto soft = law.thermal.softening.near(soft_n, temperature + T(law.thermal.heating) * q * dp);
    const T residual = q - hard.flow * rate * soft.factor;
    const auto open = both(plastic, larger(residual, -residual) > T(tolerance) * q_trial);
    if (!any(open)) break;
    low = select(residual > T(0.0), dp, low);
    high = select(residual > T(0.0), high, dp);
    const T steepness = T(g3) + (hard.slope * rate + hard.flow * rate_slope * T(inverse_dt)) * soft.factor +
                        hard.flow * rate * soft.slope * T(law.thermal.heating) * (q - T(g3) * dp);
    T next = dp + residual / steepness;
    const auto inside = both(next > low, next < high);
    next = select(inside, next, T(0.5) * (low + high));
    dp = select(open, next, dp);
  }
  heat = T(law.thermal.heating) * (q_trial - T(g3) * dp) * dp;
  return dp;
}

}  // namespace adiabatic_mises

// As the contract has it, without a tangent; hard: the hardening at s0, which the caller may need besides.
template <class T>
Mask<T> update(const AdiabaticMises& law, const LawInput<4, T>& in, const HardeningPoint<T>& hard, const T* s0, T* s1) {
  const double G = law.mises.shear_modulus(), K = law.mises.bulk_modulus();
  const T *strain = in.strain, temperature = in.temperature + s0[5];
  // 1. elastic predictor
  T volume = strain[0] + strain[1] + strain[2];
  T mean = von_mises::mean_of(s0) + T(K) * volume;
  T s[4];
  von_mises::deviator_of<4>(s0, s);
  const T q_n = von_mises::effective_of<4>(s);
  for (int i = 0; i < 3; ++i) s[i] += T(2.0 * G) * (strain[i] - volume * T(1.0 / 3));
  s[3] += T(G) * strain[3];
  T q = von_mises::effective_of<4>(s);
  // 2. admissible? At rest the factor of rate is 1.
  const auto soft = law.thermal.softening.at(temperature);
  const T flow = hard.flow * soft.factor;
  auto plastic = q > flow;
  // 3. return; a point that flowed before, its stress raised by its rate, goes on as before: guess dp from q_n
  T scale(1.0), dp(0.0), heat(0.0);
  if (any(plastic)) {
    const T over = q - select(both(q > q_n, q_n > flow), q_n, flow);
    const T guess = over / (T(3.0 * G) + hard.slope * soft.factor);
    dp = adiabatic_mises::solve_plastic_increment(law, hard, soft, q, temperature, guess, in.dt, plastic, heat);
    scale = T(1.0) - T(3.0 * G) * dp / larger(q, T(1e-300));
  }
  for (int i = 0; i < 4; ++i) s1[i] = i < 3 ? scale * s[i] + mean : scale * s[i];
  s1[4] = s0[4] + dp;
  s1[5] = s0[5] + heat;
  return q < T(0.0);
}

}  // namespace presswork
