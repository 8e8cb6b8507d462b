// SPDX-License-Identifier: Apache-2.0
// A material law of your own in one C++ file: write a struct, and PRESSWORK_LAW(Name) makes of it the routine that
// `[materials.x] umat = "law.so"` loads. docs/adding_a_law.md walks through an example.
//
// Contract of the struct:
//   static constexpr int n_properties, n_state;        what the case must give, and what a point keeps
//   static constexpr StatePart state_parts[];          if wanted: names of these values, in their order
//   explicit Law(const double* properties);            called for each point: store numbers, compute no more
//   template <int N, class T>
//   bool update(const T* strain, double dt, T* stress, T* state) const;
//     N        4 in the plane: xx, yy, zz, xy; 6 in space: xx, yy, zz, xy, xz, yz
//     strain   in    increment (N), shears engineering, in axes that turn with the material
//     dt       in    time of the increment [s]
//     stress   both  Cauchy stress (N) [MPa]
//     state    both  n_state values; they must not depend on the axes, as scalars do, but for parts that are declared
//                    as axes: unit vectors at right angles, x and y in space (6 values), which turn with the material
//   false asks for a smaller increment.
// A shell takes the law of the plane, at the strain across the sheet at which there is no stress across it: Newton's
// method finds it, with the law's own derivatives.
// T is a dual number (tensor/dual.hpp): the tangent is the exact derivative of what update computes. A branch is
// written select(a > b, x, y), functions are square_root, exponential, logarithm, power, larger, smaller; `value_of(x)`
// gives the number alone, for tests of convergence.
#pragma once

#include <cmath>
#include <cstddef>

#include "tensor/dual.hpp"

namespace presswork {

// A part of the state variables, by name. A new mesh interpolates its values; axes it makes orthonormal again.
struct StatePart {
  const char* name;
  int size;
  bool is_axes = false;  // x and y of the law in space (6 values)
};

}  // namespace presswork

namespace presswork::user_law {

// The parts that a law declares, else all of its values under one name.
template <class Law>
const StatePart* list_state(int* count) {
  if constexpr (requires { Law::state_parts; }) {
    *count = static_cast<int>(sizeof Law::state_parts / sizeof(StatePart));
    return Law::state_parts;
  } else {
    static constexpr StatePart whole[] = {{"state_variables", Law::n_state}};
    *count = Law::n_state > 0;
    return whole;
  }
}

// Turn the axes among the state variables by an increment's rotation R, by columns.
template <class Law>
void turn_axes(const double R[9], double* state) {
  if constexpr (requires { Law::state_parts; }) {
    for (const StatePart& part : Law::state_parts) {
      for (double* axis = state; part.is_axes && axis < state + part.size; axis += 3) {
        const double before[3] = {axis[0], axis[1], axis[2]};
        for (int i = 0; i < 3; ++i) axis[i] = R[i] * before[0] + R[i + 3] * before[1] + R[i + 6] * before[2];
      }
      state += part.size;
    }
  }
}

// Values and derivatives by the strain increment at the end of one.
template <int N, int n_state>
struct Point {
  Dual<double, N> stress[N], state[n_state + 1];
};

template <int N, class Law>
bool update(const Law& law, const double* stress, const double* state, const double* strain, double dt,
            Point<N, Law::n_state>& end) {
  using T = Dual<double, N>;
  T e[N];
  for (int i = 0; i < N; ++i) end.stress[i] = T(stress[i]), e[i] = T::variable(strain[i], i);
  for (int k = 0; k < Law::n_state; ++k) end.state[k] = T(state[k]);
  return law.template update<N>(e, dt, end.stress, end.state);
}

template <int N, class Law>
bool call(const Law& law, double* stress, double* state, double* tangent, const double* strain, double dt) {
  Point<N, Law::n_state> end;
  if (!update<N>(law, stress, state, strain, dt, end)) return false;
  for (int i = 0; i < N; ++i) {
    stress[i] = end.stress[i].value;
    for (int j = 0; j < N; ++j) tangent[i + N * j] = end.stress[i].slope[j];
  }
  for (int k = 0; k < Law::n_state; ++k) state[k] = end.state[k].value;
  return true;
}

// What rounding may leave of a stress is this times 1e-13.
template <class T>
double size(const T stress[4], double slope, const double strain[4]) {
  double sum = slope * (std::fabs(strain[0]) + std::fabs(strain[1]));
  for (int i = 0; i < 4; ++i) sum += std::fabs(stress[i].value);
  return sum;
}

// Plane stress: xx, yy, xy of the law of four components, which are 0, 1 and 3 there.
template <class Law>
bool call_sheet(const Law& law, double* stress, double* state, double* tangent, const double* strain, double dt) {
  constexpr int in_plane[3] = {0, 1, 3}, across = 2, most = 60;
  const double before[4] = {stress[0], stress[1], 0.0, stress[2]};
  double e[4] = {strain[0], strain[1], 0.0, strain[2]};
  Point<4, Law::n_state> end;
  for (int iteration = 0;; ++iteration) {
    if (!update<4>(law, before, state, e, dt, end)) return false;
    const auto& out = end.stress[across];
    if (!(out.slope[across] > 0.0)) return false;
    // the last step is below what rounding leaves of the stress
    const double step = out.value / out.slope[across];
    if (step == 0.0 || std::fabs(out.value) < 1e-13 * size(end.stress, out.slope[across], e)) break;
    if (iteration == most) return false;
    e[across] -= step;
  }
  const double over = 1.0 / end.stress[across].slope[across];
  for (int i = 0; i < 3; ++i) {
    const auto& s = end.stress[in_plane[i]];
    stress[i] = s.value;
    for (int j = 0; j < 3; ++j)
      tangent[i + 3 * j] = s.slope[in_plane[j]] - s.slope[across] * end.stress[across].slope[in_plane[j]] * over;
  }
  for (int k = 0; k < Law::n_state; ++k) state[k] = end.state[k].value;
  return true;
}

template <class Law>
void call(int components, double* stress, double* state, double* tangent, const double* strain, double dt,
          const double* properties, const double* rotation, double* step_factor) {
  const Law law(properties);
  turn_axes<Law>(rotation, state);
  const auto run = components == 3 ? &call_sheet<Law> : components == 4 ? &call<4, Law> : &call<6, Law>;
  if (!run(law, stress, state, tangent, strain, dt)) *step_factor = 0.5;
}

}  // namespace presswork::user_law

#define PRESSWORK_LAW(Law)                                                                                           \
  extern "C" void umat_sizes_(int* n_properties, int* n_state) {                                                     \
    *n_properties = Law::n_properties;                                                                               \
    *n_state = Law::n_state;                                                                                         \
  }                                                                                                                  \
  extern "C" const presswork::StatePart* presswork_state(int* count) {                                               \
    return presswork::user_law::list_state<Law>(count);                                                              \
  }                                                                                                                  \
  extern "C" void umat_(double* stress, double* statev, double* ddsdde, double*, double*, double*, double*, double*, \
                        double*, double*, const double*, const double* dstran, const double*, const double* dtime,   \
                        const double*, const double*, const double*, const double*, const char*, const int*,         \
                        const int*, const int* ntens, const int*, const double* props, const int*, const double*,    \
                        const double* drot, double* pnewdt, const double*, const double*, const double*, const int*, \
                        const int*, const int*, const int*, const int*, const int*, std::size_t) {                   \
    presswork::user_law::call<Law>(*ntens, stress, statev, ddsdde, dstran, *dtime, props, drot, pnewdt);             \
  }
