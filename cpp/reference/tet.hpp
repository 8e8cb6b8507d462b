// SPDX-License-Identifier: Apache-2.0
// Tetrahedra with vertices (0,0,0) (1,0,0) (0,1,0) (0,0,1). Node order: the first three corners counter-clockwise seen
// from the fourth, then the middles of the edges 01, 12, 20, 03, 13, 23; so do Abaqus and VTK (gmsh swaps the last
// two). Rules: the centroid, and the four points of degree 2 (Keast 1986); weights sum to 1/6.
#pragma once

#include "reference/quadrature.hpp"

namespace presswork {

struct Tetrahedron {
  static constexpr std::string_view plural = "tetrahedra";
  static constexpr int dim = 3, corners = 4;
  static constexpr double places[10][3] = {{0, 0, 0},     {1, 0, 0},   {0, 1, 0},   {0, 0, 1},     {0.5, 0, 0},
                                           {0.5, 0.5, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
  static constexpr int simplices[1][4] = {{0, 1, 2, 3}};
  using rules = std::integer_sequence<int, 1, 4>;

  template <int n>
  static std::array<QuadraturePoint<3>, n> rule() {
    static_assert(n == 1 || n == 4);
    std::array<QuadraturePoint<3>, n> points{};
    if constexpr (n == 1) {
      points[0] = {{0.25, 0.25, 0.25}, 1.0 / 6};
    } else {
      constexpr double near = 0.58541019662496845446, far = 0.13819660112501051518;
      for (int k = 0; k < 4; ++k)
        points[k] = {{k == 1 ? near : far, k == 2 ? near : far, k == 3 ? near : far}, 1.0 / 24};
    }
    return points;
  }
};

struct Tet4 : Tetrahedron {
  static constexpr std::string_view name = "tet4";
  static constexpr int nodes = 4, edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
                       faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, reversed[4] = {0, 2, 1, 3};
  static constexpr double mass_shares[4] = {0.25, 0.25, 0.25, 0.25};

  static void shape(const double* at, double* N, double (*dN)[3]) {
    N[0] = 1 - at[0] - at[1] - at[2];
    for (int i = 0; i < 3; ++i) {
      N[i + 1] = at[i];
      dN[0][i] = -1;
      for (int j = 0; j < 3; ++j) dN[i + 1][j] = i == j ? 1 : 0;
    }
  }
};

struct Tet10 : Tetrahedron {
  static constexpr std::string_view name = "tet10";
  static constexpr int nodes = 10, edges[6][3] = {{0, 1, 4}, {1, 2, 5}, {2, 0, 6}, {0, 3, 7}, {1, 3, 8}, {2, 3, 9}},
                       faces[4][6] = {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}},
                       reversed[10] = {0, 2, 1, 3, 6, 5, 4, 7, 9, 8};
  static constexpr double mass_shares[10] = {1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36, 4.0 / 27,
                                             4.0 / 27, 4.0 / 27, 4.0 / 27, 4.0 / 27, 4.0 / 27};

  static void shape(const double* at, double* N, double (*dN)[3]) {
    double L[4], dL[4][3];
    Tet4::shape(at, L, dL);
    for (int a = 0; a < 4; ++a) {
      N[a] = L[a] * (2 * L[a] - 1);
      for (int j = 0; j < 3; ++j) dN[a][j] = (4 * L[a] - 1) * dL[a][j];
    }
    for (const auto [a, b, m] : edges) {
      N[m] = 4 * L[a] * L[b];
      for (int j = 0; j < 3; ++j) dN[m][j] = 4 * (dL[a][j] * L[b] + L[a] * dL[b][j]);
    }
  }
};

}  // namespace presswork
