// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "arrays.hpp"
#include "explicit/loop.hpp"

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
auto update_fast(const FastLaw& self, Doubles strain, Doubles stress, Doubles eqps) {
  require(strain.ndim() == 2 && strain.shape(1) == 3, "strain must have shape (n, 3): xx, yy, xy");
  const std::size_t n = strain.shape(0);
  require(stress.ndim() == 2 && stress.shape(0) == n && stress.shape(1) == 3, "stress must have the shape of strain");
  require(eqps.size() == n, "eqps must have shape (n)");
  double *new_stress, *new_eqps, *thickness;
  auto stresses = new_array({n, 3}, &new_stress);
  auto plastic = new_array({n}, &new_eqps);
  auto thicknesses = new_array({n}, &thickness);
  for (std::size_t first = 0; first < n; first += pack_width) {
    Pack e[3], state[4];
    for (int lane = 0; lane < pack_width; ++lane) {
      const std::size_t i = std::min(first + lane, n - 1);
      const double *a = strain.data() + 3 * i, *b = stress.data() + 3 * i;
      e[0].set(lane, a[0] + a[1]), e[1].set(lane, a[0] - a[1]), e[2].set(lane, a[2]);
      state[0].set(lane, b[0] + b[1]), state[1].set(lane, b[0] - b[1]), state[2].set(lane, b[2]);
      state[3].set(lane, eqps.data()[i]);
    }
    const Pack across = self.law.advance(e[0], e[1], e[2], 0.0, state);
    for (std::size_t i = first; i < std::min(first + pack_width, n); ++i) {
      const int lane = static_cast<int>(i - first);
      new_stress[3 * i] = 0.5 * (state[0][lane] + state[1][lane]);
      new_stress[3 * i + 1] = 0.5 * (state[0][lane] - state[1][lane]);
      new_stress[3 * i + 2] = state[2][lane];
      new_eqps[i] = state[3][lane];
      thickness[i] = across[lane];
    }
  }
  return std::make_tuple(stresses, plastic, thicknesses);
}

ShellSection make_section(const SheetLaw& law, double density, std::vector<double> height, std::vector<double> weight,
                          bool tabulate, bool warped, bool viscous, std::array<double, 3> hourglass) {
  require(height.size() == weight.size() && !height.empty(), "height and weight must have the same length, not 0");
  ShellSection section{GeneralSheet{law}, {std::move(height), std::move(weight)}, density, warped, {}};
  if (tabulate)
    if (auto fast = find_fast_law(law)) section.law = std::move(*fast);
  section.control = {1.0, hourglass[0], hourglass[1], hourglass[2], viscous, density};
  return section;
}

void make_loop(ShellLoop* self, Doubles points, Ints connectivity, Doubles thickness, Doubles axis, const SheetLaw& law,
               double density, std::vector<double> height, std::vector<double> weight, bool tabulate, bool warped,
               bool viscous, std::array<double, 3> hourglass) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_nodes, 3)");
  require(connectivity.ndim() == 2 && connectivity.shape(1) == 4 && connectivity.shape(0) > 0,
          "connectivity must have shape (n, 4), n > 0");
  const std::size_t n = connectivity.shape(0), n_nodes = points.shape(0);
  require(thickness.size() == n, "thickness must have shape (n)");
  require(axis.ndim() == 2 && axis.shape(0) == n && axis.shape(1) == 3, "axis must have shape (n, 3)");
  std::vector<int> cells(connectivity.data(), connectivity.data() + 4 * n);
  for (int node : cells)
    require(node >= 0 && std::size_t(node) < n_nodes, "connectivity names a node that is not there");
  new (self)
      ShellLoop(static_cast<int>(n_nodes), points.data(),
                make_section(law, density, std::move(height), std::move(weight), tabulate, warped, viscous, hourglass),
                std::move(cells), thickness.data(), axis.data());
}

