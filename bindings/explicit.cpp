// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>
#include <nanobind/stl/variant.h>

#include "arrays.hpp"
#include "drawbeads.hpp"
#include "explicit/loop.hpp"
#include "explicit/shell_section.hpp"
#include "shell_state.hpp"
#include "tabulated_mises.hpp"
#include "tool_contact.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;
using namespace shell_state;

// Of a law of our own, or of one from a shared library.
using GivenLaw = std::variant<const Owned<SheetLaw>*, const Umat*>;

ShellSection make_section(GivenLaw given, std::array<double, 2> elastic, double density, std::vector<double> height,
                          std::vector<double> weight, bool tabulated, Treatment treatment, bool viscous,
                          std::array<double, 3> hourglass) {
  require(height.size() == weight.size() && !height.empty(), "height and weight must have the same length, not 0");
  const ShellControl control{hourglass[0], hourglass[1], hourglass[2], viscous, density};
  LayerRule rule{std::move(height), std::move(weight)};
  if (const auto* umat = std::get_if<const Umat*>(&given)) {
    require(elastic[0] > 0.0, "a law from a shared library needs its young and poisson");
    auto own = std::make_shared<const Umat>(**umat);
    const UserSheet user{{own.get(), elastic[0], elastic[1]}};
    return {user, {std::move(own)}, std::move(rule), density, treatment, control};
  }
  const Owned<SheetLaw>& law = *std::get<const Owned<SheetLaw>*>(given);
  ShellSection section{GeneralSheet{law.view}, law.data, std::move(rule), density, treatment, control};
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
void make_loop(ShellLoop<Real>* self, Doubles points) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_nodes, 3)");
  new (self) ShellLoop<Real>(static_cast<int>(points.shape(0)), points.data());
}

template <class Real>
void add_shells(ShellLoop<Real>& self, Ints connectivity, Doubles thickness, Doubles axis, GivenLaw law, double density,
                std::vector<double> height, std::vector<double> weight, bool tabulate, Treatment treatment,
                bool viscous, std::array<double, 3> hourglass, std::array<double, 2> elastic, std::vector<int> number) {
  require((std::is_same_v<Real, double>) || std::holds_alternative<const Owned<SheetLaw>*>(law),
          "a law from a shared library computes in double precision");
  require(number.empty() || number.size() == connectivity.shape(0), "number must have shape (n)");
  require(connectivity.ndim() == 2 && connectivity.shape(0) > 0, "connectivity must have shape (n, 3 or 4), n > 0");
  const std::size_t n = connectivity.shape(0), each = connectivity.shape(1);
  require(each == 3 || each == 4, "connectivity must have shape (n, 3 or 4), n > 0");
  require(thickness.size() == n, "thickness must have shape (n)");
  require(axis.ndim() == 2 && axis.shape(0) == n && axis.shape(1) == 3, "axis must have shape (n, 3)");
  std::vector<int> cells(connectivity.data(), connectivity.data() + each * n);
  for (int node : cells) require(node >= 0 && node < self.nodes.n, "connectivity names a node that is not there");
  auto section = make_section(law, elastic, density, std::move(height), std::move(weight), tabulate, treatment, viscous,
                              hourglass);
  section.number = std::move(number);
  if (each == 4 && treatment == Treatment::mitc)
    self.add(make_mitc_shells<Real>(self.nodes, std::move(section), std::move(cells), thickness.data(), axis.data()));
  else
    self.add(make_one_point_shells<Real>(static_cast<int>(each), self.nodes, std::move(section), std::move(cells),
                                         thickness.data(), axis.data()));
}

