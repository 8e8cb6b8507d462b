// SPDX-License-Identifier: Apache-2.0
// Contact of explicit shells with shells, of one sheet or of several: both faces, with their thickness, Coulomb
// friction.
//
// A node at distance d of a shell's mid-surface is pressed in by p = (t_node + t_shell)/2 - d > 0, along the line from
// the closest place of the shell (closest_on_cell.hpp) to the node, and feels there
//
//   N = k p + c p',  k = penalty m/dt^2,  c = 2 damping sqrt(k m),  never below zero,
//   T = T_n - k ds (tangential), shortened to mu N: Coulomb with an elastic stick, as with tools (tool_contact.hpp).
//
// m is the least mass of the node and of the shell's corners. The shell's corners feel the opposite force, shared out
// by the weights of the place: momentum is kept, and without friction its moment, too. Nodes of both sheets are
// pressed in by shells of the other: the two together are as stiff as one tool of twice the penalty.
//
// Partners. A node may touch a shell on each of its faces: that in which it is deepest, and of those on the other side
// of the node (whose line points the other way) that in which it is deepest. A node that has come through the
// mid-surface of the shell that it touched, or of a neighbour of that, is pushed back out of the side that it came
// from.
//
// Step. Gershgorin's bound of what contact adds to w^2 dt^2 is 2 penalty for a node on a shell, and as much again for
// the shell's nodes, on each face: 8 penalty, where tools add 2 penalty of their own (tool_contact.hpp).
//
// Search. Shells within reach of a node, thickness and a margin, are listed anew once the fastest node has gone half
// the margin since. A pair of node and shell sleeps until their nodes have gone 0.9 of its gap.
//
// Forces are found node by node and gathered node by node, in the order of cells and of nodes: no sum depends on the
// threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "contact/near_shells.hpp"
#include "explicit/state_field.hpp"

namespace presswork::explicit_dynamics {

// How shells touch shells.
struct ShellGrip {
  double friction;  // Coulomb's coefficient
  double penalty;   // stiffness over mass/dt^2
  double damping;   // over critical
};

class ShellContact : private contact::NearShells {
 public:
  static constexpr int chunk = 256;  // nodes whose forces are found in one go
  static constexpr int faces = 2;    // of a node, at each of which it may touch a shell

  // Work that contact has taken from the nodes [N mm].
  struct Work {
    double elastic = 0.0, friction = 0.0, damping = 0.0;
  };

  // What NearShells takes, and how they touch.
  ShellContact(int n_nodes, std::vector<int> cell_start, std::vector<int> cell_node, const double* undeformed,
               double thickness, const ShellGrip& grip);

  // Take the nodes' masses [t] and the step.
  void set_stiffness(const std::vector<double>& node_mass, double dt);
  double step() const { return step_; }

  // One cycle. The nodes have moved by a step (one thread; fastest: the largest speed of a node), after which the whole
  // sheet may have to be looked at: pass says so, and follow does it; then chunks of nodes find their forces, and then
  // chunks of nodes gather them off net (n, 6), internal less external forces, of nodes whose place there is not -1.
  bool pass(double dt, double fastest);
  template <class View>
  void follow(const View& sheet) {
    if (is_due_) search(sheet);
  }
  template <class View>
  void find_forces(int c, const View& sheet);
  template <class Real>
  void gather(int c, Real* net, const int* place = nullptr) const;
  void close_cycle();
  int chunks() const { return (n_nodes_ + chunk - 1) / chunk; }
  // After pass, where the whole sheet is not looked at: list the nodes whose motion, and the cells whose thickness
  // forces depend on in this cycle, which those of pairs that sleep do not.
  void list_awake();
  const std::vector<int>& nodes_awake() const { return nodes_awake_; }
  const std::vector<int>& cells_awake() const { return cells_awake_; }

  const Work& work() const { return total_; }
  // Forces on the nodes (n_nodes, 3) [N], added.
  void add_forces(double* force) const;
  // Overlap of the deepest node with a shell [mm], and which they are; 0, -1, -1: none.
  template <class View>
  double deepest(const View& sheet, int& node, int& cell);
  void list_state(std::vector<StateField>& fields);

 private:
  static constexpr double reach_awake = 0.9;  // of its gap a pair sleeps
  // What a node touches with one face.
  struct Slot {
    int cell = -1;  // none: all below is zero
    int entry = -1;
    double normal[3] = {}, shear[3] = {};  // unit vector towards the node; friction on the node [N]
    double elastic = 0.0, viscous = 0.0;   // [N]
    double weight[4] = {};                 // of the cell's corners
  };
  static constexpr int kept = 13;  // numbers of a slot in the state
  // A place of a shell as a node sees it.
  struct Seen {
    int entry = -1;
    double depth, distance, normal[3], weight[4];
  };

