// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "arrays.hpp"
#include "drawbeads.hpp"
#include "explicit/space/loop.hpp"
#include "explicit/space/shell_section.hpp"
#include "explicit/space/solids.hpp"
#include "neighbours.hpp"
#include "sheet_layers.hpp"
#include "sheet_pressure.hpp"
#include "shell_contact.hpp"
#include "space_walls.hpp"
#include "tabulated_mises.hpp"
#include "tool_contact.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;
using namespace sheet_layers;

// Of a law of our own, or of one from a shared library.
using GivenLaw = std::variant<const Owned<SheetLaw>*, const Umat*>;

ShellSection make_section(GivenLaw given, std::array<double, 2> elastic, double density, std::vector<double> height,
                          std::vector<double> weight, bool tabulated, ShellTreatment treatment, bool viscous,
                          std::array<double, 3> hourglass) {
  require(height.size() == weight.size() && !height.empty() && height.size() <= LayerRule::most_points,
          "height and weight must have the same length, 1 to 51");
  const ShellControl control{hourglass[0], hourglass[1], hourglass[2], viscous, density};
  LayerRule rule;
  rule.points = static_cast<int>(height.size());
  std::copy(height.begin(), height.end(), rule.height), std::copy(weight.begin(), weight.end(), rule.weight);
  if (const auto* umat = std::get_if<const Umat*>(&given)) {
    require(elastic[0] > 0.0, "a law from a shared library needs its young and poisson");
    auto own = std::make_shared<const Umat>(**umat);
    const UserSheet user{{own.get(), elastic[0], elastic[1]}};
    return {user, {std::move(own)}, rule, density, treatment, control};
  }
  const Owned<SheetLaw>& law = *std::get<const Owned<SheetLaw>*>(given);
  ShellSection section{GeneralSheet{law.view}, law.data, rule, density, treatment, control};
  if (tabulated) {
    if (auto fast = find_fast_law(law)) {
      section.law = fast->view, section.law_data = std::move(fast->data);
    } else {
      Owned<SheetLaw> looked_up = law;
      tabulate(looked_up);
      section.law = GeneralSheet{looked_up.view}, section.law_data = std::move(looked_up.data);
    }
  }
  return section;
}

template <class Real>
void make_loop(SpaceLoop<Real>* self, Doubles points) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_nodes, 3)");
  new (self) SpaceLoop<Real>(static_cast<int>(points.shape(0)), points.data());
}

template <class Real>
void add_shells(SpaceLoop<Real>& self, Ints connectivity, Doubles thickness, Doubles axis, GivenLaw law, double density,
                std::vector<double> height, std::vector<double> weight, bool tabulate, ShellTreatment treatment,
                bool viscous, std::array<double, 3> hourglass, std::array<double, 2> elastic, double yield_stress,
                std::vector<int> number, std::vector<double> relief) {
  require((std::is_same_v<Real, double>) || std::holds_alternative<const Owned<SheetLaw>*>(law),
          "a law from a shared library computes in double precision");
  require(number.empty() || number.size() == connectivity.shape(0), "number must have shape (n)");
  require(connectivity.ndim() == 2 && connectivity.shape(0) > 0, "connectivity must have shape (n, 3 or 4), n > 0");
  const std::size_t n = connectivity.shape(0), each = connectivity.shape(1);
  require(each == 3 || each == 4, "connectivity must have shape (n, 3 or 4), n > 0");
  require(thickness.size() == n, "thickness must have shape (n)");
  require(axis.ndim() == 2 && axis.shape(0) == n && axis.shape(1) == 3, "axis must have shape (n, 3)");
  require(relief.empty() || relief.size() == n, "relief must have shape (n)");
  std::vector<int> cells(connectivity.data(), connectivity.data() + each * n);
  for (int node : cells) require(node >= 0 && node < self.nodes.n, "connectivity names a node that is not there");
  auto section = make_section(law, elastic, density, std::move(height), std::move(weight), tabulate, treatment, viscous,
                              hourglass);
  section.yield_stress = yield_stress, section.number = std::move(number);
  auto block =
      each == 4 && treatment == ShellTreatment::mitc
          ? make_mitc_shells<Real>(self.nodes, std::move(section), std::move(cells), thickness.data(), axis.data())
          : make_one_point_shells<Real>(static_cast<int>(each), self.nodes, std::move(section), std::move(cells),
                                        thickness.data(), axis.data());
  block->set_relief(std::move(relief));
  self.add_sheet(std::move(block));
}

