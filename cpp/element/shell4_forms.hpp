// SPDX-License-Identifier: Apache-2.0
// Strains of the 4-node shell with mixed interpolation (MITC4), developed about the element's centre: what the
// physically stabilised one-point shell is made of, in the explicit loop and in the implicit procedure alike.
//
// With x = x0 + r g1 + s g2 + rs h and directors d = d0 + r d1 + s d2 + rs e, nodes at r, s = -1, 1 in turn, every
// covariant strain is a sum of products of these vectors. Constant in the plane are
//   membrane   1/2 g1.g1, 1/2 g2.g2, g1.g2       bending  g1.d1, g2.d2, g1.d2 + g2.d1      second  1/2 d1.d1, ...
//   shear      g1.d0 + h.d2, g2.d0 + h.d1        (means of two edges each, Dvorkin & Bathe 1984)
// and linear in r or s, the hourglass strains,
//   membrane   g1.h (of 11, by s), g2.h (of 22, by r)       bending  g1.e + h.d1, g2.e + h.d2
//   shear      g1.d2 + h.d0 (of 13, by s), g2.d1 + h.d0 (of 23, by r)
// less what a homogeneous strain gives of them in a distorted cell: with h = h^1 g1 + h^2 g2 + normal part that is
// h^1, h^2 times the constant strains, so that patch tests are passed and g.h becomes the product with the projected
// hourglass vector of Flanagan & Belytschko (1981). All are bilinear: their change is exactly the product of the
// configuration half-way with the increment, nothing for a rigid motion.
#pragma once

#include "element/director.hpp"

