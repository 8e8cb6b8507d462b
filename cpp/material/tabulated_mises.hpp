// SPDX-License-Identifier: Apache-2.0
// Von Mises in plane stress with isotropic hardening from a table: the fast law of the explicit loop.
//
// The update is backward Euler, as update_sheet's, written for sum s = xx + yy, difference d = xx - yy and shear c of
// the stress, in which elasticity and the yield function are diagonal (Simo & Taylor 1986). With the trial stress, the
// flow stress H(p + y) and the increment y of equivalent plastic strain, all of plasticity is one scalar equation,
//
//   G(y) = A / u^2 + B / v^2 = 1,      u = H + y E/(2 (1 - nu)),  v = H + 3 G_shear y,
//   A = s^2/4,  B = 3 d^2/4 + 3 c^2    of the trial stress,
//
// and the stress is s H/u, d H/v, c H/v. Halley's step on G^(-1/2) from y = 0 converges with order three: two steps for
// the increments of an explicit run; iteration goes on until |G - 1| is within tolerance in every lane, whatever the
// increment.
#pragma once

#include "material/return_mapping.hpp"

namespace presswork {

struct TabulatedMises {
  // of G: half of it of the flow stress; in single precision a few units in the last place
  template <class T>
  static constexpr double tolerance = std::is_same_v<T, FloatPack> || std::is_same_v<T, float> ? 2e-6 : 1e-9;
  static constexpr int max_iterations = 60;

  double young = 0.0;  // [MPa]
  double poisson = 0.0;
  TabulatedHardening hardening;

  // Advance the lanes by increments of strain: sum xx + yy, difference xx - yy, engineering shear. state: s, d, c and
  // the equivalent plastic strain, in place. Gives the increment of thickness strain.
  template <class T>
  PRESSWORK_DEVICE T advance(T sum, T difference, T shear, T state[4]) const {
    const double two_g = young / (1.0 + poisson);
    T s_n = state[0];
    T s = s_n + T(young / (1.0 - poisson)) * sum, d = state[1] + T(two_g) * difference;
    T c = state[2] + T(0.5 * two_g) * shear;
    T A = T(0.25) * s * s, B = T(0.75) * d * d + T(3.0) * c * c;
    T x_n = state[3] + T(hardening.shift());
    TabulatedHardening::Piece<T> piece;
    hardening.find(x_n, piece);
    T H = piece.value(x_n);
    auto plastic = A + B > H * H;
    if (any(plastic)) {
      T y(0.0), over_u, over_v;
      solve(A, B, x_n, plastic, piece, y, H, over_u, over_v);
      s = select(plastic, s * H * over_u, s);
      T ratio = H * over_v;
      d = select(plastic, d * ratio, d);
      c = select(plastic, c * ratio, c);
      state[3] = state[3] + y;
    }
    state[0] = s, state[1] = d, state[2] = c;
    return T((1.0 - 2.0 * poisson) / young) * (s - s_n) - sum;
  }

 private:
  template <class T>
  PRESSWORK_DEVICE void solve(T A, T B, T x_n, Mask<T> open, TabulatedHardening::Piece<T>& piece, T& y, T& H, T& over_u,
                              T& over_v) const {
    const T alpha(0.5 * young / (1.0 - poisson)), beta(1.5 * young / (1.0 + poisson));
    for (int iteration = 0;; ++iteration) {
      T x = x_n + y, slope = piece.slope(x);
      H = piece.value(x);
      T u = H + alpha * y, v = H + beta * y, both_over = T(1.0) / (u * v);
      over_u = v * both_over, over_v = u * both_over;
      T a = A * over_u * over_u, b = B * over_v * over_v, G = a + b, excess = G - T(1.0);
      open = both(open, either(excess > T(tolerance<T>), excess < T(-tolerance<T>)));
      if (!any(open) || iteration == max_iterations) return;
      T fall = a * over_u * (slope + alpha) + b * over_v * (slope + beta);
      T step = T(2.0) * G * excess / ((T(3.0) + G) * fall);
      y = select(open, larger(y + step, T(0.0)), y);
      x = x_n + y;
      if (any(either(x<piece.left, x> piece.left + piece.width))) hardening.find(x, piece);
    }
  }
};

}  // namespace presswork
