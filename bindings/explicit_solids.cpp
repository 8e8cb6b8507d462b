// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>
#include <nanobind/stl/variant.h>

#include <algorithm>
#include <numeric>

#include "arrays.hpp"
#include "explicit/solid_loop.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;

NewDoubles copy(const std::vector<double>& from, const std::vector<std::size_t>& shape) {
  double* to;
  auto array = new_array(shape, &to);
  std::copy(from.begin(), from.end(), to);
  return array;
}
void assign(std::vector<double>& to, Doubles from, const char* message) {
  require(from.size() == to.size(), message);
  std::copy_n(from.data(), to.size(), to.begin());
}

// Two numbers a node (n_nodes, 2) of rows of `stride`, that can be set.
template <AlignedArray<double> SolidLoop::* field, int stride>
void bind_field(nb::class_<SolidLoop>& c, const char* name, const char* text) {
  c.def_prop_rw(
      name,
      [](const SolidLoop& self) {
        double* to;
        auto array = new_array({std::size_t(self.n_nodes), 2}, &to);
        for (int i = 0; i < self.n_nodes; ++i)
          std::copy_n((self.*field).data() + stride * std::size_t(i), 2, to + 2 * std::size_t(i));
        return array;
      },
      [](SolidLoop& self, Doubles x) {
        require(x.size() == 2 * std::size_t(self.n_nodes), "the array must have shape (n_nodes, 2)");
        for (int i = 0; i < self.n_nodes; ++i)
          std::copy_n(x.data() + 2 * std::size_t(i), 2, (self.*field).data() + stride * std::size_t(i));
      },
      nb::rv_policy::move, text);
}

std::size_t count_cells(const SolidLoop& loop) {
  std::size_t n = 0;
  for (const auto& block : loop.blocks) n += block.n();
  return n;
}

// Rows of the state of all cells of all blocks (n, width).
template <int row, int width>
void bind_cells(nb::class_<SolidLoop>& c, const char* name, const char* text) {
  c.def_prop_rw(
      name,
      [](const SolidLoop& self) {
        const std::size_t n = count_cells(self);
        double* to;
        auto array = width > 1 ? new_array({n, std::size_t(width)}, &to) : new_array({n}, &to);
        for (const auto& block : self.blocks)
          for (int e = 0; e < block.n(); ++e)
            for (int i = 0; i < width; ++i) *to++ = block.value(e, row + i);
        return array;
      },
      [](SolidLoop& self, Doubles x) {
        require(x.size() == width * count_cells(self), "the array must have one row a cell");
        const double* from = x.data();
        for (auto& block : self.blocks)
          for (int e = 0; e < block.n(); ++e)
            for (int i = 0; i < width; ++i) block.set_value(e, row + i, *from++);
      },
      nb::rv_policy::move, text);
}

RigidWall& wall_of(const SolidLoop& self, int wall) {
  require(wall >= 0 && std::size_t(wall) < self.walls.size(), "there is no wall of this number");
  return *self.walls[wall];
}

// A PlaneLaw looks its hardening up in a table.
SolidLawChoice choose_law(std::variant<const Owned<AdiabaticMises>*, const Owned<PlaneLaw>*, const Umat*> given,
                          double young, double poisson) {
  if (const auto* mises = std::get_if<const Owned<AdiabaticMises>*>(&given)) return **mises;
  if (const auto* umat = std::get_if<const Umat*>(&given)) return OwnedUmat{**umat, young, poisson};
  Owned<PlaneLaw> law = *std::get<const Owned<PlaneLaw>*>(given);
  tabulate(law);
  return law;
}

