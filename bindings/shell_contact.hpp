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
          "share_shell_contact",
          [](Loop& self, const Loop& whole, Doubles undeformed, Ints place, Ints cell, double friction, double penalty,
             double damping) {
            const auto n = std::size_t(whole.nodes.n);
            require(undeformed.size() == 3 * n && place.size() == n,
                    "undeformed must have shape (n_nodes, 3) and place (n_nodes) of the whole sheet");
            require(cell.size() == std::size_t(self.n_elements()), "cell must have a number for each element here");
            require(self.parts(), "join the others first");
            self.share_shell_contact(whole, undeformed.data(), {friction, penalty, damping},
                                     {place.data(), place.data() + n}, {cell.data(), cell.data() + cell.size()});
          },
          nb::arg("whole"), nb::arg("undeformed"), nb::arg("place"), nb::arg("cell"), nb::kw_only(),
          nb::arg("friction"), nb::arg("penalty"), nb::arg("damping"), nb::keep_alive<1, 2>(),
          "Let the shells of this part touch those of a whole sheet. place (n_nodes there): numbers in the part, or "
          "-1; "
          "cell: numbers there of the part's elements.")
      .def(
          "shell_contact_force",
          [](const Loop& self) {
            require(!self.shares_shell_contact(), "the whole sheet knows the forces, no part of it");
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
            const double depth = self.find_deepest_in_shell(node, cell);
            return std::make_tuple(depth, node, cell);
          },
          "Overlap of the node that is deepest in a shell [mm], it, and the shell; 0, -1, -1 where none is.");
}

}  // namespace presswork::bindings
