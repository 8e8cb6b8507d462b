// SPDX-License-Identifier: Apache-2.0
// Backward Euler for any yield function, isotropic hardening with strain rate, and kinematic hardening; plane stress
// (N = 3) and three dimensions (N = 6) by one source. With xi = stress - back stress, solve for xi and dp >= 0
//
//   S (xi + back(xi, dp) - trial) + dp n(xi) = 0       n = d f/d xi, S the elastic compliance          N equations
//   f(xi) - flow(p + dp, dp/dt) = 0                                                                    1 equation
//
// by Newton with backtracking on psi = |r|^2 (both residuals as stresses), from the trial stress scaled to the yield
// surface and the dp of a hardening curve straightened to its chord. Five to seven evaluations do for trial stresses of
// 1 to 200 times the yield stress with exponent 8. Every lane of a pack goes through the same iterations; a lane that
// is done or elastic is held by a mask. Simo & Taylor 1986 (plane stress); Scherzinger 2017 (line search for high
// exponents).
#pragma once

#include <memory>

#include "material/kinematic.hpp"
#include "material/rate.hpp"
#include "material/tabulated_hardening.hpp"

namespace presswork {

// Isotropic elasticity in N components; Young's modulus may differ from lane to lane.
template <int N, class T>
struct Elasticity {
  T young;
  double poisson;
  T flexibility = T(1.0) / young;

  void stiffness(const T strain[N], T stress[N]) const {
    T G = young * T(0.5 / (1.0 + poisson));
    if constexpr (N == 3) {
      T plane = young * T(1.0 / (1.0 - poisson * poisson));
      stress[0] = plane * (strain[0] + T(poisson) * strain[1]);
      stress[1] = plane * (strain[1] + T(poisson) * strain[0]);
      stress[2] = G * strain[2];
    } else {
      T spread = young * T(poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))) * (strain[0] + strain[1] + strain[2]);
      for (int i = 0; i < 3; ++i) stress[i] = T(2.0) * G * strain[i] + spread;
      for (int i = 3; i < N; ++i) stress[i] = G * strain[i];
    }
  }
  void matrix(T (*stress)[N]) const {
    for (int j = 0; j < N; ++j) {
      T unit[N], column[N];
      for (int i = 0; i < N; ++i) unit[i] = T(i == j ? 1.0 : 0.0);
      stiffness(unit, column);
      for (int i = 0; i < N; ++i) stress[i][j] = column[i];
    }
  }
  void compliance(const T stress[N], T strain[N]) const {
    constexpr int normal = N == 3 ? 2 : 3;
    T sum(0.0);
    for (int i = 0; i < normal; ++i) sum += stress[i];
    for (int i = 0; i < normal; ++i) strain[i] = flexibility * (T(1.0 + poisson) * stress[i] - T(poisson) * sum);
    for (int i = normal; i < N; ++i) strain[i] = flexibility * T(2.0 * (1.0 + poisson)) * stress[i];
  }
};

// A law of flow: what the solver needs besides the yield function.
struct Flow {
  Hardening hardening;
  Rate rate;
  std::shared_ptr<const TabulatedHardening>
      table;  // in place of the formula, for packs of doubles; the explicit loop's

  // flow stress and its slope by dp, at p_n + dp over the time dt; softening is the temperature's factor
  template <class T>
  void evaluate(T p_n, T dp, double dt, T softening, T& flow, T& slope) const {
    bool looked_up = false;
    if constexpr (std::is_same_v<T, Pack>)
      if (table) table->evaluate(p_n + dp, flow, slope), looked_up = true;
    if (!looked_up) hardening.evaluate(p_n + dp, flow, slope);
    if (rate.law != RateLaw::none) {
      T factor, factor_slope;
      rate.evaluate(dp * T(1.0 / dt), factor, factor_slope);
      slope = slope * factor + flow * factor_slope * T(1.0 / dt);
      flow = flow * factor;
    }
    flow = flow * softening;
    slope = slope * softening;
  }
};

namespace return_mapping {

inline constexpr int max_iterations = 60;
inline constexpr double tolerance = 1e-10;  // of the flow stress

// LU without pivoting: the matrix is S plus a positive semi-definite one (and a small part from the back stress).
template <int N, class T>
struct Factors {
  T a[N][N];
  T over[N];

  void factorise() {
    for (int k = 0; k < N; ++k) {
      over[k] = T(1.0) / a[k][k];
      for (int i = k + 1; i < N; ++i) {
        a[i][k] = a[i][k] * over[k];
        for (int j = k + 1; j < N; ++j) a[i][j] -= a[i][k] * a[k][j];
      }
    }
  }
  void solve(T x[N]) const {
    for (int i = 1; i < N; ++i)
      for (int j = 0; j < i; ++j) x[i] -= a[i][j] * x[j];
    for (int i = N - 1; i >= 0; --i) {
      for (int j = i + 1; j < N; ++j) x[i] -= a[i][j] * x[j];
      x[i] = x[i] * over[i];
    }
  }
};

template <class Yield, class Kinematic, class T>
struct Solver {
  static constexpr int N = Yield::size;
  const Yield& yield;
  const Kinematic& kinematic;
  const Flow& flow_law;
  Elasticity<N, T> elastic;
  const T* history;  // of the kinematic law, at the start
  T p_n, softening;
  double dt;
  T trial[N] = {};

