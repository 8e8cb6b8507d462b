// SPDX-License-Identifier: Apache-2.0
// Vectors that are members of a bound struct as arrays that keep the struct alive.
#pragma once

#include <vector>

#include "arrays.hpp"

namespace presswork::bindings {

template <class Owner, class T>
auto view(const std::vector<T>& values, std::vector<std::size_t> shape, const Owner& owner) {
  return nb::ndarray<nb::numpy, const T>(values.data(), shape.size(), shape.data(), nb::find(owner));
}

template <class Member>
struct OwnerOf;
template <class Owner, class T>
struct OwnerOf<T Owner::*> {
  using type = Owner;
};

// The member as an array (n, columns...).
template <auto member, std::size_t... columns>
auto field(const typename OwnerOf<decltype(member)>::type& o) {
  const auto& values = o.*member;
  return view(values, {values.size() / (std::size_t(1) * ... * columns), columns...}, o);
}

}  // namespace presswork::bindings
