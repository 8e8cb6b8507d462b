// SPDX-License-Identifier: Apache-2.0
// One-point solids of the explicit loop, plane strain or axisymmetric: a quadrilateral with hourglass control, a
// triangle. The elements of solid.hpp, evaluated without a tangent, on state that is kept by packs.
//
// The quadrilateral's map is x = c + p xi + q eta + h xi eta (each with two components), so that det J = J0 + J1 xi +
// J2 eta, and the volume averages of gradients and of N/r in axisymmetry are polynomials of p, q, h, integrated
// exactly: of r dN_a/dr, times 1/4, with the corner's xi_a and eta_a,
//     xi_a (q_z c_r + p_r h_z/3) - eta_a (p_z c_r + q_r h_z/3) + xi_a eta_a (q_r q_z - p_r p_z)/3,
// that of r dN_a/dz by -r for z in the factors q_z, p_z, h_z; of N_a: J0 + (xi_a J1 + eta_a J2)/3.
#pragma once

#include "element/solid2d_cycle.hpp"

namespace presswork {

template <class Cell>
struct OnePointSolid {
  static constexpr bool is_quad = std::is_same_v<Cell, Quad4>;
  using Geometry = SolidGeometry<Cell, 1>;
  using Point = typename Geometry::PointGeometry;
  using T = Pack;
  static constexpr int nodes = Geometry::nodes;
  using Forces = SolidForces<nodes>;
  // Gradients, N/r (0 in plane strain) and volume at x; true in lanes where the cell is turned inside out.
  static Pack::Mask measure(const SolidSection& section, const T x[][2], Point& g) {
    if constexpr (is_quad)
      return measure_quad(section, x, g);
    else
      return measure_triangle(section, x, g);
  }

  // One cycle of dt, by du to x at its end. Advances the state in place and gives the nodal forces (2 nodes); in lanes
  // where the cell is turned inside out the answer is true, and the pack's state then stays.
  template <class Law>
  [[gnu::flatten]] static Pack::Mask advance(const Law& law, const SolidSection& section, double dt, const T x[][2],
                                             const T du[][2], CyclePlace& place, T* state, T* force) {
    for (int i = 0; i < 2 * nodes; ++i) force[i] = T(0.0);
    // 1. configuration at the start, deformation gradient
    T x_n[nodes][2];
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 2; ++i) x_n[a][i] = x[a][i] - du[a][i];
    Point g;
    Pack::Mask bad = measure(section, x_n, g);
    bad |= Geometry::deform(du, g);
    if (any(bad)) return bad;

    // 2. strain of the increment, stress at its end, in the frame that has not turned; work by the mean stress
    Increment<T> inc;
    measure_increment(g.F, StrainMeasure::log, false, inc);
    if constexpr (std::is_same_v<Law, CycleUmat<4>>) {
      for (int i = 0; i < 2; ++i) {
        place.at[i] = T(0.0);
        for (int a = 0; a < nodes; ++a) place.at[i] += T(1.0 / nodes) * x[a][i];
      }
      const T around = T(2.0 * std::numbers::pi) * place.at[0];
      place.length = square_root(g.volume_t / (section.axisymmetric ? around : T(section.depth)));
    }
    T unturned[4], modulus, done(0.0);
    advance_stress<Forces>(law, g.F, inc, dt, place, state, unturned, modulus);
    for (int i = 0; i < 4; ++i)
      done += T(0.5) * (state[CycleRow::stress + i] + inc.jacobian * unturned[i]) * inc.strain[i];
    turn_stress(inc.cosine, inc.sine, unturned, state + CycleRow::stress);
    state[CycleRow::work] += done * g.volume_t;

    // 3. forces on the configuration at the end
    T now[nodes][3];
    Geometry::push_forward(g, now);
    Forces::add_force(now, state + CycleRow::stress, g.volume_t * g.jacobian, force);
    if constexpr (is_quad)
      state[CycleRow::hourglass_work] += Forces::add_hourglass(modulus, section.hourglass_fraction, x_n, du, g, now,
                                                               state + CycleRow::hourglass, force, nullptr);
    return bad;
  }

