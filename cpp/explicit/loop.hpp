// SPDX-License-Identifier: Apache-2.0
// Central differences over blocks of elements and a list of interactions: n cycles a call, threaded, with the same bits
// for any number of threads.
//
// A cycle: nodes         a = (f_ext - f_int)/m, v += a h, x += v dt; then those that follow others
//          elements      f_int at x, over the move v dt, tile by tile (tile_sums.hpp)
//          interactions  their forces are taken off f_int
// h is the mean of this step and the last, so the step may change from call to call. At the end of a call x and the
// forces belong to time t, v to t - dt/2.
//
// Nodes says what a node is: in space (space_nodes.hpp) shells and solids may stand in one model, in the plane
// (plane_nodes.hpp) there are solids.
#pragma once

#include <memory>
#include <vector>

#include "explicit/element_block.hpp"
#include "explicit/interaction.hpp"
#include "explicit/neighbours.hpp"
#include "explicit/phase_clock.hpp"
#include "explicit/tile_sums.hpp"
#include "explicit/work_shares.hpp"

namespace presswork::explicit_dynamics {

template <class Nodes>
class Loop {
 public:
  using Real = typename Nodes::Real;
  explicit Loop(Nodes nodes) : nodes(std::move(nodes)) {}
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;
  virtual ~Loop() = default;

  // Take in a block of elements; they are numbered in the order of the blocks.
  void add(std::unique_ptr<ElementBlock<Nodes>> block);
  int n_elements() const;
  // Sum up the nodes' masses, after those of elements have changed.
  void set_masses();
  // Those sums (n, Nodes::masses).
  std::vector<double> sum_all_masses();
  // Let ghosts have masses (n, Nodes::masses) that this part does not sum up: contact of bodies asks for them.
  void set_ghost_masses(std::vector<double> of);
  std::vector<double> element_masses() const;

  // An element has failed in a cycle of a call; of several the first in number. status: a LawStatus, `done` where the
  // element is turned inside out.
  struct Failure {
    int element = -1, status = 0, cycle = -1;
  };
  // Cycles of dt from `time` on; the step before was dt_before [s]. The scales (n) multiply forces and prescribed
  // velocities, of walls too, in each cycle; damping [1/s].
  struct Cycles {
    int n;
    double time, dt, dt_before, damping;
    const double *force_scale, *velocity_scale;
  };
  // Advance all cycles, or up to that in which an element fails.
  Failure advance(const Cycles& cycles);
  // Energies at the present time; step: the next. Those of a part are its share.
  Energies energies(const Step& step) const;
  // Advance the elements alone, and with them the internal force.
  void advance_elements(double dt);
  // All that the next cycle depends on, by owner and name.
  std::vector<StateField> state();
  std::vector<StateField> body_state();  // of it that of nodes and elements

  Nodes nodes;
  std::vector<std::unique_ptr<ElementBlock<Nodes>>> blocks;
  std::vector<Interaction<Nodes>*> interactions;  // in the order in which they act
  Work work;                                      // up to half a step back
  double seconds[n_phases] = {};                  // of wall time by phase, in all calls of advance

  // Let this loop be one of those on the parts of a mesh; before there are tools.
  virtual void join(std::unique_ptr<Neighbours> of);
  const Neighbours* parts() const { return neighbours_.get(); }  // null: the loop has the whole mesh

 protected:
  std::vector<double> sum_masses() const;
  std::unique_ptr<Neighbours> neighbours_;  // none: the loop has the whole mesh
  std::vector<double> ghost_masses_;        // (n, Nodes::masses), or none
  // Fill what goes to neighbours; take what comes from them: ghosts move by dt, and what all parts share.
  virtual void tell_neighbours() {}
  virtual void move_ghosts(double /*dt*/) {}
  virtual void take_shared() {}
  virtual bool shares_enough() const { return false; }

 private:
  struct Team;    // what the threads of a call share
  struct Thread;  // and what each has to itself
  void move_nodes(Team& team, Thread& own, const Step& step);
  // False where an element has failed, here or in another part.
  bool advance_tiles(Team& team, Thread& own, const Step& step, int cycle, double time);
  void take_tiles(Team& team, Thread& own, int share, double dt, double time);
  // Tell the other parts the largest speed of a node, and what forces are to be summed up.
  void propose(double fastest);
  // Let ghosts move where what follows nodes asks for them; else elements without ghosts come first.
  bool awaits_ghosts() const;
  // One thread: find the largest speed of all parts, and let interactions move; false where a part has failed.
  bool agree(Team& team, const Step& step, int cycle);
  void order_tiles();
  void let_interactions_act(Team& team, Thread& own, const Step& step, int cycle);
  // Advance the elements of a tile and sum up their forces; gives the first that has failed, as its block does.
  int advance_tile(const Tile& tile, double dt, double time, Real* scratch);

  TileSums<Real, Nodes::freedoms> tiles_;
  std::vector<int> turn_;  // tiles: first those without ghosts, n_inner_ of them
  int n_inner_ = 0;
};

}  // namespace presswork::explicit_dynamics
