// SPDX-License-Identifier: Apache-2.0
// What makes one degenerated shell differ from another: the cell, the points in its plane, and where the covariant
// strains are sampled. All of it is constant tables.
//
// With nodal positions x_a and directors d_a (vectors), every covariant strain is a bilinear form of nodal values:
//   in-plane component c of {11, 22, 12 (engineering)}     1/2 sum_ab G_c[a][b] x_a.x_b,  G_11[a][b] = N_a,1 N_b,1 ...
//   transverse shear component k of {13, 23}               sum_ab H_k[a][b] x_a.d_b,      H_k[a][b] = N_a,k N_b
// so mixed interpolation, which replaces a component by values at tying points, is a sum of such tables.
//
//   none        strains where they are integrated (Ahmad, Irons & Zienkiewicz 1970)
//   selective   transverse shear from the points of the reduced rule
//   mitc        quad4: Dvorkin & Bathe 1984; tri3: Lee & Bathe 2004 (MITC3); quad9: Bucalem & Bathe 1993 (MITC9)
#pragma once

#include "reference/cells.hpp"

namespace presswork {

enum class Tying { none, selective, mitc };

template <Cell cell, int n_points, Tying tying>
struct ShellTable {
  static constexpr int nodes = node_count(cell), points = n_points;
  ShapeTable<cell, n_points> shape;
  double x[n_points][2];
  double G[n_points][3][nodes][nodes] = {};
  double H[n_points][2][nodes][nodes] = {};

  static const ShellTable& get() {
    static const ShellTable table;
    return table;
  }

  ShellTable() {
    place_points();
    for (int q = 0; q < n_points; ++q) {
      const double r = x[q][0], s = x[q][1];
      for (int c = 0; c < 3; ++c) sample_in_plane(q, c, r, s, 1.0);
      for (int k = 0; k < 2; ++k) sample_shear(q, k, r, s, 1.0);
      if constexpr (tying == Tying::selective) tie_selectively(q, r, s);
      if constexpr (tying == Tying::mitc && cell == Cell::quad4) tie_quad4(q, r, s);
      if constexpr (tying == Tying::mitc && cell == Cell::tri3) tie_tri3(q, r, s);
      if constexpr (tying == Tying::mitc && cell == Cell::quad9) tie_quad9(q, r, s);
    }
  }

 private:
  static constexpr bool is_triangle = cell == Cell::tri3 || cell == Cell::tri6;

  void place_points() {
    auto copy = [this](const auto& rule) {
      for (int q = 0; q < n_points; ++q) x[q][0] = rule[q].x, x[q][1] = rule[q].y;
    };
    if constexpr (is_triangle)
      copy(triangle_rule<n_points>());
    else
      copy(gauss_square<n_points == 1 ? 1 : n_points == 4 ? 2 : 3>());
  }

