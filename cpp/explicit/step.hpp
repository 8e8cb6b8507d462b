// SPDX-License-Identifier: Apache-2.0
// One cycle of central differences as its nodes see it, and what an explicit run keeps count of.
#pragma once

namespace presswork::explicit_dynamics {

// Why a cell has failed: `reasons` times its number plus this, a LawStatus; `done` where it is turned inside out.
inline constexpr int reasons = 8;
// Values of a solid's point that rows of cycles are judged by: stress (6), equivalent plastic strain, and the rise of
// temperature of a law that heats.
inline constexpr int point_measures = 8;

// A cycle of dt; velocities are advanced over mean_dt, the mean of this step and the one before.
struct Step {
  double dt, mean_dt, damping, force_scale, velocity_scale;  // [s], [s], [1/s]; factors on forces and prescribed motion
  double kept = (1.0 - 0.5 * damping * mean_dt) / (1.0 + 0.5 * damping * mean_dt);
  double push = mean_dt / (1.0 + 0.5 * damping * mean_dt);
};

struct Energies {
  double kinetic = 0.0;    // v(-dt/2) m v(+dt/2)/2, which linear vibration conserves together with the internal energy
  double internal = 0.0;   // work of the stresses
  double hourglass = 0.0;  // work of the hourglass forces
  double external = 0.0;   // work of nodal forces, of prescribed velocities, of tools and moving walls
  double damping = 0.0;    // taken away by mass damping, and by the damping of contact and of pushed tools
  double contact = 0.0;    // in the springs of contact and beads, and the work of pressure on the change of thickness;
                           // lost where nodes strike walls
  double friction = 0.0;   // lost in friction and in beads
};

// Work at the nodes [N mm].
struct Work {
  double external = 0.0, damping = 0.0, contact = 0.0, friction = 0.0;
  void add(const Work& other) {
    external += other.external, damping += other.damping;
    contact += other.contact, friction += other.friction;
  }
};

// What has been done by moving some nodes, and the largest of their speeds squared [mm2/s2].
struct Moved {
  Work work;
  double fastest = 0.0;
};

}  // namespace presswork::explicit_dynamics
