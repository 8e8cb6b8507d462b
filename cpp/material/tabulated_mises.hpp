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
// and the stress is s H/u, d H/v, c H/v. G^(-1/2) is nearly a straight line: its series to third order about y = 0,
// inverted, is the first guess, close enough for the increments of an explicit run. From there, or from y = 0 where the
// trial stress lies far outside, Halley's step on G^(-1/2), of order three, is repeated until |G - 1| is within
// tolerance in every lane, whatever the increment.
#pragma once

#include "material/return_mapping.hpp"
#include "tensor/carried_sum.hpp"

namespace presswork {

struct TabulatedMises {
  // of G: half of it of the flow stress; in single precision a few units in the last place
  template <class T>
  static constexpr double tolerance = std::is_same_v<T, FloatPack> || std::is_same_v<T, float> ? 2e-6 : 1e-10;
  static constexpr int max_iterations = 60;

  double young = 0.0;  // [MPa]
  double poisson = 0.0;
  TabulatedHardening hardening;

  // Advance the lanes by increments of strain: sum xx + yy, difference xx - yy, engineering shear. state: s, d, c and
  // the equivalent plastic strain, in place; rounding: of those in single precision, carried to the next increment.
  // Gives the increment of thickness strain. squares, unless null: of von Mises' stress of the elastic trial and after
  // the increment.
  template <class T>
  PRESSWORK_INLINE T advance(T sum, T difference, T shear, T state[4], T* rounding, T* squares = nullptr) const {
    const double two_g = young / (1.0 + poisson);
    T s_n = state[0], s = s_n, d = state[1], c = state[2];
    const T trial[3] = {T(young / (1.0 - poisson)) * sum, T(two_g) * difference, T(0.5 * two_g) * shear};
    if constexpr (is_single<T>) {
      add_carried(trial[0], s, rounding[0]), add_carried(trial[1], d, rounding[1]);
      add_carried(trial[2], c, rounding[2]);
    } else {
      s += trial[0], d += trial[1], c += trial[2];
    }
    T A = T(0.25) * s * s, B = T(0.75) * d * d + T(3.0) * c * c;
    T x_n = state[3] + T(hardening.shift());
    TabulatedHardening::Piece<T> piece;
    hardening.find(x_n, piece);
    T H = piece.value(x_n);
    auto plastic = A + B > H * H;
    if (squares) squares[0] = squares[1] = A + B;
    if (any(plastic)) {
      T y = select(plastic, guess(A, B, x_n, H, piece), T(0.0)), over_u, over_v;
      solve(A, B, x_n, plastic, piece, y, H, over_u, over_v);
      s = select(plastic, s * H * over_u, s);
      T ratio = H * over_v;
      d = select(plastic, d * ratio, d);
      c = select(plastic, c * ratio, c);
      if constexpr (is_single<T>)
        add_carried(y, state[3], rounding[3]);
      else
        state[3] = state[3] + y;
      if (squares) squares[1] = select(plastic, H * H, squares[1]);
    }
    state[0] = s, state[1] = d, state[2] = c;
    return T((1.0 - 2.0 * poisson) / young) * (s - s_n) - sum;
  }

 private:
  static constexpr double near = 0.1;  // of G - 1 at y = 0, within which the series is taken

  // u and v over y, beside the slope of the hardening.
  PRESSWORK_DEVICE double alpha() const { return 0.5 * young / (1.0 - poisson); }
  PRESSWORK_DEVICE double beta() const { return 1.5 * young / (1.0 + poisson); }

  // With m the mean slope of u/H and v/H, weighed by A and B, z = m y and e = G(0) - 1:
  //   (G/G(0))^(-1/2) = 1 + z + (w - 3/2 k) z^2 + (3/2 k + 2 l) z^3 = (1 + e)^(1/2),
  // k and l the second and third central moments of those slopes over m^2 and m^3, w that of the curve's curvature.
  template <class T>
  PRESSWORK_INLINE T guess(T A, T B, T x_n, T H, const TabulatedHardening::Piece<T>& piece) const {
    const T slope = piece.slope(x_n), S = A + B, square = H * H;
    const T M = A * (slope + T(alpha())) + B * (slope + T(beta()));  // m S H
    const T over = T(1.0) / (M * square), over_M = over * square, e = over * (S * M) - T(1.0), part = S * over_M;
    const T a = T(beta() - alpha()) * over_M * A, b = T(beta() - alpha()) * over_M * B;
    const T k = T(1.5) * a * b, w = piece.half_curvature(x_n) * H * part * part;
    const T second = w - k, third = k + T(2.0) * a * b * (a - b);
    const T root = T(0.5) * e * (T(1.0) - T(0.25) * e * (T(1.0) - T(0.5) * e * (T(1.0) - T(0.625) * e)));
    const T z = root * (T(1.0) - root * (second - root * (T(2.0) * second * second - third)));
    return select(e < T(near), z * H * part, T(0.0));
  }

  template <class T>
  PRESSWORK_INLINE void solve(T A, T B, T x_n, Mask<T> open, TabulatedHardening::Piece<T>& piece, T& y, T& H, T& over_u,
                              T& over_v) const {
    const T alpha(this->alpha()), beta(this->beta());
    for (int iteration = 0;; ++iteration) {
      T x = x_n + y;
      if (any(either(x<piece.left, x> piece.left + piece.width))) hardening.find_anew(x, piece);
      H = piece.value(x);
      T u = H + alpha * y, v = H + beta * y, both_over = T(1.0) / (u * v);
      over_u = v * both_over, over_v = u * both_over;
      T a = A * over_u * over_u, b = B * over_v * over_v, G = a + b, excess = G - T(1.0);
      open = both(open, either(excess > T(tolerance<T>), excess < T(-tolerance<T>)));
      if (!any(open) || iteration == max_iterations) return;
      T slope = piece.slope(x);
      T fall = a * over_u * (slope + alpha) + b * over_v * (slope + beta);
      T step = T(2.0) * G * excess / ((T(3.0) + G) * fall);
      y = select(open, larger(y + step, T(0.0)), y);
    }
  }
};

}  // namespace presswork
