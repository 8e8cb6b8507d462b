// SPDX-License-Identifier: Apache-2.0
// Pressure on a sheet of the explicit loop.
#pragma once

#include "arrays.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::bindings {

namespace sheet_pressure {

using explicit_dynamics::SheetPressures;

template <class Loop>
SheetPressures& pressures_of(Loop& self, int i) {
  require(self.pressures && i >= 0 && i < self.pressures->count(), "there is no pressure of this number");
  return *self.pressures;
}

template <class Loop>
int add_pressure(Loop& self, Ints cells, double side, double stiffness, double room) {
  require(cells.ndim() == 2 && cells.shape(0) > 0 && cells.shape(1) == 4, "cells must have shape (n > 0, 4)");
  std::vector<int> corners(cells.data(), cells.data() + cells.size());
  for (int node : corners) require(node >= 0 && node < self.nodes.n, "cells name a node that is not there");
  require(stiffness == 0.0 || room > 0.0, "a fluid needs room");
  if (!self.pressures) self.pressures = std::make_unique<SheetPressures>(self.nodes.n);
  return self.pressures->add(std::move(corners), side, {stiffness, room});
}

}  // namespace sheet_pressure

template <class Loop>
void bind_pressures(nb::class_<Loop>& loop) {
  using namespace sheet_pressure;
  loop.def(
          "add_pressure", &add_pressure<Loop>, nb::arg("cells"), nb::kw_only(), nb::arg("side"),
          nb::arg("stiffness") = 0.0, nb::arg("room") = 0.0,
          "Let a pressure act on shells (n, 4), a triangle with its last node twice; returns its number. side: 1 along "
          "their normals, -1 against. stiffness [MPa], room [mm3]: of a fluid in a closed space; 0: there is none.")
      .def(
          "drive_pressure",
          [](Loop& self, int i, Doubles course) {
            pressures_of(self, i).drive(i, {course.data(), course.data() + course.size()});
          },
          nb::arg("pressure"), nb::arg("course"),
          "Pressures (n) [MPa] at the end of the next n cycles; of a fluid its volume without pressure [mm3].")
      .def(
          "pressure_state",
          [](Loop& self, int i) {
            const SheetPressures& of = pressures_of(self, i);
            return std::array<double, 2>{of.pressure(i), of.swept(i)};
          },
          nb::arg("pressure"), "Pressure [MPa], and volume that the sheet has swept under it [mm3].");
}

}  // namespace presswork::bindings
