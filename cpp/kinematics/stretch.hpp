// SPDX-License-Identifier: Apache-2.0
// Kinematics of one increment in space: F = R U by the eigenvectors of U, the strain measures as functions of U, and
// the rates that a tangent needs.
//
// F is the deformation gradient of the increment, order 11, 12, 13, 21, ... The eigenvectors N_i of E = (F^T F - 1)/2
// are those of U, found by Jacobi's rotations; its stretches are s_i = sqrt(1 + 2 e_i), n_i = F N_i / s_i turns with
// the material, R = sum n_i N_i^T. A strain measure f gives the strain sum f(s_i) N_i N_i^T in the frame that has not
// turned.
//
// Along a velocity gradient l = d + w (dF = l F), with components in the basis n_i and N_i in which R is the identity
// (Ogden 1984, section 2.3):
//     d strain_ij = 2 s_i s_j / (s_i + s_j) (f(s_i) - f(s_j)) / (s_i - s_j) d_ij           = rate[ij] d_ij
//     (dR R^T)_ij = w_ij + (s_j - s_i) / (s_i + s_j) d_ij                                  = w_ij + turn[ij] d_ij
// Order of symmetric tensors: 11, 22, 33, 12, 23, 31; strains are engineering (shear doubled).
#pragma once

#include "kinematics/increment.hpp"

