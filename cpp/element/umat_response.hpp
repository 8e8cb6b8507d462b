// SPDX-License-Identifier: Apache-2.0
// One integration point with a law from a shared library: what point_response.hpp is for the laws of our own.
//
// The increment's strain is measured in the frame that has not turned (kinematics/increment.hpp); stress, strain and
// their increments go to the routine turned by the increment's rotation R, as Abaqus hands them over. DDSDDE comes back
// in the turned axes. A law that adds increments and turns its tensors by DROT is objective, so that its stress is R
// f(strain increment) R^T; then
//     stress_increment:   D = A DDSDDE A^T turned back by R, and the modulus is that of our own laws
//     with small displacements the routine sees no rotation and unit deformation gradients, and a = DDSDDE
//     jaumann_kirchhoff:  d sigma = w sigma - sigma w + DDSDDE : d - sigma tr d with l = d + w, so that
//                         a : l = DDSDDE : d + w sigma - sigma d
#pragma once

#include <algorithm>

#include "element/point_response.hpp"
#include "material/umat.hpp"

namespace presswork {

// History of a point behind the routine's own state variables.
struct UmatHistory {
  static constexpr int F = 0;       // of the whole deformation: 11, 12, 21, 22, 33
  static constexpr int strain = 5;  // sum of the turned increments: xx, yy, zz, xy
  static constexpr int energy = 9;  // elastic, plastic, creep per volume, as the routine keeps them
  static constexpr int work = 12;   // of the stress in the last increment, per volume, by the trapezoidal rule
  static constexpr int size = 13;
};

// The lanes of one point in a pack.
struct UmatLanes {
  int count;                    // lanes beyond it repeat the last cell
  UmatPlace place[pack_width];  // where each is
  const double* history_n[pack_width];
  double* history[pack_width];  // n_state values, then UmatHistory
};

// The worst of what the calls of a law have told; status done while all is well.
struct LawFault {
  LawStatus status = LawStatus::done;
  int cell = -1;             // in the block
  double step_factor = 1.0;  // the least that was asked for

  void note(LawStatus other, int where, double factor) {
    if (other == LawStatus::smaller && factor < step_factor) step_factor = factor;
    if (static_cast<int>(other) > static_cast<int>(status)) status = other, cell = where;
  }
};

namespace umat {

inline void fill_matrix(const double F[5], double out[9]) {
  const double full[9] = {F[0], F[2], 0.0, F[1], F[3], 0.0, 0.0, 0.0, F[4]};
  std::copy_n(full, 9, out);
}

// Calls the routine for one lane. stress and eqps in and out; D in the axes turned by (c_D, s_D).
inline LawStatus advance(const Umat& law, const UmatPlace& place, const double F[5], const double increment[4],
                         double c, double s, const double* history_n, double* history, double stress[4], double& eqps,
                         UmatPoint& p) {
  const double *tail_n = history_n + law.n_state, *F_n = tail_n + UmatHistory::F;
  double* tail = history + law.n_state;
  double whole[5] = {F[0] * F_n[0] + F[1] * F_n[2], F[0] * F_n[1] + F[1] * F_n[3], F[2] * F_n[0] + F[3] * F_n[2],
                     F[2] * F_n[1] + F[3] * F_n[3], F[4] * F_n[4]};
  const double rotation[5] = {c, -s, s, c, 1.0};
  double before[4];
  turn_stress(c, s, stress, before);
  std::copy_n(before, 4, p.stress);
  turn_strain(c, s, tail_n + UmatHistory::strain, p.strain);
  turn_strain(c, s, increment, p.increment);
  fill_matrix(rotation, p.rotation);
  fill_matrix(F_n, p.F_n);
  fill_matrix(whole, p.F);
  std::copy_n(tail_n + UmatHistory::energy, 3, p.energy);
  std::copy_n(history_n, law.n_state, history);
  const double strain[4] = {p.strain[0] + p.increment[0], p.strain[1] + p.increment[1], p.strain[2] + p.increment[2],
                            p.strain[3] + p.increment[3]};
  double step[4];
  std::copy_n(p.increment, 4, step);
  const LawStatus status = law.call(place, p, history);
  if (status != LawStatus::done) return status;
  std::copy_n(whole, 5, tail + UmatHistory::F);
  std::copy_n(strain, 4, tail + UmatHistory::strain);
  std::copy_n(p.energy, 3, tail + UmatHistory::energy);
  double work = 0.0;
  for (int i = 0; i < 4; ++i) work += 0.5 * (before[i] + p.stress[i]) * step[i];
  tail[UmatHistory::work] = work;
  std::copy_n(p.stress, 4, stress);
  eqps = law.plastic_strain ? history[law.plastic_strain - 1] : 0.0;
  return status;
}

template <class T>
void jaumann_modulus(const T D[4][4], const T* s, T a[5][5]) {
  const T S[2][2] = {{s[0], s[3]}, {s[3], s[1]}};
  const T half(0.5);
  const int at[2][2] = {{0, 1}, {2, 3}}, row_of[4] = {0, 3, 3, 1}, strain_of[4] = {0, 3, 3, 1};
  for (int r = 0; r < 4; ++r) {
    for (int k = 0; k < 4; ++k) a[r][k] = D[row_of[r]][strain_of[k]];  // engineering shear: d12 + d21 along l12 or l21
    a[r][4] = D[row_of[r]][2];
  }
  for (int k = 0; k < 4; ++k) a[4][k] = D[2][strain_of[k]];
  a[4][4] = D[2][2] - s[2];
  // w sigma - sigma d with w = (l - l^T)/2, d = (l + l^T)/2
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        a[at[i][j]][at[i][k]] += half * S[k][j];
        a[at[i][j]][at[k][i]] -= half * S[k][j];
        a[at[i][j]][at[k][j]] -= half * S[i][k];
        a[at[i][j]][at[j][k]] -= half * S[i][k];
      }
}

}  // namespace umat

