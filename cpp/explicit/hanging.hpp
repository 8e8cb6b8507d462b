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

#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

struct HangingNode {
  int node, end[2];
  int across[4];  // the far nodes of the shells on either side of the side: two of the whole one, two of the halves
};

template <class Real>
class HangingNodes {
 public:
  // Throws std::invalid_argument where the end of a side hangs itself, or a number names no node.
  void set(int n_nodes, std::vector<HangingNode> hanging);

  int n() const { return static_cast<int>(hanging_.size()); }
  int n_ends() const { return static_cast<int>(end_.size()); }
  const std::vector<HangingNode>& all() const { return hanging_; }
  bool has(int node) const { return !hangs_.empty() && hangs_[node]; }

  // Give masses and rotary inertias (n_nodes, 2) of hanging nodes to their ends.
  void give_masses(std::vector<double>& sum) const;

  // Where sides and heights are now, for the next move.
  void measure(const Nodes<Real>& nodes, int first, int last);
  // Move hanging nodes [first, last) with their ends by dt; returns their largest speed squared.
  double move(Nodes<Real>& nodes, double dt, int first, int last) const;
  // Measure, and take the forces (n_nodes, 6) off hanging nodes [first, last); then let the ends [first, last) have
  // them.
  void take_forces(const Nodes<Real>& nodes, Real* force, int first, int last);
  void give_forces(Real* force, int first, int last) const;

 private:
  struct Side {
    double along[3], normal[3], height[3];  // d, n, h
  };
  struct Given {
    double force[3], moment[2][3];  // to each end, to the first and to the second
  };
  std::vector<HangingNode> hanging_;
  std::vector<Side> side_;
  std::vector<Given> given_;
  std::vector<char> hangs_;                       // of nodes
  std::vector<int> end_, end_start_, end_entry_;  // ends, and what they get: twice the hanging node, plus 1 of a second
};

}  // namespace presswork::explicit_dynamics