namespace presswork {

// Row and column of component k of a symmetric tensor, and the component of (row, column).
PRESSWORK_DEVICE constexpr int voigt_row(int k) {
  constexpr int row[6] = {0, 1, 2, 0, 1, 2};
  return row[k];
}
PRESSWORK_DEVICE constexpr int voigt_column(int k) {
  constexpr int column[6] = {0, 1, 2, 1, 2, 0};
  return column[k];
}
PRESSWORK_DEVICE constexpr int voigt_of(int i, int j) {
  constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  return of[i][j];
}

template <class T>
struct Stretch {
  T strain[6];          // in the frame that has not turned; engineering
  T axis[3][3];         // [component][i]: N_i
  T turned_axis[3][3];  // n_i
  T rotation[3][3];     // R
  T rate[6], turn[6];   // as above; turn of ij = 12, 23, 31, and of ji with the other sign
  T jacobian;
};

namespace stretch {

// Eigenvectors (columns of V) of a symmetric matrix, whose diagonal becomes that of the eigenvalues. Lanes that are
// done keep what they have, so that no lane's bits depend on the others of its pack.
template <class T>
PRESSWORK_DEVICE void diagonalise(T A[3][3], T V[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) V[i][j] = T(i == j ? 1.0 : 0.0);
  auto open = invert(T(0.0) < T(0.0));
  for (int sweep = 0; sweep < 12; ++sweep) {
    T off = A[0][1] * A[0][1] + A[1][2] * A[1][2] + A[2][0] * A[2][0];
    T size = A[0][0] * A[0][0] + A[1][1] * A[1][1] + A[2][2] * A[2][2];
    open = both(open, off > T(1e-34) * size);
    if (!any(open)) break;
    for (int k = 3; k < 6; ++k) {
      const int p = voigt_row(k), q = voigt_column(k), r = 3 - p - q;
      // the rotation by at most 45 degrees that makes A_pq zero; its tangent is t
      T apart = A[q][q] - A[p][p], twice = T(2.0) * A[p][q];
      T signed_twice = select(apart < T(0.0), -twice, twice), wide = larger(apart, -apart);
      T t = signed_twice / (wide + square_root(wide * wide + twice * twice) + T(1e-300));
      if constexpr (is_of_doubles<T>) t = select(open, t, T(0.0));
      T c = T(1.0) / square_root(T(1.0) + t * t), s = t * c;
      A[p][p] -= t * A[p][q], A[q][q] += t * A[p][q];
      A[p][q] = A[q][p] = T(0.0);
      T rp = c * A[r][p] - s * A[r][q], rq = s * A[r][p] + c * A[r][q];
      A[r][p] = A[p][r] = rp, A[r][q] = A[q][r] = rq;
      for (int i = 0; i < 3; ++i) {
        T vp = c * V[i][p] - s * V[i][q], vq = s * V[i][p] + c * V[i][q];
        V[i][p] = vp, V[i][q] = vq;
      }
    }
  }
}

// Q A Q^T of a symmetric tensor.
template <class T>
PRESSWORK_DEVICE void turn_tensor(const T Q[3][3], const T in[6], T out[6]) {
  T half[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      half[i][j] = Q[i][0] * in[voigt_of(0, j)] + Q[i][1] * in[voigt_of(1, j)] + Q[i][2] * in[voigt_of(2, j)];
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row(k), j = voigt_column(k);
    out[k] = half[i][0] * Q[j][0] + half[i][1] * Q[j][1] + half[i][2] * Q[j][2];
  }
}

// d stress / d strain in turned axes: rows and columns turn as stresses.
template <class T>
PRESSWORK_DEVICE void turn_modulus(const T Q[3][3], T (&D)[6][6]) {
  for (int j = 0; j < 6; ++j) {
    T column[6], turned[6];
    for (int i = 0; i < 6; ++i) column[i] = D[i][j];
    turn_tensor(Q, column, turned);
    for (int i = 0; i < 6; ++i) D[i][j] = turned[i];
  }
  for (int i = 0; i < 6; ++i) {
    T turned[6];
    turn_tensor(Q, D[i], turned);
    for (int j = 0; j < 6; ++j) D[i][j] = turned[j];
  }
}

template <class T>
PRESSWORK_DEVICE T determinant(const T F[9]) {
  return F[0] * (F[4] * F[8] - F[5] * F[7]) + F[1] * (F[5] * F[6] - F[3] * F[8]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

// f(s_i) of the strain measures; s^2 = 1 + 2 e.
template <class T>
PRESSWORK_DEVICE T strain_of(StrainMeasure measure, T e, T s) {
  if (measure == StrainMeasure::log) return T(0.5) * logarithm_one_plus(T(2.0) * e);
  if (measure == StrainMeasure::stretch) return T(2.0) * e / (s + T(1.0));
  return e;
}

// (f(s_i) - f(s_j)) / (s_i - s_j)
template <class T>
PRESSWORK_DEVICE T divided(StrainMeasure measure, T si, T sj) {
  if (measure == StrainMeasure::stretch) return T(1.0);
  if (measure == StrainMeasure::green_lagrange) return T(0.5) * (si + sj);
  T half = T(0.5) * (si - sj), g, slope;
  divided_atanh(T(0.5) * (si + sj), half * half, g, slope);
  return g;
}

}  // namespace stretch

// Polar decomposition and strain of one increment, rate and turn only if with_rates. F must have a positive
// determinant; measure is log, stretch or green_lagrange.
template <class T>
PRESSWORK_DEVICE void split_increment(const T F[9], StrainMeasure measure, bool with_rates, Stretch<T>& out) {
  // 1. eigenvectors of E
  T E[3][3], s[3], f[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      E[i][j] = T(0.5) * (F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j] - T(i == j ? 1.0 : 0.0));
  stretch::diagonalise(E, out.axis);
  // 2. stretches, strain, rotation
  for (int i = 0; i < 3; ++i) {
    s[i] = square_root(T(1.0) + T(2.0) * E[i][i]);
    f[i] = stretch::strain_of(measure, E[i][i], s[i]);
    for (int r = 0; r < 3; ++r)
      out.turned_axis[r][i] =
          (F[3 * r] * out.axis[0][i] + F[3 * r + 1] * out.axis[1][i] + F[3 * r + 2] * out.axis[2][i]) / s[i];
  }
  const auto& N = out.axis;
  for (int k = 0; k < 6; ++k) {
    const int i = voigt_row(k), j = voigt_column(k);
    T sum = f[0] * N[i][0] * N[j][0] + f[1] * N[i][1] * N[j][1] + f[2] * N[i][2] * N[j][2];
    out.strain[k] = k < 3 ? sum : T(2.0) * sum;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.rotation[i][j] =
          out.turned_axis[i][0] * N[j][0] + out.turned_axis[i][1] * N[j][1] + out.turned_axis[i][2] * N[j][2];
  out.jacobian = stretch::determinant(F);
  if (!with_rates) return;
  // 3. rates
  for (int k = 0; k < 6; ++k) {
    T si = s[voigt_row(k)], sj = s[voigt_column(k)], inv = T(1.0) / (si + sj);
    out.rate[k] = T(2.0) * si * sj * inv * stretch::divided(measure, si, sj);
    out.turn[k] = (sj - si) * inv;
  }
}

}  // namespace presswork
