// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "arrays.hpp"
#include "drawbeads.hpp"
#include "explicit/loop.hpp"
#include "explicit/shell_section.hpp"
#include "tool_contact.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;
using NewBytes = nb::ndarray<nb::numpy, std::uint8_t>;

// The fast law where it gives what the general one does: von Mises, isotropic hardening alone.
std::optional<FastMises> find_fast_law(const SheetLaw& law) {
  const auto* quadratic = std::get_if<QuadraticYield<3>>(&law.yield);
  const bool plain = law.kinematic.index() == 0 && law.flow.rate.law == RateLaw::none && law.young_rate == 0.0;
  const auto von_mises = HillParameters{}.plane_stress();
  if (!plain || !quadratic) return std::nullopt;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::fabs(quadratic->P[i][j] - von_mises.P[i][j]) > 1e-14) return std::nullopt;
  return FastMises{{law.young, law.poisson, TabulatedHardening(law.flow.hardening)}};
}

struct FastLaw {
  FastMises law;
};

// Points (n, 3) by packs: stress, equivalent plastic strain, thickness strain increment.
template <class Real>
void update_range(const FastMises& law, std::size_t n, const double* strain, const double* stress, const double* eqps,
                  double* new_stress, double* new_eqps, double* thickness) {
  using P = PackOf<Real>;
  for (std::size_t first = 0; first < n; first += P::width) {
    P e[3], state[4];
    for (int lane = 0; lane < P::width; ++lane) {
      const std::size_t i = std::min(first + lane, n - 1);
      const double *a = strain + 3 * i, *b = stress + 3 * i;
      const double sums[3] = {a[0] + a[1], a[0] - a[1], a[2]}, kept[4] = {b[0] + b[1], b[0] - b[1], b[2], eqps[i]};
      for (int j = 0; j < 3; ++j) e[j].set(lane, static_cast<Real>(sums[j]));
      for (int j = 0; j < 4; ++j) state[j].set(lane, static_cast<Real>(kept[j]));
    }
    const P across = law.advance(e[0], e[1], e[2], 0.0, state);
    for (std::size_t i = first; i < std::min(first + P::width, n); ++i) {
      const int lane = static_cast<int>(i - first);
      new_stress[3 * i] = 0.5 * (state[0][lane] + state[1][lane]);
      new_stress[3 * i + 1] = 0.5 * (state[0][lane] - state[1][lane]);
      new_stress[3 * i + 2] = state[2][lane];
      new_eqps[i] = state[3][lane];
      thickness[i] = across[lane];
    }
  }
}

auto update_fast(const FastLaw& self, Doubles strain, Doubles stress, Doubles eqps, bool single) {
  require(strain.ndim() == 2 && strain.shape(1) == 3, "strain must have shape (n, 3): xx, yy, xy");
  const std::size_t n = strain.shape(0);
  require(stress.ndim() == 2 && stress.shape(0) == n && stress.shape(1) == 3, "stress must have the shape of strain");
  require(eqps.size() == n, "eqps must have shape (n)");
  double *new_stress, *new_eqps, *thickness;
  auto stresses = new_array({n, 3}, &new_stress);
  auto plastic = new_array({n}, &new_eqps);
  auto thicknesses = new_array({n}, &thickness);
  auto update = single ? update_range<float> : update_range<double>;
  update(self.law, n, strain.data(), stress.data(), eqps.data(), new_stress, new_eqps, thickness);
  return std::make_tuple(stresses, plastic, thicknesses);
}

ShellSection make_section(const SheetLaw& law, double density, std::vector<double> height, std::vector<double> weight,
                          bool tabulate, Treatment treatment, bool viscous, std::array<double, 3> hourglass) {
  require(height.size() == weight.size() && !height.empty(), "height and weight must have the same length, not 0");
  ShellSection section{GeneralSheet{law}, {std::move(height), std::move(weight)}, density, treatment, {}};
  if (tabulate) {
    if (auto fast = find_fast_law(law))
      section.law = std::move(*fast);
    else if (auto table = std::make_shared<const TabulatedHardening>(law.flow.hardening); table->error() < 1e-5)
      std::get<GeneralSheet>(section.law).law.flow.table = std::move(table);
  }
  section.control = {1.0, hourglass[0], hourglass[1], hourglass[2], viscous, density};
  return section;
}

