// SPDX-License-Identifier: Apache-2.0
// Yield functions: equivalent stress, its gradient and its Hessian. All are homogeneous of degree one in the stress, so
// that stress : gradient = equivalent stress and the plastic multiplier is the work-conjugate equivalent plastic
// strain.
//
// Stress order xx, yy, xy (plane stress), xx, yy, zz, xy or xx, yy, zz, xy, yz, zx; x is the rolling direction. The
// gradient belongs to engineering shear strains: gradient[xy] is the rate of gamma_xy per unit of equivalent plastic
// strain.
//
//   QuadraticYield<N>   sqrt(s P s)                                von Mises; Hill 1948
//   EvenPowerYield<k>   (phi / 2)^(1/2k), plane stress              Barlat & Lian 1989; Yld2000-2d (Barlat et al. 2003)
//     phi = b1 [4 (D1^2 + E1^2)]^k + b2 [(M + r)^2k + (M - r)^2k],  r^2 = D2^2 + E2^2,
//     D1, M, D2 linear in (xx, yy), E1, E2 multiples of xy
//   Yld2004<N, m>       Barlat et al. 2005, yld2004.hpp
//   Yld2000-2d is the even power with 2 sqrt(D1^2 + E1^2) = X'1 - X'2, M = 3 (X''1 + X''2)/2, r = (X''1 - X''2)/2, b1 =
//   b2 = 1; Barlat 1989 has D1 = D2 = (xx - h yy)/2, E1 = E2 = p xy, M = (xx + h yy)/2, b1 = c, b2 = a. For an even
//   exponent the bracket is a polynomial in M^2 and r^2: no root, no branch, smooth at the corners where principal
//   values meet.
#pragma once

#include "material/yield_terms.hpp"
#include "material/yld2004.hpp"
#include "tensor/choice.hpp"

namespace presswork {

template <int N>
struct QuadraticYield {
  static constexpr int size = N;
  double P[N][N] = {};

  template <class T>
  PRESSWORK_DEVICE T multiply(const T s[N], T product[N]) const {
    T sum(0.0);
    for (int i = 0; i < N; ++i) {
      product[i] = T(0.0);
      for (int j = 0; j < N; ++j) product[i] += T(P[i][j]) * s[j];
      sum += product[i] * s[i];
    }
    return square_root(larger(sum, T(0.0)));
  }
  template <class T>
  PRESSWORK_DEVICE T value(const T s[N]) const {
    T product[N];
    return multiply(s, product);
  }
  template <class T>
  PRESSWORK_CALLED void evaluate(const T s[N], YieldTerms<N, T>& out) const {
    out.value = multiply(s, out.gradient);
    T over = T(1.0) / larger(out.value, T(1e-300));
    for (auto& g : out.gradient) g *= over;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j)
        out.hessian[i][j] = out.hessian[j][i] = over * (T(P[i][j]) - out.gradient[i] * out.gradient[j]);
  }
};

// Hill 1948: F (yy-zz)^2 + G (zz-xx)^2 + H (xx-yy)^2 + 2 L yz^2 + 2 M zx^2 + 2 N xy^2; von Mises is F=G=H=1/2,
// L=M=N=3/2.
struct HillParameters {
  double F = 0.5, G = 0.5, H = 0.5, L = 1.5, M = 1.5, N = 1.5;

  QuadraticYield<3> plane_stress() const { return {{{G + H, -H, 0}, {-H, F + H, 0}, {0, 0, 2 * N}}}; }
  // 4 or 6 components
  template <int size>
  QuadraticYield<size> solid() const {
    const double P[6][6] = {{G + H, -H, -G, 0, 0, 0}, {-H, F + H, -F, 0, 0, 0}, {-G, -F, F + G, 0, 0, 0},
                            {0, 0, 0, 2 * N, 0, 0},   {0, 0, 0, 0, 2 * L, 0},   {0, 0, 0, 0, 0, 2 * M}};
    QuadraticYield<size> made;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) made.P[i][j] = P[i][j];
    return made;
  }
};

