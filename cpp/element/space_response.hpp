// SPDX-License-Identifier: Apache-2.0
// One integration point of a solid in space in one increment: Cauchy stress and spatial tangent from the deformation
// gradient. What point_response.hpp is for the plane, whose equations these are.
//
// With l = d + w the residual's derivative a : l = d sigma + sigma tr l - sigma l^T is
//     a : l = C : d + l sigma             C = (D : rate + turning) - (sigma d + d sigma) + sigma tr d
// where D : rate is the law's tangent along the strain of the increment and `turning` the part of R's rate that comes
// with d (kinematics/stretch.hpp); what comes with w is in l sigma. So C is a 6x6 matrix, and l sigma, the
// initial-stress part K_u, is the scalar grad N_a . sigma grad N_b of two nodes. `thesis` puts D or, for the
// Green-Lagrange matrix, U D U / J in the place of D : rate + turning, and may leave out K_e: -(sigma d + d sigma), K_u
// and K_v: sigma tr d.
#pragma once

#include "element/point_response.hpp"
#include "kinematics/stretch.hpp"

namespace presswork {

template <class T>
struct SpaceResponse {
  T stress[6];      // xx, yy, zz, xy, yz, zx
  T modulus[6][6];  // C; engineering shear
  bool with_initial_stress;
};

namespace space {

// -(s d + d s)
template <class T>
PRESSWORK_DEVICE void add_minus_stress_strain(const T s[6], T (&C)[6][6]) {
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row(k), j = voigt_column(k);
    for (int m = 0; m < 3; ++m) {  // s_im d_mj + d_im s_mj, d of a shear component half the engineering one
      const int mj = voigt_of(m, j), im = voigt_of(i, m);
      C[k][mj] -= mj < 3 ? s[voigt_of(i, m)] : T(0.5) * s[voigt_of(i, m)];
      C[k][im] -= im < 3 ? s[voigt_of(m, j)] : T(0.5) * s[voigt_of(m, j)];
    }
  }
}

// In the basis of the eigenvectors: D : rate, and the turning of the stress s with d.
template <class T>
PRESSWORK_DEVICE void make_consistent(const Stretch<T>& inc, const T s[6], T (&C)[6][6]) {
  for (auto& row : C)
    for (int k = 0; k < 6; ++k) row[k] = row[k] * inc.rate[k];
  // (t d s - s t d)_ij with t_ij = turn_ij d_ij antisymmetric
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row(k), j = voigt_column(k);
    for (int m = 0; m < 3; ++m) {
      const T half(0.5);
      if (m != i) {
        const int im = voigt_of(i, m);
        const T turn = voigt_row(im) == i ? inc.turn[im] : -inc.turn[im];
        C[k][im] += half * turn * s[voigt_of(m, j)];
      }
      if (m != j) {
        const int mj = voigt_of(m, j);
        const T turn = voigt_row(mj) == m ? inc.turn[mj] : -inc.turn[mj];
        C[k][mj] -= half * turn * s[voigt_of(i, m)];
      }
    }
  }
}

// U D U / J in the frame that has not turned: the strain rate along l* is U sym(l*) U.
template <class T>
PRESSWORK_DEVICE void make_green_lagrange(const T F[9], const T R[3][3], T jacobian, T (&C)[6][6]) {
  T U[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) U[i][j] = R[0][i] * F[j] + R[1][i] * F[3 + j] + R[2][i] * F[6 + j];
  stretch::turn_modulus(U, C);  // U is symmetric: U D U turns as Q D Q^T does
  T inv = T(1.0) / jacobian;
  for (auto& row : C)
    for (auto& x : row) x *= inv;
}

}  // namespace space