// Positions, state, contact; then the forces there, of elements and tools.
template <class Real>
void inherit(SpaceLoop<Real>& self, const SpaceLoop<Real>& from, Doubles position, Ints node_parents, Ints parent,
             Doubles share, double dt) {
  const std::size_t n = self.nodes.n, elements = self.n_elements();
  require(node_parents.size() == 4 * n && parent.size() == elements && share.size() == elements,
          "node_parents must have shape (n_nodes, 4), parent and share (n)");
  const auto holds = [](Ints numbers, int end) {
    return std::all_of(numbers.data(), numbers.data() + numbers.size(), [&](int i) { return i >= 0 && i < end; });
  };
  require(holds(node_parents, from.nodes.n) && holds(parent, from.n_elements()), "a parent is not there");
  require(!self.contact || (from.contact && self.contact->tools.size() == from.contact->tools.size()),
          "the tools must be those of the other loop");
  position_of(self.nodes).set(position, "position");
  self.inherit(from, node_parents.data(), parent.data(), share.data());
  double* none;
  const NewDoubles rest = new_array({n, 6}, &none);
  const NewDoubles force = trial_force(self, Doubles(rest));
  internal_force_of(self.nodes).set(Doubles(force), "force");
  require(bool(self.beads) == bool(from.beads), "the beads must be those of the other loop");
  if (self.beads) self.beads->inherit(*from.beads, dt, self.nodes, self.nodes.internal_force.data());
  require((self.pressures ? self.pressures->count() : 0) == (from.pressures ? from.pressures->count() : 0),
          "the pressures must be those of the other loop");
  if (self.pressures) {
    self.pressures->inherit(*from.pressures, self.nodes);
    for (int piece = 0; piece < self.pressures->n_node_chunks(); ++piece)
      self.pressures->gather(piece, self.nodes.internal_force.data());
  }
  std::vector<double> of_tools(3 * n, 0.0);
  if (self.contact) self.contact->add_forces(of_tools.data());
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) self.nodes.internal_force.data()[6 * i + k] -= static_cast<Real>(of_tools[3 * i + k]);
  self.hanging.give_all_forces(self.nodes);
}

template <class Real>
void set_hanging(SpaceLoop<Real>& self, Ints hanging) {
  require(hanging.ndim() == 2 && hanging.shape(1) == 7, "hanging must have shape (n, 7)");
  std::vector<HangingNode> nodes;
  for (std::size_t i = 0; i < hanging.shape(0); ++i) {
    const auto* row = hanging.data() + 7 * i;
    nodes.push_back({row[0], {row[1], row[2]}, {row[3], row[4], row[5], row[6]}});
  }
  self.set_hanging(std::move(nodes));
}

using GivenSolidLaw = std::variant<const Owned<VonMises>*, const Owned<SolidLaw>*, const Umat*>;

// A SolidLaw looks its hardening up in a table.
SpaceSolidLaw choose_solid_law(GivenSolidLaw given, std::array<double, 2> elastic) {
  if (const auto* mises = std::get_if<const Owned<VonMises>*>(&given)) return **mises;
  if (const auto* umat = std::get_if<const Umat*>(&given)) {
    require(elastic[0] > 0.0, "a law from a shared library needs its young and poisson");
    return own_umat<6>(**umat, elastic[0], elastic[1]);
  }
  Owned<SolidLaw> law = *std::get<const Owned<SolidLaw>*>(given);
  tabulate(law);
  return law;
}

