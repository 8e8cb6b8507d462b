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

#include "element/point_response.hpp"
#include "element/umat_point.hpp"

namespace presswork {

namespace umat {

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
      double gradient[9] = {F[0][lane], F[2][lane], 0.0, F[1][lane], F[3][lane], 0.0, 0.0, 0.0, F[4][lane]};
      if (settings.small_displacements) umat::Turn<3>().fill(gradient);
      const double increment[4] = {inc.strain[0][lane], inc.strain[1][lane], inc.strain[2][lane], inc.strain[3][lane]};
      for (int i = 0; i < 4; ++i) s[i] = s0[i][lane];
      const LawStatus status =
          umat::advance<4>(law, lanes, lane, umat::Turn<4>{c, n}, gradient, increment, s, eqps, point);
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
