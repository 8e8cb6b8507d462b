// SPDX-License-Identifier: Apache-2.0
// What is read of the shells of an explicit loop, begun with and tried.
#pragma once

#include <algorithm>

#include "arrays.hpp"
#include "explicit/space/loop.hpp"
#include "explicit_loop.hpp"

namespace presswork::bindings {

namespace sheet_layers {

using explicit_dynamics::SheetBlock;
using explicit_dynamics::SpaceLoop;

template <class Real>
const SheetBlock<Real>& block_of(const SpaceLoop<Real>& self, int block) {
  require(block >= 0 && std::size_t(block) < self.blocks.size() && self.is_sheet(block),
          "there is no block of shells of this number");
  return self.sheet(block);
}

template <class Real>
NewDoubles thickness_of(const SpaceLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  double* to;
  auto array = new_array({std::size_t(elements.n())}, &to);
  for (int e = 0; e < elements.n(); ++e) *to++ = elements.value(e, elements.rows().thickness);
  return array;
}

// Pressure through the thickness (n, points in the plane).
template <class Real>
NewDoubles pressure_of(const SpaceLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  const auto& rows = elements.rows();
  double* to;
  auto array = new_array({std::size_t(elements.n()), std::size_t(rows.in_plane)}, &to);
  for (int e = 0; e < elements.n(); ++e)
    for (int q = 0; q < rows.in_plane; ++q) *to++ = elements.value(e, rows.pressure + q * rows.pressure_step);
  return array;
}

// Stress (n, points in the plane, points across, 3) as xx, yy, xy, what flows: with the pressure added to xx and yy.
template <class Real>
NewDoubles stress_of(const SpaceLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  const auto& rows = elements.rows();
  double* to;
  auto array = new_array({std::size_t(elements.n()), std::size_t(rows.in_plane), std::size_t(rows.across), 3}, &to);
  for (int e = 0; e < elements.n(); ++e)
    for (int k = 0; k < rows.in_plane * rows.across; ++k, to += 3) {
      const int row = rows.layers + k * rows.law;
      const double sum = elements.value(e, row), difference = elements.value(e, row + 1);
      to[0] = 0.5 * (sum + difference), to[1] = 0.5 * (sum - difference), to[2] = elements.value(e, row + 2);
    }
  return array;
}

template <class Real>
NewDoubles history_of(const SpaceLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  const auto& rows = elements.rows();
  const int size = rows.law - 3;
  double* to;
  auto array = new_array(
      {std::size_t(elements.n()), std::size_t(rows.in_plane), std::size_t(rows.across), std::size_t(size)}, &to);
  for (int e = 0; e < elements.n(); ++e)
    for (int k = 0; k < rows.in_plane * rows.across; ++k)
      for (int r = 0; r < size; ++r) *to++ = elements.value(e, rows.layers + k * rows.law + 3 + r);
  return array;
}

// Set the layers (n, points in the plane, points across, rows of the law) of a block: sum and difference of the normal
// stresses, shear, then what the law keeps.
template <class Real>
void set_layers(SpaceLoop<Real>& self, int block, Doubles layers) {
  const auto& rows = block_of(self, block).rows();
  auto& elements = self.sheet(block);
  const int size = rows.end_of_layers() - rows.layers;
  require(layers.size() == std::size_t(elements.n()) * size, "layers must have one row of the law for each point");
  for (int e = 0; e < elements.n(); ++e) {
    for (int r = 0; r < size; ++r) elements.set_value(e, rows.layers + r, layers.data()[std::size_t(e) * size + r]);
    elements.clear_rounding(e);
  }
}

// What the internal force would be after an increment of displacement and rotation; all is put back as it was.
template <class Real>
NewDoubles trial_force(SpaceLoop<Real>& self, Doubles increment) {
  const auto n = static_cast<std::size_t>(self.nodes.n);
  require(increment.ndim() == 2 && increment.shape(0) == n && increment.shape(1) == 6,
          "increment must have shape (n_nodes, 6)");
  std::vector<explicit_dynamics::StateField> fields = self.body_state();
  std::vector<std::vector<double>> before;
  for (const auto& field : fields) field.read(before.emplace_back(field.size()).data());
  self.hanging.begin(self.nodes, 1);
  velocity_of(self.nodes).set(increment, "increment");
  const auto& follows = self.nodes.follows;
  for (std::size_t i = 0; i < n; ++i)
    for (int j = 0; j < 3; ++j)
      if (follows.empty() || !follows[i]) self.nodes.position.data()[4 * i + j] += increment.data()[6 * i + j];
  for (int piece = 0; piece < self.hanging.n_following(); ++piece)
    self.hanging.follow(self.nodes, {1.0, 1.0, 0.0, 0.0, 0.0}, piece);
  self.advance_elements(1.0);
  self.hanging.give_all_forces(self.nodes);
  auto array = internal_force_of(self.nodes).get();
  for (std::size_t f = 0; f < fields.size(); ++f) fields[f].write(before[f].data());
  return array;
}

}  // namespace sheet_layers

template <class Real>
void bind_layers(nb::class_<explicit_dynamics::SpaceLoop<Real>>& loop) {
  using namespace sheet_layers;
  loop.def("stress", &stress_of<Real>, nb::arg("block"),
           "Stress xx, yy, xy (n, points in the plane, layers, 3) of a block in the law's frame [MPa]; of squeezed "
           "shells with the pressure added to xx and yy.")
      .def("history", &history_of<Real>, nb::arg("block"),
           "What the law of a block keeps (n, points in the plane, layers, size); first eqps.")
      .def("set_layers", &set_layers<Real>, nb::arg("block"), nb::arg("layers"),
           "Set the layers (n, points in the plane, layers, 3 + size) of a block: sum and difference of the normal "
           "stresses, shear, what the law keeps.")
      .def("pressure", &pressure_of<Real>, nb::arg("block"),
           "Pressure through the thickness (n, points in the plane) of a block that tools squeeze [MPa].")
      .def("thickness", &thickness_of<Real>, nb::arg("block"), "Thickness (n) [mm] of a block.")
      .def("trial_force", &trial_force<Real>, nb::arg("increment"),
           "Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.");
}

}  // namespace presswork::bindings
