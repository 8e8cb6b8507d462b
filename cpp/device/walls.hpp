// SPDX-License-Identifier: Apache-2.0
// Rigid tools of solids in a cycle with a lane a thread: the pass that moves a node corrects its velocity by them
// (explicit/space/wall_touch.hpp), and one pass more moves the tools.
//
//   meet_walls   one node of the solids' surface against all tools, before it moves
//   push_walls   the same: the forces on it, to be summed up over chunks of 256 nodes in a fixed order
//   move_walls   one lane: the tools, by the sums and by the largest speed of a node
#pragma once

#include "device/nodes.hpp"
#include "device/tools.hpp"
#include "explicit/exact_sum.hpp"
#include "explicit/space/wall_touch.hpp"

namespace presswork::device {

using explicit_dynamics::WallBody;
using explicit_dynamics::WallNodes;

// Force on the nodes of a chunk [N] and its moment about a tool's axis [N mm].
struct WallSums {
  double of[4] = {0.0, 0.0, 0.0, 0.0};

  PRESSWORK_DEVICE WallSums& operator+=(const WallSums& other) {
    for (int i = 0; i < 4; ++i) of[i] += other.of[i];
    return *this;
  }
};

struct Walls {
  int n = 0;               // no walls: nothing else is set
  const char* touches;     // (n_nodes): nodes of the surface of solids
  WallBody* wall;          // (n)
  const Surface* surface;  // (n)
  const WallNodes* node;   // (n)
  double* work;            // (n_nodes, 2): at contact and in friction, summed up over the cycles [N mm]
  double* fastest;         // (chunks): squares of the largest speeds
  WallSums* sums;          // (chunks, n)
};

// What meet_walls of explicit/ asks for.
PRESSWORK_INLINE auto see_walls(const Walls& walls) {
  return
      [&walls](int i) { return explicit_dynamics::WallView<Surface>{walls.wall[i], walls.node[i], walls.surface[i]}; };
}

// Correct the velocity v of a node at x; gives the work of the walls from outside.
PRESSWORK_INLINE double meet_walls(const Walls& walls, const Step& step, int node, const double x[3],
                                   const double before[3], double inverse, const explicit_dynamics::FreeMotion& free,
                                   double v[3]) {
  if (walls.n == 0 || !walls.touches[node]) return 0.0;
  const auto done =
      explicit_dynamics::meet_walls(walls.n, see_walls(walls), node, x, before, inverse, free, step, true, v);
  walls.work[2 * std::size_t(node)] += done.contact, walls.work[2 * std::size_t(node) + 1] += done.friction;
  return done.external;
}

// x: where the node was before it moved. take(i, sums) is called once for every wall, whatever the node does, and with
// `there` false, of lanes beyond the last node.
template <class Take>
PRESSWORK_INLINE void push_walls(const Walls& walls, int node, bool there, const double x[3], const Take& take) {
  for (int i = 0; i < walls.n; ++i) {
    WallSums sums;
    if (there && walls.touches[node]) {
      const double* force = walls.node[i].force + 3 * std::size_t(node);
      for (int k = 0; k < 3; ++k) sums.of[k] = explicit_dynamics::round_force(force[k]);
      sums.of[3] = explicit_dynamics::round_force(walls.wall[i].motion.moment(x, force));
    }
    take(i, sums);
  }
}

// One lane, for wall i: sum, what all nodes together have of it.
PRESSWORK_DEVICE inline void move_wall(const Walls& walls, const Step& step, double fastest, int i,
                                       const WallSums& sum) {
  walls.wall[i].advance(step, std::sqrt(fastest), sum.of);
}

}  // namespace presswork::device