template <int k>
struct EvenPowerYield {
  static_assert(k == 3 || k == 4, "exponent 6 or 8");
  static constexpr int size = 3;
  double d1[2] = {}, e1 = 0.0, m[2] = {}, d2[2] = {}, e2 = 0.0;
  double b1 = 1.0, b2 = 1.0;

  template <class T>
  struct Arguments {
    T D1, E1, M, D2, E2, v, w, u;  // v = 4 (D1^2 + E1^2), w = M^2, u = r^2
  };
  template <class T>
  PRESSWORK_DEVICE Arguments<T> arguments(const T s[3]) const {
    Arguments<T> a;
    a.D1 = T(d1[0]) * s[0] + T(d1[1]) * s[1];
    a.M = T(m[0]) * s[0] + T(m[1]) * s[1];
    a.D2 = T(d2[0]) * s[0] + T(d2[1]) * s[1];
    a.E1 = T(e1) * s[2];
    a.E2 = T(e2) * s[2];
    a.v = T(4.0) * (a.D1 * a.D1 + a.E1 * a.E1);
    a.w = a.M * a.M;
    a.u = a.D2 * a.D2 + a.E2 * a.E2;
    return a;
  }
  // phi/2: half the first bracket to the power k, and the even part of the binomial series
  template <class T>
  PRESSWORK_DEVICE T half_phi(const Arguments<T>& a) const {
    T first = a.v * a.v * a.v, w = a.w, u = a.u;
    if constexpr (k == 3)
      return T(0.5 * b1) * first + T(b2) * ((w + T(15.0) * u) * w * w + (T(15.0) * w + u) * u * u);
    else {
      T w2 = w * w, u2 = u * u;
      return T(0.5 * b1) * first * a.v +
             T(b2) * ((w + T(28.0) * u) * w2 * w + T(70.0) * w2 * u2 + (T(28.0) * w + u) * u2 * u);
    }
  }
  template <class T>
  PRESSWORK_DEVICE static T root(T half_phi) {
    if constexpr (k == 3)
      return cube_root(square_root(half_phi));
    else
      return square_root(square_root(square_root(half_phi)));
  }
  template <class T>
  PRESSWORK_DEVICE T value(const T s[3]) const {
    return root(larger(half_phi(arguments(s)), T(1e-300)));
  }

