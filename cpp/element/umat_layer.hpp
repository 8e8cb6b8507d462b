// SPDX-License-Identifier: Apache-2.0
// A layer of a shell: with a SheetLaw of our own, or with a routine from a shared library in plane stress.
//
// The routine sees the lamina frame, which turns with the material: DROT is one, and neither stress nor state variables
// are to be turned. DFGRD0 and DFGRD1 are products of the increments' stretches in that frame; the stretch across the
// sheet is that of the increment's start. The strain across the sheet no routine tells: it is the elastic one of the
// change of stress, with the elastic constants of the routine's first tangent, and what keeps the volume of the rest:
//     e33 = -nu/E (ds11 + ds22) - (e11 + e22 - (1 - nu)/E (ds11 + ds22))
// as of the laws of our own.
#pragma once

#include <cmath>

#include "element/umat_point.hpp"
#include "material/elastic_plastic.hpp"
#include "tensor/lanes.hpp"

namespace presswork {

// A routine in plane stress, and the elastic constants of its first tangent. A layer keeps behind its stress the
// equivalent plastic strain, the routine's state variables and UmatHistory<3>.
struct SheetUmat {
  const Umat* umat;
  double young, poisson;

  int history_size() const { return 1 + umat->n_state + UmatHistory<3>::size; }
};

namespace umat {

// exp of a symmetric tensor xx, yy, xy (engineering), by columns; across: none
inline void stretch_of(const double strain[3], double F[9]) {
  const double mean = std::exp(0.5 * (strain[0] + strain[1])), half = 0.5 * (strain[0] - strain[1]);
  const double shear = 0.5 * strain[2], radius = std::sqrt(half * half + shear * shear);
  const double c = mean * std::cosh(radius), s = mean * (radius > 1e-8 ? std::sinh(radius) / radius : 1.0);
  const double columns[9] = {c + s * half, s * shear, 0.0, s * shear, c - s * half, 0.0, 0.0, 0.0, 1.0};
  std::copy_n(columns, 9, F);
}

// One lane; stress both, thickness: increment of the strain across the sheet. lanes: histories behind the equivalent
// plastic strain.
inline LawStatus advance_layer(const SheetUmat& law, const UmatLanes& lanes, int lane, const double strain[3],
                               double stress[3], double& eqps, double& thickness, UmatPoint& p) {
  double F[9];
  const double before = stress[0] + stress[1];
  stretch_of(strain, F);
  const LawStatus status = advance<3>(*law.umat, lanes, lane, Turn<3>{}, F, strain, stress, eqps, p);
  if (status != LawStatus::done) return status;
  const double change = (stress[0] + stress[1] - before) / law.young;
  thickness = (1.0 - 2.0 * law.poisson) * change - (strain[0] + strain[1]);
  lanes.history[lane][law.umat->n_state + UmatHistory<3>::F + 8] *= std::exp(thickness);
  return status;
}

}  // namespace umat

// The law of a shell's layers, of our own or a routine.
struct ShellLaw {
  const SheetLaw* own = nullptr;
  const SheetUmat* user = nullptr;
  double young, poisson;

  explicit ShellLaw(const SheetLaw& law) : own(&law), young(law.young), poisson(law.poisson) {}
  explicit ShellLaw(const SheetUmat& law) : user(&law), young(law.young), poisson(law.poisson) {}

  int history_size() const { return own ? own->history_size() : user->history_size(); }
  double start_temperature() const { return own ? own->flow.thermal.start : 0.0; }
  template <class T>
  T young_at(T eqps) const {
    return own ? own->young_at(eqps) : T(young);
  }
  // Elasticity at present, and the stress before the increment's strain: with the moduli, and thermal strain taken off.
  template <class T>
  Elasticity<3, T> elasticity(const T* state, T temperature, T before[3]) const {
    for (int i = 0; i < 3; ++i) before[i] = state[i];
    if (!own || !own->thermoelastic.active()) return {young_at(state[3]), poisson};
    const Heated<3, T> heated(*own, temperature, state);
    const T none[3] = {T(0.0), T(0.0), T(0.0)};
    T strain[3], stress[3];
    heated.take_off(none, strain);
    heated.elastic.stiffness(strain, stress);
    for (int i = 0; i < 3; ++i) before[i] = heated.state[i] + stress[i];
    return heated.elastic;
  }
};

// The same for one layer of a pack: a routine must know where it is.
struct LayerLaw {
  const ShellLaw& law;
  const UmatLanes* lanes = nullptr;  // of a routine
  int first_cell = 0;
  LawFault* fault = nullptr;

  // As update_sheet (elastic_plastic.hpp). s0 and s1 hold what a law of our own keeps; a routine's history is in lanes,
  // but for the equivalent plastic strain.
  template <class T>
  [[gnu::always_inline]] inline Mask<T> update(const LawInput<3, T>& in, const T* s0, T* s1, T& thickness,
                                               T (*tangent)[3]) const {
    return law.own ? update_sheet(*law.own, in, s0, s1, thickness, tangent) : call(in, s0, s1, thickness, tangent);
  }

 private:
  template <class T>
  [[gnu::noinline]] Mask<T> call(const LawInput<3, T>& in, const T* s0, T* s1, T& thickness, T (*tangent)[3]) const {
    T lost(0.0);
    for (int lane = 0; lane < lanes::count(lost); ++lane) {
      const int from = std::min(lane, lanes->count - 1);
      if (lane != from) {  // repeats the last
        for (int i = 0; i < 4; ++i) lanes::set(s1[i], lane, lanes::get(s1[i], from));
        for (int i = 0; tangent && i < 9; ++i)
          lanes::set(tangent[i / 3][i % 3], lane, lanes::get(tangent[i / 3][i % 3], from));
        lanes::set(thickness, lane, lanes::get(thickness, from)), lanes::set(lost, lane, lanes::get(lost, from));
        continue;
      }
      UmatPoint p{};
      double strain[3], stress[3], eqps = 0.0, across = 0.0;
      for (int i = 0; i < 3; ++i) strain[i] = lanes::get(in.strain[i], lane), stress[i] = lanes::get(s0[i], lane);
      const LawStatus status = umat::advance_layer(*law.user, *lanes, lane, strain, stress, eqps, across, p);
      if (status != LawStatus::done) {
        fault->note(status, first_cell + lane, p.step_factor);
        lanes::set(lost, lane, 1.0);
      }
      for (int i = 0; i < 3; ++i) {
        lanes::set(s1[i], lane, stress[i]);
        for (int j = 0; tangent && j < 3; ++j) lanes::set(tangent[i][j], lane, p.tangent[i + 3 * j]);
      }
      lanes::set(s1[3], lane, eqps), lanes::set(thickness, lane, across);
    }
    return lost > T(0.5);
  }
};

}  // namespace presswork
