// SPDX-License-Identifier: Apache-2.0
// Isotropic elasticity in plane stress (N = 3), plane strain and axisymmetry (4) and space (6).
#pragma once

#include <type_traits>

#include "tensor/on_device.hpp"

namespace presswork {

// Isotropic elasticity; the moduli may differ from lane to lane.
template <int N, class T>
struct Elasticity {
  T young, flexibility = T(1.0) / young;
  T shear;                 // modulus
  T plane, poisson;        // modulus in plane stress without strain across
  T spread;                // Lame's first
  T one_plus, twice_plus;  // 1 + poisson, 2 (1 + poisson)

  PRESSWORK_DEVICE Elasticity(T young, double nu)
      : young(young),
        shear(young * T(0.5 / (1.0 + nu))),
        plane(young * T(1.0 / (1.0 - nu * nu))),
        poisson(nu),
        spread(young * T(nu / ((1.0 + nu) * (1.0 - 2.0 * nu)))),
        one_plus(1.0 + nu),
        twice_plus(2.0 * (1.0 + nu)) {}
  PRESSWORK_DEVICE Elasticity(T young, T nu)
    requires(!std::is_same_v<T, double>)
      : young(young),
        shear(young * T(0.5) / (T(1.0) + nu)),
        plane(young / (T(1.0) - nu * nu)),
        poisson(nu),
        spread(young * nu / ((T(1.0) + nu) * (T(1.0) - T(2.0) * nu))),
        one_plus(T(1.0) + nu),
        twice_plus(T(2.0) * (T(1.0) + nu)) {}

  PRESSWORK_DEVICE void stiffness(const T strain[N], T stress[N]) const {
    if constexpr (N == 3) {
      stress[0] = plane * (strain[0] + poisson * strain[1]);
      stress[1] = plane * (strain[1] + poisson * strain[0]);
      stress[2] = shear * strain[2];
    } else {
      T mean = spread * (strain[0] + strain[1] + strain[2]);
      for (int i = 0; i < 3; ++i) stress[i] = T(2.0) * shear * strain[i] + mean;
      for (int i = 3; i < N; ++i) stress[i] = shear * strain[i];
    }
  }
  PRESSWORK_DEVICE void matrix(T (*stress)[N]) const {
    for (int j = 0; j < N; ++j) {
      T unit[N], column[N];
      for (int i = 0; i < N; ++i) unit[i] = T(i == j ? 1.0 : 0.0);
      stiffness(unit, column);
      for (int i = 0; i < N; ++i) stress[i][j] = column[i];
    }
  }
  PRESSWORK_DEVICE void compliance(const T stress[N], T strain[N]) const {
    constexpr int normal = N == 3 ? 2 : 3;
    T sum(0.0);
    for (int i = 0; i < normal; ++i) sum += stress[i];
    for (int i = 0; i < normal; ++i) strain[i] = flexibility * (one_plus * stress[i] - poisson * sum);
    for (int i = normal; i < N; ++i) strain[i] = flexibility * twice_plus * stress[i];
  }
};

}  // namespace presswork
