// SPDX-License-Identifier: Apache-2.0
// Geometry of a solid in the plane (solid.hpp): gradients and volume at t, F of the increment, means over the element.
#pragma once

#include <numbers>

#include "reference/quad.hpp"
#include "reference/tri.hpp"
#include "tensor/dual.hpp"

namespace presswork {

// What is common to the solids of a block in the plane; in space nothing is asked of it.
struct SolidSection {
  bool axisymmetric = false;
  double depth = 1.0;  // of plane strain [mm]
  double hourglass_fraction = 0.05;
  // of solids with a pressure at the nodes: elastic moduli [MPa], and the pressure that counts as a length [MPa/mm]
  double bulk_modulus = 1.0, shear_modulus = 1.0, pressure_scale = 1.0;
};

// To the last bit, which material/yield_terms.hpp's faster one is not.
inline double library_cube_root(double a) { return std::cbrt(a); }
inline Pack library_cube_root(Pack a) {
  return map_lanes(a, [](double x) { return std::cbrt(x); });
}
template <class S, int N>
Dual<S, N> library_cube_root(const Dual<S, N>& a) {
  S root = library_cube_root(a.value);
  return a.chain(root, root / (S(3.0) * a.value));
}

// At one point.
template <int nodes, class T = Pack>
struct SolidPoint {
  T grad[nodes][2], hoop[nodes];  // at t: gradients and N/r (zero in plane strain)
  T F[5];
  T volume_t, jacobian;
};

template <class Cell, int n_points, class T = Pack>
struct SolidGeometry {
  static constexpr int nodes = Cell::nodes;
  using PointGeometry = SolidPoint<nodes, T>;

  static const ShapeTable<Cell, n_points>& table() {
    static const ShapeTable<Cell, n_points> shared;
    return shared;
  }

  // Gradients, N/r and volume of one point at t; true in lanes where the cell is turned inside out there.
  static Mask<T> measure_reference(const SolidSection& section, const T x[][2], int q, PointGeometry& g) {
    const auto& shape = table();
    T det;
    gradients_at(x, shape.dN[q], g.grad, det);
    T thickness(section.depth), inv_r(0.0);
    if (section.axisymmetric) {
      T r(0.0);
      for (int a = 0; a < nodes; ++a) r += T(shape.N[q][a]) * x[a][0];
      thickness = T(2.0 * std::numbers::pi) * r;
      inv_r = T(1.0) / r;
    }
    for (int a = 0; a < nodes; ++a) g.hoop[a] = T(shape.N[q][a]) * inv_r;
    g.volume_t = T(shape.weight[q]) * det * thickness;
    return invert(det > T(0.0));
  }

  // The same for the one point of an axisymmetric quadrilateral: volume averages, so that a homogeneous stress is in
  // equilibrium in cells of any shape, which the centroid's values do not give.
  static Mask<T> measure_mean(const T x[][2], PointGeometry& g) {
    static const ShapeTable<Cell, 4> rule;
    T V(0.0), worst(1.0);
    for (int a = 0; a < nodes; ++a) g.grad[a][0] = g.grad[a][1] = g.hoop[a] = T(0.0);
    for (int p = 0; p < 4; ++p) {
      T grad[nodes][2], det, r(0.0);
      gradients_at(x, rule.dN[p], grad, det);
      for (int a = 0; a < nodes; ++a) r += T(rule.N[p][a]) * x[a][0];
      T area = T(2.0 * std::numbers::pi * rule.weight[p]) * det, volume = area * r;
      for (int a = 0; a < nodes; ++a) {
        for (int i = 0; i < 2; ++i) g.grad[a][i] += volume * grad[a][i];
        g.hoop[a] += area * T(rule.N[p][a]);
      }
      V += volume;
      worst = smaller(worst, det);
    }
    T inv = T(1.0) / V;
    for (int a = 0; a < nodes; ++a) g.grad[a][0] *= inv, g.grad[a][1] *= inv, g.hoop[a] *= inv;
    g.volume_t = V;
    return invert(worst > T(0.0));
  }

  static void gradients_at(const T x[][2], const double dN[][2], T grad[][2], T& det) {
    T j00(0.0), j01(0.0), j10(0.0), j11(0.0);
    for (int a = 0; a < nodes; ++a) {
      T nx(dN[a][0]), ny(dN[a][1]);
      j00 += nx * x[a][0], j01 += nx * x[a][1], j10 += ny * x[a][0], j11 += ny * x[a][1];
    }
    det = j00 * j11 - j01 * j10;
    T inv = T(1.0) / det;
    for (int a = 0; a < nodes; ++a) {
      T nx(dN[a][0]), ny(dN[a][1]);
      grad[a][0] = (j11 * nx - j01 * ny) * inv;
      grad[a][1] = (j00 * ny - j10 * nx) * inv;
    }
  }

