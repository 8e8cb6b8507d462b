// SPDX-License-Identifier: Apache-2.0
// Von Mises plasticity that hardens with strain rate, softens with temperature, and is heated by its own plastic work.
//
//   flow stress      s(p, r, T) = h(p) R(r) S(T)          (Johnson & Cook 1983 with ludwik and johnson_cook)
//   h                isotropic hardening, from a table (tabulated_hardening.hpp), R the factor of rate (rate.hpp)
//   S                1 - T*^m, T* = (T - T_ref)/(T_melt - T_ref) between 0 and 1; 1 without a melting temperature
//   temperature      dT = k q dp, k = fraction of plastic work turned to heat / (density heat capacity); no conduction
//
// Backward Euler in stress, rate and temperature at once: with q = q_t - 3G dp known from dp alone, the end of the
// increment is one scalar equation
//   q_t - 3G dp = h(p + dp) R(dp/dt) S(T + k (q_t - 3G dp) dp),
// solved by Newton inside a bracket.
#pragma once

#include "material/rate.hpp"
#include "material/tabulated_hardening.hpp"
#include "material/von_mises.hpp"

namespace presswork {

struct Softening {
  double reference = 0.0, melting = 0.0, exponent = 1.0;  // [degrees]; no softening unless melting > reference

  template <class T>
  struct Point {
    T share = T(0.0), loss = T(0.0);    // T*, T*^m
    T factor = T(1.0), slope = T(0.0);  // S, dS/dT
  };

  bool active() const { return melting > reference; }
  template <class T>
  Point<T> at(T temperature) const {
    Point<T> point;
    if (!active()) return point;
    point.share = share_at(temperature);
    finish(power(point.share, exponent), point);
    return point;
  }
  // The same at a temperature that may be near that of another point: by the binomial series about it.
  template <class T>
  Point<T> near(const Point<T>& other, T temperature) const {
    if (!active()) return other;
    Point<T> point;
    point.share = share_at(temperature);
    const T x = point.share / other.share - T(1.0);
    if (any(either(x > T(2e-3), x < T(-2e-3)))) {
      finish(power(point.share, exponent), point);
      return point;
    }
    T sum(1.0);
    for (int k = 5; k > 0; --k) sum = T(1.0) + T((exponent - (k - 1)) / k) * x * sum;
    finish(other.loss * sum, point);
    return point;
  }

 private:
  template <class T>
  T share_at(T temperature) const {
    const T share = (temperature - T(reference)) * T(1.0 / (melting - reference));
    return smaller(larger(share, T(1e-12)), T(1.0));  // an exponent below 1 has no slope at 0
  }
  template <class T>
  void finish(T loss, Point<T>& point) const {
    point.loss = loss;
    point.factor = T(1.0) - loss;
    point.slope = T(-exponent / (melting - reference)) * loss / point.share;
  }
};

struct AdiabaticMises {
  VonMises mises;  // elasticity and hardening; its integrator is not used
  Rate rate;
  Softening softening;
  double start = 0.0;    // temperature where the rise is 0 [degrees]
  double heating = 0.0;  // k above [degree/MPa]
  TabulatedHardening hardening = TabulatedHardening(mises.hardening);
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

// dp of the equation above, from a first guess; hard, soft: at t; rise is that at t, and at t+dt on return.
template <class T, class M>
T solve_plastic_increment(const AdiabaticMises& law, HardeningPoint<T> hard, const Softening::Point<T>& soft_n,
                          T q_trial, T dp, double dt, M plastic, T& rise) {
  const double g3 = 3.0 * law.mises.shear_modulus(), inverse_dt = 1.0 / dt;
  T low(0.0), high = select(plastic, q_trial * T(1.0 / g3), T(0.0)), moved(0.0);
  dp = select(plastic, dp, T(0.0));
  for (int iteration = 0; iteration < 60; ++iteration) {
    T rate, rate_slope;
    const T q = q_trial - T(g3) * dp;
    hard.move(law.hardening, dp - moved);
    moved = dp;
    law.rate.evaluate(dp * T(inverse_dt), rate, rate_slope);
    const auto soft = law.softening.near(soft_n, T(law.start) + rise + T(law.heating) * q * dp);
    const T residual = q - hard.flow * rate * soft.factor;
    const auto open = both(plastic, larger(residual, -residual) > T(tolerance) * q_trial);
    if (!any(open)) break;
    low = select(residual > T(0.0), dp, low);
    high = select(residual > T(0.0), high, dp);
    const T steepness = T(g3) + (hard.slope * rate + hard.flow * rate_slope * T(inverse_dt)) * soft.factor +
                        hard.flow * rate * soft.slope * T(law.heating) * (q - T(g3) * dp);
    T next = dp + residual / steepness;
    const auto inside = both(next > low, next < high);
    next = select(inside, next, T(0.5) * (low + high));
    dp = select(open, next, dp);
  }
  rise += T(law.heating) * (q_trial - T(g3) * dp) * dp;
  return dp;
}

}  // namespace adiabatic_mises

// Advance one material point by a strain increment in the time dt [s]; hard: the hardening at its start; rise: of
// temperature since the start of the run [degrees].
template <class T>
void update_adiabatic_mises(const AdiabaticMises& law, const T strain[4], double dt, const HardeningPoint<T>& hard,
                            PointState<T>& point, T& rise) {
  const double G = law.mises.shear_modulus(), K = law.mises.bulk_modulus();
  // 1. elastic predictor
  T volume = strain[0] + strain[1] + strain[2];
  T mean = von_mises::mean_of(point.stress) + T(K) * volume;
  T s[4];
  von_mises::deviator_of(point.stress, s);
  const T q_n = von_mises::effective_of(s);
  for (int i = 0; i < 3; ++i) s[i] += T(2.0 * G) * (strain[i] - volume * T(1.0 / 3));
  s[3] += T(G) * strain[3];
  T q = von_mises::effective_of(s);
  // 2. admissible? At rest the factor of rate is 1.
  const auto soft = law.softening.at(T(law.start) + rise);
  const T flow = hard.flow * soft.factor;
  auto plastic = q > flow;
  // 3. return; a point that flowed before, its stress raised by its rate, goes on as before: guess dp from q_n
  T scale(1.0);
  if (any(plastic)) {
    const T over = q - select(both(q > q_n, q_n > flow), q_n, flow);
    const T guess = over / (T(3.0 * G) + hard.slope * soft.factor);
    T dp = adiabatic_mises::solve_plastic_increment(law, hard, soft, q, guess, dt, plastic, rise);
    scale = T(1.0) - T(3.0 * G) * dp / larger(q, T(1e-300));
    point.eqps += dp;
  }
  for (int i = 0; i < 3; ++i) point.stress[i] = scale * s[i] + mean;
  point.stress[3] = scale * s[3];
}

}  // namespace presswork