namespace space {

template <class T>
PRESSWORK_DEVICE Mask<T> call_law(const VonMises& law, const LawInput<6, T>& in, const T* s0, T* s1,
                                  [[maybe_unused]] T (*C)[6]) {
#if defined(__CUDACC__)  // a card asks for no tangent
  advance_stress<6>(law, in.strain, s0, s1);
  return false;
#else
  return update(law, in, s0, s1, C);
#endif
}

// In the law's own axes, of which s0 keeps x and y.
template <class T>
PRESSWORK_DEVICE Mask<T> call_law(const SolidLaw& law, const LawInput<6, T>& in, const T* s0, T* s1, T (*C)[6]) {
  const int size = law.state_size();
  T Q[3][3], to_law[3][3], before[most_point_values<6>];  // columns of Q: the axes
  const T *x = s0 + size, *y = x + 3;
  for (int i = 0; i < 3; ++i) {
    Q[i][0] = x[i], Q[i][1] = y[i];
    Q[i][2] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) to_law[i][j] = Q[j][i];
  LawInput<6, T> own = in;
  T tensor[6];
  for (int i = 0; i < 6; ++i) tensor[i] = i < 3 ? in.strain[i] : T(0.5) * in.strain[i];
  stretch::turn_tensor(to_law, tensor, own.strain);
  for (int i = 3; i < 6; ++i) own.strain[i] *= T(2.0);
  stretch::turn_tensor(to_law, s0, before);
  for (int i = 6; i < size; ++i) before[i] = s0[i];
  const Mask<T> failed = update(law, own, before, s1, C);
  T stress[6];
  for (int i = 0; i < 6; ++i) stress[i] = s1[i];
  stretch::turn_tensor(Q, stress, s1);
  if (C) stretch::turn_modulus(Q, *reinterpret_cast<T(*)[6][6]>(C));
  return failed;
}

// The law's axes turn with the material.
template <class T>
PRESSWORK_DEVICE void turn_axes(const VonMises&, const T (*)[3], const T*, T*) {}
template <class T>
PRESSWORK_DEVICE void turn_axes(const SolidLaw& law, const T (*R)[3], const T* s0, T* s1) {
  const int at = law.state_size();
  for (int axis = at; axis < at + 6; axis += 3)
    for (int i = 0; i < 3; ++i)
      s1[axis + i] = R ? R[i][0] * s0[axis] + R[i][1] * s0[axis + 1] + R[i][2] * s0[axis + 2] : s0[axis + i];
}

}  // namespace space

// sym(F - 1)
template <class T>
PRESSWORK_DEVICE void small_strain(const T F[9], T strain[6]) {
  for (int i = 0; i < 3; ++i) strain[i] = F[4 * i] - T(1.0);
  for (int k = 3; k < 6; ++k) {
    const int i = voigt_row(k), j = voigt_column(k);
    strain[k] = F[3 * i + j] + F[3 * j + i];
  }
}

namespace space {

// From the law's D in the axes that have not turned, in response.modulus, to the spatial modulus.
template <class T>
PRESSWORK_DEVICE void finish_modulus(const PointSettings& settings, const T F[9], const Stretch<T>& inc,
                                     const T unturned[6], SpaceResponse<T>& response) {
  T(&C)[6][6] = response.modulus;
  const bool consistent = settings.tangent == TangentKind::consistent;
  if (consistent) {
    T to_axes[3][3], stress[6];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) to_axes[i][j] = inc.axis[j][i];
    stretch::turn_modulus(to_axes, C);
    stretch::turn_tensor(to_axes, unturned, stress);
    space::make_consistent(inc, stress, C);
    stretch::turn_modulus(inc.turned_axis, C);
  } else {
    if (settings.green_lagrange_matrix) space::make_green_lagrange(F, inc.rotation, inc.jacobian, C);
    stretch::turn_modulus(inc.rotation, C);
  }
  if (consistent || settings.k_e) space::add_minus_stress_strain(response.stress, C);
  if (consistent || settings.k_v)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 3; ++j) C[i][j] += response.stress[i];
  response.with_initial_stress = consistent || settings.k_u;
}

}  // namespace space

// Advance a point by F over the time dt, at a temperature and mixture given from outside, and, unless settings.tangent
// is none, give its spatial modulus. F must have a positive determinant; s0 goes to s1, the stress turned with the
// material. Gives the lanes in which the law failed.
template <class T, class Law>
PRESSWORK_DEVICE Mask<T> respond(const PointSettings& settings, const Law& law, const T F[9], double dt, T temperature,
                                 const T* s0, T* s1, SpaceResponse<T>& response, const T* mixture = nullptr) {
  const bool with_tangent = settings.tangent != TangentKind::none;
  T(&C)[6][6] = response.modulus;
  LawInput<6, T> in;
  in.dt = dt, in.temperature = temperature, in.mixture = mixture;
  response.with_initial_stress = false;
  if (settings.small_displacements) {
    small_strain(F, in.strain);
    const Mask<T> failed = space::call_law(law, in, s0, s1, with_tangent ? C : nullptr);
    space::turn_axes(law, static_cast<const T(*)[3]>(nullptr), s0, s1);
    for (int i = 0; i < 6; ++i) response.stress[i] = s1[i];
    return failed;
  }
  const bool consistent = settings.tangent == TangentKind::consistent;
  Stretch<T> inc;
  split_increment(F, settings.measure, with_tangent && consistent, inc);
  for (int i = 0; i < 6; ++i) in.strain[i] = inc.strain[i];
  const Mask<T> failed = space::call_law(law, in, s0, s1, with_tangent ? C : nullptr);
  T unturned[6];
  for (int i = 0; i < 6; ++i) unturned[i] = s1[i];
  stretch::turn_tensor(inc.rotation, unturned, s1);
  space::turn_axes(law, inc.rotation, s0, s1);
  for (int i = 0; i < 6; ++i) response.stress[i] = s1[i];
  if (with_tangent) space::finish_modulus(settings, F, inc, unturned, response);
  return failed;
}

}  // namespace presswork