void bind_law(nb::module_& m) {
  using Law = Owned<AdiabaticMises>;
  nb::class_<Law>(m, "AdiabaticMises",
                  "Von Mises plasticity with strain rate, softening by temperature and adiabatic heating.")
      .def(
          "__init__",
          [](Law* self, const Owned<VonMises>& mises, RateLaw rate, std::array<double, 2> parameters, double start,
             double reference, double melting, double exponent, double heating) {
            auto table = std::make_shared<const HardeningTable>(mises.view.hardening);
            AdiabaticMises made{mises.view, {}, {{reference, melting, exponent}, start, heating}, table->view()};
            require(make_rate(rate, parameters, made.rate), "rate_parameters must have the two of the law");
            new (self) Law{made, mises.data};
            self->data.push_back(std::move(table));
          },
          nb::arg("mises"), nb::kw_only(), nb::arg("rate") = RateLaw{},
          nb::arg("rate_parameters") = std::array<double, 2>{0.0, 1.0}, nb::arg("start") = 0.0,
          nb::arg("reference") = 0.0, nb::arg("melting") = 0.0, nb::arg("exponent") = 1.0, nb::arg("heating") = 0.0)
      .def(
          "update",
          [](const Law& law, Doubles strain, double dt, Doubles stress, Doubles eqps, Doubles rise) {
            const std::size_t n = eqps.size();
            require(strain.size() == 4 * n && stress.size() == 4 * n && rise.size() == n,
                    "strain and stress must have shape (n, 4), eqps and rise (n)");
            double *new_stress, *new_eqps, *new_rise;
            auto stresses = new_array({n, 4}, &new_stress);
            auto strains = new_array({n}, &new_eqps);
            auto rises = new_array({n}, &new_rise);
            for (std::size_t i = 0; i < n; ++i) {
              LawInput<4, double> in{{}, dt, law.view.thermal.start};
              double s0[6], s1[6];
              std::copy_n(strain.data() + 4 * i, 4, in.strain);
              std::copy_n(stress.data() + 4 * i, 4, s0);
              s0[4] = eqps.data()[i], s0[5] = rise.data()[i];
              update(law.view, in, HardeningPoint<double>(law.view.hardening, s0[4]), s0, s1);
              std::copy_n(s1, 4, new_stress + 4 * i);
              new_eqps[i] = s1[4], new_rise[i] = s1[5];
            }
            return std::make_tuple(stresses, strains, rises);
          },
          nb::arg("strain"), nb::arg("dt"), nb::arg("stress"), nb::arg("eqps"), nb::arg("rise"),
          "Advance points by strain increments (n, 4) in dt; returns stress (n, 4), equivalent plastic strain (n) and "
          "rise of temperature (n).");
}

}  // namespace

