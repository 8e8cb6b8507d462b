// SPDX-License-Identifier: Apache-2.0
// Forward-mode dual numbers over a scalar S (double or Pack): exact derivatives of an algorithm as written.
// Used for the tangents of the stress integrators that have no closed form, and to check those that have one.
#pragma once

#include <type_traits>

#include "tensor/pack.hpp"

namespace presswork {

template <class S, int N>
struct Dual {
  S value;
  S slope[N];

  Dual() = default;
  Dual(double s) : value(s) {
    for (auto& d : slope) d = S(0.0);
  }
  Dual(S s)
    requires(!std::is_same_v<S, double>)
      : value(s) {
    for (auto& d : slope) d = S(0.0);
  }
  static Dual variable(S value, int direction) {
    Dual r(value);
    r.slope[direction] = S(1.0);
    return r;
  }
  // f(value) with df/dvalue known
  Dual chain(S f, S derivative) const {
    Dual r(f);
    for (int i = 0; i < N; ++i) r.slope[i] = derivative * slope[i];
    return r;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r(a.value + b.value);
    for (int i = 0; i < N; ++i) r.slope[i] = a.slope[i] + b.slope[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r(a.value - b.value);
    for (int i = 0; i < N; ++i) r.slope[i] = a.slope[i] - b.slope[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r(a.value * b.value);
    for (int i = 0; i < N; ++i) r.slope[i] = a.slope[i] * b.value + a.value * b.slope[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r(a.value / b.value);
    for (int i = 0; i < N; ++i) r.slope[i] = (a.slope[i] - r.value * b.slope[i]) / b.value;
    return r;
  }
  Dual operator-() const { return Dual(0.0) - *this; }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
};

template <class M, class S, int N>
Dual<S, N> select(M m, const Dual<S, N>& a, const Dual<S, N>& b) {
  Dual<S, N> r;
  r.value = select(m, a.value, b.value);
  for (int i = 0; i < N; ++i) r.slope[i] = select(m, a.slope[i], b.slope[i]);
  return r;
}
template <class S, int N>
Dual<S, N> square_root(const Dual<S, N>& a) {
  S root = square_root(a.value);
  return a.chain(root, S(0.5) / larger(root, S(1e-300)));
}
template <class S, int N>
Dual<S, N> logarithm_one_plus(const Dual<S, N>& a) {
  return a.chain(logarithm_one_plus(a.value), S(1.0) / (S(1.0) + a.value));
}
template <class S, int N>
Dual<S, N> exponential(const Dual<S, N>& a) {
  S e = exponential(a.value);
  return a.chain(e, e);
}
template <class S, int N>
Dual<S, N> logarithm(const Dual<S, N>& a) {
  return a.chain(logarithm(a.value), S(1.0) / a.value);
}
template <class S, int N>
Dual<S, N> power(const Dual<S, N>& a, double b) {
  return a.chain(power(a.value, b), S(b) * power(a.value, b - 1.0));
}
template <class S, int N>
S value_of(const Dual<S, N>& a) {
  return a.value;
}

}  // namespace presswork
