// SPDX-License-Identifier: Apache-2.0
// What Python sees of an explicit loop, whatever its nodes are.
#pragma once

#include <nanobind/stl/map.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "arrays.hpp"
#include "explicit/contact/body_contact.hpp"
#include "explicit/loop.hpp"
#include "explicit/plane/nodes.hpp"
#include "explicit/space/nodes.hpp"
#include "material/umat.hpp"

namespace presswork::bindings {

// The first `width` numbers of n records of `stride` numbers, as an array (n, width).
template <class Number>
struct Columns {
  Number* first;
  int n, stride, width;

  NewDoubles get() const {
    double* to;
    auto array = new_array({std::size_t(n), std::size_t(width)}, &to);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < width; ++j) *to++ = first[std::size_t(i) * stride + j];
    return array;
  }
  bool is_finite() const {
    bool all = true;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < width; ++j) all &= std::isfinite(first[std::size_t(i) * stride + j]);
    return all;
  }
  void set(Doubles from, const std::string& name) const {
    require(from.ndim() == 2 && from.shape(0) == std::size_t(n) && from.shape(1) == std::size_t(width),
            (name + " must have shape (n_nodes, " + std::to_string(width) + ")").c_str());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < width; ++j)
        first[std::size_t(i) * stride + j] = static_cast<Number>(from.data()[std::size_t(i) * width + j]);
  }
};

template <class Real>
auto position_of(explicit_dynamics::SpaceNodes<Real>& nodes) {
  return Columns<double>{nodes.position.data(), nodes.n, nodes.position_stride, 3};
}
template <class Real>
auto velocity_of(explicit_dynamics::SpaceNodes<Real>& nodes) {
  return Columns<Real>{nodes.motion.data(), nodes.n, nodes.motion_stride, nodes.freedoms};
}
inline auto position_of(explicit_dynamics::PlaneNodes& nodes) {
  return Columns<double>{nodes.position.data(), nodes.n, nodes.position_stride, 2};
}
inline auto velocity_of(explicit_dynamics::PlaneNodes& nodes) {
  return Columns<double>{nodes.velocity.data(), nodes.n, nodes.freedoms, nodes.freedoms};
}
template <class Nodes>
auto force_of(Nodes& nodes) {
  return Columns<typename Nodes::Real>{nodes.force.data(), nodes.n, nodes.freedoms, nodes.freedoms};
}
template <class Nodes>
auto internal_force_of(Nodes& nodes) {
  return Columns<typename Nodes::Real>{nodes.internal_force.data(), nodes.n, nodes.freedoms, nodes.freedoms};
}
template <class Nodes>
auto reaction_of(Nodes& nodes) {
  return Columns<double>{nodes.reaction_impulse.data(), nodes.n, nodes.freedoms, nodes.freedoms};
}