// Columns [first, first + width) of records of `stride` doubles as an array (n, width), and back.
NewDoubles get_columns(const AlignedArray& from, int n, int stride, int first, int width) {
  double* to;
  auto array = new_array({std::size_t(n), std::size_t(width)}, &to);
  for (int i = 0; i < n; ++i)
    std::memcpy(to + std::size_t(i) * width, from.data() + std::size_t(i) * stride + first, width * sizeof(double));
  return array;
}
void set_columns(AlignedArray& to, int n, int stride, int first, int width, Doubles from, const char* message) {
  require(from.ndim() == 2 && from.shape(0) == std::size_t(n) && from.shape(1) == std::size_t(width), message);
  for (int i = 0; i < n; ++i)
    std::memcpy(to.data() + std::size_t(i) * stride + first, from.data() + std::size_t(i) * width,
                width * sizeof(double));
}

NewDoubles copy_vector(const std::vector<double>& from, const std::vector<std::size_t>& shape) {
  double* to;
  auto array = new_array(shape, &to);
  std::memcpy(to, from.data(), from.size() * sizeof(double));
  return array;
}

NewDoubles rows_of(const ShellLoop& self, int first, int count) {
  double* to;
  auto array = new_array({std::size_t(self.shells.n()), std::size_t(count)}, &to);
  for (int e = 0; e < self.shells.n(); ++e)
    for (int r = 0; r < count; ++r) *to++ = self.shells.value(e, first + r);
  return array;
}

// Stress (n, points, 3) as xx, yy, xy.
NewDoubles stress_of(const ShellLoop& self) {
  double* to;
  const auto& shells = self.shells;
  auto array = new_array({std::size_t(shells.n()), std::size_t(shells.points()), 3}, &to);
  for (int e = 0; e < shells.n(); ++e)
    for (int k = 0; k < shells.points(); ++k, to += 3) {
      const int row = shell4::head_rows + k * shells.law_rows();
      const double sum = shells.value(e, row), difference = shells.value(e, row + 1);
      to[0] = 0.5 * (sum + difference), to[1] = 0.5 * (sum - difference), to[2] = shells.value(e, row + 2);
    }
  return array;
}

NewDoubles history_of(const ShellLoop& self) {
  double* to;
  const auto& shells = self.shells;
  const int size = shells.law_rows() - 3;
  auto array = new_array({std::size_t(shells.n()), std::size_t(shells.points()), std::size_t(size)}, &to);
  for (int e = 0; e < shells.n(); ++e)
    for (int k = 0; k < shells.points(); ++k)
      for (int r = 0; r < size; ++r) *to++ = shells.value(e, shell4::head_rows + k * shells.law_rows() + 3 + r);
  return array;
}

// What the internal force would be after an increment of displacement and rotation, positions and state unchanged.
NewDoubles trial_force(ShellLoop& self, Doubles increment) {
  const auto n = std::size_t(self.nodes.n);
  const std::vector<double> state(self.shells.state().data(), self.shells.state().data() + self.shells.state().size());
  const std::vector<double> motion(self.nodes.motion.data(), self.nodes.motion.data() + 8 * n);
  const std::vector<double> position(self.nodes.position.data(), self.nodes.position.data() + 4 * n);
  const std::vector<double> forces = self.internal_force;
  set_columns(self.nodes.motion, self.nodes.n, 8, 0, 6, increment, "increment must have shape (n_nodes, 6)");
  for (std::size_t i = 0; i < n; ++i)
    for (int j = 0; j < 3; ++j) self.nodes.position.data()[4 * i + j] += increment.data()[6 * i + j];
  self.advance_shells(1.0);
  auto array = copy_vector(self.internal_force, {n, 6});
  std::memcpy(self.shells.state().data(), state.data(), state.size() * sizeof(double));
  std::memcpy(self.nodes.motion.data(), motion.data(), motion.size() * sizeof(double));
  std::memcpy(self.nodes.position.data(), position.data(), position.size() * sizeof(double));
  self.internal_force = forces;
  return array;
}

