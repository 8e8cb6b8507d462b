// SPDX-License-Identifier: Apache-2.0
// What acts on nodes beside their elements, as the explicit loop knows it: tools, beads, hanging nodes, walls.
//
// In a cycle an interaction is called in this order; what it does not override does nothing:
//   follow   nodes that follow others are moved, in pieces that threads share out
//   agree    by one thread of every part of a mesh in parts, when all nodes have moved: what the parts tell each other
//   move     by one thread, when all nodes have moved
//   act      when the elements have their forces: its own are taken off nodes.internal_force, in rounds one after the
//            other, each of pieces that threads share out
//   close    by one thread, when all rounds are over
// Interactions act one after the other, in the order of the loop's list.
#pragma once

#include <vector>

#include "explicit/neighbours.hpp"
#include "explicit/phase_clock.hpp"
#include "explicit/state_field.hpp"
#include "explicit/step.hpp"

namespace presswork::explicit_dynamics {

template <class Nodes>
class Interaction {
 public:
  virtual ~Interaction() = default;

  // Where its time is counted.
  virtual Phase phase() const { return Phase::contact; }
  // Before the first of n cycles. Throws std::invalid_argument where what drives it does not last so long.
  virtual void begin(Nodes&, int /*n_cycles*/) {}

  virtual int n_following() const { return 0; }
  // Returns the largest speed squared of the nodes of a piece.
  virtual double follow(Nodes&, const Step&, int /*piece*/) { return 0.0; }
  virtual void agree(Nodes&, Neighbours&, const Step&) {}
  virtual void move(const Step&, int /*cycle*/, double /*fastest*/) {}
  virtual int n_rounds() const { return 0; }
  virtual int n_pieces(int /*round*/) const { return 0; }
  virtual void act(Nodes&, const Step&, int /*cycle*/, int /*round*/, int /*piece*/) {}
  virtual void close() {}

  // Masses of the nodes (n, Nodes::masses), before they are taken.
  virtual void share_masses(std::vector<double>& /*sum*/) {}
  // dt: of the next step.
  virtual void add_energies(double /*dt*/, Energies&) const {}
  virtual void list_state(std::vector<StateField>&) {}
};

}  // namespace presswork::explicit_dynamics
