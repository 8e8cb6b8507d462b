// SPDX-License-Identifier: Apache-2.0
// One-point 4-node shell of Belytschko, Lin & Tsay (1984), with the warping terms of Belytschko, Wong & Chiang (1992).
//
// Velocity strain at the centre in a frame that turns with the material; Mindlin kinematics, v(z) = v + z w x p, three
// displacements and three rotations a node; layers through the thickness; transverse shear elastic, with factor 5/6.
// Five hourglass modes (two of the membrane, one of the deflection, two of the rotations) are held by perturbation
// stiffness or viscosity. Nodes 1 2 3 4 go round the element.
//
// Where this departs from the originals:
// - e3 is normal to both diagonals, as there; e1 is the rotation of the mean deformation gradient since the start
//   (polar decomposition), not a side: the frame turns with the material and does not depend on the node number.
// - velocity strains are taken on the geometry in the middle of the step, in the frame there, and forces on that at its
//   end: a rigid rotation gives no strain, and fast spinning does not feed vibrations (it does with one geometry).
// - hourglass velocities leave out the rigid rotation of a warped element.
// - the warping terms come from v(z) with p the normals of the warped surface at the nodes: the coupling b^c of the
//   curvature is that of Belytschko, Wong & Chiang, and the drilling rotation works through p. With them goes the
//   projection of the transverse shear on the edges (Dvorkin & Bathe's, at the centre), which makes bending of
//   distorted elements free of shear; the hourglass deflection is what remains of w beside it.
//
// Virtual power with b_x, b_y the gradients, A the area:
//   d_xx = b_x v_x + z (b_x t_y + bc_x v_x)          t_y = w_y - p_y w_z,  t_x = w_x - p_x w_z
//   d_yy = b_y v_y + z (-b_y t_x + bc_y v_y)
//   2 d_xy = b_y v_x + b_x v_y + z (b_y t_y - b_x t_x + bc_y v_x + bc_x v_y)
//   2 d_xz = b_x v_z + mean t_y,  2 d_yz = b_y v_z - mean t_x
// b of node 3 is minus that of node 1, of 4 minus that of 2: everything is written with the differences 1-3 and 2-4.
#pragma once

#include "element/squeezed_section.hpp"

