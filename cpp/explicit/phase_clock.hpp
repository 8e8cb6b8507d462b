// SPDX-License-Identifier: Apache-2.0
// Where the time of one thread goes in the explicit loop.
#pragma once

#include <chrono>

namespace presswork::explicit_dynamics {

enum class Phase {
  nodes,     // motion of nodes, hanging ones and what they give to others
  elements,  // and the sums of their forces
  contact,   // with tools and beads, and the tools' own motion
  waiting,   // for other threads
};
inline constexpr int n_phases = 4;

class PhaseClock {
 public:
  // Add the time since the last lap, or since the start, to a phase.
  void lap(Phase phase) {
    const auto now = Clock::now();
    seconds[static_cast<int>(phase)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  double seconds[n_phases] = {};

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace presswork::explicit_dynamics
