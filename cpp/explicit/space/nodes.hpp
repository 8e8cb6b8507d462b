// SPDX-License-Identifier: Apache-2.0
// Nodes in space: displacements and rotations, lumped mass and rotary inertia, as records that an element loads whole.
//
// A node that shells alone or solids alone, or both, are joined to: without a rotary inertia its rotations rest.
// Positions are double in single precision too: a step moves a node by less than a float of its coordinate resolves.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "explicit/nodes.hpp"
#include "explicit/space/held_along.hpp"
#include "explicit/space/rigid_wall.hpp"
#include "explicit/state_field.hpp"
#include "explicit/step.hpp"

namespace presswork::explicit_dynamics {

template <class R>
class SpaceNodes {
 public:
  using Real = R;  // of velocities, forces and elements; work and all that is done with a node in a step are double
  static constexpr int freedoms = 6, masses = 2, position_stride = 4, motion_stride = 8;
  static constexpr int serial_elements =
      1000;  // fewer are left to one thread: waking a second costs more than it gives
  static constexpr int record(int nodes_each) { return freedoms * nodes_each; }  // numbers of an element's forces

  // points (n, 3) [mm]
  SpaceNodes(int n, const double* points);

  // Take masses and rotary inertias (n, 2) [t, t mm2].
  void set_masses(const std::vector<double>& sum);
  // Prescribe velocities (n, 6) of the freedoms marked in fixed (n, 6).
  void prescribe(const std::uint8_t* fixed, const double* velocity);
  // Hold nodes (k, rising) along directions besides, until freedoms are prescribed anew.
  void hold_along(const std::vector<int>& node, std::vector<HeldAlong> held);
  // Move a node by its velocity, as it is kept: what moves a node is what strains its elements. Gives the velocity.
  Place step_on(int node, double dt) {
    double* x = position.data() + std::size_t(position_stride) * node;
    const Record own = load_record(motion.data() + std::size_t(motion_stride) * node);
    const Place velocity = __builtin_shufflevector(own, Record{}, 0, 1, 2, 8);
    store_place(load_place(x) + dt * velocity, x);
    return velocity;
  }
  // Note whether any force acts from outside; before moves, and again when forces are given.
  void note_forces() {
    is_pushed_ = std::any_of(force.data(), force.data() + force.size(), [](Real f) { return f != Real(0); });
  }
  // Advance nodes [first, last) by a step; those that follow others stay.
  Moved move(int first, int last, const Step& step);
  // Kinetic energy, and the work of the first half of the next step.
  void add_half_step(const Step& step, Energies& energies) const;
  void list_state(std::vector<StateField>& fields);
  // Freedoms that are held (n): a bit for each, the first the lowest, and `askew` of nodes held along directions; and
  // their velocities (n, 6).
  const std::vector<std::uint8_t>& held() const { return held_; }
  const std::vector<Real>& prescribed() const { return prescribed_; }
  static constexpr int askew = freedoms;
  // Those directions, and where those of each node begin (n + 1); none where no node is held so.
  const std::vector<HeldAlong>& directions() const { return held_along_; }
  const std::vector<int>& first_directions() const { return first_along_; }

  int n;
  AlignedArray<double> position;  // (n, 4): x, y, z [mm], unused
  AlignedArray<Real> motion;  // (n, 8): velocity [mm/s], angular velocity [1/s] (half a step back), 1/mass, 1/inertia
  AlignedArray<Real> force;   // (n, 6) and two: nodal forces [N] and moments [N mm] from outside
  AlignedArray<Real> internal_force;     // (n, 6) and two [N, N mm], less the contact forces of tools
  std::vector<double> reaction_impulse;  // (n, 6): of what holds the held freedoms, until set to zero [N s, N mm s]
  std::vector<char> follows;             // (n), or none: nodes that interactions move
  // (n): room between two tools that hold the sheet there [mm], else infinite; null: shells are not squeezed
  const double* room = nullptr;
  std::vector<SpaceWall*> walls;    // of solids; they outlive the nodes
  std::vector<char> touches_walls;  // (n), or none: nodes of the surface of solids

 private:
  // Correct that velocity by the walls, over the whole step, when their forces are kept too, or over its first half;
  // gives what forces and walls do meanwhile beside the work of the outer force.
  Work meet_walls(int node, const Step& step, bool whole, Record& after) const;
  template <bool pushed>
  Moved move_nodes(int first, int last, const Step& step);
  // Velocity half a step on of one node, its masses as they are, and its outer force at present; without `pushed` none
  // acts and none is read.
  template <bool pushed>
  void next_velocity(int node, const Step& step, Record& after, Record& outer) const;
  // Give held freedoms their velocity, and the outer force that gives it to them.
  [[gnu::noinline]] void hold(int node, const Step& step, Record& after, Record& outer) const;
  [[gnu::noinline]] void add_reaction(int node, const Step& step, const Record& outer);

  FreeMotion free_motion(int node) const;

  bool is_pushed_ = true;
  std::vector<std::uint8_t> held_;  // (n): a bit for each freedom, the first the lowest: its velocity is prescribed
  std::vector<Real> prescribed_;    // (n, 6): velocities of the held freedoms
  std::vector<HeldAlong> held_along_;
  std::vector<int> first_along_;  // (n + 1), or none: those of each node
};

}  // namespace presswork::explicit_dynamics