template <class Real>
void make_loop(ShellLoop<Real>* self, Doubles points) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_nodes, 3)");
  new (self) ShellLoop<Real>(static_cast<int>(points.shape(0)), points.data());
}

template <class Real>
void add_shells(ShellLoop<Real>& self, Ints connectivity, Doubles thickness, Doubles axis, const SheetLaw& law,
                double density, std::vector<double> height, std::vector<double> weight, bool tabulate,
                Treatment treatment, bool viscous, std::array<double, 3> hourglass) {
  require(connectivity.ndim() == 2 && connectivity.shape(0) > 0, "connectivity must have shape (n, 3 or 4), n > 0");
  const std::size_t n = connectivity.shape(0), each = connectivity.shape(1);
  require(each == 3 || each == 4, "connectivity must have shape (n, 3 or 4), n > 0");
  require(thickness.size() == n, "thickness must have shape (n)");
  require(axis.ndim() == 2 && axis.shape(0) == n && axis.shape(1) == 3, "axis must have shape (n, 3)");
  std::vector<int> cells(connectivity.data(), connectivity.data() + each * n);
  for (int node : cells) require(node >= 0 && node < self.nodes.n, "connectivity names a node that is not there");
  auto section =
      make_section(law, density, std::move(height), std::move(weight), tabulate, treatment, viscous, hourglass);
  if (each == 4 && treatment == Treatment::mitc)
    self.add(make_mitc_shells<Real>(self.nodes, std::move(section), std::move(cells), thickness.data(), axis.data()));
  else
    self.add(make_one_point_shells<Real>(static_cast<int>(each), self.nodes, std::move(section), std::move(cells),
                                         thickness.data(), axis.data()));
}

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

