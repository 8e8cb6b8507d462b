// SPDX-License-Identifier: Apache-2.0
// Contact of a sheet of shells with itself in the implicit procedure: which shells its nodes touch, forces, tangent.
//
// A node may touch a shell on each of its two faces: of those on that side the one that it is deepest in. Slot
// 2 i + 1 of node i is the face towards which the corners of its shells turn right-handed, slot 2 i the other one, as
// the sheet lies when the increment begins. With d the distance of the node from the closest place of the shell
// (closest_on_cell.hpp) and n the direction from there to the node,
//
//   gap g = d - (t_node + t_shell) / 2,
//   force on the node f = N(g) n + T,   T = P (T_n - k_t s), P = I - n n^T, shortened to mu N,
//
// s being the way of the node in the increment less that of the material at the place. The shell's corners feel -w_a f,
// w_a their weights there. N is linear in g near its value: which tangent of the law is taken the caller says
// (interaction/space_touch.py). The tangent has all derivatives, those of n and w_a, too, by dual numbers.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "contact/near_shells.hpp"

namespace presswork::contact {

// Arrays (n_nodes, 3), at a guess and when the increment began, and half the thickness of nodes and cells [mm].
struct SheetPlace {
  const double *now, *before, *half_node, *half_cell;
};

// What a slot touches.
struct SlotTouch {
  int slot, cell;
  double push, slope;  // normal force [N] and its derivative by the gap [N/mm]
  double hanging;      // stiffness against slip [N/mm]
  double shear_n[3];   // friction on the node when the increment began [N]
};

struct SlotForce {
  double force[5][3];          // on the node and the shell's corners [N]
  double tangent[5][5][3][3];  // d(-force)/dx of each pair of them [N/mm]
  double shear[3], slip[3];    // friction on the node [N], its way along the shell [mm]
};

class SheetOnItself : public NearShells {
 public:
  using NearShells::NearShells;

  int n_nodes() const { return n_nodes_; }
  int n_cells() const { return static_cast<int>(cell_start_.size()) - 1; }
  // Take the shells within `margin` of touching each node as those that it may touch. Returns the pairs of nodes and
  // corners of these, each once.
  std::vector<std::pair<int, int>> search(const double* position, const std::vector<double>& half_node,
                                          const std::vector<double>& half_cell, double margin);
  // Find what each slot touches with a gap below `reach` [mm]: cell (-1: nothing), gap and normal. Returns a node that
  // has come through a shell in the increment, -1 if none has.
  int look(const SheetPlace& sheet, double reach, int* cell, double* gap, double* normal) const;
  // nodes: the node and the corners, of a triangle the last one twice.
  void touch(const SheetPlace& sheet, const SlotTouch& at, double mu, int nodes[5], SlotForce& found) const;

 private:
  void list_nodes(int node, int cell, int nodes[5]) const;
  void find_normal(int node, const double* position, double normal[3]) const;

  Entries entries_;
};

}  // namespace presswork::contact
