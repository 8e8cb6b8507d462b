// SPDX-License-Identifier: Apache-2.0
// Choice among the plain structs of a variant by a chain of comparisons, which the compiler makes a switch: without the
// exception and the table of functions of std::visit, so that a kernel may call it on any machine.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "tensor/on_device.hpp"

namespace presswork {

template <std::size_t i = 0, class F, class... Ts>
PRESSWORK_INLINE decltype(auto) choose(const std::variant<Ts...>& choice, F&& f) {
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

// Makes the alternative of a number from its parameters by name, as its `fields` has them. False where one is missing
// or there are others.
template <class Variant>
bool make_alternative(int which, const std::map<std::string, double>& parameters, Variant& made) {
  bool fits = false;
  for_each_alternative<Variant>([&](std::size_t index, auto chosen) {
    if (which != static_cast<int>(index)) return;
    std::size_t found = 0, wanted = 0;
    chosen.fields([&](const char* name, double& value) {
      ++wanted;
      if (const auto given = parameters.find(name); given != parameters.end()) value = given->second, ++found;
    });
    fits = found == wanted && found == parameters.size();
    made = chosen;
  });
  return fits;
}

}  // namespace presswork
