// SPDX-License-Identifier: Apache-2.0
// Pressure of fluids on faces of a sheet, which follows the surface.
//
// Over a shell of four nodes x(xi, eta) = m + xi b1 + eta b2 + xi eta h the force on node a is exact:
//
//   F_a = p int N_a (x,xi cross x,eta) dA = p (b1 x b2 + xi_a/3 b1 x h + eta_a/3 h x b2),
//
// with b1 = sum xi_a x_a / 4 and so on; over one of three it is p/6 of the cross product of two sides. So F_a = p
// dV/dx_a with V the volume that the sheet sweeps, and forces and volume agree to round-off.
//
// A pressure is given by the cycle, or it is that of a fluid in a closed space: p = K ln(V_f/V_c), never below zero,
// with K the fluid's stiffness, V_f its volume without pressure, V_c that of the space: the room at first and what the
// sheet has swept since. The volume swept in a step is that of the mid-positions, which no array of the last cycle is
// kept for. The work of a step is the mean of the pressures at its ends times that volume.
//
// Shells are visited in chunks, one thread finds the pressures, and nodes gather in the order of the shells: no sum
// depends on the threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "contact/vectors.hpp"
#include "explicit/nodes.hpp"
#include "explicit/state_field.hpp"

namespace presswork::explicit_dynamics {

// A fluid in a closed space; without stiffness there is none, and the pressure is given.
struct EnclosedFluid {
  double stiffness = 0.0;  // K [MPa]
  double room = 0.0;       // of the space before the sheet has moved [mm3]
  double pressure(double volume, double swept) const {
    return std::max(0.0, stiffness * std::log(volume / std::max(room + swept, 1e-12 * room)));
  }
};

class SheetPressures {
 public:
  static constexpr int corners = 4;

  explicit SheetPressures(int n_nodes) : n_nodes_(n_nodes) {}

  // Add a pressure on shells (n, 4), a triangle with its last node twice; side: 1 along their normals, -1 against.
  int add(std::vector<int> cells, double side, const EnclosedFluid& fluid);
  int count() const { return static_cast<int>(pressures_.size()); }
  // Pressures in the cycles to come [MPa], or the fluid's volume without pressure [mm3].
  void drive(int i, std::vector<double> course) { pressures_[i].course = std::move(course); }
  bool lasts(int n_cycles) const;
  double pressure(int i) const { return pressures_[i].now; }
  double swept(int i) const { return pressures_[i].swept; }

  // One cycle, when nodes have moved by a step: chunks of shells, one thread, chunks of nodes.
  int n_cell_chunks() const { return static_cast<int>(chunks_.size()); }
  int n_node_chunks() const { return count_chunks(static_cast<int>(node_.size())); }
  template <class Nodes>
  void visit_cells(int piece, const Nodes& nodes, double dt);
  // Gives the work of all pressures in the step [N mm].
  double find_pressures(int cycle);
  // Take the forces off net (n_nodes, 6), internal less external forces.
  template <class Real>
  void gather(int piece, Real* net) const;

  // Begin with the pressures of a like sheet some shells of which are split here, and take their forces off net.
  template <class Nodes>
  void inherit(const SheetPressures& from, const Nodes& nodes);

  void list_state(std::vector<StateField>& fields);

 private:
  struct Pressure {
    int first, last;  // its shells
    double side;
    EnclosedFluid fluid;
    std::vector<double> course;
    double now = 0.0, swept = 0.0;  // [MPa], [mm3]
  };
  struct Chunk {
    int pressure, first, last;
    double swept = 0.0;  // in this step [mm3]
  };
  // Area vectors (4, 3) of a shell's nodes at positions less a part of the last motion.
  template <class Nodes>
  void measure(int cell, const Nodes& nodes, double back, double area[corners][3]) const;
  void list_nodes();

