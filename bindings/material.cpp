// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "material/von_mises.hpp"

namespace presswork::bindings {

void bind_material(nb::module_& m) {
  nb::enum_<HardeningLaw>(m, "HardeningLaw", "Flow stress against equivalent plastic strain.")
      .value("linear", HardeningLaw::linear)
      .value("swift", HardeningLaw::swift)
      .value("ludwik", HardeningLaw::ludwik)
      .value("voce", HardeningLaw::voce)
      .value("linear_voce", HardeningLaw::linear_voce)
      .value("hockett_sherby", HardeningLaw::hockett_sherby)
      .value("table", HardeningLaw::table)
      .value("swift_voce", HardeningLaw::swift_voce)
      .value("monotone_table", HardeningLaw::monotone_table);
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

  nb::class_<VonMises>(m, "VonMises", "Isotropic elasticity with von Mises plasticity; stresses in MPa.")
      .def(
          "__init__",
          [](VonMises* self, double young, double poisson, HardeningLaw hardening, std::vector<double> parameters,
             Integrator integrator, int substeps, Modulus modulus) {
            new (self) VonMises{young, poisson, {hardening, std::move(parameters)}, integrator, substeps, modulus};
          },
          nb::arg("young"), nb::arg("poisson"), nb::arg("hardening"), nb::arg("parameters"), nb::kw_only(),
          nb::arg("integrator") = Integrator::backward_euler, nb::arg("substeps") = 10,
          nb::arg("modulus") = Modulus::consistent)
      .def(
          "flow_stress",
          [](const VonMises& law, Doubles eqps) {
            double *flow, *slope;
            auto flows = new_array({eqps.size()}, &flow);
            auto slopes = new_array({eqps.size()}, &slope);
            for (std::size_t i = 0; i < eqps.size(); ++i) law.hardening.evaluate(eqps.data()[i], flow[i], slope[i]);
            return std::make_tuple(flows, slopes);
          },
          nb::arg("eqps"), "Flow stress and its slope [MPa] at equivalent plastic strains (n).")
      .def(
          "update",
          [](const VonMises& law, Doubles strain, Doubles stress, Doubles eqps) {
            const std::size_t n = eqps.size();
            require(strain.size() == 4 * n && stress.size() == 4 * n, "strain and stress must have shape (n, 4)");
            double *new_stress, *new_eqps, *tangent;
            auto stresses = new_array({n, 4}, &new_stress);
            auto strains = new_array({n}, &new_eqps);
            auto tangents = new_array({n, 4, 4}, &tangent);
            for (std::size_t i = 0; i < n; ++i) {
              PointState<double> point;
              for (int k = 0; k < 4; ++k) point.stress[k] = stress.data()[4 * i + k];
              point.eqps = eqps.data()[i];
              update_von_mises(law, strain.data() + 4 * i, point, reinterpret_cast<double (*)[4]>(tangent + 16 * i));
              for (int k = 0; k < 4; ++k) new_stress[4 * i + k] = point.stress[k];
              new_eqps[i] = point.eqps;
            }
            return std::make_tuple(stresses, strains, tangents);
          },
          nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"),
          "Advance points by strain increments (n, 4); returns stress (n, 4), eqps (n) and tangent (n, 4, 4).");
}

}  // namespace presswork::bindings
