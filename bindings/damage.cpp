// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/map.h>

#include <algorithm>

#include "arrays.hpp"
#include "material/damage.hpp"

namespace presswork::bindings {

namespace {

// Damage of n points at the end of an increment: by the trapezoidal rule in the equivalent plastic strain, by its end's
// stress where a point has not flowed before.
template <int N>
void advance_points(const Damage& law, std::size_t n, const double* stress_n, const double* stress,
                    const double* eqps_n, const double* eqps, const double* temperature, double dt, double* value) {
  for (std::size_t i = 0; i < n; ++i) {
    const double strain = eqps[i] - eqps_n[i];
    if (!(strain > 0.0)) continue;
    const auto measure = [&](const double* of) {
      auto at = damage::measure_stress<N>(of + N * i);
      at.rate = dt > 0.0 ? strain / dt : 0.0;
      at.temperature = temperature ? temperature[i] : 0.0;
      return law.per_strain(at);
    };
    const double end = measure(stress);
    value[i] += (eqps_n[i] > 0.0 ? 0.5 * (measure(stress_n) + end) : end) * strain;
  }
}

auto advance_damage(const Damage& law, Doubles value_n, Doubles stress_n, Doubles stress, Doubles eqps_n, Doubles eqps,
                    double dt, std::optional<Doubles> temperature) {
  const std::size_t n = value_n.size();
  require(stress.ndim() == 2 && stress.shape(0) == n && stress_n.size() == stress.size(),
          "stress must have shape (n, 3), (n, 4) or (n, 6)");
  require(eqps_n.size() == n && eqps.size() == n && (!temperature || temperature->size() == n),
          "plastic strains and temperature must have shape (n,)");
  double* value;
  auto result = new_array({n}, &value);
  std::copy_n(value_n.data(), n, value);
  const auto advance = [&]<int N>() {
    advance_points<N>(law, n, stress_n.data(), stress.data(), eqps_n.data(), eqps.data(),
                      temperature ? temperature->data() : nullptr, dt, value);
  };
  if (stress.shape(1) == 3)
    advance.template operator()<3>();
  else if (stress.shape(1) == 4)
    advance.template operator()<4>();
  else if (stress.shape(1) == 6)
    advance.template operator()<6>();
  else
    require(false, "stress must have shape (n, 3), (n, 4) or (n, 6)");
  return result;
}

}  // namespace

void bind_damage(nb::module_& m) {
  nb::enum_<DamageCriterion> criteria(m, "DamageCriterion", "Criterion of ductile fracture.");
  for_each_alternative<Damage::Law>(
      [&](std::size_t index, auto law) { criteria.value(law.name, static_cast<DamageCriterion>(index)); });
  nb::class_<Damage>(m, "Damage", "Damage that grows with plastic strain and does not act back.")
      .def(
          "__init__",
          [](Damage* self, DamageCriterion criterion, const std::map<std::string, double>& parameters) {
            Damage made;
            require(make_alternative(static_cast<int>(criterion), parameters, made.law),
                    "the parameters are not those of the criterion");
            new (self) Damage(made);
          },
          nb::arg("criterion"), nb::arg("parameters"))
      .def("advance", &advance_damage, nb::arg("value_n"), nb::arg("stress_n"), nb::arg("stress"), nb::arg("eqps_n"),
           nb::arg("eqps"), nb::kw_only(), nb::arg("dt"), nb::arg("temperature") = nb::none(),
           "Damage (n,) of points after an increment of dt [s]: stresses (n, 3 | 4 | 6) [MPa] and equivalent plastic "
           "strains (n,) at its start and end, temperature (n,) [degrees C].");
}

}  // namespace presswork::bindings
