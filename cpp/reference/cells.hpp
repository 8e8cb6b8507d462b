// SPDX-License-Identifier: Apache-2.0
// The table of cells that meshes have: what quadrature.hpp says of reference cells, as rows. Python reads it, and has
// no list of its own.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>
#include <tuple>
#include <vector>

#include "reference/hex.hpp"
#include "reference/line.hpp"
#include "reference/quad.hpp"
#include "reference/quadrature.hpp"
#include "reference/tet.hpp"
#include "reference/tri.hpp"

namespace presswork {

using Cells = std::tuple<Line2, Line3, Tri3, Tri6, Quad4, Quad8, Quad9, Hex8, Tet4, Tet10>;

using Rows = std::vector<std::vector<int>>;

// A quadrature rule of a cell.
struct RuleRow {
  int points;
  std::vector<double> weights;  // (points)
  std::vector<double> shapes;   // shape functions there (points, nodes)
  std::vector<double> slopes;   // their derivatives (points, nodes, dim)
};

struct CellRow {
  std::string_view name, plural;
  int dim, nodes, corners;
  std::vector<double> places;  // (nodes, dim)
  Rows edges, faces, simplices, pieces, spans;
  std::vector<int> reversed;
  std::vector<double> mass_shares;
  std::vector<RuleRow> rules;
};

template <int n, int width>
Rows list_rows(const int (&table)[n][width]) {
  Rows rows;
  for (const auto& row : table) rows.emplace_back(row, row + width);
  return rows;
}

template <class Cell, int n>
RuleRow describe_rule() {
  const ShapeTable<Cell, n> table;
  constexpr int count = n * Cell::nodes;
  const double *N = &table.N[0][0], *dN = &table.dN[0][0][0];
  return {n, {table.weight, table.weight + n}, {N, N + count}, {dN, dN + count * Cell::dim}};
}

template <class Cell, int... n>
std::vector<RuleRow> list_rules(std::integer_sequence<int, n...>) {
  return {describe_rule<Cell, n>()...};
}

template <class Cell>
CellRow describe_cell() {
  const double* places = &Cell::places[0][0];
  CellRow row{Cell::name,  Cell::plural,  Cell::dim,
              Cell::nodes, Cell::corners, {places, places + Cell::nodes * Cell::dim}};
  row.edges = list_rows(Cell::edges);
  row.simplices = list_rows(Cell::simplices);
  row.reversed.assign(std::begin(Cell::reversed), std::end(Cell::reversed));
  if constexpr (requires { Cell::faces; }) row.faces = list_rows(Cell::faces);
  if constexpr (requires { Cell::pieces; }) row.pieces = list_rows(Cell::pieces);
  if constexpr (requires { Cell::spans; }) row.spans = list_rows(Cell::spans);
  if constexpr (requires { Cell::mass_shares; })
    row.mass_shares.assign(std::begin(Cell::mass_shares), std::end(Cell::mass_shares));
  if constexpr (requires { typename Cell::rules; }) row.rules = list_rules<Cell>(typename Cell::rules{});
  return row;
}

inline std::vector<CellRow> list_cells() {
  return []<class... Cell>(std::tuple<Cell...>*) {
    return std::vector<CellRow>{describe_cell<Cell>()...};
  }(static_cast<Cells*>(nullptr));
}

}  // namespace presswork
