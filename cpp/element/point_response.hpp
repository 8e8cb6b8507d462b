// SPDX-License-Identifier: Apache-2.0
// One integration point in one increment: Cauchy stress and spatial tangent modulus from the deformation gradient.
//
// The residual is int sigma_ij d(delta u_i)/dx_j dv over the configuration at t+dt (virtual work, thesis eq. 7). Its
// derivative along a velocity gradient l is int grad(delta u) : a : l dv with
//     a : l = d sigma + sigma tr l - sigma l^T                    (hoop: d sigma_33 + sigma_33 tr l - sigma_33 l_33)
// Gradient order 11, 12, 21, 22, 33. `consistent` takes d sigma from the update as computed, rotation included.
// `thesis` adds the parts of thesis eq. 14, each switchable; with all four and the consistent D the two agree as dt ->
// 0:
//     K_o: D : sym l      K_e: -(sigma d + d sigma)      K_u: l sigma      K_v: sigma tr l
// With small displacements the strain is sym(F - 1), nothing turns, and a = D.
#pragma once

#include "kinematics/increment.hpp"
#include "material/von_mises.hpp"

namespace presswork {

enum class TangentKind : int { none = 0, consistent = 1, thesis = 2 };

struct PointSettings {
  StrainMeasure measure = StrainMeasure::log;
  TangentKind tangent = TangentKind::consistent;
  bool green_lagrange_matrix = false;  // K_o on B0 + B_L
  bool k_e = true, k_u = true, k_v = false;
  bool small_displacements = false;  // points are undeformed, strain and equilibrium linear in the displacement
};

template <class T>
struct PointResponse {
  T stress[4];
  T modulus[5][5];
};

namespace point {

// a(4 in-plane components as a 2x2 matrix X) -> R X R^T
template <class T>
void turn_gradient(T c, T s, T& x11, T& x12, T& x21, T& x22) {
  T y11 = c * x11 - s * x21, y12 = c * x12 - s * x22, y21 = s * x11 + c * x21, y22 = s * x12 + c * x22;
  x11 = c * y11 - s * y12;
  x12 = s * y11 + c * y12;
  x21 = c * y21 - s * y22;
  x22 = s * y21 + c * y22;
}

// the part of a that is the same for every law: sigma tr l - sigma l^T
template <class T>
void add_geometric(const T s[4], T a[5][5]) {
  const T rows[5] = {s[0], s[3], s[3], s[1], s[2]};
  for (int r = 0; r < 5; ++r)
    for (int c : {0, 3, 4}) a[r][c] += rows[r];
  a[0][0] -= s[0], a[0][1] -= s[3];
  a[1][2] -= s[0], a[1][3] -= s[3];
  a[2][0] -= s[3], a[2][1] -= s[1];
  a[3][2] -= s[3], a[3][3] -= s[1];
  a[4][4] -= s[2];
}

// sym(F - 1): xx, yy, zz, xy (engineering)
template <class T>
void small_strain(const T F[5], T strain[4]) {
  strain[0] = F[0] - T(1.0), strain[1] = F[3] - T(1.0), strain[2] = F[4] - T(1.0), strain[3] = F[1] + F[2];
}

template <class T>
void small_modulus(const T D[4][4], T a[5][5]) {
  constexpr int strain_of[5] = {0, 3, 3, 1, 2};
  for (int r = 0; r < 5; ++r)
    for (int k = 0; k < 5; ++k) a[r][k] = D[strain_of[r]][strain_of[k]];
}

template <class T>
void consistent_modulus(const Increment<T>& inc, const T D[4][4], const T s[4], T a[5][5]) {
  const T turned[4] = {T(-2.0) * s[3], T(2.0) * s[3], T(0.0), s[0] - s[1]};  // J s - s J
  for (int k = 0; k < 5; ++k) {
    T ds[4];
    for (int i = 0; i < 4; ++i) {
      ds[i] = turned[i] * inc.dtheta[k];
      for (int j = 0; j < 4; ++j) ds[i] += D[i][j] * inc.dstrain[j][k];
    }
    a[0][k] = ds[0], a[1][k] = ds[3], a[2][k] = ds[3], a[3][k] = ds[1], a[4][k] = ds[2];
  }
  add_geometric(s, a);
}

template <class T>
void thesis_modulus(const PointSettings& settings, const T F[5], const Increment<T>& inc, const T D[4][4], const T s[4],
                    T a[5][5]) {
  // strain along l*: M = sym, or U sym U for the Green-Lagrange matrix (then over the volume at t: 1/J)
  T M[4][5];
  for (auto& row : M)
    for (auto& x : row) x = T(0.0);
  T weight(1.0);
  if (settings.green_lagrange_matrix) {
    T c = inc.cosine, n = inc.sine;
    T u11 = c * F[0] + n * F[2], u12 = c * F[1] + n * F[3], u22 = c * F[3] - n * F[1];
    M[0][0] = u11 * u11, M[0][1] = M[0][2] = u11 * u12, M[0][3] = u12 * u12;
    M[1][0] = u12 * u12, M[1][1] = M[1][2] = u12 * u22, M[1][3] = u22 * u22;
    M[3][0] = T(2.0) * u11 * u12, M[3][1] = M[3][2] = u11 * u22 + u12 * u12, M[3][3] = T(2.0) * u12 * u22;
    M[2][4] = F[4] * F[4];
    weight = T(1.0) / inc.jacobian;
  } else {
    M[0][0] = M[1][3] = M[2][4] = M[3][1] = M[3][2] = T(1.0);
  }
  for (int r = 0; r < 5; ++r)
    for (int k = 0; k < 5; ++k) {
      T sum(0.0);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum += M[i][r] * D[i][j] * M[j][k];
      a[r][k] = weight * sum;
    }
  const int at[2][2] = {{0, 1}, {2, 3}};
  const T S[2][2] = {{s[0], s[3]}, {s[3], s[1]}};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        if (settings.k_u) a[at[i][j]][at[i][k]] += S[k][j];
        if (settings.k_e) {  // -(s_ik d_kj + d_ik s_kj), d = sym l
          a[at[i][j]][at[k][j]] -= T(0.5) * S[i][k], a[at[i][j]][at[j][k]] -= T(0.5) * S[i][k];
          a[at[i][j]][at[i][k]] -= T(0.5) * S[k][j], a[at[i][j]][at[k][i]] -= T(0.5) * S[k][j];
        }
      }
  if (settings.k_u) a[4][4] += s[2];
  if (settings.k_e) a[4][4] -= T(2.0) * s[2];
  if (settings.k_v) {
    const T rows[5] = {s[0], s[3], s[3], s[1], s[2]};
    for (int r = 0; r < 5; ++r)
      for (int c : {0, 3, 4}) a[r][c] += rows[r];
  }
}

}  // namespace point

