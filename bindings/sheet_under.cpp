// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_under.hpp"

#include <algorithm>

#include "arrays.hpp"

namespace presswork::bindings {

namespace {

using contact::Beneath;
using contact::SheetUnder;

void make_sheet(SheetUnder* self, std::vector<Ints> blocks) {
  std::vector<int> start{0}, corner;
  for (const Ints& cells : blocks) {
    require(cells.ndim() == 2 && (cells.shape(1) == 3 || cells.shape(1) == 4), "cells must have shape (n, 3 or 4)");
    corner.insert(corner.end(), cells.data(), cells.data() + cells.size());
    for (std::size_t i = 0; i < cells.shape(0); ++i) start.push_back(start.back() + static_cast<int>(cells.shape(1)));
  }
  require(!corner.empty(), "there are no cells");
  require(*std::min_element(corner.begin(), corner.end()) >= 0, "a cell names a node that is not there");
  new (self) SheetUnder(std::move(start), std::move(corner));
}

auto find_beneath(const SheetUnder& self, Doubles places, Doubles points, Ints from) {
  require(places.ndim() == 2 && places.shape(1) == 2, "places must have shape (n, 2)");
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_points, 3)");
  require(points.shape(0) > std::size_t(self.last_node()), "a cell names a node that is not there");
  const std::size_t n = places.shape(0);
  require(from.size() == n, "cells must have shape (n)");
  int *cell, *node;
  double *weight, *normal;
  std::uint8_t* inside;
  auto cells = new_array({n}, &cell);
  auto insides = new_array({n}, &inside);
  auto nodes = new_array({n, 4}, &node);
  auto weights = new_array({n, 4}, &weight);
  auto normals = new_array({n, 3}, &normal);
  for (std::size_t i = 0; i < n; ++i) {
    Beneath found;
    require(from.data()[i] < self.n_cells(), "there is no such cell");
    found.cell = from.data()[i];
    self.find(places.data() + 2 * i, points.data(), 3, found);
    cell[i] = found.cell, inside[i] = found.inside;
    if (!found.inside) continue;
    for (int a = 0; a < 4; ++a) node[4 * i + a] = found.node[std::min(a, found.corners - 1)];
    std::copy_n(found.weight, 4, weight + 4 * i);
    std::copy_n(found.normal, 3, normal + 3 * i);
  }
  return std::make_tuple(cells, insides, nodes, weights, normals);
}

}  // namespace

void bind_sheet_under(nb::module_& m) {
  nb::class_<SheetUnder>(m, "SheetUnder", "Which shell of a sheet lies beneath a place in the plan x, y.")
      .def("__init__", &make_sheet, nb::arg("blocks"), "blocks: corners of the cells of each, (n, 3) or (n, 4).")
      .def("find", &find_beneath, nb::arg("places"), nb::arg("points"), nb::arg("cells"),
           "Find what lies beneath places (n, 2) of a sheet with nodes (n_points, 3); cells (n): found last, or -1.\n"
           "Returns the cells, whether they lie beneath, and where they do: nodes (n, 4), their weights (n, 4; a\n"
           "triangle's fourth is zero) and the sheet's normal (n, 3), of any length.");
}

}  // namespace presswork::bindings
