// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>

#include <algorithm>
#include <cstring>

#include "arrays.hpp"
#include "material/anisotropic_law.hpp"

namespace presswork::bindings {

namespace {

using Array8 = std::array<double, 8>;

HillParameters hill_from(const std::array<double, 6>& c) { return {c[0], c[1], c[2], c[3], c[4], c[5]}; }

PlaneStressYield barlat_from(double a, double c, double h, double p, int exponent) {
  require(exponent == 6 || exponent == 8, "exponent must be 6 or 8");
  if (exponent == 6) return make_barlat1989<3>(a, c, h, p);
  return make_barlat1989<4>(a, c, h, p);
}

PlaneStressYield yld2000_from(const Array8& alpha, int exponent) {
  require(exponent == 6 || exponent == 8, "exponent must be 6 or 8");
  if (exponent == 6) return make_yld2000<3>(alpha.data());
  return make_yld2000<4>(alpha.data());
}

struct YieldFunction {
  PlaneStressYield yield;
};

auto evaluate_yield(const YieldFunction& self, Doubles stress) {
  require(stress.ndim() == 2 && stress.shape(1) == 3, "stress must have shape (n, 3): xx, yy, xy");
  const std::size_t n = stress.shape(0);
  double *value, *gradient, *hessian;
  auto values = new_array({n}, &value);
  auto gradients = new_array({n, 3}, &gradient);
  auto hessians = new_array({n, 3, 3}, &hessian);
  std::visit(
      [&](const auto& yield) {
        for (std::size_t i = 0; i < n; ++i) {
          YieldTerms<3, double> terms;
          yield.evaluate(stress.data() + 3 * i, terms);
          value[i] = terms.value;
          std::memcpy(gradient + 3 * i, terms.gradient, sizeof terms.gradient);
          std::memcpy(hessian + 9 * i, terms.hessian, sizeof terms.hessian);
        }
      },
      self.yield);
  return std::make_tuple(values, gradients, hessians);
}

template <int N>
auto update_arrays(const AnisotropicLaw<N>& law, Doubles strain, Doubles stress, Doubles history, double dt,
                   std::optional<Doubles> softening, bool with_tangent, bool packed) {
  require(strain.ndim() == 2 && strain.shape(1) == N, N == 3 ? "strain must have shape (n, 3): xx, yy, xy"
                                                             : "strain must have shape (n, 6): xx, yy, zz, xy, yz, zx");
  const std::size_t n = strain.shape(0), size = law.history_size();
  require(stress.ndim() == 2 && stress.shape(0) == n && stress.shape(1) == N, "stress must have the shape of strain");
  require(history.ndim() == 2 && history.shape(0) == n && history.shape(1) == size,
          "history must have shape (n, history_size)");
  require(!softening || softening->size() == n, "softening must have shape (n)");
  double *new_stress, *new_history, *thickness, *tangent = nullptr;
  auto stresses = new_array({n, N}, &new_stress);
  auto histories = new_array({n, size}, &new_history);
  auto thicknesses = new_array({N == 3 ? n : 0}, &thickness);
  auto tangents = new_array({with_tangent ? n : 0, N, N}, &tangent);
  std::uint8_t* failed = new std::uint8_t[n]();
  nb::capsule owner(failed, [](void* p) noexcept { delete[] static_cast<std::uint8_t*>(p); });
  std::memcpy(new_stress, stress.data(), N * n * sizeof(double));
  std::memcpy(new_history, history.data(), size * n * sizeof(double));
  const std::vector<double> ones(softening ? 0 : n, 1.0);
  update_points(law, n, strain.data(), dt, softening ? softening->data() : ones.data(), new_stress, new_history,
                thickness, with_tangent ? tangent : nullptr, failed, packed);
  const std::size_t shape[1] = {n};
  return std::make_tuple(stresses, histories, thicknesses, tangents,
                         nb::ndarray<nb::numpy, std::uint8_t>(failed, 1, shape, owner));
}

template <int N>
NewDoubles differentiate(const AnisotropicLaw<N>& law, Doubles strain, Doubles stress, Doubles history, double dt) {
  using D = Dual<double, N>;
  require(strain.ndim() == 2 && strain.shape(1) == N, "strain must have shape (n, N)");
  const std::size_t n = strain.shape(0), size = law.history_size();
  require(stress.size() == N * n && history.size() == size * n, "stress and history must be those of the points");
  double* derivative;
  auto derivatives = new_array({n, N, N}, &derivative);
  std::vector<D> h(size);
  for (std::size_t point = 0; point < n; ++point) {
    D e[N], s[N];
    for (int i = 0; i < N; ++i) {
      e[i] = D::variable(strain.data()[N * point + i], i);
      s[i] = D(stress.data()[N * point + i]);
    }
    for (std::size_t i = 0; i < size; ++i) h[i] = D(history.data()[size * point + i]);
    update_law<N, D>(law, e, dt, D(1.0), s, h.data(), nullptr);
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) derivative[N * (N * point + i) + j] = s[i].slope[j];
  }
  return derivatives;
}

template <int N, class Yield>
void make_law(AnisotropicLaw<N>* self, double young, double poisson, const Yield& yield, HardeningLaw hardening,
              std::vector<double> parameters, RateLaw rate, std::array<double, 2> rate_parameters,
              std::optional<Chaboche> chaboche, std::optional<YoshidaUemori> yoshida_uemori, double young_saturated,
              double young_rate) {
  require(!(chaboche && yoshida_uemori), "give chaboche or yoshida_uemori, not both");
  KinematicLaw kinematic;
  if (chaboche) kinematic = *chaboche;
  if (yoshida_uemori) kinematic = *yoshida_uemori;
  new (self)
      AnisotropicLaw<N>{young,     poisson,
                        yield,     {{hardening, std::move(parameters)}, {rate, rate_parameters[0], rate_parameters[1]}},
                        kinematic, young_saturated,
                        young_rate};
}

template <int N>
auto evaluate_flow(const AnisotropicLaw<N>& law, Doubles eqps, double rate) {
  double *flow, *slope;
  auto flows = new_array({eqps.size()}, &flow);
  auto slopes = new_array({eqps.size()}, &slope);
  double factor, factor_slope;
  law.flow.rate.evaluate(rate, factor, factor_slope);
  for (std::size_t first = 0; first < eqps.size(); first += pack_width) {
    const int lanes = static_cast<int>(std::min<std::size_t>(pack_width, eqps.size() - first));
    Pack p(eqps.data()[first]), f, s;
    for (int lane = 0; lane < lanes; ++lane) p.set(lane, eqps.data()[first + lane]);
    law.flow.hardening.evaluate(p, f, s);
    for (int lane = 0; lane < lanes; ++lane) {
      flow[first + lane] = factor * f[lane];
      slope[first + lane] = factor * s[lane];
    }
  }
  return std::make_tuple(flows, slopes);
}

template <int N>
auto evaluate_rate(const AnisotropicLaw<N>& law, Doubles rate) {
  double *factor, *slope;
  auto factors = new_array({rate.size()}, &factor);
  auto slopes = new_array({rate.size()}, &slope);
  for (std::size_t i = 0; i < rate.size(); ++i) law.flow.rate.evaluate(rate.data()[i], factor[i], slope[i]);
  return std::make_tuple(factors, slopes);
}

// What SheetLaw and SolidLaw share; make takes the yield function as Python gives it.
template <int N, class Given, class Make>
void bind_law(nb::module_& m, const char* name, const char* doc, const char* update_doc, Make make) {
  using Law = AnisotropicLaw<N>;
  nb::class_<Law>(m, name, doc)
      .def(
          "__init__",
          [make](Law* self, double young, double poisson, const Given& yield, HardeningLaw hardening,
                 std::vector<double> parameters, RateLaw rate, std::array<double, 2> rate_parameters,
                 std::optional<Chaboche> chaboche, std::optional<YoshidaUemori> yoshida_uemori, double young_saturated,
                 double young_rate) {
            make_law(self, young, poisson, make(yield), hardening, std::move(parameters), rate, rate_parameters,
                     std::move(chaboche), yoshida_uemori, young_saturated, young_rate);
          },
          nb::arg("young"), nb::arg("poisson"), nb::arg("yield_function"), nb::arg("hardening"), nb::arg("parameters"),
          nb::kw_only(), nb::arg("rate") = RateLaw::none, nb::arg("rate_parameters") = std::array<double, 2>{0.0, 1.0},
          nb::arg("chaboche") = nb::none(), nb::arg("yoshida_uemori") = nb::none(), nb::arg("young_saturated") = 0.0,
          nb::arg("young_rate") = 0.0)
      .def_ro("young", &Law::young, "Young's modulus at the start [MPa].")
      .def_ro("poisson", &Law::poisson, "Poisson's ratio.")
      .def_prop_ro("history_size", &Law::history_size, "Values a point keeps: eqps, then back stresses.")
      .def("flow_stress", &evaluate_flow<N>, nb::arg("eqps"), nb::arg("rate") = 0.0,
           "Flow stress and its slope [MPa] at equivalent plastic strains (n) and a plastic strain rate [1/s].")
      .def("rate_factor", &evaluate_rate<N>, nb::arg("rate"),
           "Factor on the flow stress and its slope [s] at equivalent plastic strain rates (n) [1/s].")
      .def("differentiate", &differentiate<N>, nb::arg("strain"), nb::arg("stress"), nb::arg("history"), nb::kw_only(),
           nb::arg("dt") = 1.0, "d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.")
      .def("update", &update_arrays<N>, nb::arg("strain"), nb::arg("stress"), nb::arg("history"), nb::kw_only(),
           nb::arg("dt") = 1.0, nb::arg("softening") = nb::none(), nb::arg("tangent") = true, nb::arg("packed") = true,
           update_doc);
}

}  // namespace

