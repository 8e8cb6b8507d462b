// SPDX-License-Identifier: Apache-2.0
// Nodes in the plane or in axisymmetry: two displacements each, lumped mass, rigid walls that none of them passes.
//
// Four nodes are moved at a time, as one vector; those that touch walls or are held once more, one by one: walls
// correct their velocity. So the bits of a node do not depend on its neighbours in the four, nor on how a mesh is
// divided.
#pragma once

#include <cstdint>
#include <vector>

#include "explicit/nodes.hpp"
#include "explicit/plane/rigid_wall.hpp"
#include "explicit/state_field.hpp"
#include "explicit/step.hpp"

namespace presswork::explicit_dynamics {

class PlaneNodes {
 public:
  using Real = double;
  static constexpr int freedoms = 2, masses = 1;
  static constexpr int position_stride = 4;
  static constexpr int serial_elements =
      2000;  // fewer are left to one thread: waking a second costs more than it gives
  static constexpr int record(int) { return 8; }  // numbers of an element's forces; a triangle's last are not used

  // points (n, 2) [mm]: x is the radius in axisymmetry. contact (n): nodes that walls hold.
  PlaneNodes(int n, const double* points, const std::uint8_t* contact);

  // Take the masses (n) [t].
  void set_masses(const std::vector<double>& sum);
  // Prescribe the velocity (n, 2) of the freedoms marked in fixed (n, 2).
  void prescribe(const std::uint8_t* fixed, const double* velocity);
  // The wall must outlive the nodes.
  void add_wall(RigidWall* wall);
  // Let other parts of the mesh move nodes.
  void leave(const std::vector<int>& nodes);
  // Move a node by its velocity.
  void step_on(int node, double dt) {
    double* x = position.data() + position_stride * std::size_t(node);
    for (int i = 0; i < 2; ++i) {
      x[2 + i] = dt * velocity.data()[2 * std::size_t(node) + i];
      x[i] += x[2 + i];
    }
  }
  // Advance nodes [first, last), a chunk, by a step.
  void note_forces() {}  // they are read in every move
  Moved move(int first, int last, const Step& step);
  // Kinetic energy, and the work of the first half of the next step.
  void add_half_step(const Step& step, Energies& energies) const;
  void list_state(std::vector<StateField>& fields);

  int n;
  AlignedArray<double> position;                         // (n, 4): x, y [mm], by how much the last cycle moved them
  AlignedArray<double> velocity, force, internal_force;  // (n, 2), as the others filled up to fours
  std::vector<double> mass;                              // (n) [t]
  std::vector<double> reaction_impulse;  // (n, 2): of what holds prescribed freedoms, added up until set to zero [N s]
  std::vector<RigidWall*> walls;

 private:
  std::size_t padded() const { return (std::size_t(n) + 3) / 4 * 4; }
  void find_kinds();
  // Velocity half a step on of one node, and what forces and walls do meanwhile: over the whole step, when the walls'
  // forces are kept too, or over its first half.
  Work step_node(int node, const Step& step, bool whole, double after[2]) const;
  void move_four(int first, const Step& step, Record& external, Record& damped, Work& sum);
  void move_one(int node, const Step& step, Work& sum);

  std::vector<std::uint8_t> contact_, fixed_;  // (n); (n, 2): velocity is prescribed
  // Of each node: moved with its neighbours, by itself, as it touches walls or is held, or by another part.
  enum Kind : std::uint8_t { plain, alone, led };
  std::vector<std::uint8_t> kind_;     // (n)
  std::vector<std::uint8_t> apart_;    // of each four nodes: one is not plain
  AlignedArray<double> inverse_mass_;  // (n, 2) [1/t]
  std::vector<double> prescribed_;     // (n, 2)
};

}  // namespace presswork::explicit_dynamics