  int n_nodes_;
  std::vector<Pressure> pressures_;
  std::vector<Chunk> chunks_;
  std::vector<int> cells_;    // (n, 4)
  std::vector<double> area_;  // of this cycle (n, 4, 3), along the push [mm2]
  std::vector<int> node_, first_of_node_, slot_, slot_pressure_;
};

template <class Nodes>
void SheetPressures::measure(int cell, const Nodes& nodes, double back, double area[corners][3]) const {
  const int* node = cells_.data() + std::size_t(corners) * cell;
  double x[corners][3];
  for (int a = 0; a < corners; ++a)
    for (int i = 0; i < 3; ++i)
      x[a][i] = nodes.position.data()[std::size_t(Nodes::position_stride) * node[a] + i] -
                back * nodes.motion.data()[std::size_t(Nodes::motion_stride) * node[a] + i];
  if (node[3] == node[2]) {
    double d[3], e[3];
    for (int i = 0; i < 3; ++i) d[i] = (x[1][i] - x[0][i]) / 6.0, e[i] = x[2][i] - x[0][i];
    for (int a = 0; a < 3; ++a) contact::cross(d, e, area[a]);
    for (double& each : area[3]) each = 0.0;
    return;
  }
  double b1[3], b2[3], h[3], flat[3], along[3], across[3];
  for (int i = 0; i < 3; ++i) {
    b1[i] = 0.25 * (-x[0][i] + x[1][i] + x[2][i] - x[3][i]);
    b2[i] = 0.25 * (-x[0][i] - x[1][i] + x[2][i] + x[3][i]);
    h[i] = 0.25 * (x[0][i] - x[1][i] + x[2][i] - x[3][i]);
  }
  contact::cross(b1, b2, flat), contact::cross(b1, h, along), contact::cross(h, b2, across);
  constexpr double xi[corners] = {-1.0, 1.0, 1.0, -1.0}, eta[corners] = {-1.0, -1.0, 1.0, 1.0};
  for (int a = 0; a < corners; ++a)
    for (int i = 0; i < 3; ++i) area[a][i] = flat[i] + (xi[a] * along[i] + eta[a] * across[i]) / 3.0;
}

template <class Nodes>
void SheetPressures::visit_cells(int piece, const Nodes& nodes, double dt) {
  Chunk& chunk = chunks_[piece];
  const double side = pressures_[chunk.pressure].side;
  chunk.swept = 0.0;
  for (int cell = chunk.first; cell < chunk.last; ++cell) {
    const int* node = cells_.data() + std::size_t(corners) * cell;
    double area[corners][3];
    measure(cell, nodes, 0.5 * dt, area);
    for (int a = 0; a < corners; ++a)
      for (int i = 0; i < 3; ++i)
        chunk.swept += side * area[a][i] * dt * nodes.motion.data()[std::size_t(Nodes::motion_stride) * node[a] + i];
    measure(cell, nodes, 0.0, area);
    double* own = area_.data() + std::size_t(3 * corners) * cell;
    for (int a = 0; a < corners; ++a)
      for (int i = 0; i < 3; ++i) *own++ = side * area[a][i];
  }
}

template <class Real>
void SheetPressures::gather(int piece, Real* net) const {
  const int end = std::min(static_cast<int>(node_.size()), (piece + 1) * chunk);
  for (int k = piece * chunk; k < end; ++k) {
    double force[3] = {};
    for (int s = first_of_node_[k]; s < first_of_node_[k + 1]; ++s) {
      const double p = pressures_[slot_pressure_[s]].now;
      for (int i = 0; i < 3; ++i) force[i] += p * area_[3 * std::size_t(slot_[s]) + i];
    }
    for (int i = 0; i < 3; ++i) net[6 * std::size_t(node_[k]) + i] -= static_cast<Real>(force[i]);
  }
}

template <class Nodes>
void SheetPressures::inherit(const SheetPressures& from, const Nodes& nodes) {
  for (int i = 0; i < count(); ++i)
    pressures_[i].now = from.pressures_[i].now, pressures_[i].swept = from.pressures_[i].swept;
  for (int piece = 0; piece < n_cell_chunks(); ++piece) visit_cells(piece, nodes, 0.0);
}

}  // namespace presswork::explicit_dynamics
