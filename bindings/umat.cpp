// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "element/umat_response.hpp"

namespace presswork::bindings {

void bind_umat(nb::module_& m) {
  nb::enum_<UmatJacobian>(m, "UmatJacobian", "What a UMAT's DDSDDE is the derivative of.")
      .value("stress_increment", UmatJacobian::stress_increment)
      .value("jaumann_kirchhoff", UmatJacobian::jaumann_kirchhoff);
  nb::enum_<LawStatus>(m, "LawStatus", "How the call of a law ended.")
      .value("done", LawStatus::done)
      .value("smaller", LawStatus::smaller)
      .value("not_finite", LawStatus::not_finite)
      .value("overrun", LawStatus::overrun)
      .value("stopped", LawStatus::stopped)
      .value("no_stress", LawStatus::no_stress)
      .value("components", LawStatus::components);
  nb::class_<LawFault>(m, "LawFault", "The worst of what the calls of a law have told.")
      .def(nb::init<>())
      .def_ro("status", &LawFault::status)
      .def_ro("cell", &LawFault::cell, "In the block.")
      .def_ro("step_factor", &LawFault::step_factor, "Least PNEWDT.");
  nb::class_<UmatPlace>(m, "UmatPlace", "Which increment a UMAT is called in.")
      .def(
          "__init__",
          [](UmatPlace* self, int stage, int increment, double stage_time, double time, double dt) {
            new (self) UmatPlace;
            self->stage = stage, self->increment = increment;
            self->time[0] = stage_time, self->time[1] = time;
            self->dt = dt;
          },
          nb::kw_only(), nb::arg("stage") = 1, nb::arg("increment") = 1, nb::arg("stage_time") = 0.0,
          nb::arg("time") = 0.0, nb::arg("dt") = 1.0, "Counted from 1; times [s] are those of the increment's start.");
  nb::class_<Umat>(m, "Umat", "A material law from a shared library with Abaqus's UMAT interface.")
      .def(nb::init<const std::string&, const std::vector<double>&, int, UmatJacobian, bool, int>(), nb::arg("library"),
           nb::arg("properties"), nb::arg("n_state"), nb::kw_only(),
           nb::arg("jacobian") = UmatJacobian::stress_increment, nb::arg("thread_safe") = false,
           nb::arg("plastic_strain") = 0,
           "Open the library; raises RuntimeError that says what is missing. plastic_strain: which state variable is "
           "the equivalent plastic strain, from 1, or 0.")
      .def_static("make_gtn", &Umat::make_gtn, nb::arg("properties"),
                  "The law of a metal with pores; properties (20) as cpp/material/gtn.hpp has them.")
      .def_ro("n_state", &Umat::n_state)
      .def(
          "update",
          [](const Umat& law, Doubles strain, Doubles stress, Doubles state, double dt) {
            const int n = static_cast<int>(strain.size());
            require((n == 3 || n == 4 || n == 6) && stress.size() == strain.size(),
                    "strain and stress must have shape (3), (4) or (6)");
            require(state.size() == std::size_t(law.n_state), "state must have shape (n_state)");
            UmatPoint p{};
            std::copy_n(stress.data(), n, p.stress);
            std::copy_n(strain.data(), n, p.increment);
            for (int i : {0, 4, 8}) p.rotation[i] = p.F_n[i] = p.F[i] = 1.0;
            const int normal = n == 3 ? 2 : 3;
            for (int i = 0; i < normal; ++i) p.F[4 * i] += strain.data()[i];
            for (int k = normal; k < n; ++k) {
              const int i = voigt_row(k - normal + 3), j = voigt_column(k - normal + 3);
              p.F[i + 3 * j] = p.F[j + 3 * i] = 0.5 * strain.data()[k];
            }
            UmatPlace place;
            place.dt = dt;
            double *new_stress, *new_state, *tangent;
            auto stresses = new_array({stress.size()}, &new_stress);
            auto states = new_array({state.size()}, &new_state);
            auto tangents = new_array({stress.size(), stress.size()}, &tangent);
            std::copy_n(state.data(), state.size(), new_state);
            const auto status = law.call(n, place, p, new_state);
            std::copy_n(p.stress, n, new_stress);
            for (int i = 0; i < n; ++i)
              for (int j = 0; j < n; ++j) tangent[n * i + j] = p.tangent[i + n * j];
            return std::make_tuple(status, stresses, states, tangents);
          },
          nb::arg("strain"), nb::arg("stress"), nb::arg("state"), nb::arg("dt") = 1.0,
          "Call it once at a small strain increment from no deformation: xx, yy, xy; xx, yy, zz, xy; or xx, yy, zz, "
          "xy, "
          "yz, zx (n). Returns status, stress (n), state (n_state) and tangent (n, n).");
}

}  // namespace presswork::bindings
