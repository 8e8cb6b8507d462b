// SPDX-License-Identifier: Apache-2.0
#include "reference/cells.hpp"

#include <algorithm>

#include "arrays.hpp"

namespace presswork::bindings {

namespace {

NewDoubles copy_values(const std::vector<double>& values, const std::vector<std::size_t>& shape) {
  double* data;
  auto result = new_array(shape, &data);
  std::copy(values.begin(), values.end(), data);
  return result;
}

}  // namespace

void bind_cells(nb::module_& m) {
  nb::class_<RuleRow>(m, "Rule", "A quadrature rule of a cell.")
      .def_ro("points", &RuleRow::points)
      .def_prop_ro(
          "weights", [](const RuleRow& r) { return copy_values(r.weights, {r.weights.size()}); }, nb::rv_policy::move,
          "Shape (points,).")
      .def_prop_ro(
          "shapes",
          [](const RuleRow& r) {
            const std::size_t n = r.points;
            return copy_values(r.shapes, {n, r.shapes.size() / n});
          },
          nb::rv_policy::move, "Shape functions at the points (points, nodes).")
      .def_prop_ro(
          "slopes",
          [](const RuleRow& r) {
            const std::size_t n = r.points, nodes = r.shapes.size() / n;
            return copy_values(r.slopes, {n, nodes, r.slopes.size() / (n * nodes)});
          },
          nb::rv_policy::move, "Their derivatives (points, nodes, dimension).");
  nb::class_<CellRow>(m, "Cell", "A row of the table of cells; cpp/reference/quadrature.hpp says what its entries are.")
      .def_prop_ro("name", [](const CellRow& c) { return std::string(c.name); })
      .def_prop_ro("plural", [](const CellRow& c) { return std::string(c.plural); })
      .def_ro("dimension", &CellRow::dim)
      .def_ro("corners", &CellRow::corners)
      .def_prop_ro(
          "places",
          [](const CellRow& c) {
            return copy_values(c.places, {static_cast<std::size_t>(c.nodes), static_cast<std::size_t>(c.dim)});
          },
          nb::rv_policy::move)
      .def_ro("edges", &CellRow::edges)
      .def_ro("faces", &CellRow::faces)
      .def_ro("simplices", &CellRow::simplices)
      .def_ro("pieces", &CellRow::pieces)
      .def_ro("spans", &CellRow::spans)
      .def_ro("reversed", &CellRow::reversed)
      .def_ro("mass_shares", &CellRow::mass_shares)
      .def_ro("rules", &CellRow::rules);
  m.def("cells", &list_cells, "The table of cells, a row each.");
}

}  // namespace presswork::bindings