namespace explicit_loop {

using State = std::map<std::string, std::map<std::string, Doubles>>;
using NewState = std::map<std::string, std::map<std::string, NewDoubles>>;

template <class Loop>
auto advance(Loop& self, double time, double dt, double dt_before, Doubles force_scale, Doubles velocity_scale,
             double damping) {
  require(force_scale.size() == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  nb::gil_scoped_release release;
  const auto failure = self.advance(
      {static_cast<int>(force_scale.size()), time, dt, dt_before, damping, force_scale.data(), velocity_scale.data()});
  return std::make_tuple(failure.element, static_cast<LawStatus>(failure.status), failure.cycle);
}

template <class Loop>
NewDoubles bound_frequencies(const Loop& self) {
  double* squared;
  auto array = new_array({std::size_t(self.n_elements())}, &squared);
  for (const auto& block : self.blocks) {
    block->bound_frequencies(self.nodes, squared);
    squared += block->n();
  }
  return array;
}

// A number for each element of all blocks (n).
template <class Loop, class Get>
NewDoubles of_elements(const Loop& self, Get&& get) {
  double* to;
  auto array = new_array({std::size_t(self.n_elements())}, &to);
  for (const auto& block : self.blocks)
    for (int e = 0; e < block->n(); ++e) *to++ = get(*block, e);
  return array;
}

template <class Loop>
void scale_mass(Loop& self, Doubles factor) {
  require(factor.size() == std::size_t(self.n_elements()), "factor must have shape (n)");
  const double* from = factor.data();
  for (auto& block : self.blocks)
    for (int e = 0; e < block->n(); ++e) block->scale_mass(e, *from++);
  self.set_masses();
}

template <class Loop>
NewState state(Loop& self) {
  NewState all;
  for (const auto& field : self.state()) {
    double* to;
    auto array = new_array(field.shape, &to);
    field.read(to);
    all[field.owner].emplace(field.name, std::move(array));
  }
  return all;
}

template <class Loop>
void write(Loop& self, const State& given) {
  for (const auto& field : self.state())
    if (field.size() > 0) field.write(given.at(field.owner).at(field.name).data());
  self.set_masses();
}

// Throws where owners, names or shapes are not those of the loop; arrays without numbers may be left out.
template <class Loop>
void check(Loop& self, const State& given) {
  const auto refuse = [](const std::string& owner) {
    const std::string kind = owner.starts_with("tool") || owner == "contact" ? "tools"
                             : owner.starts_with("wall")                     ? "walls"
                             : owner.starts_with("bodies")                   ? "contacts"
                             : owner == "beads"                              ? "beads"
                             : owner == "shell_contact"                      ? "contact of shells"
                                                                             : "mesh, elements or laws";
    throw nb::value_error(("the dump's " + kind + " are not those of this run").c_str());
  };
  const auto has_numbers = [](const auto& named) { return named.second.size() > 0; };
  std::map<std::string, std::size_t> found;
  for (const auto& field : self.state()) {
    if (field.size() == 0) continue;
    const auto owner = given.find(field.owner);
    if (owner == given.end() || !owner->second.contains(field.name)) refuse(field.owner);
    const Doubles& array = owner->second.at(field.name);
    if (array.ndim() != field.shape.size()) refuse(field.owner);
    for (std::size_t i = 0; i < field.shape.size(); ++i)
      if (array.shape(i) != field.shape[i]) refuse(field.owner);
    ++found[field.owner];
  }
  for (const auto& [owner, arrays] : given)
    if (found[owner] != std::size_t(std::count_if(arrays.begin(), arrays.end(), has_numbers))) refuse(owner);
}

template <class Loop>
auto& contact_of(const Loop& self, int contact) {
  require(contact >= 0 && std::size_t(contact) < self.contacts.size(), "there is no contact of this number");
  return *self.contacts[contact];
}

template <class Loop>
void add_contact(Loop& self, Ints slave, Ints master, Ints slave_cells, Ints master_cells, bool by_itself, double edge,
                 double thickness, double mu, double reach, double margin) {
  require(slave.ndim() == 2 && master.ndim() == 2 && slave.shape(1) == master.shape(1), "faces must have shape (n, k)");
  require(slave_cells.ndim() == 2 && master_cells.ndim() == 2 && slave_cells.shape(1) == master_cells.shape(1) &&
              slave_cells.shape(0) == slave.shape(0) && master_cells.shape(0) == master.shape(0),
          "cells must have shape (n faces, nodes)");
  const auto copy = [&](const Ints& from) {
    for (std::size_t i = 0; i < from.size(); ++i)
      require(from.data()[i] >= 0 && from.data()[i] < self.nodes.n, "a face names a node that is not there");
    return std::vector<int>(from.data(), from.data() + from.size());
  };
  self.add_contact({static_cast<int>(slave.shape(1)), static_cast<int>(slave_cells.shape(1)), copy(slave), copy(master),
                    copy(slave_cells), copy(master_cells), by_itself, edge, thickness, mu},
                   reach, margin);
}

inline NewDoubles copy_table(const std::vector<double>& from, std::size_t width) {
  double* to;
  auto array = width > 1 ? new_array({from.size() / width, width}, &to) : new_array({from.size()}, &to);
  std::copy(from.begin(), from.end(), to);
  return array;
}

}  // namespace explicit_loop

// Contact of deformable bodies.
template <class Loop, class... Rest>
void bind_contacts(nb::class_<Loop, Rest...>& c) {
  using namespace explicit_loop;
  const auto numbers = [&](const char* name, auto of, const char* text) {
    c.def(
        name,
        [of](const Loop& self, int contact) {
          const std::vector<int> from = of(contact_of(self, contact));
          int* to;
          auto array = new_array({from.size()}, &to);
          std::copy(from.begin(), from.end(), to);
          return array;
        },
        nb::arg("contact"), text);
  };
  c.def("add_contact", &add_contact<Loop>, nb::arg("slave"), nb::arg("master"), nb::arg("slave_cells"),
        nb::arg("master_cells"), nb::kw_only(), nb::arg("by_itself"), nb::arg("edge"), nb::arg("thickness"),
        nb::arg("mu"), nb::arg("reach"), nb::arg("margin"),
        "Let faces (n, k) of bodies touch; cells (n, nodes): behind each. by_itself: slave and master are the same; "
        "edge: mean length [mm]; thickness [mm], 0 of rings; mu: most of friction over pressure; reach and margin: "
        "parts of the edge.")
      .def(
          "set_contact_step", [](Loop& self, int contact, double dt) { contact_of(self, contact).step = dt; },
          nb::arg("contact"), nb::arg("dt"), "Let the springs of a contact be stable with a step [s].")
      .def(
          "limit_contact_friction",
          [](Loop& self, int contact, Doubles limit) {
            auto& of = contact_of(self, contact);
            require(limit.size() == std::size_t(of.n_slots()), "limit must have shape (n_slots)");
            of.shear_limit.assign(limit.data(), limit.data() + limit.size());
          },
          nb::arg("contact"), nb::arg("limit"), "Largest shear of each slot (n_slots) [MPa] from now on.")
      .def(
          "contact_passed", [](const Loop& self, int contact) { return contact_of(self, contact).passed; },
          nb::arg("contact"), "Whether the bodies have gone through each other.")
      .def(
          "contact_pressure",
          [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).pressure, 1); },
          nb::arg("contact"), "Pressure of the slots (n_slots) [MPa].")
      .def(
          "find_contact_stiffness",
          [](Loop& self, int contact) { return copy_table(contact_of(self, contact).find_stiffness(self.nodes), 1); },
          nb::arg("contact"), "Stiffness of the slots' springs as the next cycle has it (n_slots) [MPa/mm].")
      .def(
          "contact_shear", [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).shear, 3); },
          nb::arg("contact"), "Shear of the slots, on the slave (n_slots, 3) [MPa].")
      .def(
          "contact_push", [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).push, 3); },
          nb::arg("contact"), "Forces of the pressure on the nodes of the contact (n, 3) in the last cycle [N].")
      .def(
          "contact_rub", [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).rub, 3); },
          nb::arg("contact"), "Forces of friction on them (n, 3) [N].")
      .def(
          "contact_area",
          [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).node_area(), 1); },
          nb::arg("contact"), "Share of them in the surfaces that face each other (n) [mm2].")
      .def(
          "contact_work",
          [](const Loop& self, int contact) {
            const double* work = contact_of(self, contact).work();
            return std::make_tuple(work[0], work[1]);
          },
          nb::arg("contact"), "Work that pressure and friction of a contact have taken since the start [N mm].")
      .def(
          "contact_impulse",
          [](const Loop& self, int contact) { return copy_table(contact_of(self, contact).impulse, 1); },
          nb::arg("contact"), "Impulse that the slave has given to the master since the start (3) [N s].");
  numbers("contact_nodes", [](const auto& of) { return of.node(); }, "Nodes of a contact (n), as the loop has them.");
  numbers(
      "contact_slots",
      [](const auto& of) {
        std::vector<int> nodes = of.slot_node();
        for (int& node : nodes) node = of.node()[node];
        return nodes;
      },
      "Nodes of the slots of a contact (n_slots), as the loop has them.");
}