void bind_explicit_solids(nb::module_& m) {
  bind_law(m);
  nb::class_<SolidEnergies>(m, "SolidEnergies", "Energies of an explicit run of solids [N mm].")
      .def_ro("kinetic", &SolidEnergies::kinetic)
      .def_ro("internal", &SolidEnergies::internal)
      .def_ro("hourglass", &SolidEnergies::hourglass)
      .def_ro("external", &SolidEnergies::external)
      .def_ro("damping", &SolidEnergies::damping)
      .def_ro("contact", &SolidEnergies::contact)
      .def_ro("friction", &SolidEnergies::friction);

  nb::class_<SolidLoop> c(m, "SolidLoop", "Central differences for solids in the plane; mm, s, t, N, MPa.");
  c.def(
       "__init__",
       [](SolidLoop* self, Doubles points, Bytes contact, bool axisymmetric, double depth, double hourglass_fraction) {
         require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n_nodes, 2)");
         require(contact.size() == points.shape(0), "contact must have shape (n_nodes)");
         new (self) SolidLoop(static_cast<int>(points.shape(0)), points.data(), contact.data(),
                              {axisymmetric, depth, hourglass_fraction});
       },
       nb::arg("points"), nb::arg("contact"), nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth") = 1.0,
       nb::arg("hourglass_fraction") = 0.05)
      .def(
          "add",
          [](SolidLoop& self, const std::string& element, Ints cells,
             std::variant<const Owned<AdiabaticMises>*, const Owned<PlaneLaw>*, const Umat*> law, double density,
             double young, double poisson) {
            std::vector<int> list(cells.data(), cells.data() + cells.size());
            for (int node : list) require(node >= 0 && node < self.n_nodes, "cells name a node that is not there");
            self.add(element, std::move(list), choose_law(law, young, poisson), density);
          },
          nb::arg("element"), nb::arg("cells"), nb::arg("law"), nb::arg("density"), nb::kw_only(),
          nb::arg("young") = 0.0, nb::arg("poisson") = 0.0,
          "Add cells (n, nodes) of tri3 or quad4_1pt; they are numbered as they come. young, poisson: of a law from a "
          "shared library.")
      .def(
          "add_wall",
          [](SolidLoop& self, Doubles segments, double mu) {
            require(segments.ndim() == 2 && segments.shape(1) == 7 && segments.shape(0) > 0,
                    "segments must have shape (n > 0, 7)");
            self.add_wall({segments.data(), segments.data() + segments.size()}, mu);
          },
          nb::arg("segments"), nb::kw_only(), nb::arg("mu") = 0.0,
          "Add a rigid profile; they are numbered as they come.")
      .def(
          "wall_force",
          [](const SolidLoop& self, int wall) {
            return copy(wall_of(self, wall).force, {std::size_t(self.n_nodes), 2});
          },
          nb::arg("wall"), "Forces of a wall on the nodes (n_nodes, 2) in the last cycle.")
      .def(
          "wall_offset",
          [](const SolidLoop& self, int wall) {
            const double* at = wall_of(self, wall).offset;
            return std::array<double, 2>{at[0], at[1]};
          },
          nb::arg("wall"), "Displacement of a wall since the start [mm].")
      .def(
          "wall_impulse",
          [](const SolidLoop& self, int wall) {
            const double* sum = wall_of(self, wall).impulse;
            return std::array<double, 2>{sum[0], sum[1]};
          },
          nb::arg("wall"), "Impulse of a wall on the nodes since the start [N s].")
      .def(
          "move_wall",
          [](SolidLoop& self, int wall, std::array<double, 2> velocity) {
            std::copy_n(velocity.begin(), 2, wall_of(self, wall).velocity);
          },
          nb::arg("wall"), nb::arg("velocity"), "Set a wall's velocity [mm/s].")
      .def(
          "restore_wall",
          [](SolidLoop& self, int wall, std::array<double, 2> offset, std::array<double, 2> impulse, Doubles force) {
            RigidWall& w = wall_of(self, wall);
            assign(w.force, force, "force must have shape (n_nodes, 2)");
            std::copy_n(offset.begin(), 2, w.offset);
            std::copy_n(impulse.begin(), 2, w.impulse);
          },
          nb::arg("wall"), nb::arg("offset"), nb::arg("impulse"), nb::arg("force"),
          "Take over where a wall was and what it pushed.")
      .def(
          "advance",
          [](SolidLoop& self, double time, double dt, double dt_before, Doubles force_scale, Doubles velocity_scale,
             double damping) {
            require(force_scale.size() == velocity_scale.size(), "the scales must have the same length");
            nb::gil_scoped_release release;
            const int code = self.advance(static_cast<int>(force_scale.size()), time, dt, dt_before, damping,
                                          force_scale.data(), velocity_scale.data());
            const bool failed = code >= 0;
            return std::make_tuple(failed ? code / SolidBlock::reasons : -1,
                                   static_cast<LawStatus>(failed ? code % SolidBlock::reasons : 0));
          },
          nb::arg("time"), nb::arg("dt"), nb::arg("dt_before"), nb::arg("force_scale"), nb::arg("velocity_scale"),
          nb::kw_only(), nb::arg("damping") = 0.0,
          "Advance as many cycles of dt [s] from `time` as the scales have values; returns the cell that failed, or "
          "-1, and "
          "what its law told: done, if it is turned inside out.")
      .def("energies", &SolidLoop::energies, nb::arg("dt"), nb::arg("dt_before"), nb::kw_only(),
           nb::arg("damping") = 0.0, nb::arg("force_scale") = 1.0, nb::arg("velocity_scale") = 1.0,
           "Energies at the present time.")
      .def(
          "bound_frequencies",
          [](const SolidLoop& self) {
            double* squared;
            auto array = new_array({count_cells(self)}, &squared);
            for (const auto& b : self.blocks) {
              b.bound_frequencies(self.nodes.data(), squared);
              squared += b.n();
            }
            return array;
          },
          "Bound of the squared highest frequency of each cell (n) [1/s2].")
      .def(
          "prescribe",
          [](SolidLoop& self, Bytes fixed, Doubles velocity) {
            const std::size_t size = 2 * std::size_t(self.n_nodes);
            require(fixed.size() == size && velocity.size() == size, "the arrays must have shape (n_nodes, 2)");
            self.prescribe(fixed.data(), velocity.data());
          },
          nb::arg("fixed"), nb::arg("velocity"), "Prescribe velocities of the freedoms marked in fixed (n_nodes, 2).")
      .def(
          "set_temperature",
          [](SolidLoop& self, Doubles degrees) {
            require(degrees.size() == count_cells(self), "temperature must have shape (n)");
            const double* from = degrees.data();
            for (auto& b : self.blocks) b.set_temperature(from), from += b.n();
          },
          nb::arg("temperature"), "Give the cells temperatures (n) [degrees C] from now on.")
      .def("weigh", &SolidLoop::weigh, "Sum up the nodes' masses after a change of mass_factor.")
      .def_prop_ro(
          "mass", [](const SolidLoop& self) { return copy(self.mass, {std::size_t(self.n_nodes)}); },
          nb::rv_policy::move, "Mass of each node (n_nodes) [t].")
      .def_prop_ro(
          "cell_mass",
          [](const SolidLoop& self) {
            std::vector<double> all;
            for (const auto& b : self.blocks)
              for (int i = 0; i < b.n(); ++i) {
                const auto first = b.mass.begin() + std::ptrdiff_t(i) * b.nodes_each();
                all.push_back(std::accumulate(first, first + b.nodes_each(), 0.0));
              }
            return copy(all, {all.size()});
          },
          nb::rv_policy::move, "True mass of each cell (n) [t], without what scaling adds.")
      .def_prop_rw(
          "work",
          [](const SolidLoop& self) {
            return std::array<double, 4>{self.work.external, self.work.damping, self.work.contact, self.work.friction};
          },
          [](SolidLoop& self, std::array<double, 4> w) { self.work = {w[0], w[1], w[2], w[3]}; },
          "Work up to half a step back: external, damping, contact, friction [N mm].");
  bind_field<&SolidLoop::nodes, SolidBlock::node_record>(c, "position", "Positions (n_nodes, 2) [mm].");
  bind_field<&SolidLoop::velocity, 2>(c, "velocity", "Velocities (n_nodes, 2), half a step back [mm/s].");
  bind_field<&SolidLoop::force, 2>(c, "force", "Nodal forces from outside (n_nodes, 2) [N].");
  bind_field<&SolidLoop::internal_force, 2>(c, "internal_force", "Internal forces (n_nodes, 2) [N].");
  c.def_prop_rw(
      "reaction_impulse",
      [](const SolidLoop& self) { return copy(self.reaction_impulse, {std::size_t(self.n_nodes), 2}); },
      [](SolidLoop& self, Doubles x) { assign(self.reaction_impulse, x, "the impulse must have shape (n_nodes, 2)"); },
      nb::rv_policy::move,
      "Impulse of what holds prescribed freedoms (n_nodes, 2), added up until it is set to zero [N s].");
  c.def_prop_rw(
      "mass_factor",
      [](const SolidLoop& self) {
        std::vector<double> all;
        for (const auto& b : self.blocks) all.insert(all.end(), b.mass_factor.begin(), b.mass_factor.end());
        return copy(all, {all.size()});
      },
      [](SolidLoop& self, Doubles x) {
        require(x.size() == count_cells(self), "the array must have one value a cell");
        const double* from = x.data();
        for (auto& b : self.blocks) {
          std::copy_n(from, b.n(), b.mass_factor.begin());
          from += b.n();
        }
      },
      nb::rv_policy::move, "Mass of each cell over its true one (n); then call weigh.");
  c.def_prop_rw(
      "kept",
      [](const SolidLoop& self) {
        std::vector<double> all;
        for (const auto& b : self.blocks)
          for (int e = 0; e < b.n(); ++e)
            for (int row = CycleRow::count; row < b.rows(); ++row) all.push_back(b.value(e, row));
        return copy(all, {all.size()});
      },
      [](SolidLoop& self, Doubles x) {
        std::size_t size = 0;
        for (const auto& b : self.blocks) size += std::size_t(b.n()) * (b.rows() - CycleRow::count);
        require(x.size() == size, "kept does not belong to these cells and laws");
        const double* from = x.data();
        for (auto& b : self.blocks)
          for (int e = 0; e < b.n(); ++e)
            for (int row = CycleRow::count; row < b.rows(); ++row) b.set_value(e, row, *from++);
      },
      nb::rv_policy::move, "What the laws keep besides, cell after cell of all blocks (n).");
  bind_cells<CycleRow::stress, 4>(c, "stress", "Stress xx, yy, zz, xy (n, 4) [MPa].");
  bind_cells<CycleRow::eqps, 1>(c, "eqps", "Equivalent plastic strain (n).");
  bind_cells<CycleRow::rise, 1>(c, "rise", "Rise of temperature since the start (n).");
  bind_cells<CycleRow::hourglass, 2>(c, "hourglass", "Hourglass forces (n, 2) [N].");
  bind_cells<CycleRow::work, 2>(c, "cell_work", "Work of stress and of hourglass control (n, 2) [N mm].");
}

}  // namespace presswork::bindings