  // unknowns and what belongs to them
  T xi[N] = {}, dp = T(0.0);
  YieldTerms<N, T> terms = {};
  T flow = T(0.0), slope = T(0.0);
  BackStress<N, T> back = {};
  T residual[N] = {}, excess = T(0.0), merit = T(0.0);

  void evaluate_residual() {
    yield.evaluate(xi, terms);
    flow_law.evaluate(p_n, dp, dt, softening, flow, slope);
    T stress[N];
    for (int i = 0; i < N; ++i) stress[i] = xi[i] - trial[i];
    if constexpr (Kinematic::active) {
      kinematic.template evaluate<N>(yield, history, xi, dp, flow, slope, back);
      for (int i = 0; i < N; ++i) stress[i] += back.value[i];
    }
    elastic.compliance(stress, residual);
    excess = terms.value - flow;
    merit = T(0.0);
    for (int i = 0; i < N; ++i) {
      residual[i] += dp * terms.gradient[i];
      merit += residual[i] * residual[i];
    }
    merit = merit * elastic.young * elastic.young + excess * excess;
  }

  // A = d residual/d xi, factorised, and y = A^-1 d residual/d dp
  void linearise(Factors<N, T>& A, T y[N]) const {
    for (int j = 0; j < N; ++j) {
      T column[N], strain[N];
      for (int i = 0; i < N; ++i) column[i] = T(i == j ? 1.0 : 0.0);
      if constexpr (Kinematic::active)
        for (int i = 0; i < N; ++i) column[i] += back.by_xi[i][j];
      elastic.compliance(column, strain);
      for (int i = 0; i < N; ++i) A.a[i][j] = strain[i] + dp * terms.hessian[i][j];
    }
    A.factorise();
    for (int i = 0; i < N; ++i) y[i] = terms.gradient[i];
    if constexpr (Kinematic::active) {
      T strain[N];
      elastic.compliance(back.by_dp, strain);
      for (int i = 0; i < N; ++i) y[i] += strain[i];
    }
    A.solve(y);
  }

  T along_gradient(const T x[N]) const {
    T sum(0.0);
    for (int i = 0; i < N; ++i) sum += terms.gradient[i] * x[i];
    return sum;
  }

  // Newton with backtracking from (xi, dp); gives the lanes of `open` that did not get there.
  Mask<T> iterate(Mask<T> open) {
    T from_xi[N], from_dp = dp, step_xi[N], step_dp(0.0), length(1.0), from_merit(1e300);
    for (int i = 0; i < N; ++i) from_xi[i] = xi[i], step_xi[i] = T(0.0);
    for (int iteration = 0;; ++iteration) {
      evaluate_residual();
      open = both(open, invert(merit < T(tolerance * tolerance) * flow * flow));
      if (!any(open) || iteration == max_iterations) return open;
      // 1. lanes that came down enough get a new direction, the others a shorter step along the old one
      auto down = merit < (T(1.0) - T(2e-4) * length) * from_merit;
      Factors<N, T> A;
      T y[N], x[N];
      linearise(A, y);
      for (int i = 0; i < N; ++i) x[i] = -residual[i];
      A.solve(x);
      T new_dp = (along_gradient(x) + excess) / (along_gradient(y) + slope);
      if (any(both(open, invert(down)))) {
        T shorter = from_merit * length * length / (merit + (T(2.0) * length - T(1.0)) * from_merit);
        shorter = larger(T(0.1) * length, smaller(shorter, T(0.5) * length));
        length = select(down, T(1.0), shorter);
      } else {
        length = T(1.0);
      }
      step_dp = select(down, new_dp, step_dp);
      from_dp = select(down, dp, from_dp);
      from_merit = select(down, merit, from_merit);
      for (int i = 0; i < N; ++i) {
        step_xi[i] = select(down, x[i] - new_dp * y[i], step_xi[i]);
        from_xi[i] = select(down, xi[i], from_xi[i]);
        xi[i] = select(open, from_xi[i] + length * step_xi[i], xi[i]);
      }
      // 2. dp stays positive: at most nine tenths of it in one step
      dp = select(open, larger(from_dp + length * step_dp, T(0.1) * from_dp), dp);
    }
  }

