// SPDX-License-Identifier: Apache-2.0
// What loops on the parts of one mesh tell each other, each in a process of its own (a rank).
//
// A part has the elements that touch the nodes it owns; their other nodes are its ghosts, which other parts own.
// Elements at a border are computed by each part that owns a node of them, from the same numbers in the same order, so
// forces on own nodes are whole, and of ghosts only the motion comes from their owners. A cycle:
//
//   own nodes move       out is filled; send()
//   all own speeds known shared is filled; propose(), behind receive() where nodes follow others
//   elements without a ghost
//   receive()            in is there, ghosts move
//   elements with ghosts
//   agree()              shared is there: the fastest node, the forces on tools that forces place
//   interactions act
#pragma once

#include <cstdint>
#include <vector>

namespace presswork::explicit_dynamics {

class Neighbours {
 public:
  // Of a node: its velocities, and of a sheet half its thickness and the room between its tools [mm].
  static constexpr int half = 6, room = 7;
  int record = 8;  // numbers of a node: 8 where there is a sheet, 3 of solids in space, 2 in the plane
  static constexpr int first_force = 1;  // in shared, behind the largest speed of a node, infinite where a part fails

  virtual ~Neighbours() = default;
  virtual void send() = 0;
  virtual void propose() = 0;
  virtual void receive() = 0;
  virtual void agree() = 0;
  // Find the largest of each of n numbers of all parts, in place.
  virtual void find_largest(double* numbers, int n) = 0;

  std::vector<int> sent, ghosts;         // nodes, those of each neighbour together
  std::vector<char> is_ghost;            // (n)
  double *out = nullptr, *in = nullptr;  // (sent, record), (ghosts, record)
  // Largest of the first, sums of the others: 1 + 3 for each tool of a sheet + 4 for each of solids, in the plane 2.
  double* shared = nullptr;
  int n_shared = 1;
  bool leads = false;  // counts what belongs to no node and no element
};

}  // namespace presswork::explicit_dynamics
