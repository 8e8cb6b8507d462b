// SPDX-License-Identifier: Apache-2.0
// Fully integrated 4-node shell for the explicit loop: MITC4+ (Dvorkin & Bathe 1984; Ko, Lee & Bathe 2017) in rates, on
// 2 x 2 points in the plane.
//
// With the patterns of shell4_forms.hpp the covariant strains at r, s = -+1/sqrt 3 are
//   membrane   11: c11 + s L1 + H - 2/3 B,  22: c22 + r L2 + H - 2/3 B,  12: c12 + r L1 + s L2 + 2 r s B
//              c: constant ones, L1 = g1.h, L2 = g2.h, H = 1/2 h.h
//   bending    the same of the products with directors, H = h.e
//   shear      13: c13 + s (g1.d2 + h.d0),  23: c23 + r (g2.d1 + h.d0), which is the tying at the mid-sides
// B is what MITC4+ takes for H where it varies in the plane, from the five tied strains as if the cell were flat:
//   B (h1 h1 + h2 h2 - 1) = h1^2 (c11 + H) + h2^2 (c22 + H) + h1 h2 c12 - h1 L1 - h2 L2,   h = h1 g1 + h2 g2 + normal
//   part
// In a flat cell B = H: nothing is assumed there, and the membrane is that of the bilinear quadrilateral.
//
// Every point has layers, transverse shear stress, thickness and a frame of its own, that of the polar decomposition
// of its deformation gradient. Strains are taken in the middle of the step, forces at its end; directors are the
// normals of the warped cell at the nodes, and drilling gives way to the cell's spin, all as in shell4_stabilized.hpp.
// There is no mode without stiffness but rigid motion and drilling, and no hourglass force.
#pragma once

#include "element/shell4_stabilized.hpp"

namespace presswork::shell4_mitc {

using shell4::Centre;
using shell4::Forms;
using shell4::Patterns;

inline constexpr int points = 4;
inline constexpr double place = 0.57735026918962576451;  // 1/sqrt 3
PRESSWORK_DEVICE constexpr double at_r(int q) { return q % 2 == 0 ? -place : place; }
PRESSWORK_DEVICE constexpr double at_s(int q) { return q < 2 ? -place : place; }
// in the bound of the frequency, found by eigenvalues
inline constexpr double membrane_of_skew = 0.15, shear_of_skew = 0.4, membrane_of_warp = 0.6;

// Rows of a shell's state: thickness (mean), work, spring of a squeezed node, then those of each point, then the
// layers, point after point.
enum Row { thickness = 0, work = 1, spring = 2, first_point = 3 };
enum PointRow { point_thickness = 0, rounding = 1, reference = 2, shear = 6, pressure = 8, point_rows = 9 };
inline constexpr int head_rows = first_point + points * point_rows;

// A shell's rows, each `stride` behind the one before, as neighbouring lanes of a GPU keep them.
template <class T>
struct RowsApart {
  T* first;
  std::ptrdiff_t stride;
  PRESSWORK_DEVICE T& operator[](int row) const { return first[row * stride]; }
  PRESSWORK_DEVICE RowsApart operator+(int rows) const { return {first + rows * stride, stride}; }
};

// Products of g1, g2, h: the metric at any point.
template <class T>
struct Metric {
  T g11, g22, g12, gh[2], hh;
};

template <class T>
PRESSWORK_INLINE void measure_metric(const Patterns<T>& c, Metric<T>& out) {
  out.g11 = dot3(c.g[0], c.g[0]), out.g22 = dot3(c.g[1], c.g[1]), out.g12 = dot3(c.g[0], c.g[1]);
  for (int k = 0; k < 2; ++k) out.gh[k] = dot3(c.g[k], c.h);
  out.hh = dot3(c.h, c.h);
}

// In the frame of the first point, whose rows are given: any frame will do.
template <class T, class Rows>
PRESSWORK_INLINE void measure_centre(const T x[4][3], const Rows point, Centre<T>& out) {
  const T inverse[4] = {point[reference], point[reference + 1], point[reference + 2], point[reference + 3]};
  shell4::measure_centre(x, inverse, out);
}

// At a point: base vectors a1 = g1 + s h, a2 = g2 + r h; gives their area, and a^1, a^2 in the frame that the polar
// decomposition makes of them and of the inverse of what they were at the start.
template <class T, class Rows>
PRESSWORK_INLINE T place_frame(const Metric<T>& m, double r, double s, const Rows inverse, T contra[2][2]) {
  const T a11 = m.g11 + T(2.0 * s) * m.gh[0] + T(s * s) * m.hh, a22 = m.g22 + T(2.0 * r) * m.gh[1] + T(r * r) * m.hh;
  const T a12 = m.g12 + T(r) * m.gh[0] + T(s) * m.gh[1] + T(r * s) * m.hh;
  const T area = square_root(a11 * a22 - a12 * a12);
  // in the frame with a1 as its x, all times |a1|: a1 = (a11, 0), a2 = (a12, area)
  T cosine = a11 * inverse[0] + a12 * inverse[2] + area * inverse[3];
  T sine = area * inverse[2] - a11 * inverse[1] - a12 * inverse[3];
  const T over = T(1.0) / square_root((cosine * cosine + sine * sine) * a11), by_area = T(1.0) / area;
  cosine *= over, sine *= over;
  contra[0][0] = (area * cosine - a12 * sine) * by_area, contra[0][1] = -(a12 * cosine + area * sine) * by_area;
  contra[1][0] = a11 * sine * by_area, contra[1][1] = a11 * cosine * by_area;
  return area;
}

// What MITC4+ makes of H and B by the cell's own shape.
template <class T>
struct Assumed {
  T h[2], scale;

