// SPDX-License-Identifier: Apache-2.0
// From an array of short records (array of structures) to packs and back, by whole loads and shuffles in registers.
//
// load_records<R>(from, out): lane l of out[i] is from[l][i], i < R. store_records<R>(rows, to): to[l][i] is lane l of
// rows[i]. R is a power of two for loads and a multiple of the width for stores. A hardware gather of the same values
// takes several times as long.
#pragma once

#include <bit>
#include <cstring>
#include <utility>

#include "tensor/pack.hpp"

namespace presswork {

namespace records {

// One butterfly of a transposition: exchanges the off-diagonal blocks of `step` lanes between rows a and b.
template <int step, int... lane>
[[gnu::always_inline]] inline void exchange(Pack& a, Pack& b, std::integer_sequence<int, lane...>) {
  constexpr Pack::Mask low = {((lane & step) ? pack_width + (lane ^ step) : lane)...};
  constexpr Pack::Mask high = {((lane & step) ? pack_width + lane : (lane ^ step))...};
  const Pack::Vector first = __builtin_shuffle(a.v, b.v, low);
  b = __builtin_shuffle(a.v, b.v, high);
  a = first;
}

// Transposes blocks of `size` rows by `size` lanes.
template <int size>
[[gnu::always_inline]] inline void transpose(Pack* rows) {
  constexpr auto lanes = std::make_integer_sequence<int, pack_width>{};
  auto stage = [&]<int step>() {
    if constexpr (step < size)
      for (int i = 0; i < size; ++i)
        if (!(i & step)) exchange<step>(rows[i], rows[i | step], lanes);
  };
  stage.template operator()<1>();
  stage.template operator()<2>();
  stage.template operator()<4>();
  static_assert(size <= 8);
}

}  // namespace records

template <int R>
[[gnu::always_inline]] inline void load_records(const double* const from[pack_width], Pack out[R]) {
  if constexpr (R >= pack_width) {
    for (int chunk = 0; chunk < R; chunk += pack_width) {
      for (int lane = 0; lane < pack_width; ++lane) std::memcpy(&out[chunk + lane], from[lane] + chunk, sizeof(Pack));
      records::transpose<pack_width>(out + chunk);
    }
  } else {
    for (int i = 0; i < R; ++i) {
      alignas(sizeof(Pack)) double row[pack_width];
      for (int group = 0; group < pack_width / R; ++group)
        std::memcpy(row + group * R, from[group * R + i], R * sizeof(double));
      std::memcpy(&out[i], row, sizeof(Pack));
    }
    records::transpose<R>(out);
  }
}
template <int R>
[[gnu::always_inline]] inline void load_records(const double* const from[1], double out[R]) {
  std::memcpy(out, from[0], R * sizeof(double));
}

template <int R>
[[gnu::always_inline]] inline void store_records(const Pack rows[R], double* const to[pack_width]) {
  static_assert(R % pack_width == 0);
  for (int chunk = 0; chunk < R; chunk += pack_width) {
    Pack block[pack_width];
    for (int i = 0; i < pack_width; ++i) block[i] = rows[chunk + i];
    records::transpose<pack_width>(block);
    for (int lane = 0; lane < pack_width; ++lane) std::memcpy(to[lane] + chunk, &block[lane], sizeof(Pack));
  }
}
template <int R>
[[gnu::always_inline]] inline void store_records(const double rows[R], double* const to[1]) {
  std::memcpy(to[0], rows, R * sizeof(double));
}

}  // namespace presswork