// Positions are those of the nodes when the block is added.
void add_solids(SpaceLoop<double>& self, const std::string& element, Ints cells, GivenSolidLaw given, double density,
                double hourglass_fraction, Ints around, const std::vector<double>& kept, std::array<double, 2> elastic,
                std::vector<int> number) {
  std::vector<int> list(cells.data(), cells.data() + cells.size());
  for (int node : list) require(node >= 0 && node < self.nodes.n, "cells name a node that is not there");
  SpaceSolidLaw law = choose_solid_law(given, elastic);
  std::unique_ptr<SpaceSolids> made;
  if (element == "tet4_nodal") {
    require(!list.empty() && list.size() % 4 == 0, "cells must have shape (n > 0, 4)");
    std::vector<int> measured(around.data(), around.data() + around.size());
    require(measured.size() % 4 == 0, "around must have shape (n, 4)");
    for (int node : measured) require(node >= 0 && node < self.nodes.n, "around names a node that is not there");
    const auto& volumes = self.add_nodal_volumes(measured.empty() ? list : measured);
    made = make_nodal_tetrahedra(std::move(list), self.nodes, std::move(law), density, hourglass_fraction, volumes);
  } else {
    made = make_space_solids(element, std::move(list), self.nodes, std::move(law), density, hourglass_fraction);
  }
  require(number.empty() || int(number.size()) == made->n(), "number must have shape (n)");
  made->start_law(kept);
  made->number = std::move(number);
  self.add_solids(std::move(made));
}

NewDoubles point_measures(SpaceLoop<double>& self, int number) {
  require(number >= 0 && std::size_t(number) < self.blocks.size() && !self.is_sheet(number),
          "there is no block of solids of this number");
  const auto& block = *self.blocks[number];
  const auto layout = block.layout();
  const std::size_t width = std::min(layout.rows, explicit_dynamics::point_measures);
  double* to;
  NewDoubles made = new_array({std::size_t(block.n()), std::size_t(layout.count), width}, &to);
  for (int e = 0; e < block.n(); ++e)
    for (int q = 0; q < layout.count; ++q)
      for (std::size_t i = 0; i < width; ++i) *to++ = block.value(e, layout.first + q * layout.rows + int(i));
  return made;
}

// Springs of contact follow from the masses and the step that they were made for; then they are what was kept.
template <class Real>
void restore(SpaceLoop<Real>& self, const explicit_loop::State& given) {
  explicit_loop::check(self, given);
  explicit_loop::write(self, given);
  const double step = self.contact ? self.contact->step() : self.shell_contact ? self.shell_contact->step() : 0.0;
  if (!(step > 0.0)) return;
  self.set_contact_stiffness(step);
  explicit_loop::write(self, given);
}

template <class Real>
auto bind_space(nb::module_& m, const char* name, const char* text) {
  using Loop = SpaceLoop<Real>;
  nb::class_<Loop> loop(m, name, text);
  bind_loop(loop);
  bind_layers(loop);
  bind_tools(loop);
  bind_beads(loop);
  bind_shell_contact(loop);
  bind_pressures(loop);
  bind_parts(loop);
  loop.def("__init__", &make_loop<Real>, nb::arg("points"))
      .def("add_shells", &add_shells<Real>, nb::arg("connectivity"), nb::arg("thickness"), nb::arg("axis"),
           nb::arg("law"), nb::arg("density"), nb::arg("height"), nb::arg("weight"), nb::kw_only(),
           nb::arg("tabulate") = true, nb::arg("treatment") = ShellTreatment::plain, nb::arg("viscous") = false,
           nb::arg("hourglass") = std::array<double, 3>{0.03, 0.03, 0.03},
           nb::arg("elastic") = std::array<double, 2>{0.0, 0.0}, nb::arg("yield_stress") = 0.0,
           nb::arg("number") = std::vector<int>{}, nb::arg("relief") = std::vector<double>{},
           "Add a block of shells of 3 or 4 nodes; blocks and their elements are numbered as they come. elastic: "
           "Young's modulus and Poisson's ratio of a law from a shared library, which is told of the shells by number "
           "(n), from 0. yield_stress: half of it is the pressure [MPa] at which a pushed tool begins to squeeze. "
           "relief (n): how much nearer tools are to each other at a shell than they are drawn [mm].")
      .def("set_hanging", &set_hanging<Real>, nb::arg("hanging"),
           "Let nodes follow the ends of sides (n, 7): the node, both ends, two far nodes of the shell that has the "
           "whole side and two of those that have half of it.")
      .def("inherit", &inherit<Real>, nb::arg("other"), nb::arg("position"), nb::arg("node_parents"), nb::arg("parent"),
           nb::arg("share"), nb::arg("dt"),
           "Begin at positions (n_nodes, 3) with the state of another loop some shells of which are split here: share "
           "(n) of the parent (n) of each element, parents (n_nodes, 4) of each node; dt [s]: for beads.")
      .def(
          "take_shape",
          [](Loop& self, const Loop& other) {
            require(self.nodes.n == other.nodes.n && self.blocks.size() == other.blocks.size() &&
                        self.n_elements() == other.n_elements(),
                    "the mesh must be that of the other loop");
            self.take_shape(other);
          },
          nb::arg("other"),
          "Lie at rest and without stress where a loop of the same shells is, with its masses: what is left is "
          "elastic.")
      .def("restore", &restore<Real>, nb::arg("state"), "Take over what state gave.")
      .def_prop_ro(
          "inverse_mass",
          [](const Loop& self) {
            return Columns<const Real>{self.nodes.motion.data() + 6, self.nodes.n, self.nodes.motion_stride, 2}.get();
          },
          nb::rv_policy::move, "Inverse of mass [t] and of rotary inertia [t mm2] (n_nodes, 2); 0 where there is none.")
      .def_rw("ironing", &Loop::ironing, "Whether tools squeeze the sheet thinner; to be set before there are any.");
  return loop;
}

}  // namespace

