// SPDX-License-Identifier: Apache-2.0
// The host build of the device code: the CPU takes the place of the GPU, a lane after the other, with memory apart from
// that of the loop.
#pragma once

#include "device/resident.hpp"

namespace presswork::device {

// memory: that it may take [bytes]
template <class Real>
std::unique_ptr<Resident<Real>> make_on_host(const Problem<Real>& problem, double memory);

}  // namespace presswork::device
