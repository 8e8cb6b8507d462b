// SPDX-License-Identifier: Apache-2.0
// Cycles of a loop in space on a device: which loops, and a session, which is a loop's state there.
#pragma once

#include <memory>
#include <string>

#include "device/arrays.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::device {

using explicit_dynamics::Energies;
using explicit_dynamics::SpaceLoop;
using explicit_dynamics::Step;

enum class Target { host, cuda };

// Cycles of dt, the step before was dt_before [s]; the scales (n) multiply forces and prescribed velocities.
struct Cycles {
  int n;
  double dt, dt_before, damping;
  const double *force_scale, *velocity_scale;

  Step step(int cycle) const {
    return {dt, cycle == 0 ? 0.5 * (dt_before + dt) : dt, damping, force_scale[cycle], velocity_scale[cycle]};
  }
};

// An element has failed in a cycle of a call, as Loop's: of several the first in number. The state is of no use then.
struct Failure {
  int element = -1, status = 0, cycle = -1;
};

// What a loop has that no device computes yet; empty where there is nothing.
template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop);

// The state of a loop, of which nothing lacks, on a device. From when it is made until the loop is changed otherwise
// the device has the present state, and the loop what was fetched last; tools, beads and work in the loop are present.
// Throws std::runtime_error where the device does not, or has too little memory.
template <class Real>
class Session {
 public:
  // memory: of the host build [bytes]
  Session(SpaceLoop<Real>& loop, Target target, double memory);
  ~Session();

  // Stops where a place is not finite any more.
  Failure advance(const Cycles& cycles);
  // Whether all nodes had finite places after the last call.
  bool is_finite() const { return finite_; }
  // Take into the loop: places of nodes; their velocities and forces; reactions; elements and
  // their damage; what nodes remember of tools.
  void fetch(Part part);
  // Of elements what rows of cycles are judged by: thickness of shells; stress, plastic strain and heat of solids.
  void fetch_measures();
  // Reactions are summed up anew.
  void clear_reaction();
  // Take there how walls of the loop move now; what is given of temperatures and limits of friction, false where none
  // were before; what walls have pressed and rubbed.
  void send_walls();
  bool send_given();
  void send_sums();
  // Energies at the present time; step: the next.
  Energies energies(const Step& step);
  // The largest bound of a squared frequency [1/s2].
  double bound_frequency();
  // Keep the present state, there; and go back to it.
  void keep();
  void put_back();

  double needed() const;  // [bytes]
  const Traffic& traffic() const;

 private:
  void find_radii();

  struct Own;
  std::unique_ptr<Own> own_;
  bool finite_ = true;
};

}  // namespace presswork::device
