// SPDX-License-Identifier: Apache-2.0
// The state of an explicit run by owner and name: arrays that can be read and written, wherever their numbers are kept.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace presswork::explicit_dynamics {

// An array that the next cycle depends on. read fills, write takes, all its numbers in C order.
struct StateField {
  std::string owner, name;
  std::vector<std::size_t> shape;
  std::function<void(double*)> read;
  std::function<void(const double*)> write;

  std::size_t size() const {
    std::size_t product = 1;
    for (std::size_t n : shape) product *= n;
    return product;
  }
};

// The first `width` numbers of n records of `stride` numbers.
template <class Number>
StateField column_field(std::string owner, std::string name, Number* first, std::size_t n, std::size_t stride,
                        std::size_t width) {
  return {std::move(owner),
          std::move(name),
          {n, width},
          [=](double* to) {
            for (std::size_t i = 0; i < n; ++i)
              for (std::size_t j = 0; j < width; ++j) *to++ = static_cast<double>(first[i * stride + j]);
          },
          [=](const double* from) {
            for (std::size_t i = 0; i < n; ++i)
              for (std::size_t j = 0; j < width; ++j) first[i * stride + j] = static_cast<Number>(*from++);
          }};
}
// n numbers one after the other.
template <class Number>
StateField row_field(std::string owner, std::string name, Number* first, std::size_t n) {
  StateField field = column_field(std::move(owner), std::move(name), first, n, 1, 1);
  field.shape = {n};
  return field;
}

}  // namespace presswork::explicit_dynamics
