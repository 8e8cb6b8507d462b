// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/variant.h>

#include <algorithm>

#include "arrays.hpp"
#include "explicit/plane/loop.hpp"
#include "explicit_loop.hpp"
#include "explicit_walls.hpp"
#include "neighbours.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;

NewDoubles copy(const std::vector<double>& from, const std::vector<std::size_t>& shape) {
  double* to;
  auto array = new_array(shape, &to);
  std::copy(from.begin(), from.end(), to);
  return array;
}

// Rows of the state of all cells of all blocks (n, width).
template <int row, int width>
void bind_cells(nb::class_<PlaneLoop>& c, const char* name, const char* text) {
  c.def_prop_ro(
      name,
      [](const PlaneLoop& self) {
        const std::size_t n = self.n_elements();
        double* to;
        auto array = width > 1 ? new_array({n, std::size_t(width)}, &to) : new_array({n}, &to);
        for (const auto& block : self.blocks)
          for (int e = 0; e < block->n(); ++e)
            for (int i = 0; i < width; ++i) *to++ = block->value(e, row + i);
        return array;
      },
      nb::rv_policy::move, text);
}

// A PlaneLaw looks its hardening up in a table.
PlaneSolidLaw choose_law(std::variant<const Owned<AdiabaticMises>*, const Owned<PlaneLaw>*, const Umat*> given,
                         double young, double poisson) {
  if (const auto* mises = std::get_if<const Owned<AdiabaticMises>*>(&given)) return **mises;
  if (const auto* umat = std::get_if<const Umat*>(&given)) return own_umat<4>(**umat, young, poisson);
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
          [](Law* self, const Owned<VonMises>& mises, RateLaw rate, std::map<std::string, double> parameters,
             double start, double reference, double melting, double exponent, double heating) {
            auto table = std::make_shared<const HardeningTable>(mises.view.hardening);
            AdiabaticMises made{mises.view, {}, {{reference, melting, exponent}, start, heating}, table->view()};
            require(make_alternative(static_cast<int>(rate), parameters, made.rate.law),
                    "rate_parameters are not those of the law: see parameter_names");
            new (self) Law{made, mises.data};
            self->data.push_back(std::move(table));
          },
          nb::arg("mises"), nb::kw_only(), nb::arg("rate") = RateLaw{},
          nb::arg("rate_parameters") = std::map<std::string, double>{}, nb::arg("start") = 0.0,
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

double* points_of(const PlaneLoop& self, std::vector<double>& points) {
  for (int i = 0; i < self.nodes.n; ++i)
    for (int k = 0; k < 2; ++k)
      points.push_back(self.nodes.position.data()[PlaneNodes::position_stride * std::size_t(i) + k]);
  return points.data();
}

void bind_walls(nb::class_<PlaneLoop>& c) {
  c.def(
       "add_wall",
       [](PlaneLoop& self, Doubles segments, double mu) {
         require(segments.ndim() == 2 && segments.shape(1) == 7 && segments.shape(0) > 0,
                 "segments must have shape (n > 0, 7)");
         self.add_wall({segments.data(), segments.data() + segments.size()}, mu);
       },
       nb::arg("segments"), nb::kw_only(), nb::arg("mu") = 0.0, "Add a rigid profile; they are numbered as they come.")
      .def(
          "wall_force",
          [](const PlaneLoop& self, int wall) {
            return copy(wall_of(self, wall).force, {std::size_t(self.nodes.n), 2});
          },
          nb::arg("wall"), "Forces of a wall on the nodes (n_nodes, 2) in the last cycle.")
      .def(
          "wall_offset",
          [](const PlaneLoop& self, int wall) {
            const double* at = wall_of(self, wall).offset;
            return std::array<double, 2>{at[0], at[1]};
          },
          nb::arg("wall"), "Displacement of a wall since the start [mm].")
      .def(
          "wall_impulse",
          [](const PlaneLoop& self, int wall) {
            const double* sum = wall_of(self, wall).impulse;
            return std::array<double, 2>{sum[0], sum[1]};
          },
          nb::arg("wall"), "Impulse of a wall on the nodes since the start [N s].")
      .def(
          "wall_pressed",
          [](const PlaneLoop& self, int wall) {
            return copy(wall_of(self, wall).pressed, {std::size_t(self.nodes.n)});
          },
          nb::arg("wall"), "Impulse of a wall's pressure on the nodes since begin_wall_sums (n_nodes) [N s].")
      .def(
          "wall_rubbed",
          [](const PlaneLoop& self, int wall) { return copy(wall_of(self, wall).rubbed, {std::size_t(self.nodes.n)}); },
          nb::arg("wall"), "Work that friction on a wall has taken at the nodes since then (n_nodes) [N mm].")
      .def(
          "move_wall",
          [](PlaneLoop& self, int wall, std::array<double, 2> velocity) {
            std::copy_n(velocity.begin(), 2, wall_of(self, wall).velocity);
          },
          nb::arg("wall"), nb::arg("velocity"), "Set a wall's velocity [mm/s].");
}

}  // namespace

