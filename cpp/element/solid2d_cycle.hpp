// SPDX-License-Identifier: Apache-2.0
// The stress of a one-point solid in a cycle of the explicit loop, for each kind of law: what solid2d_one_point.hpp
// asks.
//
// A cell's state begins with the rows of CycleRow; those that a law keeps besides follow. advance_stress takes the
// state from t to t+dt but for the stress, which it gives in the axes of t, and tells the modulus of the hourglass
// control.
#pragma once

#include "element/solid2d_forces.hpp"
#include "element/umat_cycle.hpp"
#include "element/umat_response.hpp"
#include "material/adiabatic_mises.hpp"

namespace presswork {

// Stress xx, yy, zz, xy [MPa]; equivalent plastic strain; rise of temperature; hourglass forces [N]; work of the stress
// and of the hourglass forces [N mm].
struct CycleRow {
  enum : int { stress = 0, eqps = 4, rise = 5, hourglass = 6, work = 8, hourglass_work = 9, count = 10 };
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
inline int extra_rows(const CycleUmat<4>& law) { return kept_values(law); }

struct IsotropicModuli {
  double shear, bulk;
};
inline IsotropicModuli moduli_of(const AdiabaticMises& law) {
  return {law.mises.shear_modulus(), law.mises.bulk_modulus()};
}
template <class Law>
IsotropicModuli moduli_of(const Law& law) {
  return {law.shear_modulus(), law.bulk_modulus()};
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
void advance_stress(const CycleUmat<4>& law, const Pack* F, const Increment<Pack>& inc, double dt, CyclePlace& place,
                    Pack* state, Pack stress[4], Pack& modulus) {
  using T = Pack;
  const int extra = extra_rows(law);
  thread_local UmatRows rows;
  rows.take(state + CycleRow::count, extra, place.used);
  for (int lane = 0; lane < place.used; ++lane) {
    UmatPlace& at = rows.lanes.place[lane];
    at.coordinates[0] = place.at[0][lane], at.coordinates[1] = place.at[1][lane], at.length = place.length[lane];
    at.cell = place.first + lane + 1;
    at.time[0] = at.time[1] = place.time, at.dt = dt;
    at.temperature[0] = place.temperature ? (*place.temperature)[lane] : 0.0;
  }
  T s1[5];
  const T elastic(law.shear_modulus());
  modulus = Forces::hourglass_modulus(elastic, state[CycleRow::eqps], von_mises::effective_of<4>(state), T(0.0));
  PointSettings settings;
  settings.tangent = TangentKind::none;
  PointResponse<T> response;
  respond(settings, *law.umat, rows.lanes, place.first, F, state, s1, response, place.fault);
  turn_stress(inc.cosine, -inc.sine, s1, stress);
  state[CycleRow::eqps] = s1[4];
  umat::keep_rows(rows.lanes, extra, state + CycleRow::count);
}

}  // namespace presswork
