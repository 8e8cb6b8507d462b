// SPDX-License-Identifier: Apache-2.0
// Rigid tools of the explicit loop: how they move, and how they touch the sheet.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "contact/tool_surface.hpp"

namespace presswork::explicit_dynamics {

// How a tool touches the sheet.
struct Grip {
  double friction;  // Coulomb's coefficient
  double penalty;   // stiffness over nodal mass/dt^2
  double damping;   // over critical
  bool edges;       // where the tool is sharp the edges' inside touches, too
  bool thickness;   // the sheet touches with its surface, not its mid-surface
};

// It is moved, or pushed along a direction.
struct Tool {
  std::shared_ptr<const contact::ToolSurface> surface;
  Grip grip;
  bool pushed = false;
  bool removed = false;                                       // goes on as it was, and touches nothing
  double direction[3] = {0, 0, 0}, mass = 0.0, drag = 0.0;    // of a pushed one: unit vector, [t], [1/s]
  int stop = -1;                                              // the tool that a pushed one comes to stand on; -1: none
  double furthest = std::numeric_limits<double>::infinity();  // along direction beyond that tool's displacement [mm]
  std::vector<double> drive;  // of the cycles to come: velocity (n, 3) [mm/s], or force (n) [N]
  double push = 0.0;          // force of the last cycle [N]
  double displacement[3] = {0, 0, 0}, velocity[3] = {0, 0, 0};  // [mm]; half a step back [mm/s]
  double force[3] = {0, 0, 0};                                  // of the sheet on it [N]
  double travel = 0.0;  // by as much at most any point has come nearer since the start [mm]
};

struct ContactEnergies {
  double penalty = 0.0;   // in the springs of contact and stick, and the work of squeezing the sheet thinner
  double friction = 0.0;  // lost in slip
  double damping = 0.0;   // lost in the dampers of contact and of pushed tools
  double kinetic = 0.0;   // of pushed tools
  double external = 0.0;  // work of what moves the tools
};

}  // namespace presswork::explicit_dynamics
