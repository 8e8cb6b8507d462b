// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "material/von_mises.hpp"

namespace presswork::bindings {

namespace {

template <int N>
std::tuple<NewDoubles, NewDoubles, NewDoubles> update_points(const VonMises& law, Doubles strain, Doubles stress,
                                                             Doubles eqps) {
  const std::size_t n = eqps.size();
  double *new_stress, *new_eqps, *tangent;
  auto stresses = new_array({n, N}, &new_stress);
  auto strains = new_array({n}, &new_eqps);
  auto tangents = new_array({n, N, N}, &tangent);
  for (std::size_t i = 0; i < n; ++i) {
    PointState<double, N> point;
    double increment[N];
    for (int k = 0; k < N; ++k) point.stress[k] = stress.data()[N * i + k], increment[k] = strain.data()[N * i + k];
    point.eqps = eqps.data()[i];
    update_von_mises(law, increment, point, reinterpret_cast<double (*)[N]>(tangent + N * N * i));
    for (int k = 0; k < N; ++k) new_stress[N * i + k] = point.stress[k];
    new_eqps[i] = point.eqps;
  }
  return {stresses, strains, tangents};
}

}  // namespace

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
            require(strain.ndim() == 2 && (strain.shape(1) == 4 || strain.shape(1) == 6) &&
                        strain.shape(0) == eqps.size() && stress.size() == strain.size(),
                    "strain and stress must have shape (n, 4) or (n, 6)");
            return strain.shape(1) == 6 ? update_points<6>(law, strain, stress, eqps)
                                        : update_points<4>(law, strain, stress, eqps);
          },
          nb::arg("strain"), nb::arg("stress"), nb::arg("eqps"),
          "Advance points by strain increments (n, N), N = 4 (xx, yy, zz, xy) or 6 (and yz, zx); returns stress (n, "
          "N), "
          "eqps (n) and tangent (n, N, N).");
}

}  // namespace presswork::bindings
