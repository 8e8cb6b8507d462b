// SPDX-License-Identifier: Apache-2.0
// Shells of the explicit loop that touch shells.
#pragma once

#include "arrays.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::bindings {

template <class Loop>
void bind_shell_contact(nb::class_<Loop>& loop) {
  loop.def(
          "add_shell_contact",
          [](Loop& self, Doubles undeformed, double friction, double penalty, double damping) {
            require(
                undeformed.ndim() == 2 && undeformed.shape(0) == std::size_t(self.nodes.n) && undeformed.shape(1) == 3,
                "undeformed must have shape (n_nodes, 3)");
            self.add_shell_contact(undeformed.data(), {friction, penalty, damping});
          },
          nb::arg("undeformed"), nb::kw_only(), nb::arg("friction"), nb::arg("penalty"), nb::arg("damping"),
          "Let shells touch shells; undeformed (n_nodes, 3): by which those near along the sheet are left out [mm].")
      .def(
          "shell_contact_force",
          [](const Loop& self) {
            double* force;
            auto array = new_array({std::size_t(self.nodes.n), 3}, &force);
            if (self.shell_contact) self.shell_contact->add_forces(force);
            return array;
          },
          "Forces of shells that touch shells on the nodes (n_nodes, 3) [N].")
      .def(
          "deepest_in_shell",
          [](Loop& self) {
            require(bool(self.shell_contact), "shells do not touch each other");
            int node = -1, cell = -1;
            const double depth = self.shell_contact->deepest(self.view(0.0), node, cell);
            return std::make_tuple(depth, node, cell);
          },
          "Overlap of the node that is deepest in a shell [mm], it, and the shell; 0, -1, -1 where none is.");
}

}  // namespace presswork::bindings