void advance(ShellLoop& self, double dt, Doubles force_scale, Doubles velocity_scale, double damping) {
  require(force_scale.size() == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  nb::gil_scoped_release release;
  self.advance(static_cast<int>(force_scale.size()), dt, damping, force_scale.data(), velocity_scale.data());
}

auto dump(const ShellLoop& self) {
  const auto& state = self.shells.state();
  auto states = copy_vector(std::vector<double>(state.data(), state.data() + state.size()), {state.size()});
  auto forces = copy_vector(self.internal_force, {std::size_t(self.nodes.n), 6});
  return std::make_tuple(get_columns(self.nodes.position, self.nodes.n, 4, 0, 3),
                         get_columns(self.nodes.motion, self.nodes.n, 8, 0, 6), states, forces, self.work[0],
                         self.work[1]);
}

void restore(ShellLoop& self, Doubles position, Doubles velocity, Doubles state, Doubles forces, double external,
             double damping) {
  require(state.size() == self.shells.state().size() && forces.size() == self.internal_force.size(),
          "state does not belong to these shells, or was dumped on a machine with another SIMD width");
  set_columns(self.nodes.position, self.nodes.n, 4, 0, 3, position, "position must have shape (n_nodes, 3)");
  set_columns(self.nodes.motion, self.nodes.n, 8, 0, 6, velocity, "velocity must have shape (n_nodes, 6)");
  std::memcpy(self.shells.state().data(), state.data(), state.size() * sizeof(double));
  std::memcpy(self.internal_force.data(), forces.data(), forces.size() * sizeof(double));
  self.work[0] = external, self.work[1] = damping;
}

}  // namespace

