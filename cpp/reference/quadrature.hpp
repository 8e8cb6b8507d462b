// SPDX-License-Identifier: Apache-2.0
// Quadrature points, Gauss's rules on [-1, 1], and tables of a cell's shape functions at the points of a rule.
//
// A reference cell is a struct with
//     name                          as meshes call it
//     dim, nodes                    how many directions and nodes it has
//     shape(at, N, dN)              shape functions N[nodes] and their derivatives dN[nodes][dim] at at[dim]
//     rule<n>()                     the quadrature rule of n points
#pragma once

#include <array>
#include <string_view>

namespace presswork {

template <int dim>
struct QuadraturePoint {
  double at[dim];
  double weight;
};

// Points and weights of the rule of n points, n <= 3.
template <int n>
struct GaussLine {
  static_assert(n >= 1 && n <= 3);
  static constexpr double tables[3][2][3] = {
      {{0, 0, 0}, {2, 0, 0}},
      {{-0.57735026918962576451, 0.57735026918962576451, 0}, {1, 1, 0}},
      {{-0.77459666924148337704, 0, 0.77459666924148337704}, {5.0 / 9, 8.0 / 9, 5.0 / 9}}};
  static constexpr const double (&at)[3] = tables[n - 1][0], (&weight)[3] = tables[n - 1][1];
};

// Shape functions at the points of a rule.
template <class Cell, int n_points>
struct ShapeTable {
  static constexpr int nodes = Cell::nodes, dim = Cell::dim;
  double N[n_points][nodes];
  double dN[n_points][nodes][dim];
  double weight[n_points];

  ShapeTable() {
    const auto rule = Cell::template rule<n_points>();
    for (int q = 0; q < n_points; ++q) {
      Cell::shape(rule[q].at, N[q], dN[q]);
      weight[q] = rule[q].weight;
    }
  }
};

}  // namespace presswork
