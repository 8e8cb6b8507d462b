// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "material/von_mises.hpp"

namespace presswork::bindings {

namespace {

template <int N>
auto update_mises_in(const VonMises& law, Doubles strain, Doubles stress, Doubles eqps) {
  const std::size_t n = eqps.size();
  double *new_stress, *new_eqps, *tangent;
  auto stresses = new_array({n, N}, &new_stress);
  auto strains = new_array({n}, &new_eqps);
  auto tangents = new_array({n, N, N}, &tangent);
  for (std::size_t i = 0; i < n; ++i) {
    LawInput<N, double> in;
    double s0[N + 1], s1[N + 1];
    for (int k = 0; k < N; ++k) in.strain[k] = strain.data()[N * i + k], s0[k] = stress.data()[N * i + k];
    s0[N] = eqps.data()[i];
    update(law, in, s0, s1, reinterpret_cast<double (*)[N]>(tangent + N * N * i));
    for (int k = 0; k < N; ++k) new_stress[N * i + k] = s1[k];
    new_eqps[i] = s1[N];
  }
  return std::make_tuple(stresses, strains, tangents);
}

auto update_mises(const Owned<VonMises>& law, Doubles strain, Doubles stress, Doubles eqps) {
  const std::size_t n = eqps.size();
  if (strain.size() == 6 * n && stress.size() == 6 * n) return update_mises_in<6>(law.view, strain, stress, eqps);
  require(strain.size() == 4 * n && stress.size() == 4 * n, "strain and stress must have shape (n, 4) or (n, 6)");
  return update_mises_in<4>(law.view, strain, stress, eqps);
}

}  // namespace

void bind_material(nb::module_& m) {
  nb::enum_<HardeningLaw> laws(m, "HardeningLaw", "Flow stress against equivalent plastic strain.");
  for_each_alternative<Hardening::Law>(
      [&](std::size_t index, auto law) { laws.value(law.name, static_cast<HardeningLaw>(index)); });
  for_each_alternative<HotHardening::Law>(
      [&](std::size_t index, auto law) { laws.value(law.name, static_cast<HardeningLaw>(cold_laws + index)); });
  m.def(
      "parameter_names",
      [](HardeningLaw which) {
        const auto index = static_cast<std::size_t>(which);
        return index < cold_laws ? parameter_names<Hardening::Law>(index)
                                 : parameter_names<HotHardening::Law>(index - cold_laws);
      },
      nb::arg("law"),
      "Names of a hardening law's parameters, in the order in which they are given; a table has points.");
  m.def(
      "is_hot", [](HardeningLaw which) { return static_cast<std::size_t>(which) >= cold_laws; }, nb::arg("law"),
      "Whether its flow stress is one of strain, strain rate and temperature together.");
  nb::enum_<Integrator>(m, "Integrator", "Stress integrator of the von Mises law.")
      .value("backward_euler", Integrator::backward_euler)
      .value("radial_return", Integrator::radial_return)
      .value("direct", Integrator::direct)
      .value("tangent_radial_return", Integrator::tangent_radial_return)
      .value("secant", Integrator::secant)
      .value("substepping", Integrator::substepping);
  nb::enum_<Modulus>(m, "Modulus", "Derivative of the integrator, or the rate equation's matrix.")
      .value("consistent", Modulus::consistent)
      .value("continuum", Modulus::continuum);

  using Law = Owned<VonMises>;
  nb::class_<Law>(m, "VonMises", "Isotropic elasticity with von Mises plasticity; stresses in MPa.")
      .def(
          "__init__",
          [](Law* self, double young, double poisson, HardeningLaw hardening, std::vector<double> parameters,
             Integrator integrator, int substeps, Modulus modulus) {
            Law made{{young, poisson, {}, integrator, substeps, modulus}};
            require(make_hardening(hardening, std::move(parameters), made.view.hardening, made.data),
                    "the parameters are not those of the hardening law");
            new (self) Law(std::move(made));
          },
          nb::arg("young"), nb::arg("poisson"), nb::arg("hardening"), nb::arg("parameters"), nb::kw_only(),
          nb::arg("integrator") = Integrator::backward_euler, nb::arg("substeps") = 10,
          nb::arg("modulus") = Modulus::consistent)
      .def(
          "flow_stress",
          [](const Law& law, Doubles eqps) {
            double *flow, *slope;
            auto flows = new_array({eqps.size()}, &flow);
            auto slopes = new_array({eqps.size()}, &slope);
            for (std::size_t i = 0; i < eqps.size(); ++i)
              law.view.hardening.evaluate(eqps.data()[i], flow[i], slope[i]);
            return std::make_tuple(flows, slopes);
          },
          nb::arg("eqps"), "Flow stress and its slope [MPa] at equivalent plastic strains (n).")
      .def("update", &update_mises, nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"),
           "Advance points by strain increments (n, 4), or (n, 6) in space: xx, yy, zz, xy, yz, zx; returns stress, "
           "eqps (n) and tangent (n, 4, 4) or (n, 6, 6).");
}

}  // namespace presswork::bindings
