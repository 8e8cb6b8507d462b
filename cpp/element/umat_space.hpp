// SPDX-License-Identifier: Apache-2.0
// One point of a solid in space with a law from a shared library: what space_response.hpp is for the laws of our own,
// and umat_response.hpp for the plane. With DDSDDE of the Jaumann rate of Kirchhoff stress over J,
//     a : l = DDSDDE : d + w sigma - sigma d = (DDSDDE : d - d sigma - sigma d) + l sigma.
#pragma once

#include "element/space_response.hpp"
#include "element/umat_point.hpp"

namespace presswork {

// Advance the lanes of a point; what the calls tell is noted in fault.
inline void respond(const PointSettings& settings, const Umat& law, const UmatLanes& lanes, int first_cell,
                    const Pack F[9], const Pack* s0, Pack* s1, SpaceResponse<Pack>& response, LawFault& fault) {
  const bool with_tangent = settings.tangent != TangentKind::none, small = settings.small_displacements;
  const bool by_increment = law.jacobian == UmatJacobian::stress_increment;
  Stretch<Pack> inc;
  // 1. strain of the increment in the axes that have not turned
  if (small) {
    small_strain(F, inc.strain);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inc.rotation[i][j] = Pack(i == j ? 1.0 : 0.0);
  } else {
    split_increment(F, settings.measure, with_tangent && by_increment, inc);
  }
  // 2. lane by lane
  Pack(&C)[6][6] = response.modulus;
  for (int lane = 0; lane < lanes.count; ++lane) {
    umat::Turn<6> turn;
    double gradient[9], increment[6], s[6], eqps = 0.0;
    UmatPoint point{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        turn.R[i][j] = inc.rotation[i][j][lane];
        gradient[i + 3 * j] = small ? (i == j ? 1.0 : 0.0) : F[3 * i + j][lane];
      }
    for (int i = 0; i < 6; ++i) increment[i] = inc.strain[i][lane], s[i] = s0[i][lane];
    const LawStatus status = umat::advance<6>(law, lanes, lane, turn, gradient, increment, s, eqps, point);
    if (status != LawStatus::done) fault.note(status, first_cell + lane, point.step_factor);
    for (int i = 0; i < 6; ++i) {
      s1[i].set(lane, s[i]);
      for (int j = 0; with_tangent && j < 6; ++j) C[i][j].set(lane, point.tangent[i + 6 * j]);
    }
    s1[6].set(lane, eqps);
  }
  for (int i = 0; i < 6; ++i) {
    umat::repeat_last(lanes.count, s1[i]);
    for (int j = 0; with_tangent && j < 6; ++j) umat::repeat_last(lanes.count, C[i][j]);
    response.stress[i] = s1[i];
  }
  umat::repeat_last(lanes.count, s1[6]);
  // 3. tangent
  response.with_initial_stress = false;
  if (!with_tangent || small) return;
  if (!by_increment) {
    space::add_minus_stress_strain(response.stress, C);
    response.with_initial_stress = true;
    return;
  }
  Pack back[3][3], unturned[6];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) back[i][j] = inc.rotation[j][i];
  stretch::turn_modulus(back, C);
  stretch::turn_tensor(back, response.stress, unturned);
  space::finish_modulus(settings, F, inc, unturned, response);
}

}  // namespace presswork