void bind_explicit_space(nb::module_& m) {
  nb::class_<Energies>(m, "Energies", "Energies of an explicit run [N mm].")
      .def(nb::init<double, double, double, double, double, double, double>(), nb::arg("kinetic"), nb::arg("internal"),
           nb::arg("hourglass"), nb::arg("external"), nb::arg("damping"), nb::arg("contact"), nb::arg("friction"))
      .def_ro("kinetic", &Energies::kinetic)
      .def_ro("internal", &Energies::internal)
      .def_ro("hourglass", &Energies::hourglass)
      .def_ro("external", &Energies::external)
      .def_ro("damping", &Energies::damping)
      .def_ro("contact", &Energies::contact)
      .def_ro("friction", &Energies::friction);
  bind_tabulated_mises(m);

  nb::enum_<ShellTreatment>(m, "ShellTreatment",
                            "What a shell of four nodes is made of: one point in the plane, or 2 x 2.")
      .value("plain", ShellTreatment::plain, "Belytschko, Lin & Tsay 1984")
      .value("warped", ShellTreatment::warped, "with the terms of Belytschko, Wong & Chiang 1992")
      .value("stabilized", ShellTreatment::stabilized, "with hourglass stresses of the material's own")
      .value("mitc", ShellTreatment::mitc, "2 x 2 points, MITC4+");

  auto loop =
      bind_space<double>(m, "SpaceLoop", "Central differences for shells and solids in space; mm, s, t, N, MPa.");
  bind_space_walls(loop);
  bind_contacts(loop);
  loop.def("point_measures", &point_measures, nb::arg("block"),
           "Stress (6), equivalent plastic strain and, of a law that heats, its rise of temperature at the points of a "
           "block of solids (n, points, 7 or 8).");
  loop.def(
      "add_solids", &add_solids, nb::arg("element"), nb::arg("cells"), nb::arg("law"), nb::arg("density"),
      nb::arg("hourglass_fraction"), nb::arg("around"), nb::kw_only(), nb::arg("kept"),
      nb::arg("elastic") = std::array<double, 2>{0.0, 0.0}, nb::arg("number") = std::vector<int>{},
      "Add cells (n, nodes) of hex8, hex8_fbar, hex8_1pt or tet4_nodal; they are numbered as they come. "
      "hourglass_fraction: of the shear modulus, of hex8_1pt and tet4_nodal. around (n, 4): cells whose volumes "
      "nodes of tet4_nodal have, these and others; empty: these. kept: what the law keeps at every point behind the "
      "equivalent plastic strain, before the first cycle. elastic: Young's modulus and Poisson's ratio of "
      "a law from a shared library, which is told of the cells by number (n), from 0.");
  bind_space<float>(m, "SpaceLoopSingle",
                    "SpaceLoop in single precision, positions and work excepted; it has shells alone.");
}

}  // namespace presswork::bindings
