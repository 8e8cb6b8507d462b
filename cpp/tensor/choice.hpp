// SPDX-License-Identifier: Apache-2.0
// Choice among the plain structs of a variant by a chain of comparisons, which the compiler makes a switch: without the
// exception and the table of functions of std::visit, so that a kernel may call it on any machine.
#pragma once

#include <cstddef>
#include <utility>
#include <variant>

namespace presswork {

template <std::size_t i = 0, class F, class... Ts>
[[gnu::always_inline]] inline decltype(auto) choose(const std::variant<Ts...>& choice, F&& f) {
  if constexpr (i + 1 < sizeof...(Ts))
    if (choice.index() != i) return choose<i + 1>(choice, std::forward<F>(f));
  return f(*std::get_if<i>(&choice));
}

// Calls f(index, alternative made by default) for every alternative of a variant.
template <class Variant, class F>
void for_each_alternative(F&& f) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (f(i, std::variant_alternative_t<i, Variant>{}), ...);
  }(std::make_index_sequence<std::variant_size_v<Variant>>{});
}

}  // namespace presswork
