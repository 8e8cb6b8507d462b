// SPDX-License-Identifier: Apache-2.0
// What a yield function gives: equivalent stress, gradient, Hessian; and a root that some of them take.
#pragma once

#include <bit>

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

template <int N, class T>
struct YieldTerms {
  T value;
  T gradient[N];
  T hessian[N][N];
};

// x^(1/3) of a positive number; the pack's by a guess from the exponent bits and three steps of Halley.
PRESSWORK_DEVICE inline double cube_root(double x) { return std::cbrt(x); }
inline Pack cube_root(Pack x) {
  const double shift = 715094163.0 * 4294967296.0;  // (1023 (1 - 1/3) - 0.033) 2^52
  Pack::Vector bits = __builtin_convertvector(std::bit_cast<Pack::Mask>(x.v), Pack::Vector);
  Pack::Mask guess = __builtin_convertvector(bits * (1.0 / 3) + shift, Pack::Mask);
  Pack y(std::bit_cast<Pack::Vector>(guess));
  for (int i = 0; i < 3; ++i) {
    Pack cube = y * y * y;
    y = y * (cube + x + x) / (cube + cube + x);
  }
  return y;
}
template <class S, int N>
Dual<S, N> cube_root(const Dual<S, N>& a) {
  S root = cube_root(a.value);
  return a.chain(root, root / (S(3.0) * a.value));
}

}  // namespace presswork
