// SPDX-License-Identifier: Apache-2.0
#include "material/elastic_plastic.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>

#include <algorithm>
#include <cstring>

#include "arrays.hpp"

namespace presswork::bindings {

namespace {

using Nine = std::array<double, 9>;

// A yield function in every number of components in which it exists.
struct YieldFunction {
  YieldChoice<3>::type sheet;
  std::optional<YieldChoice<4>::type> plane = {};
  std::optional<YieldChoice<6>::type> solid = {};

  template <int N>
  const typename YieldChoice<N>::type& in() const {
    if constexpr (N == 3) {
      return sheet;
    } else {
      require(solid.has_value(), "this yield function exists in plane stress alone");
      if constexpr (N == 4)
        return *plane;
      else
        return *solid;
    }
  }
};

YieldFunction make_hill(const std::array<double, 6>& c) {
  const HillParameters hill{c[0], c[1], c[2], c[3], c[4], c[5]};
  return {hill.plane_stress(), hill.solid<4>(), hill.solid<6>()};
}

YieldFunction make_barlat1989(double a, double c, double h, double p, int exponent) {
  require(exponent == 6 || exponent == 8, "exponent must be 6 or 8");
  if (exponent == 6) return {presswork::make_barlat1989<3>(a, c, h, p)};
  return {presswork::make_barlat1989<4>(a, c, h, p)};
}

YieldFunction make_yld2000(const std::array<double, 8>& alpha, int exponent) {
  require(exponent == 6 || exponent == 8, "exponent must be 6 or 8");
  if (exponent == 6) return {presswork::make_yld2000<3>(alpha.data())};
  return {presswork::make_yld2000<4>(alpha.data())};
}

YieldFunction make_yld2004(const Nine& prime, const Nine& double_prime, int exponent) {
  require(exponent == 6 || exponent == 8, "exponent must be 6 or 8");
  const auto named = [](const Nine& c) {
    return Yld2004Coefficients{c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]};
  };
  const Yld2004Coefficients one = named(prime), two = named(double_prime);
  if (exponent == 6) return {Yld2004<3, 6>(one, two), Yld2004<4, 6>(one, two), Yld2004<6, 6>(one, two)};
  return {Yld2004<3, 8>(one, two), Yld2004<4, 8>(one, two), Yld2004<6, 8>(one, two)};
}

template <int N>
auto evaluate_yield_in(const YieldFunction& self, Doubles stress) {
  const std::size_t n = stress.shape(0);
  double *value, *gradient, *hessian;
  auto values = new_array({n}, &value);
  auto gradients = new_array({n, N}, &gradient);
  auto hessians = new_array({n, N, N}, &hessian);
  choose(self.in<N>(), [&](const auto& yield) {
    for (std::size_t i = 0; i < n; ++i) {
      YieldTerms<N, double> terms;
      yield.evaluate(stress.data() + N * i, terms);
      value[i] = terms.value;
      std::memcpy(gradient + N * i, terms.gradient, sizeof terms.gradient);
      std::memcpy(hessian + N * N * i, terms.hessian, sizeof terms.hessian);
    }
  });
  return std::make_tuple(values, gradients, hessians);
}

auto evaluate_yield(const YieldFunction& self, Doubles stress) {
  require(stress.ndim() == 2, "stress must have shape (n, 3), (n, 4) or (n, 6)");
  if (stress.shape(1) == 4) return evaluate_yield_in<4>(self, stress);
  if (stress.shape(1) == 6) return evaluate_yield_in<6>(self, stress);
  require(stress.shape(1) == 3, "stress must have shape (n, 3), (n, 4) or (n, 6)");
  return evaluate_yield_in<3>(self, stress);
}

// Temperatures (n), or those of the start of the run.
std::vector<double> temperatures(const Thermal& thermal, const std::optional<Doubles>& given, std::size_t n) {
  require(!given || given->size() == n, "temperature must have shape (n)");
  if (!given) return std::vector<double>(n, thermal.start);
  return {given->data(), given->data() + n};
}

template <int N>
auto update_arrays(const Owned<ElasticPlastic<N>>& owned, Doubles strain, Doubles stress, Doubles history, double dt,
                   std::optional<Doubles> temperature, bool with_tangent, bool packed, std::optional<Doubles> mixture) {
  const ElasticPlastic<N>& law = owned.view;
  require(strain.ndim() == 2 && strain.shape(1) == N, "strain must have shape (n, N)");
  const std::size_t n = strain.shape(0), size = law.history_size();
  require(stress.ndim() == 2 && stress.shape(0) == n && stress.shape(1) == N, "stress must have the shape of strain");
  require(history.ndim() == 2 && history.shape(0) == n && history.shape(1) == size,
          "history must have shape (n, history_size)");
  require(!mixture || mixture->size() == mixture_size * n, "mixture must have shape (n, 3)");
  double *new_stress, *new_history, *thickness, *tangent = nullptr;
  auto stresses = new_array({n, N}, &new_stress);
  auto histories = new_array({n, size}, &new_history);
  auto thicknesses = new_array({N == 3 ? n : 0}, &thickness);
  auto tangents = new_array({with_tangent ? n : 0, N, N}, &tangent);
  std::uint8_t* failed = new std::uint8_t[n]();
  nb::capsule owner(failed, [](void* p) noexcept { delete[] static_cast<std::uint8_t*>(p); });
  std::memcpy(new_stress, stress.data(), N * n * sizeof(double));
  std::memcpy(new_history, history.data(), size * n * sizeof(double));
  const std::vector<double> degrees = temperatures(law.flow.thermal, temperature, n);
  update_points(law, n, strain.data(), dt, degrees.data(), mixture ? mixture->data() : nullptr, new_stress, new_history,
                thickness, with_tangent ? tangent : nullptr, failed, packed);
  const std::size_t shape[1] = {n};
  return std::make_tuple(stresses, histories, thicknesses, tangents,
                         nb::ndarray<nb::numpy, std::uint8_t>(failed, 1, shape, owner));
}

template <int N>
NewDoubles differentiate(const Owned<ElasticPlastic<N>>& law, Doubles strain, Doubles stress, Doubles history,
                         double dt, std::optional<Doubles> temperature, std::optional<Doubles> mixture) {
  require(strain.ndim() == 2 && strain.shape(1) == N, "strain must have shape (n, N)");
  const std::size_t n = strain.shape(0), size = law.view.history_size();
  require(stress.size() == N * n && history.size() == size * n, "stress and history must be those of the points");
  require(!mixture || mixture->size() == mixture_size * n, "mixture must have shape (n, 3)");
  double* derivative;
  auto derivatives = new_array({n, N, N}, &derivative);
  const std::vector<double> degrees = temperatures(law.view.flow.thermal, temperature, n);
  differentiate_points(law.view, n, strain.data(), dt, degrees.data(), mixture ? mixture->data() : nullptr,
                       stress.data(), history.data(), derivative);
  return derivatives;
}

template <int N>
auto evaluate_flow(const Owned<ElasticPlastic<N>>& law, Doubles eqps, std::optional<Doubles> rate,
                   std::optional<Doubles> temperature) {
  const std::size_t n = eqps.size();
  const Flow& flow_law = law.view.flow;
  require(!rate || rate->size() == n, "rate must have shape (n)");
  double *flow, *slope;
  auto flows = new_array({n}, &flow);
  auto slopes = new_array({n}, &slope);
  const std::vector<double> degrees = temperatures(flow_law.thermal, temperature, n);
  for (std::size_t first = 0; first < n; first += pack_width) {
    const int lanes = static_cast<int>(std::min<std::size_t>(pack_width, n - first));
    Pack p(eqps.data()[first]), r(0.0), t(degrees[first]), f, s;
    for (int lane = 0; lane < lanes; ++lane) {
      p.set(lane, eqps.data()[first + lane]), t.set(lane, degrees[first + lane]);
      if (rate) r.set(lane, rate->data()[first + lane]);
    }
    flow_law.at_rate(p, r, t, f, s);
    for (int lane = 0; lane < lanes; ++lane) flow[first + lane] = f[lane], slope[first + lane] = s[lane];
  }
  return std::make_tuple(flows, slopes);
}

template <int N>
auto evaluate_rate(const Owned<ElasticPlastic<N>>& law, Doubles rate) {
  double *factor, *slope;
  auto factors = new_array({rate.size()}, &factor);
  auto slopes = new_array({rate.size()}, &slope);
  for (std::size_t i = 0; i < rate.size(); ++i) law.view.flow.rate.evaluate(rate.data()[i], factor[i], slope[i]);
  return std::make_tuple(factors, slopes);
}

TemperatureCurve make_curve(std::vector<double> given, std::vector<std::shared_ptr<const void>>& data) {
  require(given.size() % TemperatureCurve::columns == 0, "a curve of temperature has rows of four numbers");
  auto rows = std::make_shared<const std::vector<double>>(std::move(given));
  data.push_back(rows);
  return {rows->data(), static_cast<int>(rows->size() / TemperatureCurve::columns)};
}

template <int N>
void bind_law(nb::module_& m, const char* name, const char* doc, const char* update_doc) {
  using Law = Owned<ElasticPlastic<N>>;
  nb::class_<Law>(m, name, doc)
      .def(
          "__init__",
          [](Law* self, double young, double poisson, const YieldFunction& yield, HardeningLaw hardening,
             std::vector<double> parameters, RateLaw rate, std::map<std::string, double> rate_parameters,
             std::optional<Chaboche> chaboche, std::optional<YoshidaUemori> yoshida_uemori,
             std::optional<Thermal> thermal, double young_saturated, double young_rate, std::vector<double> expansion,
             std::vector<double> young_factor, std::vector<double> poisson_curve, bool phases) {
            require(!(chaboche && yoshida_uemori), "give chaboche or yoshida_uemori, not both");
            require(!phases || (N > 3 && !chaboche && !yoshida_uemori),
                    "phases are for solids without kinematic hardening");
            Law made;
            ElasticPlastic<N>& law = made.view;
            law.young = young, law.poisson = poisson, law.yield = yield.in<N>();
            law.young_saturated = young_saturated, law.young_rate = young_rate, law.phases = phases;
            const bool fits = static_cast<std::size_t>(hardening) < cold_laws
                                  ? make_hardening(hardening, std::move(parameters), law.flow.hardening, made.data)
                                  : make_hot_hardening(hardening, std::move(parameters), law.flow.hot, made.data);
            require(fits, "the parameters are not those of the hardening law");
            require(make_alternative(static_cast<int>(rate), rate_parameters, law.flow.rate.law),
                    "rate_parameters are not those of the law: see parameter_names");
            if (chaboche) law.kinematic = *chaboche;
            if (yoshida_uemori) law.kinematic = *yoshida_uemori;
            if (thermal) law.flow.thermal = *thermal;
            law.thermoelastic = {make_curve(std::move(expansion), made.data),
                                 make_curve(std::move(young_factor), made.data),
                                 make_curve(std::move(poisson_curve), made.data)};
            new (self) Law(std::move(made));
          },
          nb::arg("young"), nb::arg("poisson"), nb::arg("yield_function"), nb::arg("hardening"), nb::arg("parameters"),
          nb::kw_only(), nb::arg("rate") = RateLaw{}, nb::arg("rate_parameters") = std::map<std::string, double>{},
          nb::arg("chaboche") = nb::none(), nb::arg("yoshida_uemori") = nb::none(), nb::arg("thermal") = nb::none(),
          nb::arg("young_saturated") = 0.0, nb::arg("young_rate") = 0.0, nb::arg("expansion") = std::vector<double>{},
          nb::arg("young_factor") = std::vector<double>{}, nb::arg("poisson_curve") = std::vector<double>{},
          nb::arg("phases") = false,
          "expansion, young_factor, poisson_curve: rows of a temperature and c0, c1, c2 from there on. phases: whether "
          "points may be given a mixture: strain, K phi [1/MPa] and factor on the flow stress, each since the start.")
      .def_prop_ro(
          "young", [](const Law& law) { return law.view.young; }, "Young's modulus at the start [MPa].")
      .def_prop_ro(
          "poisson", [](const Law& law) { return law.view.poisson; }, "Poisson's ratio.")
      .def_prop_ro(
          "history_size", [](const Law& law) { return law.view.history_size(); },
          "Values a point keeps: eqps, the rise of temperature if the law heats, then back stresses.")
      .def_prop_ro(
          "heats", [](const Law& law) { return law.view.flow.thermal.heats(); },
          "Whether plastic work raises the temperature.")
      .def(
          "flow_stress", &evaluate_flow<N>, nb::arg("eqps"), nb::arg("rate") = nb::none(),
          nb::arg("temperature") = nb::none(),
          "Flow stress and its slope by plastic strain [MPa] at equivalent plastic strains (n), their rates (n) [1/s], "
          "without them at rest, and temperatures (n) [degrees C], without them that of the start.")
      .def("rate_factor", &evaluate_rate<N>, nb::arg("rate"),
           "Factor on the flow stress and its slope [s] at equivalent plastic strain rates (n) [1/s].")
      .def("differentiate", &differentiate<N>, nb::arg("strain"), nb::arg("stress"), nb::arg("history"), nb::kw_only(),
           nb::arg("dt") = 1.0, nb::arg("temperature") = nb::none(), nb::arg("mixture") = nb::none(),
           "d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.")
      .def("update", &update_arrays<N>, nb::arg("strain"), nb::arg("stress"), nb::arg("history"), nb::kw_only(),
           nb::arg("dt") = 1.0, nb::arg("temperature") = nb::none(), nb::arg("tangent") = true,
           nb::arg("packed") = true, nb::arg("mixture") = nb::none(), update_doc);
}

void bind_parts(nb::module_& m) {
  nb::enum_<RateLaw> rates(m, "RateLaw", "Factor on the flow stress by strain rate.");
  for_each_alternative<Rate::Law>(
      [&](std::size_t index, auto law) { rates.value(law.name, static_cast<RateLaw>(index)); });
  m.def(
      "parameter_names", [](RateLaw which) { return parameter_names<Rate::Law>(static_cast<std::size_t>(which)); },
      nb::arg("law"), "Names of a rate law's parameters.");

  nb::class_<YieldFunction>(m, "YieldFunction", "Equivalent stress, homogeneous of degree one.")
      .def_static("hill1948", &make_hill, nb::arg("parameters"),
                  "Hill 1948 from F, G, H, L, M, N; von Mises is 1/2, 1/2, 1/2, 3/2, 3/2, 3/2.")
      .def_static("barlat1989", &make_barlat1989, nb::arg("a"), nb::arg("c"), nb::arg("h"), nb::arg("p"),
                  nb::arg("exponent"), "Barlat & Lian 1989, of plane stress; the exponent is 6 or 8.")
      .def_static("yld2000", &make_yld2000, nb::arg("alpha"), nb::arg("exponent"),
                  "Yld2000-2d from alpha 1 to 8, of plane stress; the exponent is 6 or 8.")
      .def_static("yld2004", &make_yld2004, nb::arg("prime"), nb::arg("double_prime"), nb::arg("exponent"),
                  "Yld2004-18p from c12, c13, c21, c23, c31, c32, c44 (yz), c55 (zx), c66 (xy) of both "
                  "transformations; the exponent is 6 or 8.")
      .def_prop_ro(
          "of_plane_stress_alone", [](const YieldFunction& self) { return !self.solid.has_value(); },
          "Whether there is no such function of a stress in space.")
      .def("evaluate", &evaluate_yield, nb::arg("stress"),
           "Equivalent stress (n), its gradient (n, N) and Hessian (n, N, N) at stresses (n, N): xx, yy, xy; xx, yy, "
           "zz, xy; or xx, yy, zz, xy, yz, zx.");

  nb::class_<Chaboche>(m, "Chaboche", "Back stresses d a = C (stress - back)/flow dp - gamma a dp.")
      .def(
          "__init__",
          [](Chaboche* self, const std::vector<double>& C, const std::vector<double>& gamma) {
            require(C.size() == gamma.size(), "C and gamma must have the same length");
            require(C.size() <= Chaboche::most, "there is room for ten back stresses");
            new (self) Chaboche{static_cast<int>(C.size())};
            std::copy(C.begin(), C.end(), self->C);
            std::copy(gamma.begin(), gamma.end(), self->gamma);
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
  nb::class_<Thermal>(m, "Thermal", "Softening by temperature and adiabatic heating; degrees C.")
      .def(
          "__init__",
          [](Thermal* self, double start, double reference, double melting, double exponent, double heating) {
            new (self) Thermal{{reference, melting, exponent}, start, heating};
          },
          nb::kw_only(), nb::arg("start"), nb::arg("reference"), nb::arg("melting"), nb::arg("exponent"),
          nb::arg("heating"), "heating: rise of temperature per plastic work and volume [degree/MPa].");
}

}  // namespace

void bind_elastic_plastic(nb::module_& m) {
  bind_parts(m);
  bind_law<3>(m, "SheetLaw", "Elastic-plastic sheet in plane stress; stresses in MPa.",
              "Advance points by strain increments (n, 3) over dt [s] at temperatures (n), without them that of the "
              "start; returns stress (n, 3), history (n, history_size), thickness strain increment (n), tangent "
              "(n, 3, 3; (0, 3, 3) if not asked for) and failed (n).");
  bind_law<4>(m, "PlaneLaw", "Elastic-plastic solid in plane strain or axisymmetry; stresses in MPa.",
              "Advance points by strain increments (n, 4): xx, yy, zz, xy; as SheetLaw.update, without thickness.");
  bind_law<6>(m, "SolidLaw", "Elastic-plastic solid in space; stresses in MPa.",
              "Advance points by strain increments (n, 6): xx, yy, zz, xy, yz, zx; as SheetLaw.update, without "
              "thickness.");
}

}  // namespace presswork::bindings
