// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "contact/node_on_tool.hpp"
#include "contact/sheet_on_itself.hpp"

namespace presswork::bindings {

namespace {

using contact::NodeOnTool;

NodeOnTool take_node(std::size_t i, const Doubles& push, const Doubles& slope, const Doubles& normal,
                     const Doubles& rise, const Doubles& bend) {
  return {push.data()[i], slope.data()[i], normal.data() + 3 * i, rise.data() + 3 * i, bend.data() + 9 * i};
}

auto push_nodes(Doubles push, Doubles slope, Doubles normal, Doubles rise, Doubles bend) {
  const std::size_t n = push.size();
  require(slope.size() == n && normal.size() == 3 * n && rise.size() == 3 * n && bend.size() == 9 * n,
          "of each node one push and slope, three of normal and rise, nine of bend");
  double *force, *tangent;
  auto forces = new_array({n, 3}, &force);
  auto tangents = new_array({n, 3, 3}, &tangent);
  for (std::size_t i = 0; i < n; ++i)
    contact::push_node(take_node(i, push, slope, normal, rise, bend), force + 3 * i, tangent + 9 * i);
  return std::make_tuple(forces, tangents);
}

NewDoubles rub_nodes(Doubles push, Doubles slope, Doubles normal, Doubles rise, Doubles bend, Doubles hanging,
                     Doubles pulled, Doubles limit, Doubles by_push, MutableDoubles tangent) {
  const std::size_t n = push.size();
  require(slope.size() == n && normal.size() == 3 * n && rise.size() == 3 * n && bend.size() == 9 * n,
          "of each node one push and slope, three of normal and rise, nine of bend");
  require(hanging.size() == n && pulled.size() == 3 * n && limit.size() == n && by_push.size() == n &&
              tangent.size() == 9 * n,
          "of each node one hanging, limit and by_push, three of pulled, nine of tangent");
  double* friction;
  auto frictions = new_array({n, 3}, &friction);
  for (std::size_t i = 0; i < n; ++i)
    contact::rub_node(take_node(i, push, slope, normal, rise, bend), hanging.data()[i], pulled.data() + 3 * i,
                      limit.data()[i], by_push.data()[i], friction + 3 * i, tangent.data() + 9 * i);
  return frictions;
}

using contact::SheetOnItself;
using contact::SheetPlace;

void make_sheet(SheetOnItself* self, const std::vector<Ints>& blocks, Doubles undeformed, double thickness) {
  require(undeformed.ndim() == 2 && undeformed.shape(1) == 3, "undeformed must have shape (n_points, 3)");
  std::vector<int> start{0}, corner;
  for (const Ints& cells : blocks) {
    require(cells.ndim() == 2 && (cells.shape(1) == 3 || cells.shape(1) == 4), "cells must have shape (n, 3 or 4)");
    corner.insert(corner.end(), cells.data(), cells.data() + cells.size());
    for (std::size_t i = 0; i < cells.shape(0); ++i) start.push_back(start.back() + static_cast<int>(cells.shape(1)));
  }
  const int n = static_cast<int>(undeformed.shape(0));
  for (int node : corner) require(node >= 0 && node < n, "a cell names a node that is not there");
  new (self) SheetOnItself(n, std::move(start), std::move(corner), undeformed.data(), thickness);
}

SheetPlace take_place(const SheetOnItself& self, const Doubles& now, const Doubles& before, const Doubles& half_node,
                      const Doubles& half_cell) {
  const auto n = static_cast<std::size_t>(self.n_nodes());
  require(now.size() == 3 * n && before.size() == 3 * n && half_node.size() == n &&
              half_cell.size() == std::size_t(self.n_cells()),
          "places (n_points, 3), now and before, half the thickness of points and cells");
  return {now.data(), before.data(), half_node.data(), half_cell.data()};
}

NewArray<int> search_sheet(SheetOnItself& self, Doubles now, Doubles half_node, Doubles half_cell, double margin) {
  take_place(self, now, now, half_node, half_cell);
  const auto pairs = self.search(now.data(), {half_node.data(), half_node.data() + half_node.size()},
                                 {half_cell.data(), half_cell.data() + half_cell.size()}, margin);
  int* pair;
  auto result = new_array({pairs.size(), 2}, &pair);
  for (const auto& [a, b] : pairs) *pair++ = a, *pair++ = b;
  return result;
}

auto look_at_sheet(const SheetOnItself& self, Doubles now, Doubles before, Doubles half_node, Doubles half_cell,
                   double reach) {
  const SheetPlace place = take_place(self, now, before, half_node, half_cell);
  const std::size_t slots = 2 * static_cast<std::size_t>(self.n_nodes());
  int* cell;
  double *gap, *normal;
  auto cells = new_array({slots}, &cell);
  auto gaps = new_array({slots}, &gap);
  auto normals = new_array({slots, 3}, &normal);
  const int gone = self.look(place, reach, cell, gap, normal);
  return std::make_tuple(cells, gaps, normals, gone);
}

auto touch_sheet(const SheetOnItself& self, Doubles now, Doubles before, Doubles half_node, Doubles half_cell,
                 Ints slots, Ints cells, Doubles push, Doubles slope, Doubles hanging, Doubles shear_n, double mu) {
  const SheetPlace place = take_place(self, now, before, half_node, half_cell);
  const std::size_t n = slots.size();
  require(cells.size() == n && push.size() == n && slope.size() == n && hanging.size() == n && shear_n.size() == 3 * n,
          "of each slot one cell, push, slope and hanging, three of shear_n");
  double *force, *block, *shear, *slip;
  int* pair;
  auto forces = new_array({static_cast<std::size_t>(self.n_nodes()), 3}, &force);
  auto pairs = new_array({25 * n, 2}, &pair);
  auto blocks = new_array({25 * n, 3, 3}, &block);
  auto shears = new_array({n, 3}, &shear);
  auto slips = new_array({n, 3}, &slip);
  for (std::size_t k = 0; k < n; ++k) {
    require(slots.data()[k] >= 0 && slots.data()[k] < 2 * self.n_nodes() && cells.data()[k] >= 0 &&
                cells.data()[k] < self.n_cells(),
            "there is no such slot or cell");
    const double* before_shear = shear_n.data() + 3 * k;
    int nodes[5];
    contact::SlotForce found;
    self.touch(place,
               {slots.data()[k],
                cells.data()[k],
                push.data()[k],
                slope.data()[k],
                hanging.data()[k],
                {before_shear[0], before_shear[1], before_shear[2]}},
               mu, nodes, found);
    for (int a = 0; a < 5; ++a)
      for (int i = 0; i < 3; ++i) force[3 * std::size_t(nodes[a]) + i] += found.force[a][i];
    for (int a = 0; a < 5; ++a)
      for (int b = 0; b < 5; ++b) *pair++ = nodes[a], *pair++ = nodes[b];
    std::copy_n(&found.tangent[0][0][0][0], 225, block + 225 * k);
    std::copy_n(found.shear, 3, shear + 3 * k), std::copy_n(found.slip, 3, slip + 3 * k);
  }
  return std::make_tuple(forces, pairs, blocks, shears, slips);
}

}  // namespace

void bind_node_contact(nb::module_& m) {
  nb::class_<SheetOnItself>(m, "SheetOnItself", "Contact of a sheet with itself; see sheet_on_itself.hpp.")
      .def("__init__", &make_sheet, nb::arg("blocks"), nb::arg("undeformed"), nb::kw_only(), nb::arg("thickness"),
           "blocks: corners of the cells of each, (n, 3) or (n, 4). undeformed (n_points, 3): by which shells near "
           "along the sheet are left out; thickness: the largest [mm].")
      .def("search", &search_sheet, nb::arg("now"), nb::arg("half_node"), nb::arg("half_cell"), nb::arg("margin"),
           "Take the shells within margin of touching each node as those it may touch; returns the pairs of nodes "
           "(n, 2) that this couples.")
      .def("look", &look_at_sheet, nb::arg("now"), nb::arg("before"), nb::arg("half_node"), nb::arg("half_cell"),
           nb::arg("reach"),
           "What the faces of nodes touch with a gap below reach: cells (2 n_points,), -1 of none, gaps, infinite of "
           "none, and normals (2 n_points, 3); and a node that has come through a shell, -1 if none has.")
      .def("touch", &touch_sheet, nb::arg("now"), nb::arg("before"), nb::arg("half_node"), nb::arg("half_cell"),
           nb::arg("slots"), nb::arg("cells"), nb::kw_only(), nb::arg("push"), nb::arg("slope"), nb::arg("hanging"),
           nb::arg("shear_n"), nb::arg("mu"),
           "Forces on the nodes (n_points, 3), pairs (25 n, 2) and blocks (25 n, 3, 3) of d(-force)/dx, friction and "
           "way (n, 3) of each slot.");
  m.def("push_nodes", &push_nodes, nb::arg("push"), nb::arg("slope"), nb::arg("normal"), nb::arg("rise"),
        nb::arg("bend"),
        "Normal forces of a tool on nodes (n, 3) [N] and their tangent (n, 3, 3) [N/mm], as node_on_tool.hpp says. "
        "push (n,) and slope (n,) by the gap; derivatives of gap (n, 3) and normal (n, 3, 3) by the place.");
  m.def("rub_nodes", &rub_nodes, nb::arg("push"), nb::arg("slope"), nb::arg("normal"), nb::arg("rise"), nb::arg("bend"),
        nb::kw_only(), nb::arg("hanging"), nb::arg("pulled"), nb::arg("limit"), nb::arg("by_push"), nb::arg("tangent"),
        "Friction on nodes that a tool pushes (n, 3) [N], as node_on_tool.hpp says; its part is added to the tangent.");
}

}  // namespace presswork::bindings