// Stress (n, points in the plane, points across, 3) as xx, yy, xy.
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
auto advance(ShellLoop<Real>& self, double dt, Doubles force_scale, Doubles velocity_scale, double damping) {
  require(force_scale.size() == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  nb::gil_scoped_release release;
  const auto failure =
      self.advance(static_cast<int>(force_scale.size()), dt, damping, force_scale.data(), velocity_scale.data());
  return std::make_tuple(failure.element, failure.cycle);
}

template <class Real>
NewDoubles masses_of(const ShellLoop<Real>& self) {
  double* to;
  auto array = new_array({std::size_t(self.n_elements())}, &to);
  for (const auto& block : self.blocks) to = std::copy(block->mass().begin(), block->mass().end(), to);
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

// Positions, state, contact; then the forces there, of elements and tools.
template <class Real>
void inherit(ShellLoop<Real>& self, const ShellLoop<Real>& from, Doubles position, Ints node_parents, Ints parent,
             Doubles share, double dt) {
  const std::size_t n = self.nodes.n, elements = self.n_elements();
  require(node_parents.size() == 4 * n && parent.size() == elements && share.size() == elements,
          "node_parents must have shape (n_nodes, 4), parent and share (n)");
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
  bind_tools(loop);
  bind_beads(loop);
  loop.def("__init__", &make_loop<Real>, nb::arg("points"))
      .def("add_shells", &add_shells<Real>, nb::arg("connectivity"), nb::arg("thickness"), nb::arg("axis"),
           nb::arg("law"), nb::arg("density"), nb::arg("height"), nb::arg("weight"), nb::kw_only(),
           nb::arg("tabulate") = true, nb::arg("treatment") = Treatment::plain, nb::arg("viscous") = false,
           nb::arg("hourglass") = std::array<double, 3>{0.03, 0.03, 0.03},
           "Add a block of shells of 3 or 4 nodes; blocks and their elements are numbered as they come.")
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
           "returns "
           "the shell and the cycle of it, or -1, -1.")
      .def_prop_ro(
          "seconds",
          [](const Loop& self) {
            const auto of = [&](Phase phase) { return self.seconds[static_cast<int>(phase)]; };
            return std::make_tuple(of(Phase::nodes), of(Phase::elements), of(Phase::contact), of(Phase::waiting));
          },
          "Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.")
      .def("energies", &Loop::energies, nb::arg("dt"), nb::kw_only(), nb::arg("damping") = 0.0,
           nb::arg("force_scale") = 1.0, nb::arg("velocity_scale") = 1.0, "Energies at the present time.")
      .def("trial_force", &trial_force<Real>, nb::arg("increment"),
           "Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.")
      .def("dump", &dump<Real>,
           "Position, velocity, state of each block's elements (n, rows), internal force, external work, damping.")
      .def("restore", &restore<Real>, nb::arg("position"), nb::arg("velocity"), nb::arg("states"), nb::arg("forces"),
           nb::arg("external"), nb::arg("damping"), "Take over what dump gave.")
      .def("bound_frequencies", &bound_frequencies<Real>,
           "Bound of the squared highest frequency of each element [1/s2].")
      .def_prop_ro(
          "internal_force",
          [](const Loop& self) { return get_columns(self.internal_force.data(), self.nodes.n, 6, 0, 6); },
          nb::rv_policy::move, "Internal force [N] and moment [N mm] (n_nodes, 6).")
      .def_prop_rw(
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
      .def_prop_rw(
          "force", [](const Loop& self) { return get_columns(self.force.data(), self.nodes.n, 6, 0, 6); },
          [](Loop& self, Doubles f) {
            set_columns(self.force.data(), self.nodes.n, 6, 6, f, "force must have shape (n_nodes, 6)");
          },
          nb::rv_policy::move, "Nodal forces and moments from outside (n_nodes, 6) [N, N mm].")
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
          nb::arg("fixed"), nb::arg("velocity"), "Prescribe velocities of the freedoms marked in fixed (n_nodes, 6).")
      .def_prop_rw("element_mass", &masses_of<Real>, &set_element_masses<Real>, nb::rv_policy::move,
                   "Mass of each element (n) [t]; setting it sets the nodes' masses.")
      .def("stress", &stress_of<Real>, nb::arg("block"),
           "Stress xx, yy, xy (n, points in the plane, layers, 3) of a block in the law's frame [MPa].")
      .def("history", &history_of<Real>, nb::arg("block"),
           "What the law of a block keeps (n, points in the plane, layers, size); first eqps.")
      .def("thickness", &thickness_of<Real>, nb::arg("block"), "Thickness (n) [mm] of a block.");
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

  nb::class_<FastLaw>(m, "TabulatedMises",
                      "The explicit loop's von Mises update in plane stress; hardening from a table.")
      .def(
          "__init__",
          [](FastLaw* self, const SheetLaw& law) {
            auto fast = find_fast_law(law);
            require(fast.has_value(), "the law must be von Mises with isotropic hardening alone");
            new (self) FastLaw{std::move(*fast)};
          },
          nb::arg("law"))
      .def_prop_ro(
          "table_error", [](const FastLaw& self) { return self.law.hardening.error(); },
          "Largest error of the table, of the flow stress.")
      .def_prop_ro(
          "table_rows", [](const FastLaw& self) { return self.law.hardening.rows(); },
          "Number of the table's intervals.")
      .def(
          "update", &update_fast, nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"), nb::kw_only(),
          nb::arg("single") = false,
          "Advance points by strain increments (n, 3); returns stress (n, 3), equivalent plastic strain (n), thickness "
          "strain increment (n).");

  nb::enum_<Treatment>(m, "ShellTreatment", "What a shell of four nodes is made of: one point in the plane, or 2 x 2.")
      .value("plain", Treatment::plain, "Belytschko, Lin & Tsay 1984")
      .value("warped", Treatment::warped, "with the terms of Belytschko, Wong & Chiang 1992")
      .value("stabilized", Treatment::stabilized, "with hourglass stresses of the material's own")
      .value("mitc", Treatment::mitc, "2 x 2 points, MITC4+");

  bind_loop<double>(m, "ShellLoop", "Central differences for shells; mm, s, t, N, MPa.");
  bind_loop<float>(m, "ShellLoopSingle", "ShellLoop in single precision, positions and work excepted.");
}

}  // namespace presswork::bindings