  // F of the increment; true in lanes where the point is turned inside out, which small displacements cannot do.
  static Mask<T> deform(const T du[][2], PointGeometry& g, bool small = false) {
    T* F = g.F;
    F[0] = F[3] = F[4] = T(1.0), F[1] = F[2] = T(0.0);
    for (int a = 0; a < nodes; ++a) {
      F[0] += du[a][0] * g.grad[a][0], F[1] += du[a][0] * g.grad[a][1];
      F[2] += du[a][1] * g.grad[a][0], F[3] += du[a][1] * g.grad[a][1];
      F[4] += du[a][0] * g.hoop[a];
    }
    if (small) {
      g.jacobian = T(1.0);
      return invert(T(0.0) < T(1.0));
    }
    T plane = F[0] * F[3] - F[1] * F[2];
    g.jacobian = plane * F[4];
    // a trace of F that is not positive is a half turn: outside what an increment may do
    T worst = smaller(smaller(plane, F[4]), F[0] + F[3]);
    return invert(worst > T(1e-6));
  }

  // Gradients on the configuration at t+dt, and N/r there (zero in plane strain); small: as at t.
  static void push_forward(const PointGeometry& g, T now[][3], bool small = false) {
    if (small) {
      for (int a = 0; a < nodes; ++a) now[a][0] = g.grad[a][0], now[a][1] = g.grad[a][1], now[a][2] = g.hoop[a];
      return;
    }
    T inv = T(1.0) / (g.F[0] * g.F[3] - g.F[1] * g.F[2]), inv_hoop = T(1.0) / g.F[4];
    for (int a = 0; a < nodes; ++a) {
      now[a][0] = (g.grad[a][0] * g.F[3] - g.grad[a][1] * g.F[2]) * inv;
      now[a][1] = (g.grad[a][1] * g.F[0] - g.grad[a][0] * g.F[1]) * inv;
      now[a][2] = g.hoop[a] * inv_hoop;
    }
  }

  // Element volume ratio Jbar, and (with stiffness) the mean divergence row of every freedom. small: the mean of tr
  // strain in its place.
  static T mean_dilatation(const PointGeometry* g, bool with_row, bool small, T* mean_div) {
    T v(0.0), V(0.0);
    if (small) {
      for (int q = 0; q < n_points; ++q) {
        v += g[q].volume_t * (g[q].F[0] + g[q].F[3] + g[q].F[4] - T(3.0));
        V += g[q].volume_t;
      }
      for (int a = 0; a < nodes; ++a) {
        mean_div[2 * a] = mean_div[2 * a + 1] = T(0.0);
        for (int q = 0; q < n_points; ++q) {
          mean_div[2 * a] += g[q].volume_t / V * (g[q].grad[a][0] + g[q].hoop[a]);
          mean_div[2 * a + 1] += g[q].volume_t / V * g[q].grad[a][1];
        }
      }
      return v / V;
    }
    for (int q = 0; q < n_points; ++q) v += g[q].volume_t * g[q].jacobian, V += g[q].volume_t;
    if (with_row) {
      for (int i = 0; i < 2 * nodes; ++i) mean_div[i] = T(0.0);
      for (int q = 0; q < n_points; ++q) {
        T now[nodes][3], weight = g[q].volume_t * g[q].jacobian / v;
        push_forward(g[q], now);
        for (int a = 0; a < nodes; ++a) {
          mean_div[2 * a] += weight * (now[a][0] + now[a][2]);
          mean_div[2 * a + 1] += weight * now[a][1];
        }
      }
    }
    return v / V;
  }

  static void use_mean_dilatation(const SolidSection& section, T mean, const PointGeometry& g, bool small, T F[5]) {
    if (small) {
      T more = (mean - (F[0] + F[3] + F[4] - T(3.0))) * T(section.axisymmetric ? 1.0 / 3 : 0.5);
      F[0] += more, F[3] += more;
      if (section.axisymmetric) F[4] += more;
      return;
    }
    T ratio = mean / g.jacobian;
    T factor = section.axisymmetric ? library_cube_root(ratio) : square_root(ratio);
    for (int i = 0; i < 4; ++i) F[i] *= factor;
    if (section.axisymmetric) F[4] *= factor;
  }
};

}  // namespace presswork
