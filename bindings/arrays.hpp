// SPDX-License-Identifier: Apache-2.0
// Array types and small helpers shared by the binding files.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <string>

#include "material/law_data.hpp"

namespace nb = nanobind;

namespace presswork::bindings {

using Doubles = nb::ndarray<const double, nb::numpy, nb::c_contig, nb::device::cpu>;
using MutableDoubles = nb::ndarray<double, nb::numpy, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int, nb::numpy, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::numpy, nb::c_contig, nb::device::cpu>;
template <class T>
using NewArray = nb::ndarray<nb::numpy, T>;
using NewDoubles = NewArray<double>;

inline void require(bool holds, const char* message) {
  if (!holds) throw std::invalid_argument(message);
}

// A new array that Python owns.
template <class T>
NewArray<T> new_array(const std::vector<std::size_t>& shape, T** data) {
  std::size_t size = 1;
  for (auto n : shape) size *= n;
  *data = new T[size]();
  nb::capsule owner(*data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
  return NewArray<T>(*data, shape.size(), shape.data(), owner);
}

// Names of the parameters of one of a variant's laws; a table's rows are its points.
template <class Laws>
std::vector<std::string> parameter_names(std::size_t which) {
  std::vector<std::string> names;
  for_each_alternative<Laws>([&](std::size_t index, auto law) {
    if (index != which) return;
    if constexpr (requires { law.rows; })
      names.push_back("points");
    else
      law.fields([&](const char* name, double&) { names.push_back(name); });
  });
  return names;
}

}  // namespace presswork::bindings
