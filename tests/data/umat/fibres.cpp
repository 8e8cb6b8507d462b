// SPDX-License-Identifier: Apache-2.0
// A law with a history of its own: an isotropic metal without hardening that has fibres along its first axis, and keeps
// the sums of the absolute strain along them and of that across.
// Properties: E, nu, yield stress. State: equivalent plastic strain; sums along and across; axes.
#include "material/user_law.hpp"

using namespace presswork;

struct Fibres {
  static constexpr int n_properties = 3, n_state = 9;
  static constexpr StatePart state_parts[] = {{"plastic_strain", 1}, {"travel", 2}, {"fibres", 6, true}};
  double shear, bulk, yield;

  explicit Fibres(const double* p) : shear(p[0] / (2 * (1 + p[1]))), bulk(p[0] / (3 * (1 - 2 * p[1]))), yield(p[2]) {}

  template <int N, class T>
  bool update(const T* strain, double, T* stress, T* state) const {
    // 1. radial return to the yield stress
    T mean = (stress[0] + stress[1] + stress[2]) * T(1.0 / 3), volume = strain[0] + strain[1] + strain[2], s[N];
    for (int i = 0; i < 3; ++i) s[i] = stress[i] - mean + T(2 * shear) * (strain[i] - volume * T(1.0 / 3));
    for (int i = 3; i < N; ++i) s[i] = stress[i] + T(shear) * strain[i];
    T square(1e-30);
    for (int i = 0; i < N; ++i) square += T(i < 3 ? 1.5 : 3.0) * s[i] * s[i];
    const T q = square_root(square), r = smaller(q, T(yield));
    for (int i = 0; i < N; ++i) stress[i] = s[i] * (r / q) + (i < 3 ? mean + T(bulk) * volume : T(0.0));
    state[0] = state[0] + (q - r) * T(1 / (3 * shear));

    // 2. strain along the fibres, in the plane of x and y, and across them
    const double c = value_of(state[3]), n = value_of(state[4]);
    const T along = T(c * c) * strain[0] + T(n * n) * strain[1] + T(c * n) * strain[3];
    state[1] = state[1] + larger(along, T(0.0) - along);
    state[2] = state[2] + larger(strain[0] + strain[1] - along, along - strain[0] - strain[1]);
    return true;
  }
};

PRESSWORK_LAW(Fibres)
