// SPDX-License-Identifier: Apache-2.0
// Triangles with vertices (0,0) (1,0) (0,1). Node order: corners counter-clockwise, then mid-sides (i between corners i
// and i + 1). Rules: Dunavant (1985), weights sum to 1/2.
#pragma once

#include <cmath>

#include "reference/quadrature.hpp"

namespace presswork {

struct Triangle {
  static constexpr std::string_view plural = "triangles";
  static constexpr int dim = 2, corners = 3;
  static constexpr double places[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  static constexpr int simplices[1][3] = {{0, 1, 2}}, spans[2][2] = {{0, 1}, {0, 2}};
  using rules = std::integer_sequence<int, 1, 3, 6, 7>;

  template <int n>
  static std::array<QuadraturePoint<2>, n> rule() {
    static_assert(n == 1 || n == 3 || n == 6 || n == 7);
    std::array<QuadraturePoint<2>, n> points{};
    int k = 0;
    auto orbit = [&](double a, double weight) {  // the three points (a, a), (1-2a, a), (a, 1-2a)
      points[k++] = {{a, a}, weight / 2};
      points[k++] = {{1 - 2 * a, a}, weight / 2};
      points[k++] = {{a, 1 - 2 * a}, weight / 2};
    };
    if constexpr (n == 1) {
      points[0] = {{1.0 / 3, 1.0 / 3}, 0.5};
    } else if constexpr (n == 3) {  // degree 2
      orbit(1.0 / 6, 1.0 / 3);
    } else if constexpr (n == 6) {  // degree 4
      orbit(0.44594849091596488632, 0.22338158967801146570);
      orbit(0.09157621350977074346, 0.10995174365532186764);
    } else {  // degree 5
      points[k++] = {{1.0 / 3, 1.0 / 3}, 0.225 / 2};
      const double r = std::sqrt(15.0);
      orbit((6 + r) / 21, (155 + r) / 1200);
      orbit((6 - r) / 21, (155 - r) / 1200);
    }
    return points;
  }

 protected:
  static void put(double n, double nx, double ny, double& N, double (&dN)[2]) { N = n, dN[0] = nx, dN[1] = ny; }
};

struct Tri3 : Triangle {
  static constexpr std::string_view name = "tri3";
  static constexpr int nodes = 3, edges[3][2] = {{0, 1}, {1, 2}, {2, 0}}, pieces[1][3] = {{0, 1, 2}},
                       reversed[3] = {0, 2, 1};
  static constexpr double mass_shares[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};

  static void shape(const double* at, double* N, double (*dN)[2]) {
    put(1 - at[0] - at[1], -1, -1, N[0], dN[0]);
    put(at[0], 1, 0, N[1], dN[1]);
    put(at[1], 0, 1, N[2], dN[2]);
  }
};

// The corners, and the cubic 27 z x y, which vanishes on the sides.
struct Tri3Bubble : Triangle {
  static constexpr std::string_view name = "tri3";  // of the mesh, which does not know the bubble
  static constexpr int nodes = 4;

  static void shape(const double* at, double* N, double (*dN)[2]) {
    const double x = at[0], y = at[1], z = 1 - x - y;
    Tri3::shape(at, N, dN);
    put(27 * z * x * y, 27 * y * (z - x), 27 * x * (z - y), N[3], dN[3]);
  }
};

struct Tri6 : Triangle {
  static constexpr std::string_view name = "tri6";
  static constexpr int nodes = 6, edges[3][3] = {{0, 1, 3}, {1, 2, 4}, {2, 0, 5}},
                       pieces[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}, reversed[6] = {0, 2, 1, 5, 4, 3};
  static constexpr double mass_shares[6] = {3.0 / 57, 3.0 / 57, 3.0 / 57, 16.0 / 57, 16.0 / 57, 16.0 / 57};

  static void shape(const double* at, double* N, double (*dN)[2]) {
    const double x = at[0], y = at[1], z = 1 - x - y;
    put(z * (2 * z - 1), 1 - 4 * z, 1 - 4 * z, N[0], dN[0]);
    put(x * (2 * x - 1), 4 * x - 1, 0, N[1], dN[1]);
    put(y * (2 * y - 1), 0, 4 * y - 1, N[2], dN[2]);
    put(4 * z * x, 4 * (z - x), -4 * x, N[3], dN[3]);
    put(4 * x * y, 4 * y, 4 * x, N[4], dN[4]);
    put(4 * y * z, -4 * y, 4 * (z - y), N[5], dN[5]);
  }
};

}  // namespace presswork
