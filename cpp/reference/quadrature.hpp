// SPDX-License-Identifier: Apache-2.0
// Quadrature points, Gauss's rules on [-1, 1], and tables of a cell's shape functions at the points of a rule.
//
// A reference cell is a struct with
//     name, plural                  as meshes call it, and as messages call cells of its shape
//     dim, nodes                    how many directions and nodes it has
//     corners                       how many of the nodes are corners: the first ones
//     places                        natural coordinates of the nodes [nodes][dim]
//     edges                         first end, last end[, middle] of each
//     faces                         nodes of each, counter-clockwise seen from outside (in space)
//     simplices                     of corners, which fill the cell
//     pieces                        triangles between all nodes (in the plane)
//     spans                         two pairs of corners; their differences' cross product is twice the area (in the
//     plane) reversed                      the nodes of the cell turned inside out mass_shares                   of the
//     nodes in the cell's mass, in proportion to int N^2 dV (Hinton, Rock &
//                                   Zienkiewicz 1976); a cell without takes int N dV
//     shape(at, N, dN)              shape functions N[nodes] and their derivatives dN[nodes][dim] at at[dim]
//     rule<n>(), rules              the quadrature rule of n points, and the list of such n
// cells.hpp lists them; Python's table of cells is made from that list (bindings/cells.cpp).
#pragma once

#include <array>
#include <string_view>
#include <utility>

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