  // Bound of the highest squared frequency [1/s2], elastic, at x; mass of the cell's nodes [t].
  //
  // The eigenvalues of M^-1 V B^T D B are those of A = V D (B M^-1 B^T), of which n can differ from 0 (3 in plane
  // strain, 4 in axisymmetry); with their sum s and sum of squares t the largest is at most s/n + sqrt((n-1)/n (t -
  // s^2/n)) (Wolkowicz & Styan 1980). The hourglass control adds at most its own.
  static T bound_frequency(const IsotropicModuli& moduli, const SolidSection& section, const T x[][2], const T mass[]) {
    Point g;
    measure(section, x, g);
    T inverse_mass[nodes], G[4][4] = {};
    for (int a = 0; a < nodes; ++a) {
      inverse_mass[a] = T(1.0) / mass[a];
      const T along[2][4] = {{g.grad[a][0], T(0.0), g.hoop[a], g.grad[a][1]},
                             {T(0.0), g.grad[a][1], T(0.0), g.grad[a][0]}};
      for (const auto& row : along)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) G[i][j] += inverse_mass[a] * row[i] * row[j];
    }
    const double shear = moduli.shear, lame = moduli.bulk - 2.0 / 3.0 * shear;
    T A[4][4], sum(0.0), squares(0.0);
    for (int j = 0; j < 4; ++j) {
      const T trace = T(lame) * (G[0][j] + G[1][j] + G[2][j]);
      for (int i = 0; i < 3; ++i) A[i][j] = g.volume_t * (trace + T(2.0 * shear) * G[i][j]);
      A[3][j] = g.volume_t * T(shear) * G[3][j];
    }
    for (int i = 0; i < 4; ++i) {
      sum += A[i][i];
      for (int j = 0; j < 4; ++j) squares += A[i][j] * A[j][i];
    }
    const double n = section.axisymmetric ? 4.0 : 3.0;
    T bound = sum * T(1.0 / n) + square_root(larger(T((n - 1.0) / n) * (squares - sum * sum * T(1.0 / n)), T(0.0)));
    if constexpr (is_quad) {
      T at[2] = {T(0.0), T(0.0)}, norm(0.0), inertia(0.0);
      for (int a = 0; a < 4; ++a)
        for (int i = 0; i < 2; ++i) at[i] += T(xi[a] * eta[a]) * x[a][i], norm += g.grad[a][i] * g.grad[a][i];
      for (int a = 0; a < 4; ++a) {
        const T gamma = T(0.25) * (T(xi[a] * eta[a]) - at[0] * g.grad[a][0] - at[1] * g.grad[a][1]);
        inertia += gamma * gamma * inverse_mass[a];
      }
      bound += T(2.0 * section.hourglass_fraction * shear) * g.volume_t * norm * inertia;
    }
    return bound;
  }

 private:
  static constexpr double xi[4] = {-1, 1, 1, -1}, eta[4] = {-1, -1, 1, 1};

  static Pack::Mask measure_quad(const SolidSection& section, const T x[][2], Point& g) {
    T c_r = T(0.25) * ((x[0][0] + x[1][0]) + (x[2][0] + x[3][0])), p[2], q[2], h[2];
    for (int i = 0; i < 2; ++i) {
      T bottom = x[1][i] - x[0][i], top = x[2][i] - x[3][i];
      p[i] = T(0.25) * (top + bottom);
      h[i] = T(0.25) * (top - bottom);
      q[i] = T(0.25) * ((x[3][i] - x[0][i]) + (x[2][i] - x[1][i]));
    }
    const T J0 = p[0] * q[1] - q[0] * p[1], J1 = p[0] * h[1] - h[0] * p[1], J2 = h[0] * q[1] - q[0] * h[1];
    // the smallest det J of the four Gauss points, as in the implicit element
    const T worst = J0 - T(0.5773502691896258) * (larger(J1, -J1) + larger(J2, -J2));
    if (!section.axisymmetric) {
      const T inv = T(0.25) / J0;
      for (int a = 0; a < 4; ++a) {
        g.grad[a][0] = (T(xi[a]) * q[1] - T(eta[a]) * p[1]) * inv;
        g.grad[a][1] = (T(eta[a]) * p[0] - T(xi[a]) * q[0]) * inv;
        g.hoop[a] = T(0.0);
      }
      g.volume_t = T(4.0 * section.depth) * J0;
      return !(J0 > T(0.0));
    }
    const T third(1.0 / 3), volume = T(4.0) * (c_r * J0 + third * (p[0] * J1 + q[0] * J2)), inv = T(1.0) / volume;
    T by_xi[2], by_eta[2], by_both[2];  // r d/dr from factors of z, r d/dz from those of r
    for (int i = 0; i < 2; ++i) {
      const T scale = i == 0 ? inv : -inv;
      const T q_i = q[1 - i], p_i = p[1 - i], h_i = third * h[1 - i];
      by_xi[i] = scale * (q_i * c_r + p[0] * h_i);
      by_eta[i] = -scale * (p_i * c_r + q[0] * h_i);
      by_both[i] = scale * third * (q[0] * q_i - p[0] * p_i);
    }
    const T hoop = inv * J0, hoop_xi = inv * third * J1, hoop_eta = inv * third * J2;
    for (int a = 0; a < 4; ++a) {
      for (int i = 0; i < 2; ++i)
        g.grad[a][i] = T(xi[a]) * by_xi[i] + T(eta[a]) * by_eta[i] + T(xi[a] * eta[a]) * by_both[i];
      g.hoop[a] = hoop + T(xi[a]) * hoop_xi + T(eta[a]) * hoop_eta;
    }
    g.volume_t = T(2.0 * std::numbers::pi) * volume;
    return !(worst > T(0.0));
  }

  static Pack::Mask measure_triangle(const SolidSection& section, const T x[][2], Point& g) {
    T side[3][2];  // opposite a corner, counter-clockwise
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 2; ++i) side[a][i] = x[(a + 2) % 3][i] - x[(a + 1) % 3][i];
    const T det = side[1][0] * side[2][1] - side[1][1] * side[2][0];
    T thickness(section.depth), hoop(0.0), inv = T(1.0) / det;
    if (section.axisymmetric) {
      const T three_r = x[0][0] + x[1][0] + x[2][0];
      thickness = T(2.0 / 3.0 * std::numbers::pi) * three_r;
      hoop = T(1.0) / three_r;
    }
    for (int a = 0; a < 3; ++a) {
      g.grad[a][0] = -side[a][1] * inv;
      g.grad[a][1] = side[a][0] * inv;
      g.hoop[a] = hoop;
    }
    g.volume_t = T(0.5) * det * thickness;
    return !(det > T(0.0));
  }
};

}  // namespace presswork
