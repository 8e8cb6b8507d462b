// SPDX-License-Identifier: Apache-2.0
// Yld2004-18p (Barlat, Aretz, Yoon, Karabin, Brem & Dick 2005, Int. J. Plasticity 21, 1009): in space, in plane strain
// and axisymmetry, and in plane stress.
//
//   sum over i, j of |S'_i - S''_j|^m = 4 f^m,   S'_i, S''_j the principal values of C' s and C'' s, s the deviator
//
// For an even exponent m the sum is a polynomial in the invariants of both tensors: with p_k = tr A^k,
//
//   sum (S'_i - S''_j)^m = sum over k of binomial(m, k) (-1)^k p_k(C' s) p_(m-k)(C'' s),
//
// so that no principal value is sought, and all is smooth where some coincide. Power sums follow from the invariants
// e_1, e_2, e_3 by Newton's identities; with h_k the complete symmetric polynomials, dp_k/de_a = (-1)^(a+1) k h_(k-a),
// and with g_k = sum of h_i h_(k-i), dh_k/de_a = (-1)^(a+1) g_(k-a).
#pragma once

#include "material/yield_terms.hpp"

namespace presswork {

// Barlat's names; 44 belongs to yz, 55 to zx, 66 to xy.
struct Yld2004Coefficients {
  double c12, c13, c21, c23, c31, c32, c44, c55, c66;
};

template <int N, int m>
struct Yld2004 {
  static_assert(m == 6 || m == 8, "exponent 6 or 8");
  static constexpr int size = N, normals = N == 3 ? 2 : 3, shears = N == 6 ? 3 : 1;
  // Of C' and of C'', the deviator taken in: xx, yy, zz by xx, yy, zz; xy, yz, zx by themselves.
  double normal[2][3][3] = {}, shear[2][3] = {};

  Yld2004() = default;
  Yld2004(const Yld2004Coefficients& prime, const Yld2004Coefficients& double_prime) {
    const Yld2004Coefficients* both[2] = {&prime, &double_prime};
    for (int t = 0; t < 2; ++t) {
      const Yld2004Coefficients& c = *both[t];
      const double C[3][3] = {{0, -c.c12, -c.c13}, {-c.c21, 0, -c.c23}, {-c.c31, -c.c32, 0}};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) normal[t][i][j] = C[i][j] - (C[i][0] + C[i][1] + C[i][2]) / 3;
      shear[t][0] = c.c66, shear[t][1] = c.c44, shear[t][2] = c.c55;
    }
  }

  // A transformed stress: xx, yy, zz, xy, yz, zx, its invariants, power sums and their derivatives by invariants.
  template <class T>
  struct Tensor {
    T a[6], e[3], p[m + 1], h[m];

    PRESSWORK_DEVICE T by(int k, int i) const {  // dp_k/de_i, i from 0
      if (k <= i) return T(0.0);
      return (i == 1 ? T(-k) : T(k)) * h[k - i - 1];
    }
  };

  template <class T>
  PRESSWORK_DEVICE void transform(const T s[N], int t, Tensor<T>& A) const {
    for (int i = 0; i < 3; ++i) {
      A.a[i] = T(normal[t][i][0]) * s[0];
      for (int j = 1; j < normals; ++j) A.a[i] += T(normal[t][i][j]) * s[j];
      A.a[3 + i] = i < shears ? T(shear[t][i]) * s[normals + i] : T(0.0);
    }
    const T *a = A.a, xy = a[3], yz = a[4], zx = a[5];
    A.e[0] = a[0] + a[1] + a[2];
    A.e[1] = a[0] * a[1] + a[1] * a[2] + a[2] * a[0] - xy * xy;
    A.e[2] = a[2] * (a[0] * a[1] - xy * xy);
    if constexpr (N == 6) {
      A.e[1] -= yz * yz + zx * zx;
      A.e[2] += T(2.0) * xy * yz * zx - a[0] * yz * yz - a[1] * zx * zx;
    }
    T *p = A.p, *h = A.h, *e = A.e;
    p[0] = T(3.0), p[1] = e[0], p[2] = e[0] * p[1] - T(2.0) * e[1];
    p[3] = e[0] * p[2] - e[1] * p[1] + T(3.0) * e[2];
    h[0] = T(1.0), h[1] = e[0], h[2] = e[0] * h[1] - e[1];
    for (int k = 4; k <= m; ++k) p[k] = e[0] * p[k - 1] - e[1] * p[k - 2] + e[2] * p[k - 3];
    for (int k = 3; k < m; ++k) h[k] = e[0] * h[k - 1] - e[1] * h[k - 2] + e[2] * h[k - 3];
  }