  bool are_neighbours(int cell, int other) const;
  // half: thickness of nodes and cells [mm].
  void search(const double* position, const std::vector<double>& half_node, const std::vector<double>& half_cell);
  template <class View>
  void search(const View& sheet);
  template <class View>
  double half_of_node(int node, const View& sheet) const;
  template <class View>
  Seen look(int node, int entry, double half, const View& sheet) const;
  template <class View>
  void slip(int node, const View& sheet, int cell, const double weight[4], double dx[3]) const;
  template <class View>
  void touch(int node, const View& sheet, const Seen& at, const Slot& before, Slot& now) const;
  template <class View>
  void add_work(int node, const View& sheet, const Slot& slot, Work& work) const;
  // Force on the node.
  static void add_force(const Slot& slot, double scale, double force[3]) {
    for (int i = 0; i < 3; ++i) force[i] += scale * ((slot.elastic + slot.viscous) * slot.normal[i] + slot.shear[i]);
  }
  void gather_node(int node, double force[3]) const;

  ShellGrip grip_;
  std::vector<double> base_;  // mass/dt^2 [N/mm]
  double step_ = 0.0;
  // What the search has found: entries of each node, and those of each cell in the order of the nodes.
  bool searched_ = false, is_due_ = true;
  double margin_, travel_ = 0.0, next_search_ = 0.0;
  Entries entries_;
  std::vector<int> of_cell_start_, of_cell_;
  std::vector<int> near_start_, near_;  // of each chunk: nodes that have entries, or whose shells have
  std::vector<int> nodes_awake_, cells_awake_;
  std::vector<char> knows_node_, knows_cell_;  // they are in these lists
  std::vector<double> wake_;
  std::vector<signed char> active_;  // of entries: the face that touches, -1: none
  std::vector<Slot> slots_;          // (n_nodes, faces)
  std::vector<Work> works_;          // of chunks, in this cycle
  Work total_;
};

template <class View>
double ShellContact::half_of_node(int node, const View& sheet) const {
  const int first = node_start_[node], last = node_start_[node + 1];
  double sum = 0.0;
  for (int s = first; s < last; ++s) sum += sheet.thickness(node_cell_[s]);
  return last > first ? 0.5 * sum / (last - first) : 0.0;
}

template <class View>
void ShellContact::search(const View& sheet) {
  const int n_cells = static_cast<int>(cell_start_.size()) - 1;
  std::vector<double> half_node(n_nodes_), half_cell(n_cells);
  for (int i = 0; i < n_nodes_; ++i) half_node[i] = half_of_node(i, sheet);
  for (int c = 0; c < n_cells; ++c) half_cell[c] = corners(c) > 0 ? 0.5 * sheet.thickness(c) : 0.0;
  search(sheet.position, half_node, half_cell);
}

template <class View>
ShellContact::Seen ShellContact::look(int node, int entry, double half, const View& sheet) const {
  const int cell = entries_.cell[entry], n = corners(cell);
  const double* x = sheet.position + 4 * std::size_t(node);
  double corner[4][3];
  for (int a = 0; a < n; ++a)
    std::memcpy(corner[a], sheet.position + 4 * std::size_t(cell_node_[cell_start_[cell] + a]), sizeof corner[a]);
  const contact::OnCell at = contact::find_closest_on_cell(x, n, corner);
  Seen seen;
  seen.entry = entry, seen.distance = std::sqrt(at.squared);
  std::copy_n(at.weight, 4, seen.weight);
  double sign = 1.0;
  for (int f = 0; f < faces; ++f) {  // come through what it touched, or its neighbour
    const Slot& slot = slots_[std::size_t(node) * faces + f];
    if (slot.cell < 0 || contact::dot(slot.normal, at.away) >= 0.0) continue;
    if (slot.cell == cell || are_neighbours(slot.cell, cell)) sign = -1.0;
  }
  const double limit = 1e-9 * half;
  if (seen.distance > limit) {
    for (int i = 0; i < 3; ++i) seen.normal[i] = sign * at.away[i] / seen.distance;
  } else {  // in the mid-surface: out along the shell's normal
    double d[3], e[3];
    for (int i = 0; i < 3; ++i) d[i] = corner[2][i] - corner[0][i], e[i] = corner[n - 1][i] - corner[1][i];
    contact::cross(d, e, seen.normal);
    const double size = std::sqrt(contact::dot(seen.normal, seen.normal));
    for (double& each : seen.normal) each /= size;
  }
  seen.depth = half + 0.5 * sheet.thickness(cell) - sign * seen.distance;
  return seen;
}

template <class View>
void ShellContact::slip(int node, const View& sheet, int cell, const double weight[4], double dx[3]) const {
  const auto* own = sheet.motion + 8 * std::size_t(node);
  for (int i = 0; i < 3; ++i) dx[i] = double(own[i]);
  for (int a = 0; a < corners(cell); ++a) {
    const auto* v = sheet.motion + 8 * std::size_t(cell_node_[cell_start_[cell] + a]);
    for (int i = 0; i < 3; ++i) dx[i] -= weight[a] * double(v[i]);
  }
  for (int i = 0; i < 3; ++i) dx[i] *= sheet.dt;
}

// Half of the work of its forces over the step: by those at its begin, or at its end.
template <class View>
void ShellContact::add_work(int node, const View& sheet, const Slot& slot, Work& work) const {
  if (slot.cell < 0) return;
  double dx[3];
  slip(node, sheet, slot.cell, slot.weight, dx);
  const double closing = contact::dot(slot.normal, dx);
  work.elastic -= 0.5 * slot.elastic * closing;
  work.damping -= 0.5 * slot.viscous * closing;
  work.friction -= 0.5 * contact::dot(slot.shear, dx);
}

template <class View>
void ShellContact::touch(int node, const View& sheet, const Seen& at, const Slot& before, Slot& now) const {
  const int cell = entries_.cell[at.entry];
  double base = base_[node];
  for (int a = 0; a < corners(cell); ++a) base = std::min(base, base_[cell_node_[cell_start_[cell] + a]]);
  const double k = grip_.penalty * base;
  double dx[3];
  slip(node, sheet, cell, at.weight, dx);
  // 1. normal force; the damper never pulls
  const double closing = contact::dot(at.normal, dx);
  now.cell = cell, now.entry = at.entry;
  now.elastic = k * at.depth, now.viscous = 0.0;
  if (sheet.dt > 0.0) {
    const double c = 2.0 * grip_.damping * std::sqrt(grip_.penalty) * base * step_ / sheet.dt;
    now.viscous = std::max(-c * closing, -now.elastic);
  }
  std::copy_n(at.normal, 3, now.normal), std::copy_n(at.weight, 4, now.weight);
  // 2. friction: elastic trial in the present tangent plane, shortened to mu N
  const double out = contact::dot(at.normal, before.shear), limit = grip_.friction * (now.elastic + now.viscous);
  for (int i = 0; i < 3; ++i)
    now.shear[i] = before.shear[i] - out * at.normal[i] - k * (dx[i] - closing * at.normal[i]);
  const double size = std::sqrt(contact::dot(now.shear, now.shear));
  if (size > limit)
    for (double& each : now.shear) each *= limit / size;
}

template <class View>
void ShellContact::find_forces(int c, const View& sheet) {
  Work work;
  for (int near = near_start_[c]; near < near_start_[c + 1]; ++near) {
    const int node = near_[near], first = entries_.start[node], last = entries_.start[node + 1];
    Slot* slots = &slots_[std::size_t(node) * faces];
    if (first == last && slots[0].cell < 0) continue;
    Seen best[faces];
    double half = -1.0;
    // 1. what touches: the deepest of all
    const auto consider = [&](int face) {
      for (int e = first; e < last; ++e) {
        if (wake_[e] > travel_) continue;
        if (half < 0.0) half = half_of_node(node, sheet);
        const Seen seen = look(node, e, half, sheet);
        if (seen.depth <= 0.0) {
          wake_[e] = travel_ - reach_awake * seen.depth;
          continue;
        }
        if (face > 0 && contact::dot(seen.normal, best[0].normal) >= 0.0) continue;
        if (best[face].entry < 0 || seen.depth > best[face].depth) best[face] = seen;
      }
    };
    consider(0);
    if (best[0].entry >= 0) consider(1);  // 2. the deepest on the other side; those that are off have fallen asleep
    // 3. forces; friction goes on where a face touched on the same side
    Slot now[faces];
    for (int f = 0; f < faces; ++f) {
      add_work(node, sheet, slots[f], work);
      if (slots[f].entry >= 0) active_[slots[f].entry] = -1;
    }
    for (int f = 0; f < faces; ++f) {
      if (best[f].entry < 0) continue;
      Slot none;
      const Slot* before = &none;
      for (int b = 0; b < faces; ++b)
        if (slots[b].cell >= 0 && contact::dot(slots[b].normal, best[f].normal) > 0.0) before = &slots[b];
      touch(node, sheet, best[f], *before, now[f]);
      add_work(node, sheet, now[f], work);
    }
    for (int f = 0; f < faces; ++f) {
      slots[f] = now[f];
      if (now[f].entry >= 0) active_[now[f].entry] = static_cast<signed char>(f);
    }
  }
  works_[c] = work;
}

template <class Real>
void ShellContact::gather(int c, Real* net, const int* place) const {
  for (int near = near_start_[c]; near < near_start_[c + 1]; ++near) {
    const int node = near_[near], to = place ? place[node] : node;
    if (to < 0) continue;
    double force[3] = {};
    gather_node(node, force);
    for (int i = 0; i < 3; ++i) net[6 * std::size_t(to) + i] -= static_cast<Real>(force[i]);
  }
}

template <class View>
double ShellContact::deepest(const View& sheet, int& node, int& cell) {
  if (!searched_) search(sheet);
  double worst = 0.0;
  node = cell = -1;
  for (int i = 0; i < n_nodes_; ++i) {
    const double half = half_of_node(i, sheet);
    for (int e = entries_.start[i]; e < entries_.start[i + 1]; ++e)
      if (const Seen seen = look(i, e, half, sheet); seen.depth > worst)
        worst = seen.depth, node = i, cell = entries_.cell[e];
  }
  return worst;
}

}  // namespace presswork::explicit_dynamics
