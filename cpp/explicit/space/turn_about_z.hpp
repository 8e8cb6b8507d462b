// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tensor/on_device.hpp"

namespace presswork::explicit_dynamics {

// A vector turned about z by an angle of which cosine and sine are given.
PRESSWORK_DEVICE inline void turn_about_z(const double from[3], double cosine, double sine, double to[3]) {
  to[0] = cosine * from[0] - sine * from[1];
  to[1] = sine * from[0] + cosine * from[1];
  to[2] = from[2];
}

}  // namespace presswork::explicit_dynamics
