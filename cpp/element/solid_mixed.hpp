// SPDX-License-Identifier: Apache-2.0
// tet4_mini: the linear tetrahedron with a pressure at its nodes and a condensed bubble (Arnold, Brezzi & Fortin 1984).
//
// A node has four freedoms: its displacement and q, the change of the pressure over the increment (tension positive),
// as the length dp/scale [mm], so that the matrix has entries of one size. At the centroid the law takes F of the
// increment with the change of volume that the pressure asks for, as with F-bar:
//
//     F (Jbar/J)^(1/3),    ln Jbar = mean dp / K + the law's thermal dilatation
//
// so that every law gives stress, history and tangent as in other elements. The equation of node a's pressure is
//
//     V [(J - Jbar)/4 - sum_b ((1 + d_ab)/20 - 1/16) dp_b / K] - sum_b C_ab (s p_b - p_b,n) = 0           [mm3]
//
// d_ab Kronecker's, V the volume at t: the volume in balance with the pressures, whose mean counts as the law has it
// and whose differences by the consistent matrix. C is what the bubble b = 256 N1 N2 N3 N4 adds:
//
//     C_ab = (int b)^2 grad N_a . B^-1 grad N_b,    int b = 32/105 V
//     B    = G (tr M 1 + M/3),   M = int grad b grad b^T = 4096/945 V sum_a grad N_a grad N_a^T
//
// p is the sum of all changes. The bubble's own stress balances grad p; plastic flow relaxes it as it relaxes every
// deviatoric stress, to 1/s of its elastic trial, s = 1 + 3 G d eqps / sigma_eq. So the bubble moves by
// B^-1 (s grad p - grad p_n): elastic where nothing flows, viscous where everything does. d eqps and sigma_eq are those
// of the increment before, d eqps in proportion to the time, which leaves the equations linear in p and the tangent
// exact.
//
// Derivatives: with the law's tangent in q = (a : I - 2 sigma)/3 as in F-bar (de Souza Neto et al. 1996), whose mean
// divergence is that of the pressure. Small displacements: J - Jbar becomes the difference of the traces.
#pragma once

#include "element/solid_space.hpp"
#include "reference/tet.hpp"

namespace presswork {

template <class T>
struct MixedTetrahedron : SolidSpace<Tet4, 1, T> {
  using Body = SolidSpace<Tet4, 1, T>;
  using Point = typename Body::Point;
  using Gradients = typename Body::Gradients;
  static constexpr int nodes = 4, node_freedoms = 4, freedoms = nodes * node_freedoms;