namespace presswork {

struct ShellControl {
  double membrane = 0.03;  // hourglass coefficients r_m, r_w, r_theta
  double deflection = 0.03;
  double rotation = 0.03;
  bool viscous = false;  // hourglass forces from velocities, not from their integral
  double density = 0.0;  // [t/mm3]; for viscosity
};

namespace shell4 {

inline constexpr double shear_factor = 5.0 / 6.0;
// rows of an element's state: thickness, inverse reference sides (2x2), transverse shear stress xz, yz, hourglass
// forces (membrane x, y, deflection, rotations x, y, none; of stabilised shells those of shell4_forms.hpp), work,
// hourglass work, rounding of the thickness, pressure through the thickness and the spring of a node that is squeezed
// (squeezed_section.hpp); then the layers
enum Row {
  thickness = 0,
  reference = 1,
  shear_xz = 5,
  shear_yz = 6,
  hourglass = 7,
  work = 13,
  hourglass_work = 14,
  thickness_rounding = 15,
  pressure = 16,
  spring = 17
};
inline constexpr int head_rows = 18;

template <class T>
PRESSWORK_INLINE void change_thickness(T strain, T& thickness, T& rounding) {
  add_carried(thickness * strain, thickness, rounding);
}

template <class T>
PRESSWORK_INLINE T dot(const T a[3], const T b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
PRESSWORK_INLINE void cross(const T a[3], const T b[3], T c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}
template <class T>
PRESSWORK_INLINE void scale(T a[3], T by) {
  for (int i = 0; i < 3; ++i) a[i] *= by;
}

template <class T>
struct Geometry {
  T e[3][3];        // rows: the frame's axes
  T area, over_2a;  // [mm2]
  T p[2], q[2];     // diagonals 1-3 and 2-4 in the frame
  T H[3];           // x1 - x2 + x3 - x4 in the frame
  T bx[2], by[2];   // gradients of nodes 1, 2
};

// Diagonals p = x3 - x1, q = x4 - x2; sides g1 = p - q, g2 = p + q (twice the mean sides).
template <class T>
PRESSWORK_INLINE void make_frame(const T p[3], const T q[3], const T inverse[4], T e[3][3], T& twice_area) {
  T f1[3], f2[3], turned[3];
  cross(p, q, e[2]);
  twice_area = square_root(dot(e[2], e[2]));
  scale(e[2], T(1.0) / twice_area);
  for (int i = 0; i < 3; ++i) {
    T g1 = p[i] - q[i], g2 = p[i] + q[i];
    f1[i] = g1 * inverse[0] + g2 * inverse[2];
    f2[i] = g1 * inverse[1] + g2 * inverse[3];
  }
  cross(f2, e[2], turned);
  for (int i = 0; i < 3; ++i) e[0][i] = f1[i] + turned[i];
  scale(e[0], T(1.0) / square_root(dot(e[0], e[0])));
  cross(e[2], e[0], e[1]);
}

template <class T>
PRESSWORK_INLINE void measure(const T x[4][3], const T inverse[4], Geometry<T>& g) {
  T p[3], q[3], h[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = x[2][i] - x[0][i];
    q[i] = x[3][i] - x[1][i];
    h[i] = (x[0][i] - x[1][i]) + (x[2][i] - x[3][i]);
  }
  T twice;
  make_frame(p, q, inverse, g.e, twice);
  g.area = T(0.5) * twice;
  g.over_2a = T(1.0) / twice;
  for (int i = 0; i < 2; ++i) g.p[i] = dot(p, g.e[i]), g.q[i] = dot(q, g.e[i]);
  for (int i = 0; i < 3; ++i) g.H[i] = dot(h, g.e[i]);
  g.bx[0] = -g.q[1] * g.over_2a, g.bx[1] = g.p[1] * g.over_2a;
  g.by[0] = g.q[0] * g.over_2a, g.by[1] = -g.p[0] * g.over_2a;
}

// The field's values as differences 1-3, 2-4, hourglass pattern and sum, in the frame.
template <class T>
struct Pattern {
  T d13[3], d24[3], h[3], sum[3];
};

template <class T>
PRESSWORK_INLINE void to_patterns(const T u[4][3], const T e[3][3], Pattern<T>& out) {
  T a[3], b[3], s13[3], s24[3], h[3], sum[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = u[0][i] - u[2][i], b[i] = u[1][i] - u[3][i];
    s13[i] = u[0][i] + u[2][i], s24[i] = u[1][i] + u[3][i];
    h[i] = s13[i] - s24[i], sum[i] = s13[i] + s24[i];
  }
  for (int i = 0; i < 3; ++i) {
    out.d13[i] = dot(a, e[i]), out.d24[i] = dot(b, e[i]);
    out.h[i] = dot(h, e[i]), out.sum[i] = dot(sum, e[i]);
  }
}

template <class T>
struct Strain {
  T membrane[3], curvature[3];  // increments: sum, difference, engineering shear
  T shear[2];                   // xz, yz
  T q[5];                       // hourglass: membrane x, y, deflection, rotations x, y
};

// Take the drilling rotation, beyond the element's own spin, into t_x, t_y: t = w - p w_z at each node, p_1 = -p_3, p_2
// = -p_4.
template <class T>
PRESSWORK_INLINE void tilt_rotations(const Geometry<T>& g, T spin, Pattern<T>& w) {
  const T z4 = g.H[2];  // four times the hourglass height
  const T s13 = T(0.5) * (w.sum[2] + w.h[2]) - T(2.0) * spin, s24 = T(0.5) * (w.sum[2] - w.h[2]) - T(2.0) * spin;
  const T p13[2] = {-z4 * g.bx[0], -z4 * g.by[0]}, p24[2] = {z4 * g.bx[1], z4 * g.by[1]};
  for (int i = 0; i < 2; ++i) {
    w.d13[i] -= p13[i] * s13, w.d24[i] -= p24[i] * s24;
    T a = p13[i] * w.d13[2], b = p24[i] * w.d24[2];
    w.h[i] -= a - b, w.sum[i] -= a + b;
  }
}

// What depends on the rotations before they are tilted, so that a rigid rotation of a warped element gives none: the
// hourglass rotations, and the projection's part of shear and hourglass deflection. With the product t.x = t_y x - t_x
// y, shear along an edge is the difference of w plus the mean of t.x; at the centre that is b.w + mean t plus
// (b_1 d13 - b_2 d24).H/4, and what is left to the hourglass mode is h.w + sum.H/4 + (d24.q - d13.p)/4, none for any
// quadratic w with its own slopes.
template <bool warped, class T>
PRESSWORK_INLINE void measure_rotations(const Geometry<T>& g, const Pattern<T>& w, Strain<T>& out) {
  const T a = g.H[0] * g.bx[0] + g.H[1] * g.by[0], b = g.H[0] * g.bx[1] + g.H[1] * g.by[1];
  for (int i = 0; i < 2; ++i) out.q[3 + i] = w.h[i] - a * w.d13[i] - b * w.d24[i];
  out.shear[0] = out.shear[1] = out.q[2] = T(0.0);
  if constexpr (warped) {
    auto along = [](const T t[3], const T x[]) { return T(0.25) * (t[1] * x[0] - t[0] * x[1]); };
    T d13 = along(w.d13, g.H), d24 = along(w.d24, g.H);
    out.shear[0] = g.bx[0] * d13 - g.bx[1] * d24;
    out.shear[1] = g.by[0] * d13 - g.by[1] * d24;
    out.q[2] = along(w.sum, g.H) + along(w.d24, g.q) - along(w.d13, g.p);
  }
}

// v, w: velocities times dt; w is left with the tilted rotations.
template <bool warped, class T>
PRESSWORK_INLINE void measure_strain(const Geometry<T>& g, const Pattern<T>& v, Pattern<T>& w, Strain<T>& out) {
  measure_rotations<warped>(g, w, out);
  auto by_x = [&](T a, T b) { return g.bx[0] * a + g.bx[1] * b; };
  auto by_y = [&](T a, T b) { return g.by[0] * a + g.by[1] * b; };
  T L[3][2];
  for (int i = 0; i < 3; ++i) L[i][0] = by_x(v.d13[i], v.d24[i]), L[i][1] = by_y(v.d13[i], v.d24[i]);
  // 1. membrane
  out.membrane[0] = L[0][0] + L[1][1];
  out.membrane[1] = L[0][0] - L[1][1];
  out.membrane[2] = L[0][1] + L[1][0];
  // 2. curvature; bc_x v_x is L S with S = c (p p - q q), of which the strain's part stands here and the spin's in the
  // tilting
  if constexpr (warped) tilt_rotations(g, T(0.5) * (L[1][0] - L[0][1]), w);
  T tyx = by_x(w.d13[1], w.d24[1]), tyy = by_y(w.d13[1], w.d24[1]);
  T txx = by_x(w.d13[0], w.d24[0]), txy = by_y(w.d13[0], w.d24[0]);
  T kxx = tyx, kyy = -txy, kxy = tyy - txx;
  if constexpr (warped) {
    T c = T(2.0) * g.H[2] * g.over_2a * g.over_2a;  // 2 z/A^2 with z = H/4
    T sxx = c * (g.p[0] * g.p[0] - g.q[0] * g.q[0]), syy = c * (g.p[1] * g.p[1] - g.q[1] * g.q[1]);
    T sxy = c * (g.p[0] * g.p[1] - g.q[0] * g.q[1]), dxy = T(0.5) * out.membrane[2];
    kxx += T(0.5) * (out.membrane[0] + out.membrane[1]) * sxx + dxy * sxy;
    kyy += T(0.5) * (out.membrane[0] - out.membrane[1]) * syy + dxy * sxy;
    kxy += out.membrane[0] * sxy + dxy * (sxx + syy);
  }
  out.curvature[0] = kxx + kyy, out.curvature[1] = kxx - kyy, out.curvature[2] = kxy;
  // 3. transverse shear
  out.shear[0] += L[2][0] + T(0.25) * w.sum[1];
  out.shear[1] += L[2][1] - T(0.25) * w.sum[0];
  // 4. hourglass
  for (int i = 0; i < 2; ++i) out.q[i] = v.h[i] - g.H[0] * L[i][0] - g.H[1] * L[i][1] + g.H[2] * L[2][i];
  out.q[2] += v.h[2];
  if constexpr (!warped) out.q[2] -= g.H[0] * L[2][0] + g.H[1] * L[2][1];
}

// Stiffness [N/mm; rotations: N mm] of the five hourglass modes; sizes is the sum of b^2 over nodes and directions.
template <class T>
PRESSWORK_INLINE void hourglass_moduli(const ShellControl& control, double young, double poisson, const Geometry<T>& g,
                                       T thickness, T sizes, T k[5]) {
  T area = g.area, t2 = thickness * thickness;
  T membrane = T(control.membrane * young / 8.0) * thickness * area * sizes;
  T bending = T(control.rotation * young / 192.0) * thickness * t2 * area * sizes;
  T deflection = T(control.deflection * shear_factor * young / (24.0 * (1.0 + poisson))) * thickness * t2 * sizes;
  k[0] = k[1] = membrane, k[2] = deflection, k[3] = k[4] = bending;
}
template <class T>
void hourglass_viscosities(const ShellControl& control, double dt, double young, double poisson, const Geometry<T>& g,
                           T thickness, T k[5]) {
  const double wave = std::sqrt(young / (control.density * (1.0 - poisson * poisson)));
  T base = T(0.25 * control.density * wave / dt) * thickness * square_root(g.area);
  T squared = thickness * thickness;
  k[0] = k[1] = T(control.membrane) * base;
  k[2] = T(control.deflection) * base * smaller(squared / g.area, T(1.0));
  k[3] = k[4] = T(control.rotation / 12.0) * base * squared;
}

template <class T>
PRESSWORK_DEVICE void measure_gradients(const Geometry<T>& g, T& g1, T& g2) {  // eigenvalues of b b^T, g1 > g2
  T xx = g.bx[0] * g.bx[0] + g.bx[1] * g.bx[1], yy = g.by[0] * g.by[0] + g.by[1] * g.by[1];
  T xy = g.bx[0] * g.by[0] + g.bx[1] * g.by[1], root = square_root((xx - yy) * (xx - yy) + T(4.0) * xy * xy);
  g1 = xx + yy + root, g2 = xx + yy - root;
}

// Highest frequency squared of shear, its projection weighing rotations more the more the element is out of line.
template <class T>
PRESSWORK_DEVICE T shear_frequency(double poisson, const Geometry<T>& g, T g1, T g2, T specific, T alpha) {
  T projected = T(1.0) + T(0.25) * (g1 + g2) * (g.H[0] * g.H[0] + g.H[1] * g.H[1]);
  return T(0.5 * shear_factor / (1.0 + poisson)) * specific * (T(4.0) * g1 + projected / alpha);
}

// Bound of the highest frequency squared; alpha: rotary inertia over mass. Membrane: 4 c^2 (g1 + nu g2).
template <class T>
PRESSWORK_DEVICE T bound_frequency(double young, double poisson, const Geometry<T>& g, T thickness, T mass, T alpha) {
  T g1, g2, specific = T(young) * g.area * thickness / mass;
  measure_gradients(g, g1, g2);
  T membrane = T(4.0 / (1.0 - poisson * poisson)) * specific * (g1 + T(poisson) * g2);
  return larger(membrane, membrane * thickness * thickness / (T(12.0) * alpha) +
                              shear_frequency(poisson, g, g1, g2, specific, alpha));
}

// Nodal forces and moments from resultants; force: (4, 6) in global axes.
template <bool warped, class T>
PRESSWORK_INLINE void spread(const Geometry<T>& g, const Resultants<T>& r, const T shear[2], const T Q[5], T* force) {
  T A = g.area;
  auto xx = [&](const T n[3]) { return T(0.5) * A * (n[0] + n[1]); };
  auto yy = [&](const T n[3]) { return T(0.5) * A * (n[0] - n[1]); };
  // 1. force and moment as first moments N along x, y: node 1 gets bx N_x + by N_y
  T N[3][2] = {{xx(r.force), A * r.force[2]}, {A * r.force[2], yy(r.force)}, {A * shear[0], A * shear[1]}};
  T mxx = xx(r.moment), myy = yy(r.moment), mxy = A * r.moment[2];
  T M[2][2] = {{-mxy, -myy}, {mxx, mxy}};  // of t_x, t_y
  for (int i = 0; i < (warped ? 2 : 3); ++i)
    for (int j = 0; j < 2; ++j) N[i][j] -= Q[i] * g.H[j];
  for (int i = 0; i < 2; ++i) N[2][i] += g.H[2] * Q[i];
  T f13[3], f24[3], m13[3], m24[3], s13[3], s24[3];
  for (int i = 0; i < 3; ++i) {
    f13[i] = g.bx[0] * N[i][0] + g.by[0] * N[i][1];
    f24[i] = g.bx[1] * N[i][0] + g.by[1] * N[i][1];
  }
  for (int i = 0; i < 2; ++i) {
    m13[i] = g.bx[0] * M[i][0] + g.by[0] * M[i][1];
    m24[i] = g.bx[1] * M[i][0] + g.by[1] * M[i][1];
  }
  s13[0] = s24[0] = T(-0.25) * A * shear[1], s13[1] = s24[1] = T(0.25) * A * shear[0];
  m13[2] = m24[2] = s13[2] = s24[2] = T(0.0);
  // 2. warping
  if constexpr (warped) {
    T c = T(2.0) * g.H[2] * g.over_2a * g.over_2a;
    T x[2] = {c * mxx, c * mxy}, y[2] = {c * mxy, c * myy};
    f13[0] -= g.p[0] * x[0] + g.p[1] * x[1], f24[0] += g.q[0] * x[0] + g.q[1] * x[1];
    f13[1] -= g.p[0] * y[0] + g.p[1] * y[1], f24[1] += g.q[0] * y[0] + g.q[1] * y[1];
    const T z4 = g.H[2];
    const T p13[2] = {-z4 * g.bx[0], -z4 * g.by[0]}, p24[2] = {z4 * g.bx[1], z4 * g.by[1]};
    for (int i = 0; i < 2; ++i) {
      m13[2] -= p13[i] * s13[i], s13[2] -= p13[i] * m13[i];
      m24[2] -= p24[i] * s24[i], s24[2] -= p24[i] * m24[i];
    }
  }
  // 3. what works on the rotations as they are: hourglass and the projection of shear
  if constexpr (warped) {
    const T quarter = T(0.25) * A, q4 = T(0.25) * Q[2];
    T a = quarter * (shear[0] * g.bx[0] + shear[1] * g.by[0]), b = quarter * (shear[0] * g.bx[1] + shear[1] * g.by[1]);
    const T H[2] = {-g.H[1], g.H[0]}, p[2] = {-g.p[1], g.p[0]}, q[2] = {-g.q[1], g.q[0]};
    for (int i = 0; i < 2; ++i) {
      m13[i] += a * H[i] - q4 * p[i], m24[i] += q4 * q[i] - b * H[i];
      s13[i] += q4 * H[i], s24[i] += q4 * H[i];
    }
  }
  const T a13 = g.H[0] * g.bx[0] + g.H[1] * g.by[0], a24 = g.H[0] * g.bx[1] + g.H[1] * g.by[1];
  for (int i = 0; i < 2; ++i) {
    m13[i] -= a13 * Q[3 + i], m24[i] -= a24 * Q[3 + i];
    s13[i] += Q[3 + i], s24[i] -= Q[3 + i];
  }
  // 4. to global axes
  for (int i = 0; i < 3; ++i) {
    auto out = [&](const T a[3]) { return a[0] * g.e[0][i] + a[1] * g.e[1][i] + a[2] * g.e[2][i]; };
    T a = out(f13), b = out(f24), q = out(Q);
    force[i] = q + a, force[12 + i] = q - a, force[6 + i] = b - q, force[18 + i] = -b - q;
    T ma = out(m13), mb = out(m24), sa = out(s13), sb = out(s24);
    force[3 + i] = sa + ma, force[15 + i] = sa - ma, force[9 + i] = sb + mb, force[21 + i] = sb - mb;
  }
}

// Advance one shell (or pack) by dt: positions x at the end of the step, velocity v and angular velocity w of it.
// room: between tools at the nodes (4), or null. state: rows as above, in place. force: (4, 6), the internal force.
template <bool warped, class T, class Law>
PRESSWORK_INLINE void advance(const Law& law, const LayerRule& rule, const ShellControl& control,
                              const LayerConditions<T>& now, const T x[4][3], const T v[4][3], const T w[4][3],
                              const T* room, T* state, T* force) {
  // 1. kinematics, in the middle of the step
  const T dt(now.dt);
  Strain<T> strain;
  {
    T middle[4][3];
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) middle[a][i] = x[a][i] - T(0.5) * dt * v[a][i];
    Geometry<T> g;
    measure(middle, state + reference, g);
    Pattern<T> dv, dw;
    to_patterns(v, g.e, dv);
    to_patterns(w, g.e, dw);
    for (int i = 0; i < 3; ++i)
      for (T* a : {&dv.d13[i], &dv.d24[i], &dv.h[i], &dw.d13[i], &dw.d24[i], &dw.h[i], &dw.sum[i]}) *a *= dt;
    measure_strain<warped>(g, dv, dw, strain);
  }
  Geometry<T> g;
  measure(x, state + reference, g);
  // 2. layers
  T t = state[thickness];
  Resultants<T> r;
  const auto layers = layers_in_row(law, rule.points, state + head_rows);
  advance_section(law, rule, strain.membrane, strain.curvature, t, now, layers, r);
  squeeze_between_tools<4>(law, rule, room, state[spring] / g.area, t, strain.membrane, layers, state[pressure], r);
  // 3. transverse shear
  const double shear_modulus = 0.5 * shear_factor * law.young / (1.0 + law.poisson);
  T shear[2];
  for (int i = 0; i < 2; ++i) {
    T before = state[shear_xz + i], now = before + T(shear_modulus) * strain.shear[i];
    r.work += T(0.5) * t * (before + now) * strain.shear[i];
    state[shear_xz + i] = now;
    shear[i] = t * now;
  }
  // 4. hourglass control
  T k[5], Q[5], lost(0.0);
  if (control.viscous) {
    hourglass_viscosities(control, now.dt, law.young, law.poisson, g, t, k);
  } else {
    T sizes(0.0);
    for (int i = 0; i < 2; ++i) sizes += g.bx[i] * g.bx[i] + g.by[i] * g.by[i];
    hourglass_moduli(control, law.young, law.poisson, g, t, T(2.0) * sizes, k);
  }
  for (int i = 0; i < 5; ++i) {
    T before = state[hourglass + i];
    Q[i] = k[i] * strain.q[i];
    if (control.viscous) {
      lost += Q[i] * strain.q[i];
    } else {
      Q[i] += before;
      lost += T(0.5) * (before + Q[i]) * strain.q[i];
    }
    state[hourglass + i] = Q[i];
  }
  state[work] += g.area * r.work;
  state[hourglass_work] += lost;
  change_thickness(r.thickness_strain, state[thickness], state[thickness_rounding]);
  // 5. nodal forces
  spread<warped>(g, r, shear, Q, force);
}

}  // namespace shell4
}  // namespace presswork
