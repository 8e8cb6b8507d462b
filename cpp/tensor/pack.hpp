// SPDX-License-Identifier: Apache-2.0
// A thin SIMD pack of doubles or floats, and the few scalar functions that kernels call on double and pack alike.
//
// A kernel is a template on its scalar T: double (one lane, also of a GPU) or float, Pack (the CPU's vector width),
// FloatPack or Dual (dual.hpp).
// Comparisons give Mask<T>; a branch is written select(mask, a, b) and any(mask).
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "tensor/on_device.hpp"

namespace presswork {

// Bytes of a vector: those of the CPU compiled for, or fewer if asked for (8: one lane of double).
#if !defined(PRESSWORK_VECTOR_BYTES)
#if defined(__AVX512F__)
#define PRESSWORK_VECTOR_BYTES 64
#elif defined(__AVX__)
#define PRESSWORK_VECTOR_BYTES 32
#else
#define PRESSWORK_VECTOR_BYTES 16
#endif
#endif
inline constexpr int vector_bytes = PRESSWORK_VECTOR_BYTES;

template <class Real>
struct VectorOf;
template <>
struct VectorOf<double> {
  using Integer = std::int64_t;
  typedef double Vector __attribute__((vector_size(vector_bytes)));
  typedef Integer Mask __attribute__((vector_size(vector_bytes)));
};
template <>
struct VectorOf<float> {
  using Integer = std::int32_t;
  typedef float Vector __attribute__((vector_size(vector_bytes)));
  typedef Integer Mask __attribute__((vector_size(vector_bytes)));
};

template <class Real>
struct PackOf {
  static constexpr int width = vector_bytes / sizeof(Real);
  using Integer = typename VectorOf<Real>::Integer;
  using Vector = typename VectorOf<Real>::Vector;
  using Mask = typename VectorOf<Real>::Mask;
  Vector v;

  PackOf() = default;
  PackOf(Real s) : v(Vector{} + s) {}
  PackOf(Vector x) : v(x) {}
  Real operator[](int lane) const { return v[lane]; }
  void set(int lane, Real x) { v[lane] = x; }