  // As Solid::evaluate, with x (nodes, 4): place and pressure over scale at t, du: their changes. `points` keeps the
  // state also by
  //     dilatation()                              of the law without stress in this increment
  //     begin_bubble(s), keep_bubble(G)           how far flow has relaxed the bubble; the next one's from G
  template <class Points>
  [[gnu::always_inline]] static inline Mask<T> evaluate(const SolidSection& section, const PointSettings& settings,
                                                        const T x[][4], const T du[][4], Points& points, T* force,
                                                        T* K) {
    // 1. kinematics
    Point g;
    const bool small = settings.small_displacements;
    T place[nodes][3], moved[nodes][3], p_n[nodes], dp[nodes], mean(0.0);
    for (int a = 0; a < nodes; ++a) {
      for (int i = 0; i < 3; ++i) place[a][i] = x[a][i], moved[a][i] = du[a][i];
      p_n[a] = T(section.pressure_scale) * x[a][3], dp[a] = T(section.pressure_scale) * du[a][3];
      mean += T(0.25) * dp[a];
    }
    Mask<T> bad = Body::measure_reference(section, place, 0, g);
    bad = either(bad, Body::deform(moved, small, g));
    if (any(bad)) return bad;

    // 2. stress with the volume that the pressure asks for
    const T by_bulk(1.0 / section.bulk_modulus), dilatation = mean * by_bulk + points.dilatation();
    const T ratio = small ? dilatation : exponential(dilatation);
    T F[9];
    std::copy_n(g.F, 9, F);
    Body::use_mean_dilatation(section, ratio, g, small, F);
    typename Body::Response response;
    points.advance(0, place, moved, &g, F, response);
    const T volume = g.volume_t * g.jacobian;
    T own[3 * nodes], forms[nodes][nodes], relaxed;
    Gradients now;
    for (auto& f : own) f = T(0.0);
    Body::push_forward(g, small, now);
    Body::add_force(now, response.stress, volume, own);

    // 3. the pressures' equations
    points.begin_bubble(relaxed);
    find_bubble(g, section.shear_modulus, forms);
    const T missing = small ? g.F[0] + g.F[4] + g.F[8] - T(3.0) - ratio : g.jacobian - ratio;
    const T scale(section.pressure_scale), store = g.volume_t * by_bulk;
    for (int a = 0; a < nodes; ++a) {
      T sum = T(0.25) * g.volume_t * missing;
      for (int b = 0; b < nodes; ++b)
        sum -= store * T(a == b ? 0.1 - 0.0625 : 0.05 - 0.0625) * dp[b] +
               forms[a][b] * (relaxed * (p_n[b] + dp[b]) - p_n[b]);
      for (int i = 0; i < 3; ++i) force[4 * a + i] = own[3 * a + i];
      force[4 * a + 3] = scale * sum;
    }
    points.keep_bubble(section.shear_modulus);
    points.keep(0, volume);
    if (!K) return bad;

    // 4. tangent
    T stiffness[9 * nodes * nodes], q[6], pull[nodes][3];
    for (auto& k : stiffness) k = T(0.0);
    Body::add_stiffness(now, response, volume, stiffness);
    const double less = small ? 0.0 : response.with_initial_stress ? 1.0 : 2.0;
    for (int i = 0; i < 6; ++i)
      q[i] = T(1.0 / 3) * volume *
             (response.modulus[i][0] + response.modulus[i][1] + response.modulus[i][2] - T(less) * response.stress[i]);
    const T stretch = small ? T(1.0) : ratio;  // d Jbar / d ln Jbar
    for (int a = 0; a < nodes; ++a) Body::apply(now[a], q, pull[a]);
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b) {
        T* block = K + 4 * a * freedoms + 4 * b;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j)
            block[i * freedoms + j] = stiffness[(3 * a + i) * 3 * nodes + 3 * b + j] - pull[a][i] * now[b][j];
          block[i * freedoms + 3] = T(0.25) * scale * by_bulk * pull[a][i];
          block[3 * freedoms + i] = T(0.25) * scale * volume * now[b][i];
        }
        const T held = store * (T(a == b ? 0.1 - 0.0625 : 0.05 - 0.0625) + T(0.0625) * stretch);
        block[3 * freedoms + 3] = -scale * scale * (held + relaxed * forms[a][b]);
      }
    return bad;
  }

  // C [mm3/MPa]
  static void find_bubble(const Point& g, double shear_modulus, T C[nodes][nodes]) {
    T B[9], inverse[9], along[nodes][3], trace(0.0);
    const T whole = T(shear_modulus * 4096.0 / 945.0) * g.volume_t;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        B[3 * i + j] = T(0.0);
        for (int a = 0; a < nodes; ++a) B[3 * i + j] += g.grad[a][i] * g.grad[a][j];
        if (i == j) trace += B[3 * i + j];
      }
    for (int i = 0; i < 9; ++i) B[i] = whole * (T(1.0 / 3) * B[i] + (i % 4 == 0 ? trace : T(0.0)));
    Body::find_cofactors(B, inverse);
    const T area = T(32.0 / 105.0) * g.volume_t, factor = area * area / stretch::determinant(B);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i)
        along[a][i] = factor * (inverse[3 * i] * g.grad[a][0] + inverse[3 * i + 1] * g.grad[a][1] +
                                inverse[3 * i + 2] * g.grad[a][2]);
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b)
        C[a][b] = g.grad[a][0] * along[b][0] + g.grad[a][1] * along[b][1] + g.grad[a][2] * along[b][2];
  }
};

// How far flow relaxes deviatoric stress: 3 G d eqps / sigma_eq; stress in order xx, yy, zz, xy, yz, zx.
template <class T>
T relaxed_by_flow(double shear_modulus, const T s[6], T flowed) {
  const T x = s[0] - s[1], y = s[1] - s[2], z = s[2] - s[0];
  const T square = T(0.5) * (x * x + y * y + z * z) + T(3.0) * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  const auto is_loaded = square > T(1e-12);
  return select(is_loaded, T(3.0 * shear_modulus) * flowed / square_root(select(is_loaded, square, T(1.0))), T(0.0));
}

}  // namespace presswork
