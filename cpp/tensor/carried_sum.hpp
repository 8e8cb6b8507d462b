// SPDX-License-Identifier: Apache-2.0
// Sums of many small increments: what rounding takes from one is added to the next (Kahan 1965).
//
// Increments of 1e-6 of the sum are 16 units in the last place of a float. Equal ones are all rounded the same way, and
// the sum would drift; those of less than half a unit would be lost.
#pragma once

#include <type_traits>

#include "tensor/pack.hpp"

namespace presswork {

// Whether sums of T over the cycles of a run need it.
template <class T>
inline constexpr bool is_single = std::is_same_v<T, float>;
template <>
inline constexpr bool is_single<FloatPack> = true;

template <class T>
PRESSWORK_INLINE void add_carried(T increment, T& sum, T& rounding) {
  const T before = sum, change = increment + rounding;
  sum = before + change;
  rounding = change - (sum - before);
}

}  // namespace presswork