  friend PackOf operator+(PackOf a, PackOf b) { return a.v + b.v; }
  friend PackOf operator-(PackOf a, PackOf b) { return a.v - b.v; }
  friend PackOf operator*(PackOf a, PackOf b) { return a.v * b.v; }
  friend PackOf operator/(PackOf a, PackOf b) { return a.v / b.v; }
  PackOf operator-() const { return -v; }
  PackOf& operator+=(PackOf b) {
    v += b.v;
    return *this;
  }
  PackOf& operator-=(PackOf b) {
    v -= b.v;
    return *this;
  }
  PackOf& operator*=(PackOf b) {
    v *= b.v;
    return *this;
  }
  friend Mask operator<(PackOf a, PackOf b) { return a.v < b.v; }
  friend Mask operator>(PackOf a, PackOf b) { return a.v > b.v; }
  friend PackOf select(Mask m, PackOf a, PackOf b) { return PackOf(m ? a.v : b.v); }
};

using Pack = PackOf<double>;
using FloatPack = PackOf<float>;  // twice the lanes
inline constexpr int pack_width = Pack::width;

// Whether T is a double or a pack of them: no floats, no dual numbers.
template <class T>
inline constexpr bool is_of_doubles = false;
template <>
inline constexpr bool is_of_doubles<double> = true;
template <>
inline constexpr bool is_of_doubles<Pack> = true;

// --- masks ---------------------------------------------------------------------------------------------------------
template <class T>
using Mask = decltype(T(0.0) < T(0.0));

PRESSWORK_DEVICE inline double select(bool m, double a, double b) { return m ? a : b; }
PRESSWORK_DEVICE inline float select(bool m, float a, float b) { return m ? a : b; }
PRESSWORK_DEVICE inline bool any(bool m) { return m; }
PRESSWORK_DEVICE inline bool both(bool a, bool b) { return a && b; }
PRESSWORK_DEVICE inline bool either(bool a, bool b) { return a || b; }
PRESSWORK_DEVICE inline bool invert(bool m) { return !m; }

inline bool any(Pack::Mask m) {
#if PRESSWORK_VECTOR_BYTES == 64
  return _mm512_test_epi64_mask((__m512i)m, (__m512i)m) != 0;
#elif PRESSWORK_VECTOR_BYTES == 32
  return _mm256_movemask_pd((__m256d)m) != 0;
#else
  std::int64_t found = 0;
  for (int i = 0; i < Pack::width; ++i) found |= m[i];
  return found != 0;
#endif
}
inline bool any(FloatPack::Mask m) {
#if PRESSWORK_VECTOR_BYTES == 32
  return _mm256_movemask_ps((__m256)m) != 0;
#else
  return any(std::bit_cast<Pack::Mask>(m));
#endif
}
inline Pack::Mask both(Pack::Mask a, Pack::Mask b) { return a & b; }
inline Pack::Mask either(Pack::Mask a, Pack::Mask b) { return a | b; }
inline Pack::Mask invert(Pack::Mask m) { return ~m; }
inline FloatPack::Mask both(FloatPack::Mask a, FloatPack::Mask b) { return a & b; }
inline FloatPack::Mask either(FloatPack::Mask a, FloatPack::Mask b) { return a | b; }
inline FloatPack::Mask invert(FloatPack::Mask m) { return ~m; }

// --- functions -----------------------------------------------------------------------------------------------------
// Applies a scalar function lane by lane; the compiler turns sqrt into one vector instruction.
template <class F>
Pack map_lanes(Pack a, F f) {
  Pack r;
  for (int i = 0; i < pack_width; ++i) r.v[i] = f(a.v[i]);
  return r;
}

PRESSWORK_DEVICE inline double square_root(double a) { return std::sqrt(a); }
PRESSWORK_DEVICE inline float square_root(float a) { return std::sqrt(a); }
PRESSWORK_DEVICE inline double logarithm(double a) { return std::log(a); }
PRESSWORK_DEVICE inline double logarithm_one_plus(double a) { return std::log1p(a); }
PRESSWORK_DEVICE inline double exponential(double a) { return std::exp(a); }
PRESSWORK_DEVICE inline double power(double a, double b) { return std::pow(a, b); }

inline Pack square_root(Pack a) {
#if PRESSWORK_VECTOR_BYTES == 64
  return Pack((Pack::Vector)_mm512_maskz_sqrt_pd(0xff, (__m512d)a.v));
#elif PRESSWORK_VECTOR_BYTES == 32
  return Pack((Pack::Vector)_mm256_sqrt_pd((__m256d)a.v));
#else
  return map_lanes(a, [](double x) { return std::sqrt(x); });
#endif
}
inline FloatPack square_root(FloatPack a) {
#if PRESSWORK_VECTOR_BYTES == 64
  return FloatPack((FloatPack::Vector)_mm512_maskz_sqrt_ps(0xffff, (__m512)a.v));
#elif PRESSWORK_VECTOR_BYTES == 32
  return FloatPack((FloatPack::Vector)_mm256_sqrt_ps((__m256)a.v));
#else
  for (int i = 0; i < FloatPack::width; ++i) a.v[i] = std::sqrt(a.v[i]);
  return a;
#endif
}

// Horner's rule, the highest coefficient first.
template <std::size_t n>
Pack polynomial(Pack x, const double (&c)[n]) {
  Pack sum(c[0]);
  for (std::size_t i = 1; i < n; ++i) sum = sum * x + Pack(c[i]);
  return sum;
}

// ln of all lanes at once, to about one unit in the last place: x = 2^e m, sqrt(1/2) <= m < sqrt(2), ln m = 2 atanh((m
// - 1)/(m + 1)) by its series. Lanes that are not normal positive numbers are left to the library.
inline Pack logarithm(Pack a) {
  auto odd = (a.v < Pack(2.3e-308).v) | (a.v > Pack(1.7e308).v) | (a.v != a.v);
  if (any(odd)) return map_lanes(a, [](double x) { return std::log(x); });
  const Pack::Mask bits = std::bit_cast<Pack::Mask>(a.v), shift = bits - 0x3fe6a09e667f3bcdLL;  // sqrt(1/2)
  const Pack::Mask exponent = shift >> 52;
  Pack m(std::bit_cast<Pack::Vector>(bits - (exponent << 52)));
  // a small whole number becomes a double by the bits of 1.5 2^52
  Pack e(std::bit_cast<Pack::Vector>(exponent + 0x4338000000000000LL) - 6755399441055744.0);
  Pack s = (m - Pack(1.0)) / (m + Pack(1.0)), s2 = s * s;
  static constexpr double series[] = {2.0 / 23, 2.0 / 21, 2.0 / 19, 2.0 / 17, 2.0 / 15, 2.0 / 13,
                                      2.0 / 11, 2.0 / 9,  2.0 / 7,  2.0 / 5,  2.0 / 3};
  Pack rest = s * s2 * polynomial(s2, series);
  return e * Pack(6.93147180369123816490e-01) + (e * Pack(1.90821492927058770002e-10) + rest + (s + s));
}
inline Pack logarithm_one_plus(Pack a) {
  return map_lanes(a, [](double x) { return std::log1p(x); });
}

// e^x of all lanes at once: x = n ln 2 + r, |r| <= ln(2)/2, e^r by its series, 2^n by the exponent's bits.
inline Pack exponential(Pack a) {
  auto odd = (a.v < Pack(-700.0).v) | (a.v > Pack(700.0).v) | (a.v != a.v);
  if (any(odd)) return map_lanes(a, [](double x) { return std::exp(x); });
  Pack shifted = a * Pack(1.44269504088896338700) + Pack(6755399441055744.0), n = shifted - Pack(6755399441055744.0);
  Pack r = a - n * Pack(6.93147180369123816490e-01) - n * Pack(1.90821492927058770002e-10);
  static constexpr double series[] = {
      1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040,
      1.0 / 720,        1.0 / 120,       1.0 / 24,       1.0 / 6,       0.5,          1.0,         1.0};
  Pack value = polynomial(r, series);
  return Pack(
      std::bit_cast<Pack::Vector>(std::bit_cast<Pack::Mask>(value.v) + (std::bit_cast<Pack::Mask>(shifted.v) << 52)));
}

// a^b of positive numbers
inline Pack power(Pack a, double b) { return exponential(Pack(b) * logarithm(a)); }

// The lower (half 0) or upper lanes of floats as doubles, and back.
inline Pack widen(FloatPack a, int half) {
  Pack r;
  for (int i = 0; i < pack_width; ++i) r.v[i] = a.v[half * pack_width + i];
  return r;
}
inline void narrow(Pack a, int half, FloatPack& to) {
  for (int i = 0; i < pack_width; ++i) to.v[half * pack_width + i] = static_cast<float>(a.v[i]);
}

template <class T>
PRESSWORK_DEVICE T smaller(T a, T b) {
  return select(a < b, a, b);
}
template <class T>
PRESSWORK_DEVICE T larger(T a, T b) {
  return select(a > b, a, b);
}

// The value without derivatives: identity but for dual numbers.
PRESSWORK_DEVICE inline double value_of(double a) { return a; }
inline Pack value_of(Pack a) { return a; }

}  // namespace presswork
