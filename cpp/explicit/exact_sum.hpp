// SPDX-License-Identifier: Apache-2.0
// Forces on tools, rounded so that their sums depend on no order: on no number of threads, nor of parts of the mesh.
#pragma once

#include "tensor/on_device.hpp"

namespace presswork::explicit_dynamics {

// Added and taken away again, leaves a multiple of 2^-25 N: up to 10^8 N, sums of such numbers are exact.
inline constexpr double force_rounding = 1.5 * (1 << 27);

PRESSWORK_INLINE double round_force(double x) { return (x + force_rounding) - force_rounding; }

}  // namespace presswork::explicit_dynamics
