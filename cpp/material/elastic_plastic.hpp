// SPDX-License-Identifier: Apache-2.0
// Elastic-plastic laws with any yield function, isotropic and kinematic hardening, strain rate and temperature:
// SheetLaw in plane stress (what a shell or membrane calls), PlaneLaw in plane strain and axisymmetry, SolidLaw in
// space. The contract is that of law.hpp; a shell adds elastic transverse shear of its own.
//
// State: stress (N), equivalent plastic strain, where the law heats the rise of temperature, then what kinematic.hpp
// keeps, with phases the strain and the K phi of the last increment (MixturePlace), and where elasticity depends on
// temperature that of the last increment, less that of the start. In plane stress update_sheet gives the thickness
// strain besides: elastic and plastic, volume kept by the plastic part.
#pragma once

#include "material/law_data.hpp"
#include "material/return_mapping.hpp"
#include "material/thermoelastic.hpp"
#include "material/yield_functions.hpp"

namespace presswork {

template <int N>
struct ElasticPlastic {
  double young = 0.0;  // [MPa]
  double poisson = 0.0;
  typename YieldChoice<N>::type yield = {};
  Flow flow = {};
  KinematicLaw kinematic = {};
  double young_saturated = 0.0;  // Young's modulus after large plastic strain [MPa]
  Thermoelastic thermoelastic = {};
  bool phases = false;      // whether the input may have a mixture; without a back stress, and not in plane stress
  double young_rate = 0.0;  // E = Ea + (E0 - Ea) exp(-rate p), p of the start of the increment; 0 keeps E0

  PRESSWORK_DEVICE int history_size() const {  // values behind the stress
    return 1 + (flow.thermal.heats() ? 1 : 0) +
           choose(kinematic, [](const auto& k) { return k.template history_size<N>(); }) + (phases ? 2 : 0) +
           (thermoelastic.active() ? 1 : 0);
  }
  // Where a state has what the law keeps of the mixture.
  PRESSWORK_DEVICE int mixture_at() const { return state_size() - 2 - (thermoelastic.active() ? 1 : 0); }
  PRESSWORK_DEVICE int state_size() const { return N + history_size(); }
  PRESSWORK_DEVICE double shear_modulus() const { return young / (2.0 * (1.0 + poisson)); }
  PRESSWORK_DEVICE double bulk_modulus() const { return young / (3.0 * (1.0 - 2.0 * poisson)); }