template <class Real>
auto advance(ShellLoop<Real>& self, double dt, Doubles force_scale, Doubles velocity_scale, double damping) {
  const std::size_t n = force_scale.size();
  require(n == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  if (self.contact)
    for (const auto& tool : self.contact->tools)
      require(tool.removed || tool.drive.size() >= (tool.pushed ? n : 3 * n),
              "a tool is not driven for as many cycles");
  if (self.beads)
    for (const auto& bead : self.beads->beads)
      require(bead.share.size() >= n, "a bead is not driven for as many cycles");
  nb::gil_scoped_release release;
  const auto failure =
      self.advance(static_cast<int>(force_scale.size()), dt, damping, force_scale.data(), velocity_scale.data());
  return std::make_tuple(failure.element, failure.cycle, failure.told);
}

// Positions, state, contact; then the forces there, of elements and tools.
template <class Real>
void inherit(ShellLoop<Real>& self, const ShellLoop<Real>& from, Doubles position, Ints node_parents, Ints parent,
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
  set_columns(self.nodes.position.data(), self.nodes.n, 4, 3, position, "position must have shape (n_nodes, 3)");
  self.inherit(from, node_parents.data(), parent.data(), share.data());
  double* none;
  const NewDoubles rest = new_array({n, 6}, &none);
  const NewDoubles force = trial_force(self, Doubles(rest));
  set_columns(self.internal_force.data(), self.nodes.n, 6, 6, Doubles(force), "");
  require(bool(self.beads) == bool(from.beads), "the beads must be those of the other loop");
  if (self.beads) self.beads->inherit(*from.beads, dt, self.nodes, self.internal_force.data());
  std::vector<double> of_tools(3 * n, 0.0);
  if (self.contact) self.contact->add_forces(of_tools.data());
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) self.internal_force.data()[6 * i + k] -= static_cast<Real>(of_tools[3 * i + k]);
  self.give_hanging_forces();
}

template <class Real>
void set_hanging(ShellLoop<Real>& self, Ints hanging) {
  require(hanging.ndim() == 2 && hanging.shape(1) == 7, "hanging must have shape (n, 7)");
  std::vector<HangingNode> nodes;
  for (std::size_t i = 0; i < hanging.shape(0); ++i) {
    const auto* row = hanging.data() + 7 * i;
    nodes.push_back({row[0], {row[1], row[2]}, {row[3], row[4], row[5], row[6]}});
  }
  self.set_hanging(std::move(nodes));
}

template <class Real>
NewDoubles bound_frequencies(const ShellLoop<Real>& self) {
  double* squared;
  auto array = new_array({std::size_t(self.n_elements())}, &squared);
  for (const auto& block : self.blocks) {
    block->bound_frequencies(self.nodes, squared);
    squared += block->n();
  }
  return array;
}

