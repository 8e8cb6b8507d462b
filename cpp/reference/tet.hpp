// SPDX-License-Identifier: Apache-2.0
// Tetrahedra with vertices (0,0,0) (1,0,0) (0,1,0) (0,0,1). Node order: the first three corners counter-clockwise seen
// from the fourth; so do Abaqus, gmsh and VTK. Rules: the centroid, and the four points of degree 2 (Keast 1986);
// weights sum to 1/6.
#pragma once

#include "reference/quadrature.hpp"

namespace presswork {

struct Tet4 {
  static constexpr std::string_view name = "tet4";
  static constexpr int dim = 3, nodes = 4;

  static void shape(const double* at, double* N, double (*dN)[3]) {
    N[0] = 1 - at[0] - at[1] - at[2];
    for (int i = 0; i < 3; ++i) {
      N[i + 1] = at[i];
      dN[0][i] = -1;
      for (int j = 0; j < 3; ++j) dN[i + 1][j] = i == j ? 1 : 0;
    }
  }

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

}  // namespace presswork
