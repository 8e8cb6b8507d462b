// SPDX-License-Identifier: Apache-2.0
// One-point 3-node shell for the explicit loop: constant membrane strain and curvature, transverse shear tied at the
// middles of the edges (MITC3, Lee & Bathe 2004).
//
// With g1 = x2 - x1, g2 = x3 - x1, the normal n and changes c of the directors n at the nodes, covariant strains are
//   membrane  g1.v_1, g2.v_2, g1.v_2 + g2.v_1     bending  the same with c,   v_1 = v2 - v1, v_2 = v3 - v1
//   shear     e1 + s curl, e2 - r curl            e1 = g1.(c1 + c2)/2 + n.v_1,  e2 = g2.(c1 + c3)/2 + n.v_2
//   curl = (g1.c_2 - g2.c_1)/2, the rotation of the field of directors about n
// Only the shear varies: its value at the centroid is taken, and what is left is the one hourglass mode, held by the
// curl. No deflection has it, as c is then a gradient; in thin shells, which would lock, it is held the less the
// thinner: its shear modulus, and that of the rest, is reduced by t^2/(t^2 + relief A) (Lyly, Stenberg & Vihinen 1993).
//
// Frame, steps and rows of the state are those of shell4_one_point.hpp; of the hourglass rows the first counts.
#pragma once

#include "element/shell4_stabilized.hpp"

