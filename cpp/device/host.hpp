// SPDX-License-Identifier: Apache-2.0
// The host build of the device code: the CPU takes the place of the GPU, a lane after the other.
#pragma once

#include "device/cycle.hpp"

namespace presswork::device {

template <class Real>
void advance_on_host(const Problem<Real>& problem, const Cycles& cycles);

}  // namespace presswork::device
