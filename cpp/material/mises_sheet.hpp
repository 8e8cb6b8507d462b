// SPDX-License-Identifier: Apache-2.0
// Return mapping of von Mises in plane stress by one equation, for a flow stress H of strain, rate and temperature that
// its own plastic work does not heat: what the explicit loop takes in place of return_mapping.hpp, which solves four.
//
// Backward Euler written for sum s = xx + yy, difference d = xx - yy and shear c of the stress, in which elasticity and
// the yield function are diagonal (Simo & Taylor 1986). With the trial stress, all of plasticity is
//
//   G(y) = A / u^2 + B / v^2 = 1,      u = H + y E/(2 (1 - nu)),  v = H + 3 G_shear y,
//   A = s^2/4,  B = 3 d^2/4 + 3 c^2    of the trial stress,
//
// for the increment y of equivalent plastic strain, and the stress is s H/u, d H/v, c H/v. G falls with y as long as H
// does not fall faster than elasticity rises. It is solved by Halley's step on G^(-1/2), inside a bracket: at its upper
// end H would be nothing.
#pragma once

#include "material/elasticity.hpp"
#include "material/flow.hpp"
#include "material/law.hpp"

namespace presswork {

namespace mises_sheet {

inline constexpr int max_iterations = 60;
inline constexpr double tolerance = 1e-10;  // of the flow stress

template <class T>
struct Solver {
  const Flow& flow_law;
  T p_n, softness;  // factor of temperature on the flow stress
  double dt;
  T A, B, alpha, beta;  // alpha = E/(2 (1 - nu)), beta = 3 G_shear
  T y = T(0.0), over_u = T(0.0), over_v = T(0.0);
  T flow = T(0.0), slope = T(0.0);  // flow stress, and by y

  PRESSWORK_DEVICE void evaluate(T at) {
    flow_law.harden(p_n + at, flow, slope);
    if (flow_law.rate.active()) {
      T factor, by_rate;
      flow_law.rate.evaluate(at * T(1.0 / dt), factor, by_rate);
      slope = slope * factor + flow * by_rate * T(1.0 / dt);
      flow = flow * factor;
    }
    flow = flow * softness, slope = slope * softness;
  }

  // Finds y, the flow stress, 1/u and 1/v in the lanes of `open`; gives those that did not get there. flow_n: at rest.
  PRESSWORK_DEVICE Mask<T> solve(Mask<T> open, T trial, T flow_n) {
    const T rises = (A * alpha + B * beta) / (trial * trial);  // by which the trial stress falls with y at first
    T low(0.0), high = square_root(A / (alpha * alpha) + B / (beta * beta));
    // on the chord of the flow stress up to where a flow stress that does not rise would end
    const T over = trial - flow_n, longest = over / rises;
    evaluate(longest);
    y = select(open, smaller(longest * over / (over + larger(flow - flow_n, T(0.0))), high), T(0.0));
    for (int iteration = 0;; ++iteration) {
      evaluate(y);
      const T u = flow + alpha * y, v = flow + beta * y;
      over_u = T(1.0) / u, over_v = T(1.0) / v;
      const T a = A * over_u * over_u, b = B * over_v * over_v, G = a + b, excess = G - T(1.0);
      open = both(open, either(excess > T(2.0 * tolerance), excess < T(-2.0 * tolerance)));
      if (!any(open) || iteration == max_iterations) return open;
      const auto below = excess > T(0.0);
      low = select(below, y, low), high = select(below, high, y);
      const T fall = a * over_u * (slope + alpha) + b * over_v * (slope + beta);
      const T next = y + T(2.0) * G * excess / ((T(3.0) + G) * fall);
      const auto inside = both(next > low, next < high);
      y = select(open, select(inside, next, T(0.5) * (low + high)), y);
    }
  }
};

}  // namespace mises_sheet

// As return_to_yield (return_mapping.hpp), without a tangent. State: stress, equivalent plastic strain.
template <class T>
PRESSWORK_DEVICE Mask<T> return_mises_sheet(const Flow& flow_law, const Elasticity<3, T>& elastic,
                                            const LawInput<3, T>& in, const T* s0, T* s1) {
  T trial[3];
  elastic.stiffness(in.strain, trial);
  for (int i = 0; i < 3; ++i) trial[i] += s0[i];
  const T sum = trial[0] + trial[1], difference = trial[0] - trial[1];
  const T A = T(0.25) * sum * sum, B = T(0.75) * difference * difference + T(3.0) * trial[2] * trial[2];
  const T size = square_root(A + B);
  const auto finite = A + B < T(1e200);
  const bool frozen = flow_law.depends_on_rate() && in.dt == 0.0;
  const auto& softening = flow_law.thermal.softening;
  mises_sheet::Solver<T> s{flow_law,
                           s0[3],
                           softening.active() ? softening.at(in.temperature).factor : T(1.0),
                           in.dt,
                           A,
                           B,
                           elastic.young * T(0.5) / (T(1.0) - elastic.poisson),
                           T(3.0) * elastic.shear};
  if (!frozen) s.evaluate(T(0.0));
  const T flow_n = s.flow;
  const auto plastic = both(size > flow_n * T(1.0 + 1e-14), finite);
  for (int i = 0; i < 3; ++i) s1[i] = select(finite, trial[i], s0[i]);
  s1[3] = s0[3];
  if (frozen || !any(plastic)) return invert(finite);
  const auto open = s.solve(plastic, size, flow_n);
  const auto moved = both(plastic, invert(open));
  const T mean = T(0.5) * sum * s.flow * s.over_u, half = T(0.5) * difference * s.flow * s.over_v;
  s1[0] = select(moved, mean + half, select(open, s0[0], s1[0]));
  s1[1] = select(moved, mean - half, select(open, s0[1], s1[1]));
  s1[2] = select(moved, trial[2] * s.flow * s.over_v, select(open, s0[2], s1[2]));
  s1[3] = select(moved, s0[3] + s.y, s0[3]);
  return either(open, invert(finite));
}

}  // namespace presswork
