// SPDX-License-Identifier: Apache-2.0
// From an array of short records (array of structures) to packs and back, by whole loads and shuffles in registers.
//
// load_records<R>(from, out): lane l of out[i] is from[l][i], i < R. store_records<R>(rows, to): to[l][i] is lane l of
// rows[i]. R is a power of two for loads and a
// multiple of half the width for stores. A hardware gather of the same values
// takes several times as long.
#pragma once

#include <bit>
#include <cstring>
#include <utility>

#include "tensor/pack.hpp"

namespace presswork {

namespace records {

// One butterfly of a transposition: exchanges the off-diagonal blocks of `step` lanes between rows a and b.
template <int step, class P, int... lane>
[[gnu::always_inline]] inline void exchange(P& a, P& b, std::integer_sequence<int, lane...>) {
  constexpr typename P::Mask low = {((lane & step) ? P::width + (lane ^ step) : lane)...};
  constexpr typename P::Mask high = {((lane & step) ? P::width + lane : (lane ^ step))...};
  const typename P::Vector first = __builtin_shuffle(a.v, b.v, low);
  b = __builtin_shuffle(a.v, b.v, high);
  a = first;
}

// Transposes blocks of `size` rows by `size` lanes.
template <int size, class P>
[[gnu::always_inline]] inline void transpose(P* rows) {
  constexpr auto lanes = std::make_integer_sequence<int, P::width>{};
  auto stage = [&]<int step>() {
    if constexpr (step < size)
      for (int i = 0; i < size; ++i)
        if (!(i & step)) exchange<step>(rows[i], rows[i | step], lanes);
  };
  stage.template operator()<1>();
  stage.template operator()<2>();
  stage.template operator()<4>();
  stage.template operator()<8>();
  static_assert(size <= 16);
}

// A pack of the records of R numbers at from[0], from[R], from[2 R], ...: by inserts in registers, since a load of what
// several narrower stores have just written waits for all of them.
template <int R, class Real>
[[gnu::always_inline]] inline PackOf<Real> join(const Real* const* from) {
  using P = PackOf<Real>;
#if PRESSWORK_VECTOR_BYTES == 64
  if constexpr (R * sizeof(Real) == 32) {
    const auto part = [&](int i) { return _mm256_loadu_ps(reinterpret_cast<const float*>(from[i * R])); };
    const __m512 pair = _mm512_castps256_ps512(part(0));
    return P(std::bit_cast<typename P::Vector>(_mm512_insertf32x8(pair, part(1), 1)));
  } else if constexpr (R * sizeof(Real) == 16) {
    const auto part = [&](int i) { return _mm_loadu_ps(reinterpret_cast<const float*>(from[i * R])); };
    __m512 all = _mm512_castps128_ps512(part(0));
    all = _mm512_insertf32x4(all, part(1), 1);
    all = _mm512_insertf32x4(all, part(2), 2);
    all = _mm512_insertf32x4(all, part(3), 3);
    return P(std::bit_cast<typename P::Vector>(all));
  }
#elif PRESSWORK_VECTOR_BYTES == 32
  if constexpr (R * sizeof(Real) == 16) {
    const auto part = [&](int i) { return _mm_loadu_ps(reinterpret_cast<const float*>(from[i * R])); };
    return P(std::bit_cast<typename P::Vector>(_mm256_insertf128_ps(_mm256_castps128_ps256(part(0)), part(1), 1)));
  }
#endif
  P joined;
  for (int group = 0; group < P::width / R; ++group)
    for (int i = 0; i < R; ++i) joined.v[group * R + i] = from[group * R][i];
  return joined;
}

}  // namespace records

template <int R, class Real>
[[gnu::always_inline]] inline void load_records(const Real* const from[PackOf<Real>::width], PackOf<Real> out[R]) {
  using P = PackOf<Real>;
  constexpr int width = P::width;
  if constexpr (R >= width) {
    for (int chunk = 0; chunk < R; chunk += width) {
      for (int lane = 0; lane < width; ++lane) std::memcpy(&out[chunk + lane], from[lane] + chunk, sizeof(P));
      records::transpose<width>(out + chunk);
    }
  } else {
    for (int i = 0; i < R; ++i) out[i] = records::join<R>(from + i);
    records::transpose<R>(out);
  }
}

template <int R, class Real>
[[gnu::always_inline]] inline void store_records(const PackOf<Real> rows[R], Real* const to[PackOf<Real>::width]) {
  using P = PackOf<Real>;
  constexpr int width = P::width;
  if constexpr (R % width == 0) {
    for (int chunk = 0; chunk < R; chunk += width) {
      P block[width];
      for (int i = 0; i < width; ++i) block[i] = rows[chunk + i];
      records::transpose<width>(block);
      for (int lane = 0; lane < width; ++lane) std::memcpy(to[lane] + chunk, &block[lane], sizeof(P));
    }
  } else {  // half packs: rows i of lanes l and l + half lie in row l of the transposed block
    constexpr int half = width / 2;
    static_assert(R % half == 0);
    for (int chunk = 0; chunk < R; chunk += half) {
      P block[half];
      for (int i = 0; i < half; ++i) block[i] = rows[chunk + i];
      records::transpose<half>(block);
      for (int lane = 0; lane < half; ++lane) {
        std::memcpy(to[lane] + chunk, &block[lane], sizeof(P) / 2);
        std::memcpy(to[lane + half] + chunk, reinterpret_cast<const Real*>(&block[lane]) + half, sizeof(P) / 2);
      }
    }
  }
}

}  // namespace presswork