  PRESSWORK_INLINE explicit Assumed(const T skew[2]) : h{skew[0], skew[1]} {
    // below 1 in a convex quadrilateral; 1 where two corners meet
    scale = T(1.0) / (smaller(h[0] * h[0] + h[1] * h[1], T(0.99)) - T(1.0));
  }
  // constant: 11, 22 and 12, to which H - 2/3 B is added; linear: L1, L2; gives 2 B
  PRESSWORK_INLINE T tie(T constant[3], const T linear[2], T H) const {
    const T B = scale * (h[0] * (h[0] * (constant[0] + H) + h[1] * constant[2] - linear[0]) +
                         h[1] * (h[1] * (constant[1] + H) - linear[1]));
    const T both = H - T(2.0 / 3.0) * B;
    constant[0] += both, constant[1] += both;
    return T(2.0) * B;
  }
  // tie, transposed: resultants on constant, linear and 2 B to those on the strains; gives that on H
  PRESSWORK_INLINE T spread(T constant[3], T linear[2], T on_two_B) const {
    const T sum = constant[0] + constant[1], B = scale * (T(2.0) * on_two_B - T(2.0 / 3.0) * sum);
    constant[0] += B * h[0] * h[0], constant[1] += B * h[1] * h[1], constant[2] += B * h[0] * h[1];
    linear[0] -= B * h[0], linear[1] -= B * h[1];
    return sum + B * (h[0] * h[0] + h[1] * h[1]);
  }
};

// Adds what a point's resultants do on the strains of the cell; n: 11, 22, 12.
template <class T>
PRESSWORK_INLINE void add_point(double r, double s, const T n[3], T constant[3], T linear[2], T& on_two_B) {
  for (int i = 0; i < 3; ++i) constant[i] += n[i];
  linear[0] += T(s) * n[0] + T(r) * n[2];
  linear[1] += T(r) * n[1] + T(s) * n[2];
  on_two_B += T(r * s) * n[2];
}

// Bound of the highest frequency squared of an element of this mass, its rotary inertia alpha times that: membrane, or
// the sum of bending and shear. What shell4::bound_frequency does with the gradients at the centre is done here with
// 3/4 of their mean over the points, which is the same in a parallelogram; then what the modes of distorted and warped
// cells have in common.
template <class T, class Rows>
PRESSWORK_DEVICE T bound_frequency(double young, double poisson, const T x[4][3], const Rows state, T mass, T alpha) {
  Centre<T> g;
  Rows point = state + first_point;
  measure_centre(x, point, g);
  Metric<T> m;
  measure_metric(g.c, m);
  // 1. sums over the points: area, gradients of the nodes' shape functions, and of the tied rotations, as tensors
  T area(0.0), G[3] = {T(0.0), T(0.0), T(0.0)}, R[3] = {T(0.0), T(0.0), T(0.0)};  // xx, yy, xy
  for (int q = 0; q < points; ++q, point = point + point_rows) {
    const double r = at_r(q), s = at_s(q);
    T contra[2][2];
    const T here = place_frame(m, r, s, point + reference, contra);
    const T first = T(1.0 / 3.0) * m.g11 + m.hh + T(2.0 * s) * m.gh[0];
    const T second = T(1.0 / 3.0) * m.g22 + m.hh + T(2.0 * r) * m.gh[1];
    for (int i = 0; i < 3; ++i) {
      const int a = i == 1, b = i != 0;
      const T aa = contra[0][a] * contra[0][b], bb = contra[1][a] * contra[1][b];
      const T ab = contra[0][a] * contra[1][b] + contra[0][b] * contra[1][a];
      G[i] += here * (T(0.25) * (aa + bb) + T(0.1875 * r * s) * ab);
      R[i] += here * T(0.75) * (aa * first + bb * second + T(i < 2 ? 1.0 : 0.0));
    }
    area += here;
  }
  // 2. largest and smallest eigenvalue
  const T over_area = T(1.0) / area, over = T(1.0) / alpha;
  const auto eigenvalues = [&](const T t[3], T& low) {
    const T mean = T(0.5) * over_area * (t[0] + t[1]), gap = over_area * (t[0] - t[1]), xy = over_area * t[2];
    const T half = T(0.5) * square_root(gap * gap + T(4.0) * xy * xy);
    low = mean - half;
    return mean + half;
  };
  T g2, r2;
  const T g1 = eigenvalues(G, g2), r1 = eigenvalues(R, r2);
  // 3. the bound
  const T t = state[thickness], specific = T(young) * area * t / mass;
  const T height = dot3(g.c.h, g.c.d0), skew = larger(g.skew[0], -g.skew[0]) + larger(g.skew[1], -g.skew[1]);
  const T warp = square_root(larger(height, -height) * t * T(2.0) / g.area);
  const T membrane = T(4.0 / (1.0 - poisson * poisson)) * specific * (g1 + T(poisson) * g2);
  const T bending = membrane * t * t * T(1.0 / 12.0) * over;
  const T shear = T(0.5 * shell4::shear_factor / (1.0 + poisson)) * specific * (T(4.0) * g1 + r1 * over);
  return larger(membrane * (T(1.0) + T(membrane_of_skew) * skew + T(membrane_of_warp) * warp),
                bending + shear * (T(1.0) + T(shear_of_skew) * skew));
}

// Advance one shell (or pack) by dt; arguments as those of shell4::advance, but that the layers need not follow the
// other rows of the state, which may be apart.
template <class T, class Law, class Rows, class Layers>
PRESSWORK_INLINE void advance(const Law& law, const LayerRule& rule, const LayerConditions<T>& now, const T x[4][3],
                              const T v[4][3], const T w[4][3], const T* room, const Rows state, Layers layers,
                              T* force) {
  const double dt = now.dt;
  using namespace shell4;
  const T none[3] = {T(0.0), T(0.0), T(0.0)};
  // 1. strains of the cell, in the middle of the step
  Forms<T> strain;
  T twice_B[2];  // of membrane and bending
  Metric<T> middle_metric;
  {
    T middle[4][3];
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) middle[a][i] = x[a][i] - T(0.5 * dt) * v[a][i];
    Centre<T> g;
    shell4_mitc::measure_centre(middle, state + first_point, g);
    measure_metric(g.c, middle_metric);
    Patterns<T> change;
    measure_change(g, dt, v, w, change, none, strain);
    const Assumed<T> assumed(g.skew);
    twice_B[0] = assumed.tie(strain.membrane, strain.hourglass, dot3(g.c.h, change.h));
    twice_B[1] = assumed.tie(strain.bending, strain.hourglass + 2, dot3(g.c.h, change.e));
  }
  Centre<T> g;
  shell4_mitc::measure_centre(x, state + first_point, g);
  Metric<T> metric;
  measure_metric(g.c, metric);
  // 2. points: layers and transverse shear
  const T shear_modulus(0.5 * shear_factor * law.young / (1.0 + law.poisson));
  Forms<T> out;
  for (int i = 0; i < 3; ++i) out.membrane[i] = out.bending[i] = T(0.0);
  for (int i = 0; i < 2; ++i) out.shear[i] = T(0.0);
  for (auto& Q : out.hourglass) Q = T(0.0);
  T on_B[2] = {T(0.0), T(0.0)}, done(0.0), mean(0.0);
  Rows point = state + first_point;
  for (int q = 0; q < points; ++q, layers.skip(rule.points), point = point + point_rows) {
    const double r = at_r(q), s = at_s(q);
    T contra[2][2], e[3], membrane[3], curvature[3], shear_strain[2];
    place_frame(middle_metric, r, s, point + reference, contra);
    const auto covariant = [&](const T constant[3], const T linear[2], T two_B) {
      e[0] = constant[0] + T(s) * linear[0], e[1] = constant[1] + T(r) * linear[1];
      e[2] = constant[2] + T(r) * linear[0] + T(s) * linear[1] + T(r * s) * two_B;
    };
    T in_frame[3];
    covariant(strain.membrane, strain.hourglass, twice_B[0]);
    to_frame(contra, e, in_frame), to_sums(in_frame, membrane);
    covariant(strain.bending, strain.hourglass + 2, twice_B[1]);
    to_frame(contra, e, in_frame), to_sums(in_frame, curvature);
    const T across[2] = {strain.shear[0] + T(s) * strain.hourglass[4], strain.shear[1] + T(r) * strain.hourglass[5]};
    for (int i = 0; i < 2; ++i) shear_strain[i] = contra[0][i] * across[0] + contra[1][i] * across[1];

    const T area = place_frame(metric, r, s, point + reference, contra), t = point[point_thickness];
    Resultants<T> found;
    advance_section(law, rule, membrane, curvature, t, now.at_point(q, rule.points), layers, found);
    squeeze_between_tools<4>(law, rule, room, T(0.25) * state[spring] / area, t, membrane, layers, point[pressure],
                             found);
    T n[3], on[3];
    from_sums(found.force, n), from_frame(contra, area, n, on);
    add_point(r, s, on, out.membrane, out.hourglass, on_B[0]);
    from_sums(found.moment, n), from_frame(contra, area, n, on);
    add_point(r, s, on, out.bending, out.hourglass + 2, on_B[1]);
    T stress[2];
    for (int i = 0; i < 2; ++i) {
      const T before = point[shear + i], now = before + shear_modulus * shear_strain[i];
      found.work += T(0.5) * t * (before + now) * shear_strain[i];
      point[shear + i] = now;
      stress[i] = area * t * now;
    }
    for (int k = 0; k < 2; ++k) {
      const T Q = contra[k][0] * stress[0] + contra[k][1] * stress[1];
      out.shear[k] += Q, out.hourglass[4 + k] += T(k == 0 ? s : r) * Q;
    }
    done += area * found.work;
    change_thickness(found.thickness_strain, point[point_thickness], point[rounding]);
    mean += T(0.25) * point[point_thickness];
  }
  state[work] += done;
  state[thickness] = mean;
  // 3. nodal forces
  const Assumed<T> assumed(g.skew);
  const T on_H = assumed.spread(out.membrane, out.hourglass, on_B[0]);
  const T on_e = assumed.spread(out.bending, out.hourglass + 2, on_B[1]);
  Patterns<T> f;
  shell4::spread<false>(none, g.c, out, f);
  for (int i = 0; i < 3; ++i) f.h[i] += on_H * g.c.h[i], f.e[i] += on_e * g.c.h[i];
  spread_to_nodes(g, out.bending, f, force);
}

}  // namespace presswork::shell4_mitc
