// SPDX-License-Identifier: Apache-2.0
// Central differences for shells: n cycles a call, threaded, with the same bits for any number of threads.
//
// A cycle: nodes    a = (f_ext - f_int)/m, v += a dt, x += v dt
//          elements f_int from x, v (each pack writes forces of its own)
//          beads    and
//          tools    their forces are taken off f_int
// Hanging nodes move after the others, with the ends of their sides, and give their forces to them at the end.
// At the end of a call x and the forces belong to time t, v to t - dt/2.
//
// Real is that of velocities, forces and elements; positions, work and all that is done with a node in a step are
// double.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "explicit/drawbeads.hpp"
#include "explicit/element_block.hpp"
#include "explicit/hanging.hpp"
#include "explicit/phase_clock.hpp"
#include "explicit/tiles.hpp"
#include "explicit/tool_contact.hpp"

namespace presswork::explicit_dynamics {

struct Energies {
  double kinetic = 0.0;    // v(-dt/2) m v(+dt/2)/2, which linear vibration conserves together with the internal energy
  double internal = 0.0;   // work of the stresses
  double hourglass = 0.0;  // work of the hourglass forces
  double external = 0.0;   // work of nodal forces, of prescribed velocities and of tools
  double damping = 0.0;    // taken away by mass damping, and by the damping of contact and of pushed tools
  double contact = 0.0;    // in the springs of contact and beads, and the work of pressure on the change of thickness
  double friction = 0.0;   // lost in friction and in beads
};

template <class Real>
class ShellLoop {
 public:
  // points (n, 3) [mm]
  ShellLoop(int n_nodes, const double* points);

  // Take in a block of elements; they are numbered in the order of the blocks.
  void add(std::unique_ptr<ElementBlock<Real>> block);
  int n_elements() const;

  Nodes<Real> nodes;
  std::vector<std::unique_ptr<ElementBlock<Real>>> blocks;
  AlignedArray<Real> force;        // (n, 6) and two: nodal forces [N] and moments [N mm] from outside
  std::vector<std::uint8_t> held;  // (n): a bit for each freedom, the first the lowest: its velocity is prescribed
  std::vector<Real> prescribed;    // (n, 6): velocities of the held freedoms

  HangingNodes<Real> hanging;
  void set_hanging(std::vector<HangingNode> nodes);
  // Let the ends of hanging nodes' sides have their forces; outside of advance.
  void give_hanging_forces();

  // Begin, at positions that have been set, with the state of another loop some shells of which are split here: each of
  // its elements has a share (n) of the parent (n); velocities, contact and friction of a node are means of its
  // parents' (n_nodes, 4).
  void inherit(const ShellLoop& from, const int* node_parents, const int* parent, const double* share);

  // Masses of nodes from those of the elements; after a change of either.
  void set_masses();
  std::vector<double> element_masses() const;
  // The material law of an element has failed in a cycle of a call; of several the first in number.
  struct Failure {
    int element = -1, cycle = -1;
    LawStatus told = LawStatus::done;
  };
  // Advance n cycles of dt, or up to that in which a material law fails. The scales (n) multiply force and prescribed
  // velocities in each cycle; damping [1/s].
  Failure advance(int n, double dt, double damping, const double* force_scale, const double* velocity_scale);
  // Energies at the present time; scales are those of the next cycle.
  Energies energies(double dt, double damping, double force_scale, double velocity_scale) const;
  // Advance the elements alone, and with them the internal force.
  void advance_elements(double dt);

  // (n, 6): impulse of what holds the held freedoms, added up until it is set to zero [N s, N mm s]
  std::vector<double> reaction_impulse;
  AlignedArray<Real> internal_force;  // (n, 6) and two [N, N mm], less the contact forces of tools

  std::unique_ptr<Drawbeads> beads;  // none without beads
  contact::SheetUnder find_cells() const;

  bool ironing = true;                   // tools squeeze the sheet; to be set before there are any
  std::unique_ptr<ToolContact> contact;  // none without tools
  // To be called when there are tools, and after a change of masses.
  std::unique_ptr<ToolContact> make_contact() const;
  void set_contact_stiffness(double dt);
  // What contact must know of the sheet, after a step of dt.
  auto view(double dt) const {
    return SheetView{nodes.position.data(), nodes.motion.data(), [this](int cell) { return thickness(cell); },
                     [this](int cell) { return value(cell, &StateRows::spring); }, dt};
  }
  double thickness(int element) const { return value(element, &StateRows::thickness); }

  double seconds[n_phases] = {};  // of wall time by phase, in all calls of advance
  double work[2] = {0.0, 0.0};    // done by force and prescription, by damping: up to half a step back

 private:
  // The block that an element is of; its number becomes that in the block.
  const ElementBlock<Real>& block_of(int& element) const {
    std::size_t b = 0;
    for (; element >= blocks[b]->n(); ++b) element -= blocks[b]->n();
    return *blocks[b];
  }
  double value(int element, const int StateRows::* row) const {
    const auto& block = block_of(element);
    return block.value(element, block.rows().*row);
  }
  void find_room() { nodes.room = contact ? contact->room() : nullptr; }
  struct Sums {
    double external = 0.0, damping = 0.0;
    double fastest = 0.0;  // speed of a node, squared
  };
  struct Step {
    double dt, damping, force_scale, velocity_scale;
    double kept = (1.0 - 0.5 * damping * dt) / (1.0 + 0.5 * damping * dt), push = dt / (1.0 + 0.5 * damping * dt);
  };
  Sums move_nodes(int first, int last, const Step& step);
  // Velocity half a step on of one node, its masses as they are, and its outer force at present.
  void next_velocity(int node, const Step& step, Record& after, Record& outer) const;
  // Give held freedoms their velocity, and the outer force that gives it to them.
  [[gnu::noinline]] void hold(int node, const Step& step, Record& after, Record& outer) const;

  [[gnu::noinline]] void add_reaction(int node, const Step& step, const Record& outer);

  Tiles<Real> tiles_;
  std::vector<double> own_mass_;  // of nodes, before hanging ones give theirs away
};

}  // namespace presswork::explicit_dynamics