void bind_explicit(nb::module_& m) {
  nb::class_<Energies>(m, "Energies", "Energies of an explicit run [N mm].")
      .def_ro("kinetic", &Energies::kinetic)
      .def_ro("internal", &Energies::internal)
      .def_ro("hourglass", &Energies::hourglass)
      .def_ro("external", &Energies::external)
      .def_ro("damping", &Energies::damping);

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
          "update", &update_fast, nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"),
          "Advance points by strain increments (n, 3); returns stress (n, 3), equivalent plastic strain (n), thickness "
          "strain increment (n).");

  nb::class_<ShellLoop>(m, "ShellLoop", "Central differences for one-point shells; mm, s, t, N, MPa.")
      .def("__init__", &make_loop, nb::arg("points"), nb::arg("connectivity"), nb::arg("thickness"), nb::arg("axis"),
           nb::arg("law"), nb::arg("density"), nb::arg("height"), nb::arg("weight"), nb::kw_only(),
           nb::arg("tabulate") = true, nb::arg("warped") = false, nb::arg("viscous") = false,
           nb::arg("hourglass") = std::array<double, 3>{0.03, 0.03, 0.03})
      .def("advance", &advance, nb::arg("dt"), nb::arg("force_scale"), nb::arg("velocity_scale"), nb::kw_only(),
           nb::arg("damping") = 0.0, "Advance as many cycles of dt [s] as the scales have values.")
      .def("energies", &ShellLoop::energies, nb::arg("dt"), nb::kw_only(), nb::arg("damping") = 0.0,
           nb::arg("force_scale") = 1.0, nb::arg("velocity_scale") = 1.0, "Energies at the present time.")
      .def("trial_force", &trial_force, nb::arg("increment"),
           "Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.")
      .def_prop_ro(
          "internal_force",
          [](const ShellLoop& self) { return copy_vector(self.internal_force, {std::size_t(self.nodes.n), 6}); },
          nb::rv_policy::move, "Internal force [N] and moment [N mm] (n_nodes, 6).")
      .def("dump", &dump, "Position, velocity, element state, internal force, external work, damping.")
      .def("restore", &restore, nb::arg("position"), nb::arg("velocity"), nb::arg("state"), nb::arg("forces"),
           nb::arg("external"), nb::arg("damping"), "Take over what dump gave.")
      .def(
          "bound_frequencies",
          [](const ShellLoop& self) {
            double* squared;
            auto array = new_array({std::size_t(self.shells.n())}, &squared);
            self.shells.bound_frequencies(self.nodes, squared);
            return array;
          },
          "Bound of the squared highest frequency of each element [1/s2].")
      .def_prop_rw(
          "position", [](const ShellLoop& self) { return get_columns(self.nodes.position, self.nodes.n, 4, 0, 3); },
          [](ShellLoop& self, Doubles x) {
            set_columns(self.nodes.position, self.nodes.n, 4, 0, 3, x, "position must have shape (n_nodes, 3)");
          },
          nb::rv_policy::move, "Positions (n_nodes, 3) [mm].")
      .def_prop_rw(
          "velocity", [](const ShellLoop& self) { return get_columns(self.nodes.motion, self.nodes.n, 8, 0, 6); },
          [](ShellLoop& self, Doubles v) {
            set_columns(self.nodes.motion, self.nodes.n, 8, 0, 6, v, "velocity must have shape (n_nodes, 6)");
          },
          nb::rv_policy::move, "Velocities and angular velocities (n_nodes, 6), half a step back [mm/s, 1/s].")
      .def_prop_ro(
          "inverse_mass", [](const ShellLoop& self) { return get_columns(self.nodes.motion, self.nodes.n, 8, 6, 2); },
          nb::rv_policy::move, "Inverse of mass [t] and of rotary inertia [t mm2] (n_nodes, 2); 0 where there is none.")
      .def_prop_rw(
          "force", [](const ShellLoop& self) { return copy_vector(self.force, {std::size_t(self.nodes.n), 6}); },
          [](ShellLoop& self, Doubles f) {
            require(f.size() == self.force.size(), "force must have shape (n_nodes, 6)");
            std::memcpy(self.force.data(), f.data(), f.size() * sizeof(double));
          },
          nb::rv_policy::move, "Nodal forces and moments from outside (n_nodes, 6) [N, N mm].")
      .def(
          "prescribe",
          [](ShellLoop& self, Bytes fixed, Doubles velocity) {
            require(fixed.size() == self.fixed.size() && velocity.size() == self.prescribed.size(),
                    "fixed and velocity must have shape (n_nodes, 6)");
            std::memcpy(self.fixed.data(), fixed.data(), fixed.size());
            std::memcpy(self.prescribed.data(), velocity.data(), velocity.size() * sizeof(double));
          },
          nb::arg("fixed"), nb::arg("velocity"), "Prescribe velocities of the freedoms marked in fixed (n_nodes, 6).")
      .def_prop_rw(
          "element_mass",
          [](ShellLoop& self) { return copy_vector(self.shells.mass(), {std::size_t(self.shells.n())}); },
          [](ShellLoop& self, Doubles mass) {
            require(mass.size() == self.shells.mass().size(), "element_mass must have shape (n)");
            std::memcpy(self.shells.mass().data(), mass.data(), mass.size() * sizeof(double));
            self.set_masses();
          },
          nb::rv_policy::move, "Mass of each element (n) [t]; setting it sets the nodes' masses.")
      .def_prop_ro("stress", &stress_of, nb::rv_policy::move,
                   "Stress xx, yy, xy of the layers (n, points, 3) in the law's frame [MPa].")
      .def_prop_ro("history", &history_of, nb::rv_policy::move,
                   "What the law keeps at each layer (n, points, size); first eqps.")
      .def_prop_ro(
          "thickness", [](const ShellLoop& self) { return rows_of(self, shell4::thickness, 1); }, nb::rv_policy::move,
          "Thickness (n, 1) [mm].");
}

}  // namespace presswork::bindings
