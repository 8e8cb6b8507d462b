// SPDX-License-Identifier: Apache-2.0
// A material law of your own in one C++ file: write a struct, and PRESSWORK_LAW(Name) makes of it the routine that
// `[materials.x] umat = "law.so"` loads. docs/adding_a_law.md walks through an example.
//
// Contract of the struct:
//   static constexpr int n_properties, n_state;        what the case must give, and what a point keeps
//   explicit Law(const double* properties);            called for each point: store numbers, compute no more
//   template <class T>
//   bool update(const T strain[4], double dt, T stress[4], T* state) const;
//     strain   in    increment xx, yy, zz, xy (engineering) in axes that turn with the material
//     dt       in    time of the increment [s]
//     stress   both  Cauchy stress xx, yy, zz, xy [MPa]
//     state    both  n_state values; they must not depend on the axes, as scalars do: nobody turns them
//   false asks for a smaller increment.
// T is a dual number (tensor/dual.hpp): the tangent is the exact derivative of what update computes. A branch is
// written select(a > b, x, y), functions are square_root, exponential, logarithm, power, larger, smaller; `value_of(x)`
// gives the number alone, for tests of convergence.
#pragma once

#include <cstddef>

#include "tensor/dual.hpp"

namespace presswork::user_law {

using Number = Dual<double, 4>;

template <class Law>
void call(double* stress, double* state, double* tangent, const double* strain, double dt, const double* properties,
          double* step_factor) {
  const Law law(properties);
  Number s[4], e[4], h[Law::n_state + 1];
  for (int i = 0; i < 4; ++i) {
    s[i] = Number(stress[i]);
    e[i] = Number::variable(strain[i], i);
  }
  for (int k = 0; k < Law::n_state; ++k) h[k] = Number(state[k]);
  if (!law.update(e, dt, s, h)) {
    *step_factor = 0.5;
    return;
  }
  for (int i = 0; i < 4; ++i) {
    stress[i] = s[i].value;
    for (int j = 0; j < 4; ++j) tangent[i + 4 * j] = s[i].slope[j];
  }
  for (int k = 0; k < Law::n_state; ++k) state[k] = h[k].value;
}

}  // namespace presswork::user_law

#define PRESSWORK_LAW(Law)                                                                                           \
  extern "C" void umat_sizes_(int* n_properties, int* n_state) {                                                     \
    *n_properties = Law::n_properties;                                                                               \
    *n_state = Law::n_state;                                                                                         \
  }                                                                                                                  \
  extern "C" void umat_(double* stress, double* statev, double* ddsdde, double*, double*, double*, double*, double*, \
                        double*, double*, const double*, const double* dstran, const double*, const double* dtime,   \
                        const double*, const double*, const double*, const double*, const char*, const int*,         \
                        const int*, const int*, const int*, const double* props, const int*, const double*,          \
                        const double*, double* pnewdt, const double*, const double*, const double*, const int*,      \
                        const int*, const int*, const int*, const int*, const int*, std::size_t) {                   \
    presswork::user_law::call<Law>(stress, statev, ddsdde, dstran, *dtime, props, pnewdt);                           \
  }
