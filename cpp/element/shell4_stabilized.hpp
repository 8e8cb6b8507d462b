// SPDX-License-Identifier: Apache-2.0
// One-point 4-node shell with physical stabilisation (after Belytschko & Leviathan 1994), for the explicit loop.
//
// Strains and hourglass modes are those of shell4_forms.hpp: the MITC4 shell developed about its centre. Six hourglass
// stresses are carried through time with the moduli of the material: elastic ones, and where the layers flow, what a
// radial return leaves of theirs is left of the hourglass stress too (shell4_one_point.hpp has the alternative,
// perturbation with coefficients to choose). Directors at the nodes are the normals of the warped surface there, d1 =
// -z g^2, d2 = -z g^1 with z the hourglass height (Belytschko, Wong & Chiang 1992).
//
// The frame, the middle of the step for strains and its end for forces, and the rows of the state are those of
// shell4_one_point.hpp.
#pragma once

#include "element/shell4_forms.hpp"
#include "element/shell4_one_point.hpp"

namespace presswork::shell4 {

template <class T>
struct Centre {
  Patterns<T> c;
  T p[4][3];       // directors at the nodes
  T area;          // [mm2]
  T contra[2][2];  // g^1, g^2 in the frame
  T skew[2];       // h^1, h^2
  T spin[2][3];    // of a velocity about the normal: the sum of these times its patterns of g1, g2
  T drill[2][3];   // bending strains by the nodes' drilling beyond that spin: by its mean and by its hourglass
};

template <class T>
PRESSWORK_INLINE void measure_centre(const T x[4][3], const T inverse[4], Centre<T>& out) {
  Patterns<T>& c = out.c;
  to_patterns(x, c.g[0], c.g[1], c.h);
  T p[3], q[3], e[3][3], twice;
  for (int i = 0; i < 3; ++i) p[i] = x[2][i] - x[0][i], q[i] = x[3][i] - x[1][i];
  make_frame(p, q, inverse, e, twice);
  out.area = T(0.5) * twice;
  const T a = dot(c.g[0], e[0]), b = dot(c.g[0], e[1]), m = dot(c.g[1], e[0]), n = dot(c.g[1], e[1]);
  const T over = T(8.0) / twice;  // 1/(a n - b m)
  out.contra[0][0] = n * over, out.contra[0][1] = -m * over;
  out.contra[1][0] = -b * over, out.contra[1][1] = a * over;
  const T hx = dot(c.h, e[0]), hy = dot(c.h, e[1]), z = dot(c.h, e[2]);
  for (int k = 0; k < 2; ++k) {
    out.skew[k] = hx * out.contra[k][0] + hy * out.contra[k][1];
    const T* other = out.contra[1 - k];
    for (int i = 0; i < 3; ++i) {
      c.d[k][i] = -z * (other[0] * e[0][i] + other[1] * e[1][i]);
      out.spin[k][i] = T(0.5) * (out.contra[k][0] * e[1][i] - out.contra[k][1] * e[0][i]);
    }
  }
  const T lift = z * over;
  const T g11 = lift * (a * a + b * b), g22 = lift * (m * m + n * n), g12 = lift * (a * m + b * n);
  out.drill[0][0] = g11, out.drill[0][1] = -g22, out.drill[0][2] = T(0.0);
  out.drill[1][0] = -g12, out.drill[1][1] = g12, out.drill[1][2] = g11 - g22;
  for (int i = 0; i < 3; ++i) {
    c.d0[i] = e[2][i];
    T s = c.d[0][i] + c.d[1][i], d = c.d[0][i] - c.d[1][i];
    out.p[0][i] = e[2][i] - s, out.p[2][i] = e[2][i] + s;
    out.p[1][i] = e[2][i] + d, out.p[3][i] = e[2][i] - d;
  }
}

// Bound of the highest frequency squared; mass and alpha as in bound_frequency. On a flat parallelogram membrane,
// shear, and bending with the hourglass of shear are modes apart, and the membrane's is 2 c^2 (g1 + g2 + sqrt((g1 -
// g2)^2 + 4 nu^2 g1 g2)). What skew and warping couple is a factor found by eigenvalues of random shapes.
template <class T>
PRESSWORK_DEVICE T bound_stabilized(double young, double poisson, const Geometry<T>& g, T thickness, T mass, T alpha) {
  T g1, g2, specific = T(young) * g.area * thickness / mass, over(0.0), skew[2];
  measure_gradients(g, g1, g2);
  for (int k = 0; k < 2; ++k) {
    const T sign(k == 0 ? -1.0 : 1.0);
    const T x = T(0.25) * (g.p[0] + sign * g.q[0]), y = T(0.25) * (g.p[1] + sign * g.q[1]);
    over += T(1.0) / (x * x + y * y);
    skew[k] = T(0.5) * (g.H[0] * (g.bx[1] + sign * g.bx[0]) + g.H[1] * (g.by[1] + sign * g.by[0]));
  }
  const T root = square_root((g1 - g2) * (g1 - g2) + T(4.0 * poisson * poisson) * g1 * g2);
  const T membrane = T(2.0 / (1.0 - poisson * poisson)) * specific * (g1 + g2 + root);
  const T bending = membrane * thickness * thickness * T(1.0 / 12.0) / alpha;
  const T hourglass = T(shear_factor / (6.0 * (1.0 + poisson))) * specific * (T(1.0) / alpha + over);
  const T excess =
      T(1.0) + T(0.2) * (larger(skew[0], -skew[0]) + larger(skew[1], -skew[1])) + T(0.4) * (g1 + g2) * g.H[2] * g.H[2];
  const T flat = larger(shear_frequency(poisson, g, g1, g2, specific, alpha), bending + hourglass);
  return larger(membrane, flat) * excess;
}

// Sum, difference and shear of an in-plane tensor, from and to components.
template <class T>
PRESSWORK_INLINE void to_sums(const T e[3], T out[3]) {
  out[0] = e[0] + e[1], out[1] = e[0] - e[1], out[2] = e[2];
}
template <class T>
PRESSWORK_INLINE void from_sums(const T n[3], T out[3]) {
  out[0] = T(0.5) * (n[0] + n[1]), out[1] = T(0.5) * (n[0] - n[1]), out[2] = n[2];
}

// Change of a director in dt. The drilling rotation of the node gives way to the element's own spin: it has no
// stiffness of its own, and would find a way round shear and twist in warped elements.
template <class T>
PRESSWORK_INLINE T turn_director(const T w[3], T dt, T spin, const T normal[3], const T p[3], T out[3]) {
  const T drilling = dt * dot(w, normal) - spin;
  T own[3];
  for (int i = 0; i < 3; ++i) own[i] = dt * w[i] - drilling * normal[i];
  cross(own, p, out);
  return drilling;
}

// Change of patterns and of strains in dt by velocities v and angular velocities w; skew as in `measure`.
template <class T>
PRESSWORK_INLINE void measure_change(const Centre<T>& g, double dt, const T v[4][3], const T w[4][3],
                                     Patterns<T>& change, const T skew[2], Forms<T>& strain) {
  T step[4][3], turn[4][3], drilling[4];
  for (int a = 0; a < 4; ++a)
    for (int i = 0; i < 3; ++i) step[a][i] = T(dt) * v[a][i];
  to_patterns(step, change.g[0], change.g[1], change.h);
  const T spin = dot(g.spin[0], change.g[0]) + dot(g.spin[1], change.g[1]);
  for (int a = 0; a < 4; ++a) drilling[a] = turn_director(w[a], T(dt), spin, g.c.d0, g.p[a], turn[a]);
  const T even = drilling[0] + drilling[2], odd = drilling[1] + drilling[3];
  const T drilled[2] = {T(0.25) * (even + odd), T(0.25) * (even - odd)};
  to_patterns(turn, change.d[0], change.d[1], change.e);
  to_mean(turn, change.d0);
  measure<false>(skew, g.c, change, strain);
  for (int i = 0; i < 3; ++i) strain.bending[i] += drilled[0] * g.drill[0][i] + drilled[1] * g.drill[1][i];
}

// Nodal forces and moments (4, 6) from forces on the patterns, f, which is used up, and what bending does on drilling;
// `measure_change` transposed.
template <class T>
PRESSWORK_INLINE void spread_to_nodes(const Centre<T>& g, const T bending[3], Patterns<T>& f, T* force) {
  T at[4][3], drilled[2] = {T(0.0), T(0.0)};
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 3; ++i) drilled[k] += g.drill[k][i] * bending[i];
  T drilling = -drilled[0];
  const T of_node[2] = {T(0.25) * (drilled[0] + drilled[1]), T(0.25) * (drilled[0] - drilled[1])};
  from_patterns(f.d0, f.d[0], f.d[1], f.e, at);
  for (int a = 0; a < 4; ++a) {
    T* moment = force + 6 * a + 3;
    cross(g.p[a], at[a], moment);
    const T along = dot(moment, g.c.d0);
    for (int i = 0; i < 3; ++i) moment[i] += (of_node[a % 2] - along) * g.c.d0[i];
    drilling += along;
  }
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 3; ++i) f.g[k][i] += drilling * g.spin[k][i];
  const T none[3] = {T(0.0), T(0.0), T(0.0)};
  from_patterns(none, f.g[0], f.g[1], f.h, at);
  for (int a = 0; a < 4; ++a)
    for (int i = 0; i < 3; ++i) force[6 * a + i] = at[a][i];
}