  template <class T>
  PRESSWORK_DEVICE T young_at(T eqps) const {
    if (young_rate == 0.0) return T(young);
    return T(young_saturated) + T(young - young_saturated) * exponential(T(-young_rate) * eqps);
  }
  // Whole temperature of a point in state s0 at a given one, and that of its last increment.
  template <class T>
  PRESSWORK_DEVICE T temperature_now(T given, const T* s0) const {
    return flow.thermal.heats() ? given + s0[N + 1] : given;
  }
  template <class T>
  PRESSWORK_DEVICE T temperature_before(const T* s0) const {
    return T(flow.thermal.start) + s0[state_size() - 1];
  }
  template <class T>
  PRESSWORK_DEVICE Elasticity<N, T> elasticity(T eqps) const {
    return {young_at(eqps), poisson};
  }
  template <class T>
  PRESSWORK_DEVICE Elasticity<N, T> elasticity(T eqps, T temperature) const {
    const T E = young_at(eqps) * thermoelastic.young_factor_at(temperature);
    return {E, thermoelastic.poisson_at(poisson, temperature)};
  }
  // Whether mises_sheet.hpp serves: von Mises without back stress, whose flow stress is smooth and does not heat
  // itself.
  PRESSWORK_DEVICE bool is_plain() const {
    const auto* quadratic = std::get_if<QuadraticYield<N>>(&yield);
    if (!quadratic || flow.hot.active() || flow.thermal.heats() || kinematic.index() != 0) return false;
    const auto& P = quadratic->P;
    return P[0][0] == 1.0 && P[1][1] == 1.0 && P[0][1] == -0.5 && P[1][0] == -0.5 && P[2][2] == 3.0;
  }
  // Flow stress and its slope at equivalent plastic strain p, at rest.
  template <class T>
  PRESSWORK_DEVICE void flow_at_rest(T p, T temperature, T& flow_stress, T& slope) const {
    flow.at_rest(p, temperature, flow_stress, slope);
  }
};

// Lets a law look its hardening up in a table where that follows it closely: what the explicit loops do.
template <int N>
void tabulate(Owned<ElasticPlastic<N>>& law) {
  if (law.view.flow.hot.active()) return;
  auto table = std::make_shared<const HardeningTable>(law.view.flow.hardening);
  if (!(table->error() < 1e-5)) return;
  law.view.flow.tabulated = true, law.view.flow.table = table->view();
  law.data.push_back(std::move(table));
}

using SheetLaw = ElasticPlastic<3>;
using PlaneLaw = ElasticPlastic<4>;
using SolidLaw = ElasticPlastic<6>;

// T is double, Pack or, for tests of the tangent, Dual<double, N>.
// Compiled once for all that call it: a card's kernels share it, too.
template <int N, class T>
[[gnu::noinline]] PRESSWORK_DEVICE Mask<T> update(const ElasticPlastic<N>& law, const LawInput<N, T>& in, const T* s0,
                                                  T* s1, T (*tangent)[N]);

// a CUDA compiler needs those of double for the card (elastic_plastic_update.hpp)
#if !defined(__CUDACC__)
extern template bool update(const SheetLaw&, const LawInput<3, double>&, const double*, double*, double (*)[3]);
extern template bool update(const PlaneLaw&, const LawInput<4, double>&, const double*, double*, double (*)[4]);
extern template bool update(const SolidLaw&, const LawInput<6, double>&, const double*, double*, double (*)[6]);
extern template Mask<Pack> update(const SheetLaw&, const LawInput<3, Pack>&, const Pack*, Pack*, Pack (*)[3]);
extern template Mask<Pack> update(const PlaneLaw&, const LawInput<4, Pack>&, const Pack*, Pack*, Pack (*)[4]);
extern template Mask<Pack> update(const SolidLaw&, const LawInput<6, Pack>&, const Pack*, Pack*, Pack (*)[6]);
#endif

// Values behind the stress that a law keeps at most.
template <int N>
inline constexpr int most_kept = 3 + N * Chaboche::most;

// A point as it is when temperature and phases have changed and nothing has moved: elasticity at present, strain of
// free growth, temperature, and in `state` s0 with the stress that the moduli make of it.
//
// Transformation plasticity, strain = 1.5 K dphi s with the deviator s of the end, divides shear modulus and deviator
// by 1 + 3 G K dphi before the return to yield, which with its tangent stays as it is. A flow stress of `flow` times
// the law's is one whose stresses and moduli are divided by it: what the law answers is multiplied by `flow`.
template <int N, class T>
struct Heated {
  Elasticity<N, T> before, elastic;
  T thermal, temperature, flow = T(1.0), state[N + most_kept<N>];

