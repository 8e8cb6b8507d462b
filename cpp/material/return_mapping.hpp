// SPDX-License-Identifier: Apache-2.0
// Backward Euler for any yield function, isotropic hardening with strain rate and temperature, and kinematic hardening;
// plane stress (N = 3), plane strain and axisymmetry (4) and space (6) by one source. With xi = stress - back stress,
// solve for xi and dp >= 0
//
//   S (xi + back(xi, dp) - trial) + dp n(xi) = 0       n = d f/d xi, S the elastic compliance          N equations
//   f(xi) - flow(p + dp, dp/dt, temperature) = 0       temperature + k f(xi) dp where heated           1 equation
//
// (flow: flow.hpp)
// by Newton with backtracking on psi = |r|^2 (both residuals as stresses), from the trial stress scaled to the yield
// surface and the dp of a hardening curve straightened to its chord. Five to seven evaluations do for trial stresses of
// 1 to 200 times the yield stress with exponent 8. Every lane of a pack goes through the same iterations; a lane that
// is done or elastic is held by a mask. Simo & Taylor 1986 (plane stress); Scherzinger 2017 (line search for high
// exponents).
#pragma once

#include "material/elasticity.hpp"
#include "material/flow.hpp"
#include "material/kinematic.hpp"
#include "material/law.hpp"

namespace presswork {

namespace return_mapping {

inline constexpr int max_iterations = 60;
inline constexpr double tolerance = 1e-10;  // of the flow stress
inline constexpr double molten = 1e-8;      // of Young's modulus: a flow stress that is none

// LU without pivoting: the matrix is S plus a positive semi-definite one (and a small part from the back stress).
template <int N, class T>
struct Factors {
  T a[N][N];
  T over[N];