void bind_explicit_plane(nb::module_& m) {
  bind_law(m);
  nb::class_<PlaneLoop> c(m, "PlaneLoop", "Central differences for solids in the plane; mm, s, t, N, MPa.");
  c.def(
       "__init__",
       [](PlaneLoop* self, Doubles points, Bytes contact, bool axisymmetric, double depth, double hourglass_fraction) {
         require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n_nodes, 2)");
         require(contact.size() == points.shape(0), "contact must have shape (n_nodes)");
         new (self) PlaneLoop(static_cast<int>(points.shape(0)), points.data(), contact.data(),
                              {axisymmetric, depth, hourglass_fraction});
       },
       nb::arg("points"), nb::arg("contact"), nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth") = 1.0,
       nb::arg("hourglass_fraction") = 0.05)
      .def(
          "add_solids",
          [](PlaneLoop& self, const std::string& element, Ints cells,
             std::variant<const Owned<AdiabaticMises>*, const Owned<PlaneLaw>*, const Umat*> law, double density,
             const std::vector<double>& kept, double young, double poisson) {
            std::vector<int> list(cells.data(), cells.data() + cells.size());
            for (int node : list) require(node >= 0 && node < self.nodes.n, "cells name a node that is not there");
            std::vector<double> points;
            self.add_solids(element, std::move(list), points_of(self, points), choose_law(law, young, poisson), density,
                            kept);
          },
          nb::arg("element"), nb::arg("cells"), nb::arg("law"), nb::arg("density"), nb::kw_only(), nb::arg("kept"),
          nb::arg("young") = 0.0, nb::arg("poisson") = 0.0,
          "Add cells (n, nodes) of tri3 or quad4_1pt; they are numbered as they come. kept: what the law keeps besides "
          "plastic strain and rise of temperature, before the first cycle. young, poisson: of a law from a shared "
          "library.")
      .def(
          "restore",
          [](PlaneLoop& self, const explicit_loop::State& given) {
            explicit_loop::check(self, given);
            explicit_loop::write(self, given);
          },
          nb::arg("state"), "Take over what state gave.")
      .def_prop_ro(
          "mass", [](const PlaneLoop& self) { return copy(self.nodes.mass, {std::size_t(self.nodes.n)}); },
          nb::rv_policy::move, "Mass of each node (n_nodes) [t].");
  bind_loop(c);
  bind_contacts(c);
  bind_wall_sums(c);
  bind_walls(c);
  bind_join(c);
  bind_cells<CycleRow::stress, 4>(c, "stress", "Stress xx, yy, zz, xy (n, 4) [MPa].");
  bind_cells<CycleRow::eqps, 1>(c, "eqps", "Equivalent plastic strain (n).");
  bind_cells<CycleRow::rise, 1>(c, "rise", "Rise of temperature since the start (n).");
}

}  // namespace presswork::bindings
