// SPDX-License-Identifier: Apache-2.0
// Kinematic hardening: the back stress at the end of an increment as a function of the shifted stress xi = stress -
// back stress and of the increment dp of equivalent plastic strain, backward Euler in closed form.
//
//   NoKinematic     none
//   Chaboche        d a_i = C_i xi/Y dp - g_i a_i dp, any number of them; g_i = 0 is Prager-Ziegler's linear law
//   YoshidaUemori   d theta = C [(a/Y) xi - sqrt(a / f(theta)) theta] dp,  a = B + R - Y
//                   d beta = m (b xi/Y - beta) dp,   d R = m (Rsat - R) dp outside the stagnation surface
//
// The direction xi/Y is Ziegler's. In plane stress a back stress is kept as the plane stress with the same deviator;
// for von Mises the laws are then those of Chaboche (1986) and Yoshida & Uemori (2002) with (2/3) C d(plastic strain).
// Yoshida & Uemori: R and the stagnation surface (centre q, size r) are those of the start of the increment while it is
// solved, and follow at its end: with x = f(beta - q) - r > 0, r grows by h x and q follows radially. Young's modulus
// falls with the plastic strain: E = E0 - (E0 - Ea)(1 - exp(-xi p)).
//
// History: Chaboche a_1, a_2, ... (N each); Yoshida-Uemori theta, beta (N each), R, q (N), r.
#pragma once

#include "material/yield_functions.hpp"

namespace presswork {

// back stress at the end and its derivatives
template <int N, class T>
struct BackStress {
  T value[N];
  T by_xi[N][N];
  T by_dp[N];
  T by_flow[N];  // at a fixed dp: where the flow stress knows of xi, as one that is heated does
};

// The direction in which a back stress grows: all of xi in plane stress, else its deviator.
template <int N, class T>
PRESSWORK_DEVICE void back_direction(const T xi[N], T direction[N]) {
  for (int i = 0; i < N; ++i) direction[i] = xi[i];
  if constexpr (N > 3) {
    T mean = (xi[0] + xi[1] + xi[2]) * T(1.0 / 3);
    for (int i = 0; i < 3; ++i) direction[i] -= mean;
  }
}
// adds factor d(direction)/d(xi)
template <int N, class T>
PRESSWORK_DEVICE void add_direction_slope(T factor, T by_xi[N][N]) {
  for (int i = 0; i < N; ++i) by_xi[i][i] += factor;
  if constexpr (N > 3)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) by_xi[i][j] -= factor * T(1.0 / 3);
}

struct NoKinematic {
  static constexpr bool active = false;
  template <int N>
  PRESSWORK_DEVICE int history_size() const {
    return 0;
  }
};

struct Chaboche {
  static constexpr bool active = true;
  static constexpr int most = 10;  // for which a layer of a shell has room
  int count = 0;
  double C[most] = {}, gamma[most] = {};  // [MPa], [-]

  template <int N>
  PRESSWORK_DEVICE int history_size() const {
    return N * count;
  }
  template <int N, class T>
  PRESSWORK_DEVICE void total(const T* history, T back[N]) const {
    for (int i = 0; i < N; ++i) back[i] = T(0.0);
    for (int k = 0; k < count; ++k)
      for (int i = 0; i < N; ++i) back[i] += history[N * k + i];
  }
  template <int N, class Yield, class T>
  PRESSWORK_DEVICE void evaluate(const Yield&, const T* history, const T xi[N], T dp, T flow, T flow_slope,
                                 BackStress<N, T>& out) const {
    T direction[N], growth(0.0), growth_slope(0.0), over = T(1.0) / flow;
    back_direction<N>(xi, direction);
    for (int i = 0; i < N; ++i) {
      out.value[i] = out.by_dp[i] = T(0.0);
      for (auto& x : out.by_xi[i]) x = T(0.0);
    }
    for (int k = 0; k < count; ++k) {
      T fade = T(1.0) / (T(1.0) + T(gamma[k]) * dp);
      T w = T(C[k]) * fade * over;
      growth += w * dp;
      growth_slope += w * (fade - dp * flow_slope * over);  // d(dp/(1 + g dp))/ddp = 1/(1 + g dp)^2
      for (int i = 0; i < N; ++i) {
        out.value[i] += history[N * k + i] * fade;
        out.by_dp[i] -= T(gamma[k]) * fade * fade * history[N * k + i];
      }
    }
    for (int i = 0; i < N; ++i) {
      out.value[i] += growth * direction[i];
      out.by_dp[i] += growth_slope * direction[i];
      out.by_flow[i] = -growth * over * direction[i];
    }
    add_direction_slope<N>(growth, out.by_xi);
  }
  template <int N, class Yield, class T>
  PRESSWORK_DEVICE void advance(const Yield&, T* history, const T xi[N], T dp, T flow, Mask<T> moved) const {
    T direction[N];
    back_direction<N>(xi, direction);
    for (int k = 0; k < count; ++k)
      for (int i = 0; i < N; ++i) {
        T& a = history[N * k + i];
        a = select(moved, (a + T(C[k]) * dp * direction[i] / flow) / (T(1.0) + T(gamma[k]) * dp), a);
      }
  }
};

