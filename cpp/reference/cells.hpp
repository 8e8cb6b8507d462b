// SPDX-License-Identifier: Apache-2.0
// Shape functions, their derivatives and quadrature on the reference cells.
//
// Triangle: vertices (0,0) (1,0) (0,1); quadrilateral: [-1,1]^2. Node order: corners counter-clockwise, then mid-sides
// (i between corner i and i+1), then the centre. Triangle rules: Dunavant (1985), weights sum to 1/2.
#pragma once

#include <array>
#include <cmath>

namespace presswork {

// tri3_bubble: the corners and the cubic 27 z x y, which vanishes on the sides
enum class Cell : int { tri3, tri3_bubble, tri6, quad4, quad8, quad9 };

constexpr bool is_triangle(Cell cell) { return cell == Cell::tri3 || cell == Cell::tri3_bubble || cell == Cell::tri6; }

constexpr int node_count(Cell cell) {
  switch (cell) {
    case Cell::tri3:
      return 3;
    case Cell::tri3_bubble:
      return 4;
    case Cell::tri6:
      return 6;
    case Cell::quad4:
      return 4;
    case Cell::quad8:
      return 8;
    case Cell::quad9:
      return 9;
  }
  return 0;
}

// N[n] and dN[n][2] at (x, y).
template <Cell cell>
void shape_functions(double x, double y, double* N, double (*dN)[2]) {
  auto put = [&](int i, double n, double nx, double ny) {
    N[i] = n;
    dN[i][0] = nx;
    dN[i][1] = ny;
  };
  if constexpr (cell == Cell::tri3 || cell == Cell::tri3_bubble) {
    const double z = 1 - x - y;
    put(0, z, -1, -1);
    put(1, x, 1, 0);
    put(2, y, 0, 1);
    if constexpr (cell == Cell::tri3_bubble) put(3, 27 * z * x * y, 27 * y * (z - x), 27 * x * (z - y));
  } else if constexpr (cell == Cell::tri6) {
    const double z = 1 - x - y;
    put(0, z * (2 * z - 1), 1 - 4 * z, 1 - 4 * z);
    put(1, x * (2 * x - 1), 4 * x - 1, 0);
    put(2, y * (2 * y - 1), 0, 4 * y - 1);
    put(3, 4 * z * x, 4 * (z - x), -4 * x);
    put(4, 4 * x * y, 4 * y, 4 * x);
    put(5, 4 * y * z, -4 * y, 4 * (z - y));
  } else {
    constexpr double cx[4] = {-1, 1, 1, -1}, cy[4] = {-1, -1, 1, 1};
    if constexpr (cell == Cell::quad4) {
      for (int i = 0; i < 4; ++i)
        put(i, 0.25 * (1 + cx[i] * x) * (1 + cy[i] * y), 0.25 * cx[i] * (1 + cy[i] * y),
            0.25 * cy[i] * (1 + cx[i] * x));
    } else if constexpr (cell == Cell::quad8) {
      for (int i = 0; i < 4; ++i) {
        const double u = cx[i] * x, v = cy[i] * y;
        put(i, 0.25 * (1 + u) * (1 + v) * (u + v - 1), 0.25 * cx[i] * (1 + v) * (2 * u + v),
            0.25 * cy[i] * (1 + u) * (2 * v + u));
      }
      put(4, 0.5 * (1 - x * x) * (1 - y), -x * (1 - y), -0.5 * (1 - x * x));
      put(5, 0.5 * (1 + x) * (1 - y * y), 0.5 * (1 - y * y), -y * (1 + x));
      put(6, 0.5 * (1 - x * x) * (1 + y), -x * (1 + y), 0.5 * (1 - x * x));
      put(7, 0.5 * (1 - x) * (1 - y * y), -0.5 * (1 - y * y), -y * (1 - x));
    } else {
      auto line = [](int k, double s, double& value, double& slope) {  // -1, +1, 0
        if (k == 0) value = 0.5 * s * (s - 1), slope = s - 0.5;
        if (k == 1) value = 0.5 * s * (s + 1), slope = s + 0.5;
        if (k == 2) value = 1 - s * s, slope = -2 * s;
      };
      constexpr int ix[9] = {0, 1, 1, 0, 2, 1, 2, 0, 2}, iy[9] = {0, 0, 1, 1, 0, 2, 1, 2, 2};
      for (int i = 0; i < 9; ++i) {
        double a = 0, da = 0, b = 0, db = 0;
        line(ix[i], x, a, da);
        line(iy[i], y, b, db);
        put(i, a * b, da * b, a * db);
      }
    }
  }
}

struct QuadraturePoint {
  double x, y, weight;
};

template <int n>
std::array<QuadraturePoint, n * n> gauss_square() {
  static_assert(n >= 1 && n <= 3);
  constexpr double points[3][3] = {{0, 0, 0},
                                   {-0.57735026918962576451, 0.57735026918962576451, 0},
                                   {-0.77459666924148337704, 0, 0.77459666924148337704}};
  constexpr double weights[3][3] = {{2, 0, 0}, {1, 1, 0}, {5.0 / 9, 8.0 / 9, 5.0 / 9}};
  std::array<QuadraturePoint, n * n> rule{};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      rule[j * n + i] = {points[n - 1][i], points[n - 1][j], weights[n - 1][i] * weights[n - 1][j]};
  return rule;
}

template <int n>
std::array<QuadraturePoint, n> triangle_rule() {
  static_assert(n == 1 || n == 3 || n == 6 || n == 7);
  std::array<QuadraturePoint, n> rule{};
  int k = 0;
  auto orbit = [&](double a, double weight) {  // the three points (a, a), (1-2a, a), (a, 1-2a)
    rule[k++] = {a, a, weight / 2};
    rule[k++] = {1 - 2 * a, a, weight / 2};
    rule[k++] = {a, 1 - 2 * a, weight / 2};
  };
  if constexpr (n == 1) {
    rule[0] = {1.0 / 3, 1.0 / 3, 0.5};
  } else if constexpr (n == 3) {  // degree 2
    orbit(1.0 / 6, 1.0 / 3);
  } else if constexpr (n == 6) {  // degree 4
    orbit(0.44594849091596488632, 0.22338158967801146570);
    orbit(0.09157621350977074346, 0.10995174365532186764);
  } else {  // degree 5
    rule[k++] = {1.0 / 3, 1.0 / 3, 0.225 / 2};
    const double r = std::sqrt(15.0);
    orbit((6 + r) / 21, (155 + r) / 1200);
    orbit((6 - r) / 21, (155 - r) / 1200);
  }
  return rule;
}

// Shape functions tabulated at the points of a rule.
template <Cell cell, int n_points>
struct ShapeTable {
  static constexpr int nodes = node_count(cell);
  double N[n_points][nodes];
  double dN[n_points][nodes][2];
  double weight[n_points];

  ShapeTable() {
    if constexpr (is_triangle(cell))
      fill(triangle_rule<n_points>());
    else
      fill(gauss_square<n_points == 1 ? 1 : n_points == 4 ? 2 : 3>());
  }

 private:
  template <class Rule>
  void fill(const Rule& rule) {
    for (int q = 0; q < n_points; ++q) {
      shape_functions<cell>(rule[q].x, rule[q].y, N[q], dN[q]);
      weight[q] = rule[q].weight;
    }
  }
};

}  // namespace presswork