template <class Real>
void bind_loop(nb::module_& m, const char* name, const char* text) {
  using Loop = ShellLoop<Real>;
  nb::class_<Loop> loop(m, name, text);
  bind_state(loop);
  bind_tools(loop);
  bind_beads(loop);
  loop.def("__init__", &make_loop<Real>, nb::arg("points"))
      .def("add_shells", &add_shells<Real>, nb::arg("connectivity"), nb::arg("thickness"), nb::arg("axis"),
           nb::arg("law"), nb::arg("density"), nb::arg("height"), nb::arg("weight"), nb::kw_only(),
           nb::arg("tabulate") = true, nb::arg("treatment") = Treatment::plain, nb::arg("viscous") = false,
           nb::arg("hourglass") = std::array<double, 3>{0.03, 0.03, 0.03},
           nb::arg("elastic") = std::array<double, 2>{0.0, 0.0}, nb::arg("number") = std::vector<int>{},
           "Add a block of shells of 3 or 4 nodes; blocks and their elements are numbered as they come. elastic: "
           "Young's modulus and Poisson's ratio of a law from a shared library, which is told of the shells by number "
           "(n), from 0.")
      .def_prop_rw(
          "time", [](const Loop& self) { return self.nodes.time; },
          [](Loop& self, double time) { self.nodes.time = time; },
          "At the start of the next call of advance [s], for laws from shared libraries.")
      .def(
          "set_temperature",
          [](Loop& self, int block, Doubles degrees) {
            require(block >= 0 && std::size_t(block) < self.blocks.size(), "there is no block of this number");
            const auto& rows = self.blocks[block]->rows();
            require(degrees.size() == std::size_t(self.blocks[block]->n()) * rows.in_plane * rows.across,
                    "temperature must have shape (n, points in the plane, layers)");
            self.blocks[block]->set_temperature(degrees.data());
          },
          nb::arg("block"), nb::arg("temperature"),
          "Give the layers of a block temperatures (n, points in the plane, layers) [degrees C] from now on.")
      .def("set_hanging", &set_hanging<Real>, nb::arg("hanging"),
           "Let nodes follow the ends of sides (n, 7): the node, both ends, two far nodes of the shell that has the "
           "whole side and two of those that have half of it.")
      .def("inherit", &inherit<Real>, nb::arg("other"), nb::arg("position"), nb::arg("node_parents"), nb::arg("parent"),
           nb::arg("share"), nb::arg("dt"),
           "Begin at positions (n_nodes, 3) with the state of another loop some shells of which are split here: share "
           "(n) of the parent (n) of each element, parents (n_nodes, 4) of each node; dt [s]: for beads.")
      .def("advance", &advance<Real>, nb::arg("dt"), nb::arg("force_scale"), nb::arg("velocity_scale"), nb::kw_only(),
           nb::arg("damping") = 0.0,
           "Advance as many cycles of dt [s] as the scales have values, or up to that in which a material law fails; "
           "returns the shell, the cycle of it and what its law told, or -1, -1, done.")
      .def_prop_ro(
          "seconds",
          [](const Loop& self) {
            const auto of = [&](Phase phase) { return self.seconds[static_cast<int>(phase)]; };
            return std::make_tuple(of(Phase::nodes), of(Phase::elements), of(Phase::contact), of(Phase::waiting));
          },
          "Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.")
      .def("energies", &Loop::energies, nb::arg("dt"), nb::kw_only(), nb::arg("damping") = 0.0,
           nb::arg("force_scale") = 1.0, nb::arg("velocity_scale") = 1.0, "Energies at the present time.")
      .def("bound_frequencies", &bound_frequencies<Real>,
           "Bound of the squared highest frequency of each element [1/s2].")
      .def_rw("ironing", &Loop::ironing, "Whether tools squeeze the sheet thinner; to be set before there are any.")
      .def_prop_rw(
          "force", [](const Loop& self) { return get_columns(self.force.data(), self.nodes.n, 6, 0, 6); },
          [](Loop& self, Doubles f) {
            set_columns(self.force.data(), self.nodes.n, 6, 6, f, "force must have shape (n_nodes, 6)");
          },
          nb::rv_policy::move, "Nodal forces and moments from outside (n_nodes, 6) [N, N mm].")
      .def_prop_rw(
          "reaction_impulse",
          [](const Loop& self) { return get_columns(self.reaction_impulse.data(), self.nodes.n, 6, 0, 6); },
          [](Loop& self, Doubles x) {
            set_columns(self.reaction_impulse.data(), self.nodes.n, 6, 6, x,
                        "the impulse must have shape (n_nodes, 6)");
          },
          nb::rv_policy::move,
          "Impulse of what holds prescribed freedoms (n_nodes, 6), added up until it is set to zero [N s, N mm s].")
      .def(
          "prescribe",
          [](Loop& self, Bytes fixed, Doubles velocity) {
            require(fixed.size() == self.prescribed.size(), "fixed must have shape (n_nodes, 6)");
            set_columns(self.prescribed.data(), self.nodes.n, 6, 6, velocity, "velocity must have shape (n_nodes, 6)");
            for (std::size_t i = 0; i < self.held.size(); ++i) {
              self.held[i] = 0;
              for (int j = 0; j < 6; ++j) self.held[i] |= (fixed.data()[6 * i + j] != 0) << j;
            }
          },
          nb::arg("fixed"), nb::arg("velocity"), "Prescribe velocities of the freedoms marked in fixed (n_nodes, 6).");
}

}  // namespace

void bind_explicit(nb::module_& m) {
  nb::class_<Energies>(m, "Energies", "Energies of an explicit run [N mm].")
      .def_ro("kinetic", &Energies::kinetic)
      .def_ro("internal", &Energies::internal)
      .def_ro("hourglass", &Energies::hourglass)
      .def_ro("external", &Energies::external)
      .def_ro("damping", &Energies::damping)
      .def_ro("contact", &Energies::contact)
      .def_ro("friction", &Energies::friction);
  bind_tabulated_mises(m);

  nb::enum_<Treatment>(m, "ShellTreatment", "What a shell of four nodes is made of: one point in the plane, or 2 x 2.")
      .value("plain", Treatment::plain, "Belytschko, Lin & Tsay 1984")
      .value("warped", Treatment::warped, "with the terms of Belytschko, Wong & Chiang 1992")
      .value("stabilized", Treatment::stabilized, "with hourglass stresses of the material's own")
      .value("mitc", Treatment::mitc, "2 x 2 points, MITC4+");

  bind_loop<double>(m, "ShellLoop", "Central differences for shells; mm, s, t, N, MPa.");
  bind_loop<float>(m, "ShellLoopSingle", "ShellLoop in single precision, positions and work excepted.");
}

}  // namespace presswork::bindings
