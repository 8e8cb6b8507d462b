// SPDX-License-Identifier: Apache-2.0
// The state of the explicit loop of shells: what is read, set, dumped and tried of nodes and elements.
#pragma once

#include <algorithm>

#include "arrays.hpp"
#include "explicit/loop.hpp"

namespace presswork::bindings {

namespace shell_state {

using explicit_dynamics::ElementBlock;
using explicit_dynamics::ShellLoop;

// Columns [first, first + width) of records of `stride` numbers as an array (n, width), and back.
template <class Real>
NewDoubles get_columns(const Real* from, int n, int stride, int first, int width) {
  double* to;
  auto array = new_array({std::size_t(n), std::size_t(width)}, &to);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < width; ++j) *to++ = from[std::size_t(i) * stride + first + j];
  return array;
}
template <class Real>
void set_columns(Real* to, int n, int stride, int width, Doubles from, const char* message) {
  require(from.ndim() == 2 && from.shape(0) == std::size_t(n) && from.shape(1) == std::size_t(width), message);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < width; ++j)
      to[std::size_t(i) * stride + j] = static_cast<Real>(from.data()[std::size_t(i) * width + j]);
}

template <class Real>
const ElementBlock<Real>& block_of(const ShellLoop<Real>& self, int block) {
  require(block >= 0 && std::size_t(block) < self.blocks.size(), "there is no block of this number");
  return *self.blocks[block];
}

// Rows of a block's state: all of them (n, rows), in the order of elements.
template <class Real>
NewDoubles state_of(const ShellLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  const int rows = elements.rows().count();
  double* to;
  auto array = new_array({std::size_t(elements.n()), std::size_t(rows)}, &to);
  for (int e = 0; e < elements.n(); ++e)
    for (int r = 0; r < rows; ++r) *to++ = elements.value(e, r);
  return array;
}

template <class Real>
NewDoubles thickness_of(const ShellLoop<Real>& self, int block) {
  const auto& elements = block_of(self, block);
  double* to;
  auto array = new_array({std::size_t(elements.n())}, &to);
  for (int e = 0; e < elements.n(); ++e) *to++ = elements.value(e, elements.rows().thickness);
  return array;
}

