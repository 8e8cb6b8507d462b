// SPDX-License-Identifier: Apache-2.0
#include "tabulated_mises.hpp"

#include <algorithm>
#include <cmath>

namespace presswork::bindings {

bool is_fast(const SheetLaw& law) {
  const auto* quadratic = std::get_if<QuadraticYield<3>>(&law.yield);
  const bool isothermal =
      !law.flow.thermal.softening.active() && !law.flow.thermal.heats() && !law.thermoelastic.active();
  const bool plain = law.kinematic.index() == 0 && !law.flow.depends_on_rate() && law.young_rate == 0.0 && isothermal;
  const auto von_mises = HillParameters{}.plane_stress();
  if (!plain || !quadratic) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::fabs(quadratic->P[i][j] - von_mises.P[i][j]) > 1e-14) return false;
  return true;
}

std::optional<Owned<FastMises>> find_fast_law(const Owned<SheetLaw>& given) {
  const SheetLaw& law = given.view;
  if (!is_fast(law)) return std::nullopt;
  auto table = std::make_shared<const HardeningTable>(law.flow.hardening);
  return Owned<FastMises>{{law.young, law.poisson, table->view()}, {std::move(table)}};
}

namespace {

struct FastLaw {
  Owned<FastMises> law;
  std::shared_ptr<const HardeningTable> table() const {
    return std::static_pointer_cast<const HardeningTable>(law.data.front());
  }
};

// Points (n, 3) by packs: stress, equivalent plastic strain, thickness strain increment.
template <class Real>
void update_range(const FastMises& law, std::size_t n, const double* strain, const double* stress, const double* eqps,
                  double* new_stress, double* new_eqps, double* thickness) {
  using P = PackOf<Real>;
  for (std::size_t first = 0; first < n; first += P::width) {
    P e[3], state[4], rounding[4] = {P(0), P(0), P(0), P(0)};
    for (int lane = 0; lane < P::width; ++lane) {
      const std::size_t i = std::min(first + lane, n - 1);
      const double *a = strain + 3 * i, *b = stress + 3 * i;
      const double sums[3] = {a[0] + a[1], a[0] - a[1], a[2]}, kept[4] = {b[0] + b[1], b[0] - b[1], b[2], eqps[i]};
      for (int j = 0; j < 3; ++j) e[j].set(lane, static_cast<Real>(sums[j]));
      for (int j = 0; j < 4; ++j) state[j].set(lane, static_cast<Real>(kept[j]));
    }
    const P across = law.advance(e[0], e[1], e[2], LayerConditions<P>{0.0}, 0, state, rounding);
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
  update(self.law.view, n, strain.data(), stress.data(), eqps.data(), new_stress, new_eqps, thickness);
  return std::make_tuple(stresses, plastic, thicknesses);
}

}  // namespace

void bind_tabulated_mises(nb::module_& m) {
  m.def(
      "is_tabulated", [](const Owned<SheetLaw>& law) { return is_fast(law.view); }, nb::arg("law"),
      "Whether explicit shells take their stress from TabulatedMises: von Mises, isotropic hardening alone.");
  nb::class_<FastLaw>(m, "TabulatedMises",
                      "The explicit loop's von Mises update in plane stress; hardening from a table.")
      .def(
          "__init__",
          [](FastLaw* self, const Owned<SheetLaw>& law) {
            auto fast = find_fast_law(law);
            require(fast.has_value(), "the law must be von Mises with isotropic hardening alone");
            new (self) FastLaw{std::move(*fast)};
          },
          nb::arg("law"))
      .def_prop_ro(
          "table_error", [](const FastLaw& self) { return self.table()->error(); },
          "Largest error of the table, of the flow stress.")
      .def_prop_ro(
          "table_rows", [](const FastLaw& self) { return self.law.view.hardening.last + 1; },
          "Number of the table's intervals.")
      .def(
          "update", &update_fast, nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"), nb::kw_only(),
          nb::arg("single") = false,
          "Advance points by strain increments (n, 3); returns stress (n, 3), equivalent plastic strain (n), thickness "
          "strain increment (n).");
}

}  // namespace presswork::bindings
