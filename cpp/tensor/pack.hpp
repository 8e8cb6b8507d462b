// SPDX-License-Identifier: Apache-2.0
// A thin SIMD pack of doubles, and the few scalar functions that kernels call on double and pack alike.
//
// A kernel is a template on its scalar T: double (one lane), Pack (the CPU's vector width) or Dual (dual.hpp).
// Comparisons give Mask<T>; a branch is written select(mask, a, b) and any(mask).
#pragma once

#include <cmath>
#include <cstdint>

namespace presswork {

#if defined(__AVX512F__)
inline constexpr int pack_width = 8;
#elif defined(__AVX__)
inline constexpr int pack_width = 4;
#else
inline constexpr int pack_width = 2;
#endif

struct Pack {
  typedef double Vector __attribute__((vector_size(pack_width * 8)));
  typedef std::int64_t Mask __attribute__((vector_size(pack_width * 8)));
  Vector v;

  Pack() = default;
  Pack(double s) : v(Vector{} + s) {}
  Pack(Vector x) : v(x) {}
  double operator[](int lane) const { return v[lane]; }
  void set(int lane, double x) { v[lane] = x; }

  friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
  friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
  friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
  friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
  Pack operator-() const { return -v; }
  Pack& operator+=(Pack b) {
    v += b.v;
    return *this;
  }
  Pack& operator-=(Pack b) {
    v -= b.v;
    return *this;
  }
  Pack& operator*=(Pack b) {
    v *= b.v;
    return *this;
  }
  friend Mask operator<(Pack a, Pack b) { return a.v < b.v; }
  friend Mask operator>(Pack a, Pack b) { return a.v > b.v; }
};

// --- masks ---------------------------------------------------------------------------------------------------------
inline double select(bool m, double a, double b) { return m ? a : b; }
inline bool any(bool m) { return m; }
inline bool both(bool a, bool b) { return a && b; }

inline Pack select(Pack::Mask m, Pack a, Pack b) { return Pack(m ? a.v : b.v); }
inline bool any(Pack::Mask m) {
  std::int64_t seen = 0;
  for (int i = 0; i < pack_width; ++i) seen |= m[i];
  return seen != 0;
}
inline Pack::Mask both(Pack::Mask a, Pack::Mask b) { return a & b; }

// --- functions -----------------------------------------------------------------------------------------------------
// Applies a scalar function lane by lane; the compiler turns sqrt into one vector instruction.
template <class F>
Pack map_lanes(Pack a, F f) {
  Pack r;
  for (int i = 0; i < pack_width; ++i) r.v[i] = f(a.v[i]);
  return r;
}

inline double square_root(double a) { return std::sqrt(a); }
inline double logarithm(double a) { return std::log(a); }
inline double exponential(double a) { return std::exp(a); }
inline double power(double a, double b) { return std::pow(a, b); }

inline Pack square_root(Pack a) {
  return map_lanes(a, [](double x) { return std::sqrt(x); });
}
inline Pack logarithm(Pack a) {
  return map_lanes(a, [](double x) { return std::log(x); });
}
inline Pack exponential(Pack a) {
  return map_lanes(a, [](double x) { return std::exp(x); });
}
inline Pack power(Pack a, double b) {
  return map_lanes(a, [b](double x) { return std::pow(x, b); });
}

template <class T>
T smaller(T a, T b) {
  return select(a < b, a, b);
}
template <class T>
T larger(T a, T b) {
  return select(a > b, a, b);
}

// The value without derivatives: identity but for dual numbers.
inline double value_of(double a) { return a; }
inline Pack value_of(Pack a) { return a; }

}  // namespace presswork