  // 1. arguments  2. derivatives of phi/2 by v, w, u  3. chain rule to the stress  4. to the root
  template <class T>
  PRESSWORK_CALLED void evaluate(const T s[3], YieldTerms<3, T>& out) const {
    Arguments<T> a = arguments(s);
    T phi = larger(half_phi(a), T(1e-300));
    out.value = root(phi);
    T v = a.v, w = a.w, u = a.u, pv, pvv, pw, pu, pww, pwu, puu;
    if constexpr (k == 3) {
      pv = T(1.5 * b1) * v * v;
      pvv = T(3.0 * b1) * v;
      pw = T(3.0 * b2) * (w * w + T(10.0) * w * u + T(5.0) * u * u);
      pu = T(3.0 * b2) * (T(5.0) * w * w + T(10.0) * w * u + u * u);
      pww = T(6.0 * b2) * (w + T(5.0) * u);
      pwu = T(30.0 * b2) * (w + u);
      puu = T(6.0 * b2) * (T(5.0) * w + u);
    } else {
      pv = T(2.0 * b1) * v * v * v;
      pvv = T(6.0 * b1) * v * v;
      T w2 = w * w, u2 = u * u, wu = w * u;
      pw = T(4.0 * b2) * (w2 * w + T(21.0) * w2 * u + T(35.0) * w * u2 + T(7.0) * u2 * u);
      pu = T(4.0 * b2) * (T(7.0) * w2 * w + T(35.0) * w2 * u + T(21.0) * w * u2 + u2 * u);
      pww = T(4.0 * b2) * (T(3.0) * w2 + T(42.0) * wu + T(35.0) * u2);
      pwu = T(28.0 * b2) * (T(3.0) * w2 + T(10.0) * wu + T(3.0) * u2);
      puu = T(4.0 * b2) * (T(35.0) * w2 + T(42.0) * wu + T(3.0) * u2);
    }
    // half gradients of v, w, u; the halves are put back in the factors
    T gv[3] = {T(4.0 * d1[0]) * a.D1, T(4.0 * d1[1]) * a.D1, T(4.0 * e1) * a.E1};
    T gw[2] = {T(m[0]) * a.M, T(m[1]) * a.M};
    T gu[3] = {T(d2[0]) * a.D2, T(d2[1]) * a.D2, T(e2) * a.E2};
    T scale = out.value * T(1.0 / (2 * k)) / phi;
    for (int i = 0; i < 3; ++i) out.gradient[i] = T(2.0) * scale * (pv * gv[i] + pu * gu[i]);
    for (int i = 0; i < 2; ++i) out.gradient[i] += T(2.0) * scale * pw * gw[i];
    T bend = T(2 * k - 1) / out.value;
    T s4 = T(4.0) * scale, s2 = T(2.0) * scale;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        T h = pvv * gv[i] * gv[j] + puu * gu[i] * gu[j];
        if (i < 2) h += pww * gw[i] * gw[j] + pwu * (gw[i] * gu[j] + gu[i] * gw[j]);
        if (i == 2 && j < 2) h += pwu * gu[i] * gw[j];
        h = s4 * h;
        if (i < 2) h += s2 * (pv * T(4.0 * d1[i] * d1[j]) + pw * T(m[i] * m[j]) + pu * T(d2[i] * d2[j]));
        if (i == 2 && j == 2) h += s2 * (pv * T(4.0 * e1 * e1) + pu * T(e2 * e2));
        out.hessian[i][j] = out.hessian[j][i] = h - bend * out.gradient[i] * out.gradient[j];
      }
  }
};

// a |K1+K2|^2k + a |K1-K2|^2k + c |2 K2|^2k = 2 q^2k, Barlat & Lian 1989
template <int k>
EvenPowerYield<k> make_barlat1989(double a, double c, double h, double p) {
  return {{0.5, -0.5 * h}, p, {0.5, 0.5 * h}, {0.5, -0.5 * h}, p, c, a};
}

// |X'1-X'2|^2k + |2X''2+X''1|^2k + |2X''1+X''2|^2k = 2 q^2k, Barlat et al. 2003, alpha1..8 as there
template <int k>
EvenPowerYield<k> make_yld2000(const double alpha[8]) {
  const double a1 = alpha[0], a2 = alpha[1], a3 = alpha[2], a4 = alpha[3], a5 = alpha[4], a6 = alpha[5];
  const double l11 = 2 * a1 / 3, l12 = -a1 / 3, l21 = -a2 / 3, l22 = 2 * a2 / 3;
  const double k11 = (8 * a5 - 2 * a3 - 2 * a6 + 2 * a4) / 9, k12 = (4 * a6 - 4 * a4 - 4 * a5 + a3) / 9;
  const double k21 = (4 * a3 - 4 * a5 - 4 * a4 + a6) / 9, k22 = (8 * a4 - 2 * a6 - 2 * a3 + 2 * a5) / 9;
  return {{0.5 * (l11 - l21), 0.5 * (l12 - l22)},
          alpha[6],
          {1.5 * (k11 + k21), 1.5 * (k12 + k22)},
          {0.5 * (k11 - k21), 0.5 * (k12 - k22)},
          alpha[7],
          1.0,
          1.0};
}

// The yield functions that there are in N components. Barlat and Lian's and Yld2000-2d are of plane stress alone.
template <int N>
struct YieldChoice {
  using type = std::variant<QuadraticYield<N>, Yld2004<N, 6>, Yld2004<N, 8>>;
};
template <>
struct YieldChoice<3> {
  using type = std::variant<QuadraticYield<3>, EvenPowerYield<3>, EvenPowerYield<4>, Yld2004<3, 6>, Yld2004<3, 8>>;
};

}  // namespace presswork
