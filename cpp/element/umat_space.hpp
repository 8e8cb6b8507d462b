// SPDX-License-Identifier: Apache-2.0
// One point of a solid in space with a law from a shared library: what space_response.hpp is for the laws of our own,
// and umat_response.hpp for the plane. With DDSDDE of the Jaumann rate of Kirchhoff stress over J,
//     a : l = DDSDDE : d + w sigma - sigma d = (DDSDDE : d - d sigma - sigma d) + l sigma.
#pragma once

#include "element/space_response.hpp"
#include "element/umat_point.hpp"

namespace presswork {

namespace umat {

// Call the routine for the lanes of a point, by the strain of the increment in the axes that have not turned, and the
// rotation. s1: stress, turned, and equivalent plastic strain; C: DDSDDE, or null.
inline void call_lanes(const Umat& law, const UmatLanes& lanes, int first_cell, const Pack F[9], const Pack strain[6],
                       const Pack rotation[3][3], const Pack* s0, Pack* s1, Pack (*C)[6], LawFault& fault) {
  for (int lane = 0; lane < lanes.count; ++lane) {
    Turn<6> turn;
    double gradient[9], increment[6], s[6], eqps = 0.0;
    UmatPoint point{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        turn.R[i][j] = rotation[i][j][lane];
        gradient[i + 3 * j] = F[3 * i + j][lane];
      }
    for (int i = 0; i < 6; ++i) increment[i] = strain[i][lane], s[i] = s0[i][lane];
    const LawStatus status = advance<6>(law, lanes, lane, turn, gradient, increment, s, eqps, point);
    if (status != LawStatus::done) fault.note(status, first_cell + lane, point.step_factor);
    for (int i = 0; i < 6; ++i) {
      s1[i].set(lane, s[i]);
      for (int j = 0; C && j < 6; ++j) C[i][j].set(lane, point.tangent[i + 6 * j]);
    }
    s1[6].set(lane, eqps);
  }
  for (int i = 0; i < 6; ++i) {
    repeat_last(lanes.count, s1[i]);
    for (int j = 0; C && j < 6; ++j) repeat_last(lanes.count, C[i][j]);
  }
  repeat_last(lanes.count, s1[6]);
}

}  // namespace umat

// Advance the lanes of a point; what the calls tell is noted in fault.
inline void respond(const PointSettings& settings, const Umat& law, const UmatLanes& lanes, int first_cell,
                    const Pack F[9], const Pack* s0, Pack* s1, SpaceResponse<Pack>& response, LawFault& fault) {
  const bool with_tangent = settings.tangent != TangentKind::none, small = settings.small_displacements;
  const bool by_increment = law.jacobian == UmatJacobian::stress_increment;
  Stretch<Pack> inc;
  Pack none[9];  // F of no deformation
  // 1. strain of the increment in the axes that have not turned
  if (small) {
    small_strain(F, inc.strain);
    for (int i = 0; i < 9; ++i) none[i] = inc.rotation[i / 3][i % 3] = Pack(i % 4 == 0 ? 1.0 : 0.0);
  } else {
    split_increment(F, settings.measure, with_tangent && by_increment, inc);
  }
  // 2. lane by lane
  Pack(&C)[6][6] = response.modulus;
  umat::call_lanes(law, lanes, first_cell, small ? none : F, inc.strain, inc.rotation, s0, s1,
                   with_tangent ? C : nullptr, fault);
  for (int i = 0; i < 6; ++i) response.stress[i] = s1[i];
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