// Advance the lanes of a point; what the calls tell is noted in fault.
inline void respond(const PointSettings& settings, const Umat& law, const UmatLanes& lanes, int first_cell,
                    const Pack F[5], const Pack* s0, Pack* s1, PointResponse<Pack>& response, LawFault& fault) {
  const bool with_tangent = settings.tangent != TangentKind::none;
  const bool by_increment = law.jacobian == UmatJacobian::stress_increment;
  constexpr double undeformed[5] = {1.0, 0.0, 0.0, 1.0, 1.0};
  Increment<Pack> inc;
  if (settings.small_displacements) {
    point::small_strain(F, inc.strain);
    inc.cosine = Pack(1.0), inc.sine = Pack(0.0);
  } else {
    measure_increment(F, settings.measure, with_tangent && by_increment, inc);
  }
  Pack D[4][4], unturned[4];
  for (int lane = 0; lane < pack_width; ++lane) {
    double s[4] = {}, back[4] = {}, eqps = 0.0, matrix[4][4] = {};
    const double c = inc.cosine[lane], n = inc.sine[lane];
    UmatPoint point{};
    if (lane < lanes.count) {
      double gradient[5] = {F[0][lane], F[1][lane], F[2][lane], F[3][lane], F[4][lane]};
      if (settings.small_displacements) std::copy_n(undeformed, 5, gradient);
      const double increment[4] = {inc.strain[0][lane], inc.strain[1][lane], inc.strain[2][lane], inc.strain[3][lane]};
      for (int i = 0; i < 4; ++i) s[i] = s0[i][lane];
      const LawStatus status = umat::advance(law, lanes.place[lane], gradient, increment, c, n, lanes.history_n[lane],
                                             lanes.history[lane], s, eqps, point);
      if (status != LawStatus::done) fault.note(status, first_cell + lane, point.step_factor);
      double given[4][4];  // DDSDDE comes by columns
      for (int i = 0; i < 16; ++i) given[i % 4][i / 4] = point.tangent[i];
      turn_tangent(by_increment ? c : 1.0, by_increment ? -n : 0.0, given, matrix);
      turn_stress(c, -n, s, back);
    }
    const int from = std::min(lane, lanes.count - 1);
    const bool own = lane == from;
    s1[4].set(lane, own ? eqps : s1[4][from]);
    for (int i = 0; i < 4; ++i) {
      s1[i].set(lane, own ? s[i] : s1[i][from]);
      unturned[i].set(lane, own ? back[i] : unturned[i][from]);
      for (int j = 0; j < 4; ++j) D[i][j].set(lane, own ? matrix[i][j] : D[i][j][from]);
    }
  }
  for (int i = 0; i < 4; ++i) response.stress[i] = s1[i];
  if (!with_tangent) return;
  if (settings.small_displacements) {
    point::small_modulus(D, response.modulus);
    return;
  }
  if (!by_increment) {
    umat::jaumann_modulus(D, s1, response.modulus);
    return;
  }
  auto& a = response.modulus;
  point::consistent_modulus(inc, D, unturned, a);
  for (auto& row : a) point::turn_gradient(inc.cosine, inc.sine, row[0], row[1], row[2], row[3]);
  for (int k = 0; k < 5; ++k) point::turn_gradient(inc.cosine, inc.sine, a[0][k], a[1][k], a[2][k], a[3][k]);
}

}  // namespace presswork