void bind_anisotropic(nb::module_& m) {
  nb::enum_<RateLaw>(m, "RateLaw", "Factor on the flow stress by strain rate.")
      .value("none", RateLaw::none)
      .value("cowper_symonds", RateLaw::cowper_symonds)
      .value("johnson_cook", RateLaw::johnson_cook)
      .value("logarithmic", RateLaw::logarithmic);

  nb::class_<YieldFunction>(m, "YieldFunction", "Equivalent stress in plane stress, homogeneous of degree one.")
      .def_static(
          "hill1948", [](std::array<double, 6> c) { return YieldFunction{hill_from(c).plane_stress()}; },
          nb::arg("parameters"), "Hill 1948 from F, G, H, L, M, N; von Mises is 1/2, 1/2, 1/2, 3/2, 3/2, 3/2.")
      .def_static(
          "barlat1989",
          [](double a, double c, double h, double p, int exponent) {
            return YieldFunction{barlat_from(a, c, h, p, exponent)};
          },
          nb::arg("a"), nb::arg("c"), nb::arg("h"), nb::arg("p"), nb::arg("exponent"),
          "Barlat & Lian 1989; the exponent is 6 or 8.")
      .def_static(
          "yld2000", [](Array8 alpha, int exponent) { return YieldFunction{yld2000_from(alpha, exponent)}; },
          nb::arg("alpha"), nb::arg("exponent"), "Yld2000-2d from alpha 1 to 8; the exponent is 6 or 8.")
      .def("evaluate", &evaluate_yield, nb::arg("stress"),
           "Equivalent stress (n), its gradient (n, 3) and Hessian (n, 3, 3) at stresses (n, 3): xx, yy, xy.");

  nb::class_<Chaboche>(m, "Chaboche", "Back stresses d a = C (stress - back)/flow dp - gamma a dp.")
      .def(
          "__init__",
          [](Chaboche* self, std::vector<double> C, std::vector<double> gamma) {
            require(C.size() == gamma.size(), "C and gamma must have the same length");
            new (self) Chaboche{std::move(C), std::move(gamma)};
          },
          nb::arg("C"), nb::arg("gamma"));
  nb::class_<YoshidaUemori>(m, "YoshidaUemori", "Two surfaces: Yoshida & Uemori 2002; stresses in MPa.")
      .def(
          "__init__",
          [](YoshidaUemori* self, double Y, double B, double C, double m, double b, double Rsat, double h) {
            new (self) YoshidaUemori{Y, B, C, m, b, Rsat, h};
          },
          nb::kw_only(), nb::arg("Y"), nb::arg("B"), nb::arg("C"), nb::arg("m"), nb::arg("b"), nb::arg("Rsat"),
          nb::arg("h"));

  bind_law<3, YieldFunction>(
      m, "SheetLaw", "Elastic-plastic sheet in plane stress; stresses in MPa.",
      "Advance points by strain increments (n, 3) over dt [s]; returns stress (n, 3), history (n, history_size), "
      "thickness strain increment (n), tangent (n, 3, 3; (0, 3, 3) if not asked for) and failed (n).",
      [](const YieldFunction& given) { return given.yield; });
  bind_law<6, std::array<double, 6>>(
      m, "SolidLaw", "Elastic-plastic solid, Hill 1948 from F, G, H, L, M, N; stresses in MPa.",
      "Advance points by strain increments (n, 6): xx, yy, zz, xy, yz, zx; as SheetLaw.update, without thickness.",
      [](const std::array<double, 6>& given) { return std::variant<QuadraticYield<6>>(hill_from(given).solid()); });
}

}  // namespace presswork::bindings