  PRESSWORK_DEVICE static constexpr double factor(int k) {  // binomial(m, k) (-1)^k
    double c = 1.0;
    for (int i = 0; i < k; ++i) c = -c * (m - i) / (i + 1);
    return c;
  }
  template <class T>
  PRESSWORK_DEVICE static T sum(const Tensor<T>& A, const Tensor<T>& B) {
    T phi(0.0);
    for (int k = 0; k <= m; ++k) phi += T(factor(k)) * A.p[k] * B.p[m - k];
    return phi;
  }
  template <class T>
  PRESSWORK_DEVICE static T root(T quarter_phi) {
    if constexpr (m == 6)
      return cube_root(square_root(quarter_phi));
    else
      return square_root(square_root(square_root(quarter_phi)));
  }
  template <class T>
  PRESSWORK_DEVICE T value(const T s[N]) const {
    Tensor<T> A, B;
    transform(s, 0, A), transform(s, 1, B);
    return root(larger(T(0.25) * sum(A, B), T(1e-300)));
  }

  // Derivatives of an invariant, from 0, by the stress.
  template <class T>
  PRESSWORK_DEVICE void invariant_gradient(const Tensor<T>& A, int t, int which, T out[N]) const {
    const T *a = A.a, xy = a[3], yz = a[4], zx = a[5];
    T g[6];
    for (int i = 0; i < 3; ++i) g[i] = which == 0 ? T(1.0) : A.e[0] - a[i], g[3 + i] = T(-2.0) * a[3 + i];
    if (which == 2) {
      g[0] = a[1] * a[2], g[1] = a[2] * a[0], g[2] = a[0] * a[1] - xy * xy, g[3] = T(-2.0) * a[2] * xy;
      if constexpr (N == 6) {
        g[0] -= yz * yz, g[1] -= zx * zx, g[3] += T(2.0) * yz * zx;
        g[4] = T(2.0) * (xy * zx - a[0] * yz), g[5] = T(2.0) * (xy * yz - a[1] * zx);
      }
    }
    for (int j = 0; j < normals; ++j)
      out[j] = T(normal[t][0][j]) * g[0] + T(normal[t][1][j]) * g[1] + T(normal[t][2][j]) * g[2];
    for (int k = 0; k < shears; ++k) out[normals + k] = which == 0 ? T(0.0) : T(shear[t][k]) * g[3 + k];
  }