// Advance a point by F and, unless settings.tangent is none, give its spatial modulus. F must have a positive
// determinant; state goes from t to t+dt, its stress turned with the material.
template <class T>
void respond(const PointSettings& settings, const VonMises& law, const T F[5], PointState<T>& state,
             PointResponse<T>& response) {
  const bool with_tangent = settings.tangent != TangentKind::none;
  T D[4][4];
  if (settings.small_displacements) {
    T strain[4];
    point::small_strain(F, strain);
    update_von_mises(law, strain, state, with_tangent ? D : nullptr);
    for (int i = 0; i < 4; ++i) response.stress[i] = state.stress[i];
    if (with_tangent) point::small_modulus(D, response.modulus);
    return;
  }
  Increment<T> inc;
  measure_increment(F, settings.measure, with_tangent, inc);
  update_von_mises(law, inc.strain, state, with_tangent ? D : nullptr);
  const T unturned[4] = {state.stress[0], state.stress[1], state.stress[2], state.stress[3]};
  turn_stress(inc.cosine, inc.sine, unturned, state.stress);
  for (int i = 0; i < 4; ++i) response.stress[i] = state.stress[i];
  if (!with_tangent) return;

  auto& a = response.modulus;
  if (settings.tangent == TangentKind::consistent)
    point::consistent_modulus(inc, D, unturned, a);
  else
    point::thesis_modulus(settings, F, inc, D, unturned, a);
  for (auto& row : a) point::turn_gradient(inc.cosine, inc.sine, row[0], row[1], row[2], row[3]);
  for (int k = 0; k < 5; ++k) point::turn_gradient(inc.cosine, inc.sine, a[0][k], a[1][k], a[2][k], a[3][k]);
}

}  // namespace presswork
