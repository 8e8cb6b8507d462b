// SPDX-License-Identifier: Apache-2.0
// Quadrilaterals on [-1, 1]^2. Node order: corners counter-clockwise from (-1, -1), then mid-sides (i between corners i
// and i + 1), then the centre. Rules: Gauss's, the first direction fastest.
#pragma once

#include "reference/quadrature.hpp"

namespace presswork {

struct Quadrilateral {
  static constexpr std::string_view plural = "quadrilaterals";
  static constexpr int dim = 2, corners = 4;
  static constexpr double places[9][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
  static constexpr int simplices[2][3] = {{0, 1, 2}, {0, 2, 3}}, spans[2][2] = {{0, 2}, {1, 3}};
  using rules = std::integer_sequence<int, 1, 4, 9>;

  template <int n>
  static std::array<QuadraturePoint<2>, n> rule() {
    constexpr int side = n == 1 ? 1 : n == 4 ? 2 : 3;
    static_assert(side * side == n);
    using Line = GaussLine<side>;
    std::array<QuadraturePoint<2>, n> points{};
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        points[j * side + i] = {{Line::at[i], Line::at[j]}, Line::weight[i] * Line::weight[j]};
    return points;
  }

 protected:
  static void put(double n, double nx, double ny, double& N, double (&dN)[2]) { N = n, dN[0] = nx, dN[1] = ny; }
};

struct Quad4 : Quadrilateral {
  static constexpr std::string_view name = "quad4";
  static constexpr int nodes = 4, edges[4][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, pieces[2][3] = {{0, 1, 2}, {0, 2, 3}},
                       reversed[4] = {0, 3, 2, 1};
  static constexpr double mass_shares[4] = {0.25, 0.25, 0.25, 0.25};

  static void shape(const double* at, double* N, double (*dN)[2]) {
    const double x = at[0], y = at[1];
    for (int i = 0; i < 4; ++i) {
      const auto [cx, cy] = places[i];
      put(0.25 * (1 + cx * x) * (1 + cy * y), 0.25 * cx * (1 + cy * y), 0.25 * cy * (1 + cx * x), N[i], dN[i]);
    }
  }
};

struct Quad8 : Quadrilateral {
  static constexpr std::string_view name = "quad8";
  static constexpr int nodes = 8, edges[4][3] = {{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}},
                       pieces[6][3] = {{0, 4, 7}, {4, 1, 5}, {5, 2, 6}, {6, 3, 7}, {4, 5, 6}, {4, 6, 7}},
                       reversed[8] = {0, 3, 2, 1, 7, 6, 5, 4};
  static constexpr double mass_shares[8] = {3.0 / 76,  3.0 / 76,  3.0 / 76,  3.0 / 76,
                                            16.0 / 76, 16.0 / 76, 16.0 / 76, 16.0 / 76};

  static void shape(const double* at, double* N, double (*dN)[2]) {
    const double x = at[0], y = at[1];
    for (int i = 0; i < 4; ++i) {
      const auto [cx, cy] = places[i];
      const double u = cx * x, v = cy * y;
      put(0.25 * (1 + u) * (1 + v) * (u + v - 1), 0.25 * cx * (1 + v) * (2 * u + v), 0.25 * cy * (1 + u) * (2 * v + u),
          N[i], dN[i]);
    }
    put(0.5 * (1 - x * x) * (1 - y), -x * (1 - y), -0.5 * (1 - x * x), N[4], dN[4]);
    put(0.5 * (1 + x) * (1 - y * y), 0.5 * (1 - y * y), -y * (1 + x), N[5], dN[5]);
    put(0.5 * (1 - x * x) * (1 + y), -x * (1 + y), 0.5 * (1 - x * x), N[6], dN[6]);
    put(0.5 * (1 - x) * (1 - y * y), -0.5 * (1 - y * y), -y * (1 - x), N[7], dN[7]);
  }
};

struct Quad9 : Quadrilateral {
  static constexpr std::string_view name = "quad9";
  static constexpr int nodes = 9, edges[4][3] = {{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}},
                       pieces[8][3] = {{0, 4, 8}, {4, 1, 8}, {1, 5, 8}, {5, 2, 8},
                                       {2, 6, 8}, {6, 3, 8}, {3, 7, 8}, {7, 0, 8}},
                       reversed[9] = {0, 3, 2, 1, 7, 6, 5, 4, 8};
  static constexpr double mass_shares[9] = {1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36, 4.0 / 36,
                                            4.0 / 36, 4.0 / 36, 4.0 / 36, 16.0 / 36};

  static void shape(const double* at, double* N, double (*dN)[2]) {
    auto line = [](int k, double s, double& value, double& slope) {  // -1, +1, 0
      if (k == 0) value = 0.5 * s * (s - 1), slope = s - 0.5;
      if (k == 1) value = 0.5 * s * (s + 1), slope = s + 0.5;
      if (k == 2) value = 1 - s * s, slope = -2 * s;
    };
    constexpr int ix[9] = {0, 1, 1, 0, 2, 1, 2, 0, 2}, iy[9] = {0, 0, 1, 1, 0, 2, 1, 2, 2};
    for (int i = 0; i < 9; ++i) {
      double a = 0, da = 0, b = 0, db = 0;
      line(ix[i], at[0], a, da);
      line(iy[i], at[1], b, db);
      put(a * b, da * b, a * db, N[i], dN[i]);
    }
  }
};

}  // namespace presswork