struct YoshidaUemori {
  static constexpr bool active = true;
  double Y = 0.0, B = 0.0, C = 0.0, m = 0.0, b = 0.0, Rsat = 0.0, h = 0.0;  // Y, B, b, Rsat [MPa]

  template <int N>
  PRESSWORK_DEVICE int history_size() const {
    return 3 * N + 2;
  }
  template <int N, class T>
  PRESSWORK_DEVICE void total(const T* history, T back[N]) const {
    for (int i = 0; i < N; ++i) back[i] = history[i] + history[N + i];
  }
  // Theta = theta_n + C a dp/Y direction; theta = Theta x / (x + C dp sqrt(a)) with x = sqrt(f(theta)) from the
  // quadratic
  template <int N, class Yield, class T>
  PRESSWORK_DEVICE void move_theta(const Yield& yield, const T* history, const T direction[N], T dp, T theta[N],
                                   T& root_a, T& x, YieldTerms<N, T>& terms) const {
    T a = T(B - Y) + history[2 * N];
    root_a = square_root(a);
    for (int i = 0; i < N; ++i) theta[i] = history[i] + T(C / Y) * a * dp * direction[i];
    yield.evaluate(theta, terms);
    T half = T(0.5 * C) * dp * root_a;
    x = square_root(half * half + terms.value) - half;
  }
  template <int N, class Yield, class T>
  PRESSWORK_DEVICE void evaluate(const Yield& yield, const T* history, const T xi[N], T dp, T, T,
                                 BackStress<N, T>& out) const {
    T direction[N], Theta[N], root_a, x;
    YieldTerms<N, T> terms;
    back_direction<N>(xi, direction);
    move_theta<N>(yield, history, direction, dp, Theta, root_a, x, terms);
    T drag = T(C) * root_a, a = root_a * root_a;
    T bottom = larger(x + drag * dp, T(1e-300));
    T fade = x / bottom;
    // x^2 + drag dp x = f(Theta)
    T x_by_f = T(1.0) / larger(T(2.0) * x + drag * dp, T(1e-300));
    T x_by_dp = -drag * x * x_by_f;
    T fade_by_x = drag * dp / (bottom * bottom);
    T fade_by_dp = fade_by_x * x_by_dp - drag * x / (bottom * bottom);
    T grow = T(C / Y) * a, fade_by_f = fade_by_x * x_by_f;
    T along(0.0);
    for (int i = 0; i < N; ++i) along += terms.gradient[i] * direction[i];
    T slow = T(1.0) / (T(1.0) + T(m) * dp);
    T lift = T(m * b / Y) * dp * slow;
    for (int i = 0; i < N; ++i) {
      T beta = history[N + i] * slow + lift * direction[i];
      out.value[i] = fade * Theta[i] + beta;
      out.by_dp[i] = fade * grow * direction[i] + (fade_by_dp + fade_by_f * grow * along) * Theta[i] +
                     T(m) * slow * (T(b / Y) * direction[i] - beta);
      out.by_flow[i] = T(0.0);
      for (int j = 0; j < N; ++j) out.by_xi[i][j] = fade_by_f * grow * dp * Theta[i] * terms.gradient[j];
    }
    add_direction_slope<N>(fade * grow * dp + lift, out.by_xi);
  }
  template <int N, class Yield, class T>
  PRESSWORK_DEVICE void advance(const Yield& yield, T* history, const T xi[N], T dp, T, Mask<T> moved) const {
    T direction[N], Theta[N], root_a, x, before[N], after[N];
    YieldTerms<N, T> terms;
    back_direction<N>(xi, direction);
    move_theta<N>(yield, history, direction, dp, Theta, root_a, x, terms);
    T fade = x / larger(x + T(C) * root_a * dp, T(1e-300));
    T slow = T(1.0) / (T(1.0) + T(m) * dp);
    T *beta = history + N, *q = history + 2 * N + 1, &R = history[2 * N], &r = history[3 * N + 1];
    for (int i = 0; i < N; ++i) {
      history[i] = select(moved, fade * Theta[i], history[i]);
      before[i] = beta[i] - q[i];
      beta[i] = select(moved, slow * (beta[i] + T(m * b / Y) * dp * direction[i]), beta[i]);
      after[i] = beta[i] - q[i];
    }
    T size_before = yield.value(before), size = yield.value(after);
    auto outside = both(moved, size > r);
    T excess = select(outside, size - r, T(0.0));
    T share = smaller(excess / larger(size - size_before, T(1e-12 * Y)), T(1.0));
    T grown = select(outside, T(m) * dp * share, T(0.0));
    R = (R + T(Rsat) * grown) / (T(1.0) + grown);
    r += T(h) * excess;
    T keep = select(outside, T(1.0) - r / size, T(0.0));
    for (int i = 0; i < N; ++i) q[i] += keep * after[i];
  }
};

using KinematicLaw = std::variant<NoKinematic, Chaboche, YoshidaUemori>;

}  // namespace presswork
