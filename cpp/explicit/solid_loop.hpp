// SPDX-License-Identifier: Apache-2.0
// Central differences for solids in the plane or in axisymmetry: n cycles a call, threaded, with the same bits for any
// number of threads.
//
// A cycle: nodes    a = (f_ext - f_int)/m, v += a h, walls correct v, x += v dt
//          cells    forces at x, over the move v dt, tile by tile (tile_sums.hpp)
// h is the mean of this step and the last, so the step may change from call to call. At the end of a call x and f_int
// belong to time t, v to t - dt/2.
//
// Four nodes are moved at a time, as one vector; those that touch walls or are held, and their neighbours in the four,
// one by one.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "explicit/rigid_wall.hpp"
#include "explicit/solid_block.hpp"
#include "explicit/tile_sums.hpp"

namespace presswork::explicit_dynamics {

struct SolidEnergies {
  double kinetic = 0.0;    // v(-dt/2) m v(+dt/2)/2
  double internal = 0.0;   // work of the stresses
  double hourglass = 0.0;  // work of the hourglass forces
  double external = 0.0;   // work of nodal forces, of prescribed velocities and of moving walls
  double damping = 0.0;    // taken away by mass damping
  double contact = 0.0;    // lost where nodes strike walls
  double friction = 0.0;   // lost in sliding along them
};

class SolidLoop {
 public:
  // points (n, 2) [mm]: x is the radius in axisymmetry. contact (n): nodes that walls hold.
  SolidLoop(int n_nodes, const double* points, const std::uint8_t* contact, const SolidSection& section);

  SolidLoop(const SolidLoop&) = delete;
  SolidLoop& operator=(const SolidLoop&) = delete;

  void add(std::string_view element, std::vector<int> cells, SolidLawChoice law, double density);
  void add_wall(std::vector<double> segments, double mu);
  // Sum up the nodes' masses from the cells', after mass or mass_factor of a block has changed.
  void weigh();
  // Prescribe the velocity (n, 2) of the freedoms marked in fixed (n, 2).
  void prescribe(const std::uint8_t* fixed, const double* velocity);

  // Advance n cycles of dt from `time` [s]; the step before was dt_before. The scales (n) multiply force and prescribed
  // velocities (of walls too) in each cycle; damping [1/s]. Returns -1, or SolidBlock::reasons times the number of a
  // cell, counted through the blocks, plus why it failed.
  int advance(int n, double time, double dt, double dt_before, double damping, const double* force_scale,
              const double* velocity_scale);
  // Energies now; dt is the next step, dt_before the last; scales are those of the next cycle.
  SolidEnergies energies(double dt, double dt_before, double damping, double force_scale, double velocity_scale) const;

  const SolidSection section;
  const int n_nodes;
  std::vector<SolidBlock> blocks;
  std::vector<std::unique_ptr<RigidWall>> walls;
  AlignedArray<double> nodes;                            // (n, 4) as SolidBlock takes them
  AlignedArray<double> velocity, force, internal_force;  // (n, 2), as the others filled up to fours
  std::vector<double> mass;                              // (n) [t]
  std::vector<double> reaction_impulse;  // (n, 2): of what holds prescribed freedoms, added up until set to zero [N s]
  struct Work {
    double external = 0.0, damping = 0.0, contact = 0.0, friction = 0.0;
  };
  Work work;  // up to half a step back

 private:
  struct Step {
    double dt, mean_dt, damping, force_scale, velocity_scale;
    double kept = (1.0 - 0.5 * damping * mean_dt) / (1.0 + 0.5 * damping * mean_dt);
    double push = mean_dt / (1.0 + 0.5 * damping * mean_dt);
  };
  std::size_t padded() const { return (std::size_t(n_nodes) + 3) / 4 * 4; }
  void make_tiles();
  void mark_special();
  // Velocity half a step on of one node, and what forces and walls do meanwhile: over the whole step, when the walls'
  // forces are kept too, or over its first half.
  Work step_node(int node, const Step& step, bool whole, double after[2]) const;
  static void add_to(Work& sum, const Work& part);
  // Forces of each wall on these nodes are added to wall_force (n walls, 2).
  Work move_nodes(int first, int last, const Step& step, double* wall_force);
  void move_four(int first, const Step& step, Record& external, Record& damped);
  void move_one(int node, const Step& step, Work& sum, double* wall_force);
  int advance_tile(const Tile& tile, double dt, double time, double* scratch);

  std::vector<std::uint8_t> contact_, fixed_;  // (n); (n, 2): velocity is prescribed
  std::vector<std::uint8_t> special_;          // of each four nodes: one touches walls or is held
  AlignedArray<double> inverse_mass_;          // (n, 2) [1/t]
  std::vector<double> prescribed_;             // (n, 2)
  TileSums<double, 2> tiles_;
};

}  // namespace presswork::explicit_dynamics