  PRESSWORK_DEVICE void factorise() {
    for (int k = 0; k < N; ++k) {
      over[k] = T(1.0) / a[k][k];
      for (int i = k + 1; i < N; ++i) {
        a[i][k] = a[i][k] * over[k];
        for (int j = k + 1; j < N; ++j) a[i][j] -= a[i][k] * a[k][j];
      }
    }
  }
  PRESSWORK_DEVICE void solve(T x[N]) const {
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
  T p_n, temperature;
  double dt;
  T trial[N] = {};

  // unknowns and what belongs to them
  T xi[N] = {}, dp = T(0.0);
  YieldTerms<N, T> terms = {};
  Flow::Point<T> flow = {};
  BackStress<N, T> back = {};
  T residual[N] = {}, excess = T(0.0), merit = T(0.0);

  PRESSWORK_CALLED void evaluate_residual() {
    yield.evaluate(xi, terms);
    flow_law.evaluate(p_n, dp, terms.value, dt, temperature, flow);
    T stress[N];
    for (int i = 0; i < N; ++i) stress[i] = xi[i] - trial[i];
    if constexpr (Kinematic::active) {
      kinematic.template evaluate<N>(yield, history, xi, dp, flow.stress, flow.by_dp, back);
      if (flow_law.thermal.heats())
        for (int i = 0; i < N; ++i)
          for (int j = 0; j < N; ++j) back.by_xi[i][j] += back.by_flow[i] * flow.by_value * terms.gradient[j];
      for (int i = 0; i < N; ++i) stress[i] += back.value[i];
    }
    elastic.compliance(stress, residual);
    excess = terms.value - flow.stress;
    merit = T(0.0);
    for (int i = 0; i < N; ++i) {
      residual[i] += dp * terms.gradient[i];
      merit += residual[i] * residual[i];
    }
    merit = merit * elastic.young * elastic.young + excess * excess;
  }

  // A = d residual/d xi, factorised, and y = A^-1 d residual/d dp
  PRESSWORK_CALLED void linearise(Factors<N, T>& A, T y[N]) const {
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

  PRESSWORK_DEVICE T along_gradient(const T x[N]) const {
    T sum(0.0);
    for (int i = 0; i < N; ++i) sum += terms.gradient[i] * x[i];
    return sum;
  }
  // change of value - flow stress along x
  PRESSWORK_DEVICE T excess_along(const T x[N]) const {
    const T sum = along_gradient(x);
    return flow_law.thermal.heats() ? sum * (T(1.0) - flow.by_value) : sum;
  }

  // Newton with backtracking from (xi, dp); gives the lanes of `open` that did not get there.
  PRESSWORK_CALLED Mask<T> iterate(Mask<T> open) {
    T from_xi[N], from_dp = dp, step_xi[N], step_dp(0.0), length(1.0), from_merit(1e300);
    for (int i = 0; i < N; ++i) from_xi[i] = xi[i], step_xi[i] = T(0.0);
    [[maybe_unused]] Mask<T> was_apart = open;
    for (int iteration = 0;; ++iteration) {
      evaluate_residual();
      const T size = larger(flow.stress, T(molten) * elastic.young);
      const auto apart = invert(merit < T(tolerance * tolerance) * size * size);
      if constexpr (is_of_doubles<T>) {
        open = both(open, apart);
      } else {  // derivatives by dual numbers are one step behind the values
        open = both(open, invert(both(invert(apart), invert(was_apart))));
        was_apart = apart;
      }
      if (!any(open) || iteration == max_iterations) return open;
      // 1. lanes that came down enough get a new direction, the others a shorter step along the old one
      auto down = merit < (T(1.0) - T(2e-4) * length) * from_merit;
      Factors<N, T> A;
      T y[N], x[N];
      linearise(A, y);
      for (int i = 0; i < N; ++i) x[i] = -residual[i];
      A.solve(x);
      T new_dp = (excess_along(x) + excess) / (excess_along(y) + flow.by_dp);
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

  // As `iterate`, for a flow stress with corners in dp, the ends of a window or the bend where a rate begins to count,
  // on which Newton's method for both equations can come to stand: xi of a given dp by the first equation, and dp by
  // the second between bounds.
  PRESSWORK_DEVICE Mask<T> iterate_nested(Mask<T> open) {
    constexpr int most_inside = 12;
    T low(0.0), high(0.0), x(0.0);
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      Factors<N, T> A;
      T y[N];
      for (int inside = 0; inside < (iteration == 0 ? 0 : most_inside); ++inside) {
        evaluate_residual();
        linearise(A, y);
        T step[N];
        for (int i = 0; i < N; ++i) step[i] = -residual[i];
        A.solve(step);
        for (int i = 0; i < N; ++i) xi[i] += select(open, step[i], T(0.0));
      }
      evaluate_residual();
      if (iteration > 0) {
        const T size = larger(flow.stress, T(molten) * elastic.young);
        open = both(open, invert(merit < T(tolerance * tolerance) * size * size));
        if (!any(open)) return open;
      }
      linearise(A, y);
      if (iteration == 0) {
        yield.evaluate(trial, terms);
        high = T(10.0) * terms.value / larger(excess_along(y), T(1e-3) * elastic.young);
        x = T(0.01) * high;
        for (int i = 0; i < N; ++i) xi[i] = select(open, trial[i], xi[i]);
      } else {
        const auto below = excess > T(0.0);
        low = select(below, dp, low), high = select(below, high, dp);
        const T next = dp + excess / (excess_along(y) + flow.by_dp);
        x = select(both(next > low, next < high), next, larger(square_root(low * high), T(0.01) * high));
      }
      dp = select(open, x, dp);
    }
    return open;
  }

  // d stress/d strain: dxi and ddp of the two equations linearised; C where the lane is elastic
  PRESSWORK_DEVICE void consistent_tangent(Mask<T> plastic, T (*tangent)[N]) const {
    Factors<N, T> A;
    T y[N];
    linearise(A, y);
    T bottom = T(1.0) / (excess_along(y) + flow.by_dp);
    for (int j = 0; j < N; ++j) {
      T x[N], unit[N], stress[N];
      for (int i = 0; i < N; ++i) x[i] = unit[i] = T(i == j ? 1.0 : 0.0);
      A.solve(x);
      T ddp = excess_along(x) * bottom;
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
  PRESSWORK_CALLED void start(const T shifted[N], T f_trial, T flow_n, Mask<T> plastic) {
    T ratio = flow_n / larger(f_trial, T(1e-300));
    for (int i = 0; i < N; ++i) xi[i] = select(plastic, shifted[i] * ratio, T(i == 0 ? 1.0 : 0.0) * flow_n);
    yield.evaluate(xi, terms);
    T push[N];
    Flow::Point<T> highest;
    elastic.stiffness(terms.gradient, push);
    T stiffness = along_gradient(push), over = f_trial - flow_n, high = over / stiffness;
    flow_law.evaluate(p_n, high, flow_n, dt, temperature, highest);
    dp = select(plastic, high * over / (over + highest.stress - flow_n), T(0.0));
    if (flow_law.hot.active()) return start_hot(shifted, f_trial, flow_n, stiffness, high, push, plastic);
    auto near = both(plastic, f_trial < T(1.3) * flow_n);
    for (int i = 0; i < N; ++i) xi[i] = select(near, shifted[i] - dp * push[i], xi[i]);
  }

  // A flow stress that rises from next to nothing with a power of the rate is far from its chord: here the equation
  // f_trial - stiffness dp = flow is solved between 0 and `high`, by Newton's method and halving of logarithms.
  PRESSWORK_CALLED void start_hot(const T shifted[N], T f_trial, T flow_n, T stiffness, T high, const T push[N],
                                  Mask<T> plastic) {
    T low(0.0), x = select(plastic, dp, T(1e-300));
    Flow::Point<T> point;
    for (int k = 0; k < 12; ++k) {
      flow_law.evaluate(p_n, x, flow_n, dt, temperature, point);
      const T excess = f_trial - stiffness * x - point.stress;
      const auto below = excess > T(0.0);
      low = select(below, x, low), high = select(below, high, x);
      const T next = x + excess / (stiffness + point.by_dp), halved = larger(square_root(low * high), T(0.01) * high);
      x = select(both(plastic, both(next > low, next < high)), next, select(plastic, halved, x));
    }
    flow_law.evaluate(p_n, x, flow_n, dt, temperature, point);
    dp = select(plastic, x, T(0.0));
    const T ratio = point.stress / larger(f_trial, T(1e-300));
    for (int i = 0; i < N; ++i) {
      const T along = N > 3 ? shifted[i] - dp * push[i] : shifted[i] * ratio;
      xi[i] = select(plastic, along, xi[i]);
    }
  }
};

}  // namespace return_mapping

// As the contract has it (law.hpp), for one yield function and one kinematic law. The state: stress (N), equivalent
// plastic strain, work-conjugate to the yield function; where the law heats the rise of temperature; what the kinematic
// law keeps.
template <class Yield, class Kinematic, class T>
PRESSWORK_CALLED Mask<T> return_to_yield(const Yield& yield, const Kinematic& kinematic, const Flow& flow_law,
                                         const Elasticity<Yield::size, T>& elastic, const LawInput<Yield::size, T>& in,
                                         const T* s0, T* s1, T (*tangent)[Yield::size]) {
  constexpr int N = Yield::size;
  const bool heats = flow_law.thermal.heats();
  const int behind = N + 1 + (heats ? 1 : 0);  // where the kinematic law's values begin
  const T *history = s0 + behind, eqps = s0[N];
  return_mapping::Solver<Yield, Kinematic, T> s{
      yield, kinematic, flow_law, elastic, history, eqps, heats ? in.temperature + s0[N + 1] : in.temperature, in.dt};
  // 1. elastic predictor
  T shifted[N], size(0.0);
  s.elastic.stiffness(in.strain, s.trial);
  if constexpr (Kinematic::active)
    kinematic.template total<N>(history, shifted);
  else
    for (auto& x : shifted) x = T(0.0);
  for (int i = 0; i < N; ++i) {
    s.trial[i] += s0[i];
    shifted[i] = s.trial[i] - shifted[i];
    size += shifted[i] * shifted[i];
  }
  // 2. admissible? In no time at all a law with a strain rate does not flow
  const bool frozen = flow_law.depends_on_rate() && in.dt == 0.0;
  T f_trial = yield.value(shifted);
  Flow::Point<T> flow_n = {};
  if (!frozen) flow_law.evaluate(eqps, T(0.0), T(0.0), in.dt, s.temperature, flow_n);
  auto finite = size < T(1e200);
  auto plastic = both(f_trial > flow_n.stress * T(1.0 + 1e-14), finite);
  if constexpr (Kinematic::active)
    for (int i = 0; i < kinematic.template history_size<N>(); ++i) s1[behind + i] = history[i];
  if (frozen || !any(plastic)) {
    for (int i = 0; i < N; ++i) s1[i] = select(finite, s.trial[i], s0[i]);
    s1[N] = eqps;
    if (heats) s1[N + 1] = s0[N + 1];
    if (tangent) s.elastic.matrix(tangent);
    return invert(finite);
  }
  // 3. return
  s.start(shifted, f_trial, flow_n.stress, plastic);
  auto open = s.iterate(plastic);
  if (flow_law.depends_on_rate() && any(open)) open = s.iterate_nested(open);
  auto moved = both(plastic, invert(open)), kept = either(open, invert(finite));
  // 4. accept
  for (int i = 0; i < N; ++i) {
    T end = s.xi[i];
    if constexpr (Kinematic::active) end += s.back.value[i];
    s1[i] = select(kept, s0[i], select(moved, end, s.trial[i]));
  }
  s1[N] = select(moved, eqps + s.dp, eqps);
  if (heats) s1[N + 1] = s0[N + 1] + select(moved, T(flow_law.thermal.heating) * s.terms.value * s.dp, T(0.0));
  if (tangent) s.consistent_tangent(moved, tangent);
  if constexpr (Kinematic::active) kinematic.template advance<N>(yield, s1 + behind, s.xi, s.dp, s.flow.stress, moved);
  return kept;
}

}  // namespace presswork
