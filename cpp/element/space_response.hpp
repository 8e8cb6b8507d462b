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
void add_minus_stress_strain(const T s[6], T (&C)[6][6]) {
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row[k], j = voigt_column[k];
    for (int m = 0; m < 3; ++m) {  // s_im d_mj + d_im s_mj, d of a shear component half the engineering one
      const int mj = voigt_of[m][j], im = voigt_of[i][m];
      C[k][mj] -= mj < 3 ? s[voigt_of[i][m]] : T(0.5) * s[voigt_of[i][m]];
      C[k][im] -= im < 3 ? s[voigt_of[m][j]] : T(0.5) * s[voigt_of[m][j]];
    }
  }
}

// In the basis of the eigenvectors: D : rate, and the turning of the stress s with d.
template <class T>
void make_consistent(const Stretch<T>& inc, const T s[6], T (&C)[6][6]) {
  for (auto& row : C)
    for (int k = 0; k < 6; ++k) row[k] = row[k] * inc.rate[k];
  // (t d s - s t d)_ij with t_ij = turn_ij d_ij antisymmetric
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row[k], j = voigt_column[k];
    for (int m = 0; m < 3; ++m) {
      const T half(0.5);
      if (m != i) {
        const int im = voigt_of[i][m];
        const T turn = voigt_row[im] == i ? inc.turn[im] : -inc.turn[im];
        C[k][im] += half * turn * s[voigt_of[m][j]];
      }
      if (m != j) {
        const int mj = voigt_of[m][j];
        const T turn = voigt_row[mj] == m ? inc.turn[mj] : -inc.turn[mj];
        C[k][mj] -= half * turn * s[voigt_of[i][m]];
      }
    }
  }
}

// U D U / J in the frame that has not turned: the strain rate along l* is U sym(l*) U.
template <class T>
void make_green_lagrange(const T F[9], const T R[3][3], T jacobian, T (&C)[6][6]) {
  T U[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) U[i][j] = R[0][i] * F[j] + R[1][i] * F[3 + j] + R[2][i] * F[6 + j];
  stretch::turn_modulus(U, C);  // U is symmetric: U D U turns as Q D Q^T does
  T inv = T(1.0) / jacobian;
  for (auto& row : C)
    for (auto& x : row) x *= inv;
}

}  // namespace space

// sym(F - 1)
template <class T>
void small_strain(const T F[9], T strain[6]) {
  for (int i = 0; i < 3; ++i) strain[i] = F[4 * i] - T(1.0);
  for (int k = 3; k < 6; ++k) {
    const int i = voigt_row[k], j = voigt_column[k];
    strain[k] = F[3 * i + j] + F[3 * j + i];
  }
}

// Advance a point by F and, unless settings.tangent is none, give its spatial modulus. F must have a positive
// determinant; state goes from t to t+dt, its stress turned with the material.
template <class T>
void respond(const PointSettings& settings, const VonMises& law, const T F[9], PointState<T, 6>& state,
             SpaceResponse<T>& response) {
  const bool with_tangent = settings.tangent != TangentKind::none;
  T(&C)[6][6] = response.modulus;
  response.with_initial_stress = false;
  if (settings.small_displacements) {
    T strain[6];
    small_strain(F, strain);
    update_von_mises(law, strain, state, with_tangent ? C : nullptr);
    for (int i = 0; i < 6; ++i) response.stress[i] = state.stress[i];
    return;
  }
  const bool consistent = settings.tangent == TangentKind::consistent;
  Stretch<T> inc;
  split_increment(F, settings.measure, with_tangent && consistent, inc);
  update_von_mises(law, inc.strain, state, with_tangent ? C : nullptr);
  T unturned[6];
  for (int i = 0; i < 6; ++i) unturned[i] = state.stress[i];
  stretch::turn_tensor(inc.rotation, unturned, state.stress);
  for (int i = 0; i < 6; ++i) response.stress[i] = state.stress[i];
  if (!with_tangent) return;

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
  if (consistent || settings.k_e) space::add_minus_stress_strain(state.stress, C);
  if (consistent || settings.k_v)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 3; ++j) C[i][j] += state.stress[i];
  response.with_initial_stress = consistent || settings.k_u;
}

}  // namespace presswork