template <class Loop, class... Rest>
void bind_loop(nb::class_<Loop, Rest...>& c) {
  using namespace explicit_loop;
  c.def(
       "advance", &explicit_loop::advance<Loop>, nb::arg("time"), nb::arg("dt"), nb::arg("dt_before"),
       nb::arg("force_scale"), nb::arg("velocity_scale"), nb::kw_only(), nb::arg("damping") = 0.0,
       "Advance as many cycles of dt [s] from `time` on as the scales have values, the step before dt_before, or up to "
       "that in which an element fails; returns the element, what its law told (done, if it is turned inside out) and "
       "the cycle, or -1, done, -1.")
      .def(
          "energies",
          [](const Loop& self, double dt, double dt_before, double damping, double force_scale, double velocity_scale) {
            return self.energies({dt, 0.5 * (dt_before + dt), damping, force_scale, velocity_scale});
          },
          nb::arg("dt"), nb::arg("dt_before"), nb::kw_only(), nb::arg("damping") = 0.0, nb::arg("force_scale") = 1.0,
          nb::arg("velocity_scale") = 1.0, "Energies at the present time; dt: the next step [s].")
      .def_prop_ro(
          "seconds",
          [](const Loop& self) {
            using explicit_dynamics::Phase;
            const auto of = [&](Phase phase) { return self.seconds[static_cast<int>(phase)]; };
            return std::make_tuple(of(Phase::nodes), of(Phase::elements), of(Phase::contact), of(Phase::waiting));
          },
          "Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.")
      .def("bound_frequencies", &bound_frequencies<Loop>,
           "Bound of the squared highest frequency of each element (n) [1/s2].")
      .def_prop_ro(
          "element_mass",
          [](const Loop& self) { return of_elements(self, [](const auto& block, int e) { return block.mass(e); }); },
          nb::rv_policy::move, "Mass of each element (n) [t].")
      .def_prop_ro(
          "true_mass",
          [](const Loop& self) {
            return of_elements(self, [](const auto& block, int e) { return block.true_mass(e); });
          },
          nb::rv_policy::move, "Mass of each element without what scaling has added (n) [t].")
      .def_prop_ro(
          "added_mass",
          [](const Loop& self) {
            return of_elements(self, [](const auto& block, int e) { return block.added_mass(e); });
          },
          nb::rv_policy::move, "What scaling has added to the mass of each element (n) [t].")
      .def("scale_mass", &scale_mass<Loop>, nb::arg("factor"), "Multiply the masses of the elements by factors (n).")
      .def(
          "set_temperature",
          [](Loop& self, int block, Doubles degrees) {
            require(block >= 0 && std::size_t(block) < self.blocks.size(), "there is no block of this number");
            auto& elements = *self.blocks[block];
            require(degrees.size() == std::size_t(elements.n()) * elements.n_temperatures(),
                    "temperature must have shape (n, points of an element)");
            elements.set_temperature(degrees.data());
          },
          nb::arg("block"), nb::arg("temperature"),
          "Give the points of a block's elements temperatures (n, points) [degrees C] from now on; of shells (n, "
          "points "
          "in the plane, layers).")
      .def(
          "add_damage",
          [](Loop& self, int block, const std::string& name, const Damage& law, double temperature, int rise) {
            require(block >= 0 && std::size_t(block) < self.blocks.size(), "there is no block of this number");
            self.blocks[block]->add_damage({name, law, temperature, rise});
          },
          nb::arg("block"), nb::arg("name"), nb::arg("law"), nb::kw_only(), nb::arg("temperature") = 20.0,
          nb::arg("rise") = -1,
          "Let damage by a criterion grow at the points of a block. temperature: where none is given [degrees C]; "
          "rise: "
          "row of the rise of temperature behind the first of the stress, -1 if there is none.")
      .def(
          "damage",
          [](const Loop& self, int block, const std::string& name) {
            require(block >= 0 && std::size_t(block) < self.blocks.size(), "there is no block of this number");
            const auto& damage = self.blocks[block]->damage;
            require(damage.find(name) < damage.count(), "the block has no damage of this name");
            double* to;
            auto array = new_array({std::size_t(self.blocks[block]->n()), std::size_t(damage.points())}, &to);
            damage.read(damage.find(name), to);
            return array;
          },
          nb::arg("block"), nb::arg("name"), "Damage by a criterion at the points of a block (n, points).")
      .def(
          "set_slower",
          [](Loop& self, double factor) {
            for (auto& block : self.blocks) block->slower = factor;
          },
          nb::arg("factor"),
          "Let the laws of shells take their rates by a time that is so many times that of the cycles from now on.")
      .def(
          "prescribe",
          [](Loop& self, Bytes fixed, Doubles velocity) {
            const std::size_t size = std::size_t(self.nodes.n) * self.nodes.freedoms;
            require(fixed.size() == size && velocity.size() == size,
                    "fixed and velocity must have shape (n_nodes, freedoms)");
            self.nodes.prescribe(fixed.data(), velocity.data());
          },
          nb::arg("fixed"), nb::arg("velocity"),
          "Prescribe velocities of the freedoms marked in fixed (n_nodes, freedoms).")
      .def("state", &state<Loop>, "All that the next cycle depends on: arrays by owner and name.");
  const auto columns = [&](const char* name, auto of, const char* text) {
    c.def_prop_rw(
        name, [of](Loop& self) { return of(self.nodes).get(); },
        [of, name](Loop& self, Doubles x) { of(self.nodes).set(x, name); }, nb::rv_policy::move, text);
  };
  c.def_prop_ro(
      "is_finite", [](Loop& self) { return position_of(self.nodes).is_finite(); },
      "Whether the positions of all nodes are finite numbers.");
  columns("position", [](auto& nodes) { return position_of(nodes); }, "Positions (n_nodes, dimension) [mm].");
  columns(
      "velocity", [](auto& nodes) { return velocity_of(nodes); },
      "Velocities (n_nodes, freedoms), half a step back [mm/s, 1/s].");
  columns(
      "force", [](auto& nodes) { return force_of(nodes); },
      "Nodal forces and moments from outside (n_nodes, freedoms) [N, N mm].");
  columns(
      "internal_force", [](auto& nodes) { return internal_force_of(nodes); },
      "Internal forces and moments (n_nodes, freedoms) [N, N mm], less those of tools.");
  columns(
      "reaction_impulse", [](auto& nodes) { return reaction_of(nodes); },
      "Impulse of what holds prescribed freedoms (n_nodes, freedoms), until set to zero [N s, N mm s].");
}

}  // namespace presswork::bindings