  // Adds w2 and w3 times the second derivatives of the second and third invariant.
  template <class T>
  PRESSWORK_DEVICE void add_curvature(const Tensor<T>& A, int t, T w2, T w3, T (*hessian)[N]) const {
    const T* a = A.a;
    T M[6][6];
    for (auto& row : M)
      for (auto& x : row) x = T(0.0);
    const int opposite[3] = {2, 0, 1};  // the normal component that a shear xy, yz, zx does not have
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3, own = opposite[i];
      M[i][j] = M[j][i] = w2 + w3 * a[k];
      M[3 + i][3 + i] = T(-2.0) * (w2 + w3 * a[own]);
      M[own][3 + i] = M[3 + i][own] = T(-2.0) * w3 * a[3 + i];
      M[3 + i][3 + j] = M[3 + j][3 + i] = T(2.0) * w3 * a[3 + k];
    }
    for (int r = 0; r < N; ++r)
      for (int c = 0; c <= r; ++c) {
        T x(0.0);
        if (r < normals) {
          for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
              if (i != k) x += T(normal[t][i][r] * normal[t][k][c]) * M[i][k];
        } else if (c < normals) {
          const int k = r - normals, own = opposite[k];
          x = T(normal[t][own][c] * shear[t][k]) * M[own][3 + k];
        } else {
          x = T(shear[t][r - normals] * shear[t][c - normals]) * M[3 + r - normals][3 + c - normals];
        }
        hessian[r][c] += x;
      }
  }

  // 1. transformed stresses  2. derivatives of phi by the six invariants  3. chain rule to the stress  4. to the root
  template <class T>
  PRESSWORK_CALLED void evaluate(const T s[N], YieldTerms<N, T>& out) const {
    Tensor<T> A[2];
    for (int t = 0; t < 2; ++t) transform(s, t, A[t]);
    const T phi = larger(sum(A[0], A[1]), T(4e-300));
    out.value = root(T(0.25) * phi);

    T first[6], second[6][6];
    differentiate(A, first, second);

    T rows[6][N];
    for (int i = 0; i < 6; ++i) invariant_gradient(A[i / 3], i / 3, i % 3, rows[i]);
    for (int j = 0; j < N; ++j) {
      out.gradient[j] = T(0.0);
      for (int i = 0; i < 6; ++i) out.gradient[j] += first[i] * rows[i][j];
      T half[6];
      for (int i = 0; i < 6; ++i) {
        half[i] = T(0.0);
        for (int k = 0; k < 6; ++k) half[i] += second[i][k] * rows[k][j];
      }
      for (int r = j; r < N; ++r) {
        out.hessian[r][j] = T(0.0);
        for (int i = 0; i < 6; ++i) out.hessian[r][j] += rows[i][r] * half[i];
      }
    }
    for (int t = 0; t < 2; ++t) add_curvature(A[t], t, first[3 * t + 1], first[3 * t + 2], out.hessian);

    const T scale = out.value * T(1.0 / m) / phi, bend = T(m - 1) / out.value;
    for (auto& g : out.gradient) g *= scale;
    for (int r = 0; r < N; ++r)
      for (int c = 0; c <= r; ++c)
        out.hessian[r][c] = out.hessian[c][r] = scale * out.hessian[r][c] - bend * out.gradient[r] * out.gradient[c];
  }

 private:
  // Of phi by e_1, e_2, e_3 of the first tensor, then of the second.
  template <class T>
  PRESSWORK_DEVICE static void differentiate(const Tensor<T> A[2], T first[6], T second[6][6]) {
    for (int i = 0; i < 6; ++i) {
      first[i] = T(0.0);
      for (int j = 0; j < 6; ++j) second[i][j] = T(0.0);
    }
    for (int t = 0; t < 2; ++t) {
      const Tensor<T>&own = A[t], &other = A[1 - t];
      T g[m - 1];
      for (int k = 0; k <= m - 2; ++k) {
        g[k] = T(0.0);
        for (int i = 0; i <= k; ++i) g[k] += own.h[i] * own.h[k - i];
      }
      for (int k = 1; k <= m; ++k) {
        const T weight = T(factor(k)) * other.p[m - k];
        for (int i = 0; i < 3; ++i) {
          first[3 * t + i] += weight * own.by(k, i);
          for (int j = 0; j <= i; ++j)
            if (k >= i + j + 2) second[3 * t + i][3 * t + j] += weight * T((i + j) % 2 ? -k : k) * g[k - i - j - 2];
        }
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) second[3 * t + j][3 * t + i] = second[3 * t + i][3 * t + j];
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        for (int k = 1; k < m; ++k) second[i][3 + j] += T(factor(k)) * A[0].by(k, i) * A[1].by(m - k, j);
        second[3 + j][i] = second[i][3 + j];
      }
  }
};

}  // namespace presswork