  void clear_in_plane(int q, int c) {
    for (auto& row : G[q][c])
      for (auto& g : row) g = 0.0;
  }
  void clear_shear(int q, int k) {
    for (auto& row : H[q][k])
      for (auto& h : row) h = 0.0;
  }
  // add `weight` times component c at (r, s) to point q
  void sample_in_plane(int q, int c, double r, double s, double weight) {
    double N[nodes], dN[nodes][2];
    shape_functions<cell>(r, s, N, dN);
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b)
        G[q][c][a][b] += weight * (c < 2 ? dN[a][c] * dN[b][c] : dN[a][0] * dN[b][1] + dN[a][1] * dN[b][0]);
  }
  void sample_shear(int q, int k, double r, double s, double weight) {
    double N[nodes], dN[nodes][2];
    shape_functions<cell>(r, s, N, dN);
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b) H[q][k][a][b] += weight * dN[a][k] * N[b];
  }

  // shear from the reduced rule: its one point, or linear (triangle) and bilinear through its points
  void tie_selectively(int q, double r, double s) {
    const double g = std::sqrt(1.0 / 3);
    for (int k = 0; k < 2; ++k) {
      clear_shear(q, k);
      if constexpr (cell == Cell::tri3) {
        sample_shear(q, k, 1.0 / 3, 1.0 / 3, 1.0);
      } else if constexpr (cell == Cell::quad4) {
        sample_shear(q, k, 0.0, 0.0, 1.0);
      } else if constexpr (cell == Cell::tri6) {
        const double z = 1 - r - s;  // through (1/6, 1/6), (2/3, 1/6), (1/6, 2/3)
        sample_shear(q, k, 1.0 / 6, 1.0 / 6, 2 * z - 1.0 / 3);
        sample_shear(q, k, 2.0 / 3, 1.0 / 6, 2 * r - 1.0 / 3);
        sample_shear(q, k, 1.0 / 6, 2.0 / 3, 2 * s - 1.0 / 3);
      } else {
        for (double u : {-g, g})
          for (double v : {-g, g}) sample_shear(q, k, u, v, 0.25 * (1 + r * u / (g * g)) * (1 + s * v / (g * g)));
      }
    }
  }

  void tie_quad4(int q, double r, double s) {
    clear_shear(q, 0), clear_shear(q, 1);
    for (double side : {-1.0, 1.0}) {
      sample_shear(q, 0, 0.0, side, 0.5 * (1 + side * s));
      sample_shear(q, 1, side, 0.0, 0.5 * (1 + side * r));
    }
  }

  // 13 = e1 + c s, 23 = e2 - c r, c = e2 - e1 - e23(3) + e13(3), at the mid-sides 1 (1/2, 0), 2 (0, 1/2), 3 (1/2, 1/2)
  void tie_tri3(int q, double r, double s) {
    clear_shear(q, 0), clear_shear(q, 1);
    auto add = [&](int to, double factor, int k, double u, double v) {
      double N[nodes], dN[nodes][2];
      shape_functions<cell>(u, v, N, dN);
      for (int a = 0; a < nodes; ++a)
        for (int b = 0; b < nodes; ++b) H[q][to][a][b] += factor * dN[a][k] * N[b];
    };
    auto add_c = [&](int to, double factor) {
      add(to, factor, 1, 0.0, 0.5);
      add(to, -factor, 0, 0.5, 0.0);
      add(to, -factor, 1, 0.5, 0.5);
      add(to, factor, 0, 0.5, 0.5);
    };
    add(0, 1.0, 0, 0.5, 0.0);
    add_c(0, s);
    add(1, 1.0, 1, 0.0, 0.5);
    add_c(1, -r);
  }

  // 11 and 13: linear in r through +-1/sqrt 3, quadratic in s through -sqrt(3/5), 0, sqrt(3/5); 22 and 23 turned;
  // 12: bilinear through the 2x2 points
  void tie_quad9(int q, double r, double s) {
    const double g = std::sqrt(1.0 / 3), h = std::sqrt(0.6);
    auto linear = [&](double at, double u) { return 0.5 * (1 + u * at / (g * g)); };
    auto quadratic = [&](double at, double v) {
      return v == 0.0 ? 1 - at * at / (h * h) : 0.5 * (at / v) * (1 + at / v);
    };
    for (int c = 0; c < 3; ++c) clear_in_plane(q, c);
    clear_shear(q, 0), clear_shear(q, 1);
    for (double u : {-g, g}) {
      for (double v : {-h, 0.0, h}) {
        sample_in_plane(q, 0, u, v, linear(r, u) * quadratic(s, v));
        sample_shear(q, 0, u, v, linear(r, u) * quadratic(s, v));
        sample_in_plane(q, 1, v, u, linear(s, u) * quadratic(r, v));
        sample_shear(q, 1, v, u, linear(s, u) * quadratic(r, v));
      }
      for (double v : {-g, g}) sample_in_plane(q, 2, u, v, linear(r, u) * linear(s, v));
    }
  }
};

}  // namespace presswork
