// SPDX-License-Identifier: Apache-2.0
// Rigid tools of the explicit loop: how they move, and how they touch the sheet.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "contact/tool_surface.hpp"
#include "contact/vectors.hpp"

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
struct RigidTool {
  Grip grip;
  bool pushed = false;
  bool removed = false;                                       // goes on as it was, and touches nothing
  int was_pushed = 0;                                         // 1 once a force has pushed it, though it may stand now
  double direction[3] = {0, 0, 0}, mass = 0.0, drag = 0.0;    // of a pushed one: unit vector, [t], [1/s]
  int stop = -1;                                              // the tool that a pushed one comes to stand on; -1: none
  double furthest = std::numeric_limits<double>::infinity();  // along direction beyond that tool's displacement [mm]
  double push = 0.0;                                          // force of the last cycle [N]
  double displacement[3] = {0, 0, 0}, velocity[3] = {0, 0, 0};  // [mm]; half a step back [mm/s]
  double force[3] = {0, 0, 0};                                  // of the sheet on it [N]
  double travel = 0.0;  // by as much at most any point has come nearer since the start [mm]
};

struct Tool : RigidTool {
  std::shared_ptr<const contact::ToolSurface> surface;
  std::vector<double> drive;  // of the cycles to come: velocity (n, 3) [mm/s], or force (n) [N]
};

struct ContactEnergies {
  double penalty = 0.0;   // in the springs of contact and stick, and the work of squeezing the sheet thinner
  double friction = 0.0;  // lost in slip
  double damping = 0.0;   // lost in the dampers of contact and of pushed tools
  double kinetic = 0.0;   // of pushed tools
  double external = 0.0;  // work of what moves the tools

  template <class Energies>
  void add_to(Energies& e) const {
    e.kinetic += kinetic, e.external += external, e.damping += damping, e.contact += penalty, e.friction += friction;
  }
};

// Work done by what moves the tools, and lost in their drag [N mm].
struct ToolWork {
  double external = 0.0, drag = 0.0;
};

// Speed of a pushed tool half a step on.
PRESSWORK_DEVICE inline double next_speed(const RigidTool& tool, double push, double dt) {
  const double half = 0.5 * tool.drag * dt, force = push + contact::dot(tool.force, tool.direction);
  return ((1.0 - half) * contact::dot(tool.velocity, tool.direction) + dt / tool.mass * force) / (1.0 + half);
}

// One cycle of n tools, tool(t) each; drive(t): what moves or pushes it in this cycle. fastest: the largest speed of a
// node. work: of tools that are moved, and of those that forces place.
template <class ToolAt, class DriveAt>
PRESSWORK_DEVICE void move_tools(int n, const ToolAt& tool_at, const DriveAt& drive_at, double dt, double fastest,
                                 ToolWork& work, ToolWork& of_pushed) {
  const auto move = [&](RigidTool& tool, const double after[3]) {
    for (int i = 0; i < 3; ++i) {
      tool.velocity[i] = after[i];
      tool.displacement[i] += dt * after[i];
    }
    tool.travel += dt * (fastest + std::sqrt(contact::dot(after, after)));
  };
  for (int t = 0; t < n; ++t) {
    RigidTool& tool = tool_at(t);
    if (tool.pushed) continue;
    double after[3];
    for (int i = 0; i < 3; ++i) after[i] = tool.removed ? tool.velocity[i] : drive_at(t)[i];
    for (int i = 0; i < 3; ++i) work.external -= tool.force[i] * 0.5 * (tool.velocity[i] + after[i]) * dt;
    move(tool, after);
  }
  for (int t = 0; t < n; ++t) {  // what they may stand on is where it will be
    RigidTool& tool = tool_at(t);
    if (!tool.pushed) continue;
    tool.push = drive_at(t)[0];
    const double before = contact::dot(tool.velocity, tool.direction);
    double speed = next_speed(tool, tool.push, dt), held = 0.0, carried = 0.0;
    if (tool.stop >= 0) {
      const RigidTool& other = tool_at(tool.stop);
      const double way =
          contact::dot(tool.displacement, tool.direction) - contact::dot(other.displacement, tool.direction);
      const double most = (tool.furthest - way) / dt;
      if (speed > most) {
        held = (1.0 + 0.5 * tool.drag * dt) * tool.mass * (speed - most);  // the other's force on it, times dt
        carried = contact::dot(other.velocity, tool.direction);
        speed = most;
      }
    }
    const double mean = 0.5 * (before + speed);
    of_pushed.external += tool.push * mean * dt - held * carried;
    of_pushed.drag += tool.drag * tool.mass * mean * mean * dt + held * (mean - carried);
    const double after[3] = {speed * tool.direction[0], speed * tool.direction[1], speed * tool.direction[2]};
    move(tool, after);
  }
}

}  // namespace presswork::explicit_dynamics
