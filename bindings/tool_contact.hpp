// SPDX-License-Identifier: Apache-2.0
// Rigid tools of the explicit loop.
#pragma once

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>

#include <algorithm>
#include <array>

#include "arrays.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::bindings {

namespace tool_contact {

using explicit_dynamics::Grip;
using explicit_dynamics::Tool;
using explicit_dynamics::ToolContact;
using Vector = std::array<double, 3>;

template <class Loop>
ToolContact& contact_of(Loop& self) {
  require(bool(self.contact), "there are no tools");
  return *self.contact;
}
template <class Loop>
Tool& tool_of(Loop& self, int i) {
  auto& tools = contact_of(self).tools;
  require(i >= 0 && std::size_t(i) < tools.size(), "there is no tool of this number");
  return tools[i];
}

template <class Loop>
int add_tool(Loop& self, std::shared_ptr<const contact::ToolSurface> surface, double friction, double penalty,
             double damping, bool edges, bool thickness) {
  if (!self.contact) self.contact = self.make_contact();
  self.contact->add(std::move(surface), Grip{friction, penalty, damping, edges, thickness});
  return static_cast<int>(self.contact->tools.size()) - 1;
}

template <class Loop>
void push_tool(Loop& self, int i, Vector direction, double mass, double drag) {
  Tool& tool = tool_of(self, i);
  tool.pushed = true, tool.was_pushed = 1, tool.mass = mass, tool.drag = drag;
  for (int k = 0; k < 3; ++k) tool.direction[k] = direction[k];
}

template <class Loop>
void stop_tool(Loop& self, int i, int other, double furthest) {
  require(i != other && !tool_of(self, other).pushed, "a tool stands on another that is not pushed");
  Tool& tool = tool_of(self, i);
  tool.stop = other, tool.furthest = furthest;
}

template <class Loop>
void move_tool(Loop& self, int i) {
  Tool& tool = tool_of(self, i);
  tool.pushed = false, tool.stop = -1;
}

template <class Loop>
void drive_tool(Loop& self, int i, Doubles drive) {
  Tool& tool = tool_of(self, i);
  require(tool.pushed ? drive.ndim() == 1 : drive.ndim() == 2 && drive.shape(1) == 3,
          "drive must have shape (n, 3), or (n) of a pushed tool");
  tool.drive.assign(drive.data(), drive.data() + drive.size());
}

template <class Loop>
auto tool_state(Loop& self, int i) {
  const Tool& tool = tool_of(self, i);
  auto copy = [](const double v[3]) { return Vector{v[0], v[1], v[2]}; };
  return std::make_tuple(copy(tool.displacement), copy(tool.velocity), copy(tool.force));
}

template <class Loop>
NewDoubles contact_force(Loop& self) {
  double* force;
  auto array = new_array({std::size_t(self.nodes.n), 3}, &force);
  if (self.contact) self.contact->add_forces(force);
  return array;
}

template <class Loop>
NewDoubles force_of_tool(Loop& self, int i) {
  tool_of(self, i);
  double* force;
  auto array = new_array({std::size_t(self.nodes.n), 3}, &force);
  self.contact->add_forces_of(i, force);
  return array;
}

template <class Loop>
auto deepest(Loop& self, int i) {
  tool_of(self, i);
  int point = -1;
  const double depth = self.contact->deepest(i, self.view_of_tools(0.0), point);
  return std::make_tuple(depth, point);
}

}  // namespace tool_contact

template <class Loop>
void bind_tools(nb::class_<Loop>& loop) {
  using namespace tool_contact;
  loop.def("add_tool", &add_tool<Loop>, nb::arg("surface"), nb::kw_only(), nb::arg("friction"), nb::arg("penalty"),
           nb::arg("damping"), nb::arg("edges"), nb::arg("thickness"), "Add a rigid tool; returns its number.")
      .def(
          "remove_tool", [](Loop& self, int i) { tool_of(self, i), self.contact->remove(i); }, nb::arg("tool"),
          "Take a tool away; the others keep their numbers.")
      .def(
          "place_tool",
          [](Loop& self, int i, Vector displacement) { tool_of(self, i), self.contact->place(i, displacement.data()); },
          nb::arg("tool"), nb::arg("displacement"), "Put a tool somewhere else.")
      .def("push_tool", &push_tool<Loop>, nb::arg("tool"), nb::arg("direction"), nb::arg("mass"), nb::arg("drag"),
           "Let a force place a tool of this mass [t] along a unit vector; drag [1/s].")
      .def("stop_tool", &stop_tool<Loop>, nb::arg("tool"), nb::arg("other"), nb::arg("furthest"),
           "Let a pushed tool stand on another that moves, once its displacement along its direction is so much [mm] "
           "beyond the other's.")
      .def("move_tool", &move_tool<Loop>, nb::arg("tool"), "Let velocities move a tool again that a force has placed.")
      .def("drive_tool", &drive_tool<Loop>, nb::arg("tool"), nb::arg("drive"),
           "Velocities (n, 3), or forces (n) of a pushed tool, of the next n cycles.")
      .def("tool_state", &tool_state<Loop>, nb::arg("tool"),
           "Displacement [mm], velocity half a step back [mm/s], force of the sheet on the tool [N].")
      .def(
          "set_contact_stiffness", [](Loop& self, double dt) { self.set_contact_stiffness(dt); }, nb::arg("dt"),
          "Take the stiffness of contact from the masses and a step [s].")
      .def(
          "start_contact",
          [](Loop& self) {
            contact_of(self).start(self.view_of_tools(0.0), self.nodes.internal_force.data());
            self.hanging.give_all_forces(self.nodes);
          },
          "Find the forces of tools that are new.")
      .def("force_of_tool", &force_of_tool<Loop>, nb::arg("tool"), nb::rv_policy::move,
           "Forces of one tool on the nodes (n_nodes, 3) [N].")
      .def("deepest", &deepest<Loop>, nb::arg("tool"),
           "Depth of the deepest point in a tool [mm], and which it is: a node, or the number of nodes + an edge.")
      .def(
          "edge_nodes",
          [](Loop& self, int edge) {
            const ToolContact& contact = contact_of(self);
            return std::make_tuple(contact.edge_node(edge, 0), contact.edge_node(edge, 1));
          },
          nb::arg("edge"), "Nodes of an edge.")
      .def_prop_ro(
          "lost_point", [](const Loop& self) { return self.contact ? self.contact->lost() : -1; },
          "A point that has gone through a tool; -1: none.")
      .def_prop_ro("contact_force", &contact_force<Loop>, nb::rv_policy::move,
                   "Forces of the tools on the nodes (n_nodes, 3) [N].");
}

}  // namespace presswork::bindings
