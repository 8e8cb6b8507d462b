// SPDX-License-Identifier: Apache-2.0
// Drawbeads of the explicit loop.
#pragma once

#include "arrays.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::bindings {

namespace drawbeads {

using explicit_dynamics::Drawbead;
using explicit_dynamics::Drawbeads;

template <class Loop>
Drawbead& bead_of(Loop& self, int i) {
  require(self.beads && i >= 0 && std::size_t(i) < self.beads->beads.size(), "there is no bead of this number");
  return self.beads->beads[i];
}

template <class Loop>
int add_bead(Loop& self, Doubles place, Doubles across, Doubles length, double force, int tool) {
  const std::size_t n = length.size();
  require(place.ndim() == 2 && place.shape(0) == n && place.shape(1) == 2, "place must have shape (n, 2)");
  require(across.ndim() == 2 && across.shape(0) == n && across.shape(1) == 2, "across must have shape (n, 2)");
  require(tool < 0 || (self.contact && std::size_t(tool) < self.contact->tools.size()), "there is no such tool");
  if (!self.beads) self.beads = std::make_unique<Drawbeads>(self.find_cells());
  self.beads->set_masses(self.element_masses());
  self.beads->add(static_cast<int>(n), place.data(), across.data(), length.data(), force, tool);
  return static_cast<int>(self.beads->beads.size()) - 1;
}

template <class Loop>
void share_beads(Loop& self, const Loop& whole, Ints place, Ints cell) {
  require(place.size() == std::size_t(whole.nodes.n), "place must have a number for each node of the whole sheet");
  require(cell.size() == std::size_t(self.n_elements()), "cell must have a number for each element of the part");
  require(self.parts(), "join the others first");
  self.beads = std::make_unique<Drawbeads>(whole.find_cells());
  self.beads->be_part(place.data(), {cell.data(), cell.data() + cell.size()}, self.parts()->is_ghost);
}

}  // namespace drawbeads

template <class Loop>
void bind_beads(nb::class_<Loop>& loop) {
  using namespace drawbeads;
  loop.def("add_bead", &add_bead<Loop>, nb::arg("place"), nb::arg("across"), nb::arg("length"), nb::kw_only(),
           nb::arg("force"), nb::arg("tool") = -1,
           "Add a drawbead of points: places and unit normals in the plan (n, 2), lengths (n) [mm], force per length\n"
           "[N/mm], the tool that it moves with; returns its number.")
      .def(
          "drive_bead",
          [](Loop& self, int i, Doubles share) {
            bead_of(self, i).share.assign(share.data(), share.data() + share.size());
          },
          nb::arg("bead"), nb::arg("share"), "Shares (n) of its force in the next n cycles.")
      .def(
          "bead_restraint", [](Loop& self, int i) { return bead_of(self, i), self.beads->restraint(i); },
          nb::arg("bead"), "Restraining force, summed along the line [N]; of a part its share.")
      .def("share_beads", &share_beads<Loop>, nb::arg("whole"), nb::arg("place"), nb::arg("cell"),
           "Let this part hold what is its own of beads on a whole sheet. place (n_nodes there): numbers in the part, "
           "or -1; cell: numbers there of the part's elements.")
      .def(
          "place_beads",
          [](Loop& self) {
            if (self.beads) self.beads->place(self.nodes.position.data(), self.nodes.position_stride);
          },
          "Look near which shell each point of a bead is, where that is not known yet.");
}

}  // namespace presswork::bindings
