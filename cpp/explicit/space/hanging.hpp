// SPDX-License-Identifier: Apache-2.0
// Hanging nodes of a sheet that is refined in part: in the middle of a side that the shell beyond has whole.
//
// A hanging node m follows the ends 1, 2 of the side, with d = x2 - x1, its height h = x_m - (x1 + x2)/2 over the side,
// n the sheet's normal there and bars for means of the ends:
//
//   w_m = w_bar,  v_m = v_bar + w_bar x h + n n.((w1 - w2) x d)/8
//
// The last term is the sag of a side whose slope runs linearly from end to end, as the rotations do: without it the two
// halves of the side would feel shear in bending, and lock. A deflection of second degree is followed exactly, and
// so is any rigid motion. Drilling rotations have no share, since n.(w x d) and w x h leave them out (h is along n).
// The force f and moment c of m go to the ends as virtual power asks; with a = (f.n)(d x n)/8:
//
//   f_i = f/2,  c_1 = c/2 + (h x f)/2 + a,  c_2 = c/2 + (h x f)/2 - a
//
// so forces and moments balance. Half of its mass goes to each end, and twice its rotary inertia, which is above what
// the sag of the mass asks for: the stable step of the shells stays a bound.
#pragma once

#include <stdexcept>
#include <vector>

#include "explicit/interaction.hpp"
#include "explicit/space/nodes.hpp"

namespace presswork::explicit_dynamics {

struct HangingNode {
  int node, end[2];
  int across[4];  // the far nodes of the shells on either side of the side: two of the whole one, two of the halves
};

template <class Real>
class HangingNodes final : public Interaction<SpaceNodes<Real>> {
 public:
  using Nodes = SpaceNodes<Real>;
  // Throws std::invalid_argument where the end of a side hangs itself, or a number names no node.
  void set(Nodes& nodes, std::vector<HangingNode> hanging);

  int n() const { return static_cast<int>(hanging_.size()); }
  int n_ends() const { return static_cast<int>(end_.size()); }
  const std::vector<HangingNode>& all() const { return hanging_; }
  bool hangs(int node) const { return !hangs_.empty() && hangs_[node]; }

  Phase phase() const override { return Phase::nodes; }
  void begin(Nodes& nodes, int) override { measure(nodes, 0, n()); }
  int n_following() const override { return count_chunks(n()); }
  double follow(Nodes& nodes, const Step& step, int piece) override {
    return carry(nodes, step.dt, piece * chunk, std::min(n(), (piece + 1) * chunk));
  }
  // Hanging nodes give their forces away; then the ends take them.
  int n_rounds() const override { return n() > 0 ? 2 : 0; }
  int n_pieces(int round) const override { return count_chunks(round == 0 ? n() : n_ends()); }
  void act(Nodes& nodes, const Step&, int, int round, int piece) override {
    if (round == 0)
      take_forces(nodes, piece * chunk, std::min(n(), (piece + 1) * chunk));
    else
      give_forces(nodes, piece * chunk, std::min(n_ends(), (piece + 1) * chunk));
  }
  void share_masses(std::vector<double>& sum) override;

  // Let the ends have the forces of hanging nodes; outside of a cycle.
  void give_all_forces(Nodes& nodes) { take_forces(nodes, 0, n()), give_forces(nodes, 0, n_ends()); }

 private:
  // Where sides and heights are now, for the next move.
  void measure(const Nodes& nodes, int first, int last);
  // Move hanging nodes [first, last) with their ends by dt; returns their largest speed squared.
  double carry(Nodes& nodes, double dt, int first, int last) const;
  // Measure, and take the forces off hanging nodes [first, last); then let the ends [first, last) have them.
  void take_forces(Nodes& nodes, int first, int last);
  void give_forces(Nodes& nodes, int first, int last) const;

  struct Side {
    double along[3], normal[3], height[3];  // d, n, h
  };
  struct Given {
    double force[3], moment[2][3];  // to each end, to the first and to the second
  };
  std::vector<HangingNode> hanging_;
  std::vector<char> hangs_;  // (n_nodes), or none
  std::vector<Side> side_;
  std::vector<Given> given_;
  std::vector<int> end_, end_start_, end_entry_;  // ends, and what they get: twice the hanging node, plus 1 of a second
};

}  // namespace presswork::explicit_dynamics