// Pressure through the thickness (n, points in the plane).
template <class Real>
NewDoubles pressure_of(const ShellLoop<Real>& self, int block) {
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
NewDoubles stress_of(const ShellLoop<Real>& self, int block) {
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
NewDoubles history_of(const ShellLoop<Real>& self, int block) {
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

template <class Real>
auto dump(const ShellLoop<Real>& self) {
  std::vector<NewDoubles> states;
  for (std::size_t block = 0; block < self.blocks.size(); ++block) states.push_back(state_of(self, block));
  return std::make_tuple(get_columns(self.nodes.position.data(), self.nodes.n, 4, 0, 3),
                         get_columns(self.nodes.motion.data(), self.nodes.n, 8, 0, 6), states,
                         get_columns(self.internal_force.data(), self.nodes.n, 6, 0, 6), self.work[0], self.work[1]);
}

template <class Real>
void restore(ShellLoop<Real>& self, Doubles position, Doubles velocity, std::vector<Doubles> states, Doubles forces,
             double external, double damping) {
  require(states.size() == self.blocks.size(), "states must have one array for each block");
  for (std::size_t block = 0; block < states.size(); ++block) {
    auto& elements = *self.blocks[block];
    const int rows = elements.rows().count();
    require(states[block].ndim() == 2 && states[block].shape(0) == std::size_t(elements.n()) &&
                states[block].shape(1) == std::size_t(rows),
            "state does not belong to these shells: other shells, points through the thickness or law");
    for (int e = 0; e < elements.n(); ++e)
      for (int r = 0; r < rows; ++r) elements.set_value(e, r, states[block].data()[std::size_t(e) * rows + r]);
  }
  set_columns(self.nodes.position.data(), self.nodes.n, 4, 3, position, "position must have shape (n_nodes, 3)");
  set_columns(self.nodes.motion.data(), self.nodes.n, 8, 6, velocity, "velocity must have shape (n_nodes, 6)");
  set_columns(self.internal_force.data(), self.nodes.n, 6, 6, forces, "forces must have shape (n_nodes, 6)");
  self.work[0] = external, self.work[1] = damping;
}

// What the internal force would be after an increment of displacement and rotation; all is put back as it was.
template <class Real>
NewDoubles trial_force(ShellLoop<Real>& self, Doubles increment) {
  const auto n = static_cast<std::size_t>(self.nodes.n);
  require(increment.ndim() == 2 && increment.shape(0) == n && increment.shape(1) == 6,
          "increment must have shape (n_nodes, 6)");
  const auto [position, velocity, states, forces, external, damping] = dump(self);
  self.hanging.measure(self.nodes, 0, self.hanging.n());
  set_columns(self.nodes.motion.data(), self.nodes.n, 8, 6, increment, "");
  for (std::size_t i = 0; i < n; ++i)
    for (int j = 0; j < 3; ++j)
      if (!self.hanging.has(static_cast<int>(i))) self.nodes.position.data()[4 * i + j] += increment.data()[6 * i + j];
  self.hanging.move(self.nodes, 1.0, 0, self.hanging.n());
  self.advance_elements(1.0);
  auto array = get_columns(self.internal_force.data(), self.nodes.n, 6, 0, 6);
  restore(self, Doubles(position), Doubles(velocity), {states.begin(), states.end()}, Doubles(forces), external,
          damping);
  return array;
}

template <class Real>
NewDoubles masses_of(const ShellLoop<Real>& self) {
  double* to;
  auto array = new_array({std::size_t(self.n_elements())}, &to);
  const std::vector<double> masses = self.element_masses();
  std::copy(masses.begin(), masses.end(), to);
  return array;
}

template <class Real>
void set_element_masses(ShellLoop<Real>& self, Doubles mass) {
  require(mass.size() == std::size_t(self.n_elements()), "element_mass must have shape (n)");
  const double* from = mass.data();
  for (auto& block : self.blocks) {
    std::copy_n(from, block->n(), block->mass().begin());
    from += block->n();
  }
  self.set_masses();
}

}  // namespace shell_state

template <class Real>
void bind_state(nb::class_<explicit_dynamics::ShellLoop<Real>>& loop) {
  using namespace shell_state;
  using Loop = ShellLoop<Real>;
  loop.def_prop_rw(
          "position", [](const Loop& self) { return get_columns(self.nodes.position.data(), self.nodes.n, 4, 0, 3); },
          [](Loop& self, Doubles x) {
            set_columns(self.nodes.position.data(), self.nodes.n, 4, 3, x, "position must have shape (n_nodes, 3)");
          },
          nb::rv_policy::move, "Positions (n_nodes, 3) [mm].")
      .def_prop_rw(
          "velocity", [](const Loop& self) { return get_columns(self.nodes.motion.data(), self.nodes.n, 8, 0, 6); },
          [](Loop& self, Doubles v) {
            set_columns(self.nodes.motion.data(), self.nodes.n, 8, 6, v, "velocity must have shape (n_nodes, 6)");
          },
          nb::rv_policy::move, "Velocities and angular velocities (n_nodes, 6), half a step back [mm/s, 1/s].")
      .def_prop_ro(
          "inverse_mass", [](const Loop& self) { return get_columns(self.nodes.motion.data(), self.nodes.n, 8, 6, 2); },
          nb::rv_policy::move, "Inverse of mass [t] and of rotary inertia [t mm2] (n_nodes, 2); 0 where there is none.")
      .def_prop_ro(
          "internal_force",
          [](const Loop& self) { return get_columns(self.internal_force.data(), self.nodes.n, 6, 0, 6); },
          nb::rv_policy::move, "Internal force [N] and moment [N mm] (n_nodes, 6).")
      .def_prop_rw("element_mass", &masses_of<Real>, &set_element_masses<Real>, nb::rv_policy::move,
                   "Mass of each element (n) [t]; setting it sets the nodes' masses.")
      .def("stress", &stress_of<Real>, nb::arg("block"),
           "Stress xx, yy, xy (n, points in the plane, layers, 3) of a block in the law's frame [MPa]; of squeezed "
           "shells "
           "with the pressure added to xx and yy.")
      .def("history", &history_of<Real>, nb::arg("block"),
           "What the law of a block keeps (n, points in the plane, layers, size); first eqps.")
      .def("pressure", &pressure_of<Real>, nb::arg("block"),
           "Pressure through the thickness (n, points in the plane) of a block that tools squeeze [MPa].")
      .def("thickness", &thickness_of<Real>, nb::arg("block"), "Thickness (n) [mm] of a block.")
      .def("trial_force", &trial_force<Real>, nb::arg("increment"),
           "Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.")
      .def("dump", &dump<Real>,
           "Position, velocity, state of each block's elements (n, rows), internal force, external work, damping.")
      .def("restore", &restore<Real>, nb::arg("position"), nb::arg("velocity"), nb::arg("states"), nb::arg("forces"),
           nb::arg("external"), nb::arg("damping"), "Take over what dump gave.");
}

}  // namespace presswork::bindings