  PRESSWORK_DEVICE Heated(const ElasticPlastic<N>& law, T given, const T* s0, const T* mixture = nullptr)
      : before(law.elasticity(s0[N], law.temperature_before(s0))),
        elastic(law.elasticity(s0[N], law.temperature_now(given, s0))),
        thermal(law.thermoelastic.strain(law.temperature_before(s0), law.temperature_now(given, s0))),
        temperature(law.temperature_now(given, s0)) {
    T strain[N];
    before.compliance(s0, strain);
    elastic.stiffness(strain, state);
    for (int i = N; i < law.state_size(); ++i) state[i] = s0[i];
    if constexpr (N > 3)
      if (mixture) transform(law, s0, mixture);
  }
  PRESSWORK_DEVICE void transform(const ElasticPlastic<N>& law, const T* s0, const T* mixture) {
    const T* kept = s0 + law.mixture_at();
    thermal += mixture[mixture_strain] - kept[mixture_strain];
    const T shear = elastic.shear, bulk = elastic.spread + T(2.0 / 3.0) * shear;
    const T less = T(1.0) / (T(1.0) + T(3.0) * shear * larger(mixture[mixture_trip] - kept[mixture_trip], T(0.0)));
    const T softer = less * shear, sum = T(3.0) * bulk + softer;
    flow = mixture[mixture_flow];
    elastic = Elasticity<N, T>(T(9.0) * bulk * softer / (sum * flow), T(0.5) * (sum - T(3.0) * softer) / sum);
    const T mean = T(1.0 / 3.0) * (state[0] + state[1] + state[2]);
    for (int i = 0; i < 3; ++i) state[i] = (mean + less * (state[i] - mean)) / flow;
    for (int i = 3; i < N; ++i) state[i] = less * state[i] / flow;
  }
  PRESSWORK_DEVICE void take_off(const T strain[N], T mechanical[N]) const {
    constexpr int normal = N == 3 ? 2 : 3;
    for (int i = 0; i < N; ++i) mechanical[i] = i < normal ? strain[i] - thermal : strain[i];
  }
};

// The same as update for plane stress, with the increment of thickness strain.
template <class T>
PRESSWORK_DEVICE Mask<T> update_sheet(const SheetLaw& law, const LawInput<3, T>& in, const T* s0, T* s1, T& thickness,
                                      T (*tangent)[3]) {
  const T before[3] = {s0[0], s0[1], s0[2]};
  if (law.thermoelastic.active()) {
    const Heated<3, T> heated(law, in.temperature, s0);
    T strain[3], e_n[3], e[3];
    heated.take_off(in.strain, strain);
    heated.before.compliance(before, e_n);
    auto failed = update(law, in, s0, s1, tangent);
    heated.elastic.compliance(s1, e);
    const auto across = [](const Elasticity<3, T>& m, const T x[3]) {
      return -m.poisson / (T(1.0) - m.poisson) * (x[0] + x[1]);
    };
    thickness = heated.thermal + across(heated.elastic, e) - across(heated.before, e_n) -
                (strain[0] + strain[1] - (e[0] + e[1] - e_n[0] - e_n[1]));
    return failed;
  }
  const Elasticity<3, T> elastic = law.elasticity(s0[3]);
  T change[3], elastic_strain[3];
  auto failed = update(law, in, s0, s1, tangent);
  for (int i = 0; i < 3; ++i) change[i] = s1[i] - before[i];
  elastic.compliance(change, elastic_strain);
  T across = elastic_strain[0] + elastic_strain[1];
  thickness = across * T(-law.poisson / (1.0 - law.poisson)) - (in.strain[0] + in.strain[1] - across);
  return failed;
}

// Arrays over n points: strain, stress (n, N), history (n, history_size), temperature (n), mixture (n, mixture_size) or
// null, tangent (n, N, N) or null, failed (n); thickness (n) for N = 3, else null. Stress and history are advanced in
// place. By packs, or a point at a time.
template <int N>
void update_points(const ElasticPlastic<N>& law, std::size_t n, const double* strain, double dt,
                   const double* temperature, const double* mixture, double* stress, double* history, double* thickness,
                   double* tangent, std::uint8_t* failed, bool packed);

extern template void update_points(const SheetLaw&, std::size_t, const double*, double, const double*, const double*,
                                   double*, double*, double*, double*, std::uint8_t*, bool);
extern template void update_points(const PlaneLaw&, std::size_t, const double*, double, const double*, const double*,
                                   double*, double*, double*, double*, std::uint8_t*, bool);
extern template void update_points(const SolidLaw&, std::size_t, const double*, double, const double*, const double*,
                                   double*, double*, double*, double*, std::uint8_t*, bool);

// d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.
template <int N>
void differentiate_points(const ElasticPlastic<N>& law, std::size_t n, const double* strain, double dt,
                          const double* temperature, const double* mixture, const double* stress, const double* history,
                          double* derivative);

extern template void differentiate_points(const SheetLaw&, std::size_t, const double*, double, const double*,
                                          const double*, const double*, const double*, double*);
extern template void differentiate_points(const PlaneLaw&, std::size_t, const double*, double, const double*,
                                          const double*, const double*, const double*, double*);
extern template void differentiate_points(const SolidLaw&, std::size_t, const double*, double, const double*,
                                          const double*, const double*, const double*, double*);

}  // namespace presswork
