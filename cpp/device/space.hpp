// SPDX-License-Identifier: Apache-2.0
// Cycles of a loop in space on a device: the loop keeps the state, and a call borrows it.
#pragma once

#include <string>

#include "device/cycle.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::device {

enum class Target { host, cuda };

// What a loop has that no device computes yet; empty where there is nothing.
template <class Real>
std::string find_lack(const explicit_dynamics::SpaceLoop<Real>& loop);

// Advance cycles of a loop of which nothing lacks. Throws std::runtime_error where the device does not.
template <class Real>
void advance(explicit_dynamics::SpaceLoop<Real>& loop, Target target, const Cycles& cycles);

}  // namespace presswork::device