namespace presswork::shell3 {

using shell4::cross;
using shell4::dot;

inline constexpr double slender = 0.25;  // in the bound of the frequency, found by eigenvalues
inline constexpr double relief = 0.3;

template <class T>
struct Sides {
  T g[2][3], n[3];
  T area;          // [mm2]
  T contra[2][2];  // g^1, g^2 in the frame
};

template <class T>
PRESSWORK_INLINE void measure_sides(const T x[3][3], const T inverse[4], Sides<T>& out) {
  T p[3], q[3], e[3][3];
  for (int i = 0; i < 3; ++i) {
    out.g[0][i] = x[1][i] - x[0][i], out.g[1][i] = x[2][i] - x[0][i];
    p[i] = T(0.5) * (out.g[0][i] + out.g[1][i]), q[i] = T(0.5) * (out.g[1][i] - out.g[0][i]);
  }
  shell4::make_frame(p, q, inverse, e, out.area);
  const T over = T(0.5) / out.area;
  for (int i = 0; i < 2; ++i) {
    const T sign(i == 0 ? 1.0 : -1.0);
    out.contra[0][i] = sign * over * dot(out.g[1], e[1 - i]);
    out.contra[1][i] = -sign * over * dot(out.g[0], e[1 - i]);
  }
  for (int i = 0; i < 3; ++i) out.n[i] = e[2][i];
}

// Products of the sides with two vectors a, b: 11, 22, 12.
template <class T>
PRESSWORK_INLINE void multiply(const T g[2][3], const T a[3], const T b[3], T out[3]) {
  out[0] = dot(g[0], a), out[1] = dot(g[1], b), out[2] = dot(g[0], b) + dot(g[1], a);
}

// Factor of the shear modulus.
template <class T>
PRESSWORK_INLINE T relieve(T thickness, T area) {
  T square = thickness * thickness;
  return square / (square + T(relief) * area);
}

// Mean of curl's shear squared over the triangle: (A^11 + A^22 + A^12)/18.
template <class T>
PRESSWORK_INLINE T curl_metric(const Sides<T>& s) {
  const T *a = s.contra[0], *b = s.contra[1];
  return T(1.0 / 18.0) * (a[0] * a[0] + a[1] * a[1] + b[0] * b[0] + b[1] * b[1] + a[0] * b[0] + a[1] * b[1]);
}

// Bound of the highest frequency squared of an element of this mass, its rotary inertia alpha times that: membrane, or
// the sum of bending and shear.
template <class T>
PRESSWORK_DEVICE T bound_frequency(double young, double poisson, const Sides<T>& s, T thickness, T mass, T alpha) {
  const T *a = s.contra[0], *b = s.contra[1];
  T gxx = T(2.0) * (a[0] * a[0] + b[0] * b[0] + a[0] * b[0]), gyy = T(2.0) * (a[1] * a[1] + b[1] * b[1] + a[1] * b[1]);
  T gxy = T(2.0) * (a[0] * a[1] + b[0] * b[1]) + a[0] * b[1] + a[1] * b[0], gap = gxx - gyy;
  T root = square_root(gap * gap + T(4.0) * gxy * gxy), mean = T(0.5) * (gxx + gyy);
  T g1 = mean + T(0.5) * root, g2 = mean - T(0.5) * root, over = T(1.0) / alpha;
  T specific = T(3.0 * young) * s.area * thickness / mass;
  T membrane = T(1.0 / (1.0 - poisson * poisson)) * specific * (g1 + T(poisson) * g2);
  T bending = membrane * thickness * thickness * T(1.0 / 12.0) * over;
  // rotations weigh more in a slender triangle: shape is the sum of its squared sides over that of an equilateral one
  T shape = T(1.0 / std::sqrt(3.0)) * s.area *
            (a[0] * a[0] + a[1] * a[1] + b[0] * b[0] + b[1] * b[1] + a[0] * b[0] + a[1] * b[1]) * T(2.0);
  T weight = T(1.0) + T(slender) * (shape * shape - T(1.0));
  T shear =
      T(0.5 * shell4::shear_factor / (1.0 + poisson)) * relieve(thickness, s.area) * specific * (g1 + weight * over);
  return larger(membrane, bending + shear);
}

// Advance one shell (or pack) by dt; arguments as those of shell4::advance_stabilized, for three nodes.
template <class T, class Law, class Layers>
PRESSWORK_INLINE void advance(const Law& law, const LayerRule& rule, const LayerConditions<T>& now, const T x[3][3],
                              const T v[3][3], const T w[3][3], const T* room, T* state, Layers layers, T* force) {
  const double dt = now.dt;
  using namespace shell4;
  // 1. strains, in the middle of the step
  T membrane[3], curvature[3], shear_strain[2], curl;
  {
    T middle[3][3], c[3][3], v1[3], v2[3], c1[3], c2[3], e[3], E[3];
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 3; ++i) middle[a][i] = x[a][i] - T(0.5 * dt) * v[a][i];
    Sides<T> s;
    measure_sides(middle, state + reference, s);
    for (int a = 0; a < 3; ++a) cross(w[a], s.n, c[a]), scale(c[a], T(dt));
    for (int i = 0; i < 3; ++i) {
      v1[i] = T(dt) * (v[1][i] - v[0][i]), v2[i] = T(dt) * (v[2][i] - v[0][i]);
      c1[i] = c[1][i] - c[0][i], c2[i] = c[2][i] - c[0][i];
    }
    multiply(s.g, v1, v2, e), to_frame(s.contra, e, E), to_sums(E, membrane);
    multiply(s.g, c1, c2, e), to_frame(s.contra, e, E), to_sums(E, curvature);
    curl = T(0.5) * (dot(s.g[0], c2) - dot(s.g[1], c1));
    const T third = T(1.0 / 3.0) * curl;
    const T e1 = T(0.5) * (dot(s.g[0], c[0]) + dot(s.g[0], c[1])) + dot(s.n, v1) + third;
    const T e2 = T(0.5) * (dot(s.g[1], c[0]) + dot(s.g[1], c[2])) + dot(s.n, v2) - third;
    for (int i = 0; i < 2; ++i) shear_strain[i] = s.contra[0][i] * e1 + s.contra[1][i] * e2;
  }
  Sides<T> s;
  measure_sides(x, state + reference, s);
  // 2. layers
  const T t = state[thickness];
  Resultants<T> r;
  advance_section(law, rule, membrane, curvature, t, now, layers, r);
  squeeze_between_tools<3>(law, rule, room, state[spring] / s.area, t, membrane, layers, state[pressure], r);
  T n[3], N[3], M[3];
  from_sums(r.force, n), from_frame(s.contra, s.area, n, N);
  from_sums(r.moment, n), from_frame(s.contra, s.area, n, M);
  // 3. transverse shear, at the centroid and of the curl
  const T modulus = T(0.5 * shear_factor * law.young / (1.0 + law.poisson)) * relieve(t, s.area);
  T shear[2];
  for (int i = 0; i < 2; ++i) {
    T before = state[shear_xz + i], now = before + modulus * shear_strain[i];
    r.work += T(0.5) * t * (before + now) * shear_strain[i];
    state[shear_xz + i] = now;
    shear[i] = s.area * t * now;
  }
  const T q1 = s.contra[0][0] * shear[0] + s.contra[0][1] * shear[1];
  const T q2 = s.contra[1][0] * shear[0] + s.contra[1][1] * shear[1];
  const T before = state[hourglass], held = before + modulus * s.area * t * curl_metric(s) * curl;
  state[hourglass] = held;
  state[work] += s.area * r.work;
  state[hourglass_work] += T(0.5) * (before + held) * curl;
  change_thickness(r.thickness_strain, state[thickness], state[thickness_rounding]);
  // 4. nodal forces
  const T turn = T(0.5) * (T(1.0 / 3.0) * (q1 - q2) + held), half1 = T(0.5) * q1, half2 = T(0.5) * q2;
  T d[3][3];
  for (int i = 0; i < 3; ++i) {
    const T a = s.g[0][i], b = s.g[1][i];
    const T f1 = N[0] * a + N[2] * b + q1 * s.n[i], f2 = N[1] * b + N[2] * a + q2 * s.n[i];
    const T m1 = M[0] * a + M[2] * b, m2 = M[1] * b + M[2] * a;
    force[i] = -(f1 + f2), force[6 + i] = f1, force[12 + i] = f2;
    d[0][i] = half1 * a + half2 * b - (m1 + m2) + turn * (b - a);
    d[1][i] = half1 * a + m1 - turn * b;
    d[2][i] = half2 * b + m2 + turn * a;
  }
  for (int a = 0; a < 3; ++a) cross(s.n, d[a], force + 6 * a + 3);
}

}  // namespace presswork::shell3
