// SPDX-License-Identifier: Apache-2.0
// The stress of a one-point solid in a cycle of the explicit loop, for each kind of law: what solid2d_one_point.hpp
// asks.
//
// A cell's state begins with the rows of CycleRow; those that a law keeps besides follow. advance_stress takes the
// state from t to t+dt but for the stress, which it gives in the axes of t, and tells the modulus of the hourglass
// control.
#pragma once

#include <vector>

#include "element/solid2d_forces.hpp"
#include "element/umat_response.hpp"
#include "material/adiabatic_mises.hpp"

namespace presswork {

// Stress xx, yy, zz, xy [MPa]; equivalent plastic strain; rise of temperature; hourglass forces [N]; work of the stress
// and of the hourglass forces [N mm].
struct CycleRow {
  enum : int { stress = 0, eqps = 4, rise = 5, hourglass = 6, work = 8, hourglass_work = 9, count = 10 };
};

// A law from a shared library, and what it is told of the cycle.
struct CycleUmat {
  const Umat* umat;
  double young, poisson;  // of its first tangent
};

// Which cells a pack has, when, and what the calls of their law told.
struct CyclePlace {
  int first = 0, used = pack_width;  // lanes beyond repeat the last cell
  double time = 0.0;                 // at the start [s]
  LawFault fault = {};
  const Pack* temperature = nullptr;  // given to the cells [degrees C]; null: that of the law's start
  Pack at[2] = {}, length = {};       // for laws from shared libraries: centre and size of the cell [mm]

  Pack temperature_or(double start) const { return temperature ? *temperature : Pack(start); }
};

inline int extra_rows(const AdiabaticMises&) { return 0; }
inline int extra_rows(const PlaneLaw& law) { return kept_values(law) - (law.flow.thermal.heats() ? 1 : 0); }
inline int extra_rows(const CycleUmat& law) { return law.umat->n_state + UmatHistory<4>::size; }

struct IsotropicModuli {
  double shear, bulk;
};
inline IsotropicModuli moduli_of(const AdiabaticMises& law) {
  return {law.mises.shear_modulus(), law.mises.bulk_modulus()};
}
inline IsotropicModuli moduli_of(const PlaneLaw& law) { return {law.shear_modulus(), law.bulk_modulus()}; }
inline IsotropicModuli moduli_of(const CycleUmat& law) {
  return {law.young / (2.0 * (1.0 + law.poisson)), law.young / (3.0 * (1.0 - 2.0 * law.poisson))};
}

template <class Forces>
[[gnu::always_inline]] inline void advance_stress(const AdiabaticMises& law, const Pack*, const Increment<Pack>& inc,
                                                  double dt, CyclePlace& place, Pack* state, Pack stress[4],
                                                  Pack& modulus) {
  using T = Pack;
  LawInput<4, T> in{
      {inc.strain[0], inc.strain[1], inc.strain[2], inc.strain[3]}, dt, place.temperature_or(law.thermal.start)};
  T s1[6];
  const HardeningPoint<T> hard(law.hardening, state[CycleRow::eqps]);
  modulus = Forces::hourglass_modulus(T(law.mises.shear_modulus()), state[CycleRow::eqps], hard.flow, hard.slope);
  update(law, in, hard, state, s1);
  for (int i = 0; i < 4; ++i) stress[i] = s1[i];
  state[CycleRow::eqps] = s1[4], state[CycleRow::rise] = s1[5];
}

template <class Forces>
void advance_stress(const PlaneLaw& law, const Pack*, const Increment<Pack>& inc, double dt, CyclePlace& place,
                    Pack* state, Pack stress[4], Pack& modulus) {
  using T = Pack;
  const LawInput<4, T> in{
      {inc.strain[0], inc.strain[1], inc.strain[2], inc.strain[3]}, dt, place.temperature_or(start_temperature(law))};
  const bool heats = law.flow.thermal.heats();
  const int extra = extra_rows(law), behind = heats ? 6 : 5;
  T s0[most_point_values<4>], s1[most_point_values<4>], flow, slope;
  for (int i = 0; i < 5; ++i) s0[i] = state[i];
  if (heats) s0[5] = state[CycleRow::rise];
  for (int i = 0; i < extra; ++i) s0[behind + i] = state[CycleRow::count + i];
  law.flow_at_rest(s0[4], point_temperature(law, in.temperature, s0), flow, slope);
  modulus = Forces::hourglass_modulus(T(law.shear_modulus()), s0[4], flow, slope);
  const auto failed = point::call_law(law, in, s0, s1, static_cast<T(*)[4]>(nullptr));
  for (int lane = 0; any(failed) && lane < place.used; ++lane)
    if (failed[lane]) place.fault.note(LawStatus::no_stress, place.first + lane, 0.5);
  point::turn_axes(law, inc.cosine, inc.sine, s0, s1);
  for (int i = 0; i < 4; ++i) stress[i] = s1[i];
  state[CycleRow::eqps] = s1[4];
  if (heats) state[CycleRow::rise] = s1[5];
  for (int i = 0; i < extra; ++i) state[CycleRow::count + i] = s1[behind + i];
}

// Its hourglass control takes the effective stress for a flow stress once there is plastic strain.
template <class Forces>
void advance_stress(const CycleUmat& law, const Pack* F, const Increment<Pack>& inc, double dt, CyclePlace& place,
                    Pack* state, Pack stress[4], Pack& modulus) {
  using T = Pack;
  const int extra = extra_rows(law);
  thread_local std::vector<double> kept;
  kept.assign(std::size_t(2) * extra * pack_width, 0.0);
  UmatLanes lanes;
  lanes.count = place.used;
  for (int lane = 0; lane < place.used; ++lane) {
    UmatPlace& at = lanes.place[lane];
    at.coordinates[0] = place.at[0][lane], at.coordinates[1] = place.at[1][lane], at.length = place.length[lane];
    at.cell = place.first + lane + 1;
    at.time[0] = at.time[1] = place.time, at.dt = dt;
    if (place.temperature) at.temperature[0] = (*place.temperature)[lane];
    lanes.history_n[lane] = &kept[std::size_t(lane) * extra];
    lanes.history[lane] = &kept[std::size_t(pack_width + lane) * extra];
    for (int i = 0; i < extra; ++i) kept[std::size_t(lane) * extra + i] = state[CycleRow::count + i][lane];
  }
  T s1[5];
  const T elastic(moduli_of(law).shear);
  modulus = Forces::hourglass_modulus(elastic, state[CycleRow::eqps], von_mises::effective_of<4>(state), T(0.0));
  PointSettings settings;
  settings.tangent = TangentKind::none;
  PointResponse<T> response;
  respond(settings, *law.umat, lanes, place.first, F, state, s1, response, place.fault);
  turn_stress(inc.cosine, -inc.sine, s1, stress);
  state[CycleRow::eqps] = s1[4];
  for (int lane = 0; lane < pack_width; ++lane)
    for (int i = 0; i < extra; ++i)
      state[CycleRow::count + i].set(lane, lanes.history[std::min(lane, place.used - 1)][i]);
}

}  // namespace presswork