// Advance one shell (or pack) by dt; arguments as those of `advance` in shell4_one_point.hpp, but that the layers need
// not follow the other rows of the state.
template <class T, class Law, class Layers>
PRESSWORK_INLINE void advance_stabilized(const Law& law, const LayerRule& rule, const LayerConditions<T>& now,
                                         const T x[4][3], const T v[4][3], const T w[4][3], const T* room, T* state,
                                         Layers layers, T* force) {
  const double dt = now.dt;
  // 1. strains, in the middle of the step
  Forms<T> strain;
  T membrane[3], curvature[3], shear_strain[2];
  {
    T middle[4][3];
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) middle[a][i] = x[a][i] - T(0.5 * dt) * v[a][i];
    Centre<T> g;
    measure_centre(middle, state + reference, g);
    Patterns<T> change;
    measure_change(g, dt, v, w, change, g.skew, strain);
    T e[3];
    to_frame(g.contra, strain.membrane, e), to_sums(e, membrane);
    to_frame(g.contra, strain.bending, e), to_sums(e, curvature);
    for (int i = 0; i < 2; ++i) shear_strain[i] = g.contra[0][i] * strain.shear[0] + g.contra[1][i] * strain.shear[1];
  }
  Centre<T> g;
  measure_centre(x, state + reference, g);
  // 2. layers
  const T t = state[thickness];
  Resultants<T> r;
  T retained[2];
  advance_section(law, rule, membrane, curvature, t, now, layers, r, retained);
  squeeze_between_tools<4>(law, rule, room, state[spring] / g.area, t, membrane, layers, state[pressure], r);
  Forms<T> out;
  T n[3];
  from_sums(r.force, n), from_frame(g.contra, g.area, n, out.membrane);
  from_sums(r.moment, n), from_frame(g.contra, g.area, n, out.bending);
  // 3. transverse shear
  const double shear_modulus = 0.5 * shear_factor * law.young / (1.0 + law.poisson);
  T shear[2];
  for (int i = 0; i < 2; ++i) {
    T before = state[shear_xz + i], now = before + T(shear_modulus) * shear_strain[i];
    r.work += T(0.5) * t * (before + now) * shear_strain[i];
    state[shear_xz + i] = now;
    shear[i] = g.area * t * now;
  }
  for (int k = 0; k < 2; ++k) out.shear[k] = g.contra[k][0] * shear[0] + g.contra[k][1] * shear[1];
  // 4. hourglass stresses
  const T squares[2] = {dot(g.c.g[0], g.c.g[0]), dot(g.c.g[1], g.c.g[1])};
  T k[6], lost(0.0);
  hourglass_stiffness(T(law.young), T(shear_modulus), g.area, t, squares, k);
  for (int i = 0; i < 6; ++i) {
    T before = state[hourglass + i], now = before + k[i] * strain.hourglass[i];
    if (i < 4) now *= retained[i / 2];
    lost += T(0.5) * (before + now) * strain.hourglass[i];
    state[hourglass + i] = out.hourglass[i] = now;
  }
  state[work] += g.area * r.work;
  state[hourglass_work] += lost;
  change_thickness(r.thickness_strain, state[thickness], state[thickness_rounding]);
  // 5. nodal forces
  Patterns<T> f;
  spread<false>(g.skew, g.c, out, f);
  spread_to_nodes(g, out.bending, f, force);
}

}  // namespace presswork::shell4
