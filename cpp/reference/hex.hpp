// SPDX-License-Identifier: Apache-2.0
// The hexahedron on [-1, 1]^3. Node order: the corners of the lower face counter-clockwise seen from above, from (-1,
// -1, -1), then those of the upper face; so do Abaqus, gmsh and VTK. Rules: Gauss's, the first direction fastest.
#pragma once

#include "reference/quadrature.hpp"

namespace presswork {

struct Hex8 {
  static constexpr std::string_view name = "hex8", plural = "hexahedra";
  static constexpr int dim = 3, nodes = 8, corners = 8;
  static constexpr double places[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                          {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  static constexpr int edges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                       {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  static constexpr int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                      {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  static constexpr int simplices[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                          {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  static constexpr int reversed[8] = {4, 5, 6, 7, 0, 1, 2, 3};
  using rules = std::integer_sequence<int, 1, 8, 27>;

  static void shape(const double* at, double* N, double (*dN)[3]) {
    for (int a = 0; a < 8; ++a) {
      double along[3];
      for (int i = 0; i < 3; ++i) along[i] = 0.5 * (1 + places[a][i] * at[i]);
      N[a] = along[0] * along[1] * along[2];
      for (int i = 0; i < 3; ++i) dN[a][i] = 0.5 * places[a][i] * along[(i + 1) % 3] * along[(i + 2) % 3];
    }
  }

  template <int n>
  static std::array<QuadraturePoint<3>, n> rule() {
    constexpr int side = n == 1 ? 1 : n == 8 ? 2 : 3;
    static_assert(side * side * side == n);
    using Line = GaussLine<side>;
    std::array<QuadraturePoint<3>, n> points{};
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          points[(k * side + j) * side + i] = {{Line::at[i], Line::at[j], Line::at[k]},
                                               Line::weight[i] * Line::weight[j] * Line::weight[k]};
    return points;
  }
};

}  // namespace presswork