  // d stress/d strain: dxi and ddp of the two equations linearised; C where the lane is elastic
  void consistent_tangent(Mask<T> plastic, T (*tangent)[N]) const {
    Factors<N, T> A;
    T y[N];
    linearise(A, y);
    T bottom = T(1.0) / (along_gradient(y) + slope);
    for (int j = 0; j < N; ++j) {
      T x[N], unit[N], stress[N];
      for (int i = 0; i < N; ++i) x[i] = unit[i] = T(i == j ? 1.0 : 0.0);
      A.solve(x);
      T ddp = along_gradient(x) * bottom;
      for (int i = 0; i < N; ++i) x[i] -= y[i] * ddp;
      elastic.stiffness(unit, stress);
      for (int i = 0; i < N; ++i) {
        T change = x[i];
        if constexpr (Kinematic::active) {
          change += back.by_dp[i] * ddp;
          for (int k = 0; k < N; ++k) change += back.by_xi[i][k] * x[k];
        }
        tangent[i][j] = select(plastic, change, stress[i]);
      }
    }
  }

  // Start of the iteration. xi: the trial stress scaled to the yield surface; dp of f_trial - stiffness dp = flow on
  // the chord of the hardening curve up to its largest possible value. A trial stress that is not far out is moved by
  // that dp along C n instead. Lanes that are not plastic get a stress of their own, and dp = 0.
  void start(const T shifted[N], T f_trial, T flow_n, Mask<T> plastic) {
    T ratio = flow_n / larger(f_trial, T(1e-300));
    for (int i = 0; i < N; ++i) xi[i] = select(plastic, shifted[i] * ratio, T(i == 0 ? 1.0 : 0.0) * flow_n);
    yield.evaluate(xi, terms);
    T push[N], flow_high, slope_high;
    elastic.stiffness(terms.gradient, push);
    T stiffness = along_gradient(push), over = f_trial - flow_n, high = over / stiffness;
    flow_law.evaluate(p_n, high, dt, softening, flow_high, slope_high);
    dp = select(plastic, high * over / (over + flow_high - flow_n), T(0.0));
    auto near = both(plastic, f_trial < T(1.3) * flow_n);
    for (int i = 0; i < N; ++i) xi[i] = select(near, shifted[i] - dp * push[i], xi[i]);
  }
};

}  // namespace return_mapping

// Advance one point by a strain increment (shear engineering) over the time dt [s] (used by rate laws alone; 0: they
// answer elastically). softening
// multiplies the flow stress (temperature; 1 without). eqps is the equivalent plastic strain, work-conjugate to the
// yield function; history belongs to the kinematic law. tangent (N x N) may be null. Gives the lanes that failed; they
// keep stress, eqps and history of the start.
template <class Yield, class Kinematic, class T>
Mask<T> return_to_yield(const Yield& yield, const Kinematic& kinematic, const Flow& flow_law, T young, double poisson,
                        const T strain[Yield::size], double dt, T softening, T stress[Yield::size], T& eqps, T* history,
                        T (*tangent)[Yield::size]) {
  constexpr int N = Yield::size;
  return_mapping::Solver<Yield, Kinematic, T> s{yield,   kinematic, flow_law,  {young, poisson},
                                                history, eqps,      softening, dt};
  // 1. elastic predictor
  T shifted[N], flow_n(0.0), slope_n, size(0.0);
  s.elastic.stiffness(strain, s.trial);
  if constexpr (Kinematic::active)
    kinematic.template total<N>(history, shifted);
  else
    for (auto& x : shifted) x = T(0.0);
  for (int i = 0; i < N; ++i) {
    s.trial[i] += stress[i];
    shifted[i] = s.trial[i] - shifted[i];
    size += shifted[i] * shifted[i];
  }
  // 2. admissible? In no time at all a law with a strain rate does not flow
  const bool frozen = flow_law.rate.law != RateLaw::none && dt == 0.0;
  T f_trial = yield.value(shifted);
  if (!frozen) flow_law.evaluate(eqps, T(0.0), dt, softening, flow_n, slope_n);
  auto finite = size < T(1e200);
  auto plastic = both(f_trial > flow_n * T(1.0 + 1e-14), finite);
  if (frozen || !any(plastic)) {
    for (int i = 0; i < N; ++i) stress[i] = select(finite, s.trial[i], stress[i]);
    if (tangent) s.elastic.matrix(tangent);
    return invert(finite);
  }
  // 3. return
  s.start(shifted, f_trial, flow_n, plastic);
  auto open = s.iterate(plastic);
  auto moved = both(plastic, invert(open)), kept = either(open, invert(finite));
  // 4. accept
  for (int i = 0; i < N; ++i) {
    T end = s.xi[i];
    if constexpr (Kinematic::active) end += s.back.value[i];
    stress[i] = select(kept, stress[i], select(moved, end, s.trial[i]));
  }
  eqps = select(moved, eqps + s.dp, eqps);
  if (tangent) s.consistent_tangent(moved, tangent);
  if constexpr (Kinematic::active) kinematic.template advance<N>(yield, history, s.xi, s.dp, s.flow, moved);
  return kept;
}

}  // namespace presswork