namespace presswork::shell4 {

// Nodal vectors by pattern: of positions and of directors, or of increments of both.
template <class T>
struct Patterns {
  T g[2][3], h[3], d0[3], d[2][3], e[3];
};

// Covariant strains, or the resultants that do work on them.
template <class T>
struct Forms {
  T membrane[3], bending[3], second[3];  // 11, 22, 12 (engineering)
  T shear[2];                            // 13, 23
  T hourglass[6];                        // membrane, bending, shear: two each
};

template <class T>
PRESSWORK_INLINE void to_patterns(const T x[4][3], T first[3], T second[3], T third[3]) {
  for (int i = 0; i < 3; ++i) {
    T a = x[2][i] - x[0][i], b = x[1][i] - x[3][i], c = x[0][i] + x[2][i], d = x[1][i] + x[3][i];
    first[i] = T(0.25) * (a + b), second[i] = T(0.25) * (a - b), third[i] = T(0.25) * (c - d);
  }
}
template <class T>
PRESSWORK_INLINE void to_mean(const T x[4][3], T mean[3]) {
  for (int i = 0; i < 3; ++i) mean[i] = T(0.25) * ((x[0][i] + x[2][i]) + (x[1][i] + x[3][i]));
}
template <class T>
PRESSWORK_INLINE void to_patterns(const T x[4][3], const T d[4][3], Patterns<T>& out) {
  to_patterns(x, out.g[0], out.g[1], out.h);
  to_patterns(d, out.d[0], out.d[1], out.e);
  to_mean(d, out.d0);
}

// Transposed: what patterns' forces are at the nodes.
template <class T>
PRESSWORK_INLINE void from_patterns(const T mean[3], const T first[3], const T second[3], const T third[3], T x[4][3]) {
  for (int i = 0; i < 3; ++i) {
    T a = first[i] + second[i], b = first[i] - second[i], even = mean[i] + third[i], odd = mean[i] - third[i];
    x[0][i] = T(0.25) * (even - a), x[2][i] = T(0.25) * (even + a);
    x[1][i] = T(0.25) * (odd + b), x[3][i] = T(0.25) * (odd - b);
  }
}

// Change of the strains by increment v, with c the configuration half-way; skew: h^1, h^2. finite: with the directors'
// hourglass e, which small warped cells have none of, and the second powers of the height.
template <bool finite, class T>
PRESSWORK_INLINE void measure(const T skew[2], const Patterns<T>& c, const Patterns<T>& v, Forms<T>& out) {
  auto change = [](const T a[3], const T b[3], const T da[3], const T db[3]) { return dot3(a, db) + dot3(b, da); };
  // 1. constant
  for (int k = 0; k < 2; ++k) {
    out.membrane[k] = dot3(c.g[k], v.g[k]);
    out.bending[k] = change(c.g[k], c.d[k], v.g[k], v.d[k]);
    out.shear[k] = change(c.g[k], c.d0, v.g[k], v.d0) + change(c.h, c.d[1 - k], v.h, v.d[1 - k]);
    if constexpr (finite) out.second[k] = dot3(c.d[k], v.d[k]);
  }
  out.membrane[2] = change(c.g[0], c.g[1], v.g[0], v.g[1]);
  out.bending[2] = change(c.g[0], c.d[1], v.g[0], v.d[1]) + change(c.g[1], c.d[0], v.g[1], v.d[0]);
  if constexpr (finite) out.second[2] = change(c.d[0], c.d[1], v.d[0], v.d[1]);
  // 2. hourglass
  const T along = skew[0] * out.shear[0] + skew[1] * out.shear[1], upright = change(c.h, c.d0, v.h, v.d0);
  for (int k = 0; k < 2; ++k) {
    T twice = T(2.0) * skew[k];
    out.hourglass[k] = change(c.g[k], c.h, v.g[k], v.h) - twice * out.membrane[k] - skew[1 - k] * out.membrane[2];
    T bending = dot3(c.g[k], v.e) + change(c.h, c.d[k], v.h, v.d[k]);
    if constexpr (finite) bending += dot3(c.e, v.g[k]);
    out.hourglass[2 + k] = bending - twice * out.bending[k] - skew[1 - k] * out.bending[2];
    out.hourglass[4 + k] = change(c.g[k], c.d[1 - k], v.g[k], v.d[1 - k]) + upright - along;
  }
}

// Forces on the patterns of configuration c from resultants; `measure` transposed.
template <bool finite, class T>
PRESSWORK_INLINE void spread(const T skew[2], const Patterns<T>& c, const Forms<T>& r, Patterns<T>& out) {
  const T* Q = r.hourglass;
  const T both = Q[4] + Q[5];
  // 1. resultants less what the hourglass strains leave out
  T N[3], M[3], q[2];
  for (int k = 0; k < 2; ++k) {
    N[k] = r.membrane[k] - T(2.0) * skew[k] * Q[k];
    M[k] = r.bending[k] - T(2.0) * skew[k] * Q[2 + k];
    q[k] = r.shear[k] - skew[k] * both;
  }
  N[2] = r.membrane[2] - skew[1] * Q[0] - skew[0] * Q[1];
  M[2] = r.bending[2] - skew[1] * Q[2] - skew[0] * Q[3];
  // 2. products
  for (int i = 0; i < 3; ++i) {
    out.h[i] = both * c.d0[i];
    out.d0[i] = q[0] * c.g[0][i] + q[1] * c.g[1][i] + both * c.h[i];
    out.e[i] = Q[2] * c.g[0][i] + Q[3] * c.g[1][i];
    for (int k = 0; k < 2; ++k) {
      const int o = 1 - k;
      out.g[k][i] = N[k] * c.g[k][i] + N[2] * c.g[o][i] + M[k] * c.d[k][i] + (M[2] + Q[4 + k]) * c.d[o][i] +
                    q[k] * c.d0[i] + Q[k] * c.h[i];
      out.h[i] += (q[o] + Q[2 + k]) * c.d[k][i] + Q[k] * c.g[k][i];
      out.d[k][i] = M[k] * c.g[k][i] + (M[2] + Q[4 + o]) * c.g[o][i] + (q[o] + Q[2 + k]) * c.h[i];
      if constexpr (finite) {
        out.g[k][i] += Q[2 + k] * c.e[i];
        out.d[k][i] += r.second[k] * c.d[k][i] + r.second[2] * c.d[o][i];
      }
    }
  }
}

// Covariant strains of a plane to those in an orthonormal frame: contra[k] = components of g^(k+1) in it.
template <class T>
PRESSWORK_INLINE void to_frame(const T contra[2][2], const T E[3], T out[3]) {
  const T *p = contra[0], *r = contra[1];
  for (int i = 0; i < 2; ++i) out[i] = p[i] * p[i] * E[0] + r[i] * r[i] * E[1] + p[i] * r[i] * E[2];
  out[2] = T(2.0) * (p[0] * p[1] * E[0] + r[0] * r[1] * E[1]) + (p[0] * r[1] + p[1] * r[0]) * E[2];
}
// Resultants in the frame, times area, to those that do work on covariant strains.
template <class T>
PRESSWORK_INLINE void from_frame(const T contra[2][2], T area, const T n[3], T out[3]) {
  const T *p = contra[0], *r = contra[1];
  out[0] = area * (p[0] * p[0] * n[0] + p[1] * p[1] * n[1] + T(2.0) * p[0] * p[1] * n[2]);
  out[1] = area * (r[0] * r[0] * n[0] + r[1] * r[1] * n[1] + T(2.0) * r[0] * r[1] * n[2]);
  out[2] = area * (p[0] * r[0] * n[0] + p[1] * r[1] * n[1] + (p[0] * r[1] + p[1] * r[0]) * n[2]);
}

// Stiffness of the hourglass modes. Stresses are assumed, as Pian & Sumihara (1984) do: 11 alone varies with s, 22 with
// r, each without the others, which takes the parasitic shear out of in-plane bending, and the same for moments and
// shear forces. Hellinger & Reissner's principle then gives every mode a modulus of its own; squares: of g1, g2.
template <class T>
PRESSWORK_INLINE void hourglass_stiffness(T young, T shear_modulus, T area, T thickness, const T squares[2], T k[6]) {
  const T third = T(1.0 / 3.0) * area * thickness, square = T(1.0 / 12.0) * thickness * thickness;
  for (int i = 0; i < 2; ++i) {
    T over = T(1.0) / squares[i];
    k[4 + i] = third * shear_modulus * over;
    k[i] = third * young * over * over;
    k[2 + i] = k[i] * square;
  }
}

}  // namespace presswork::shell4
