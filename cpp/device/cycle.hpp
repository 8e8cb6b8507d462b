// SPDX-License-Identifier: Apache-2.0
// A cycle of the explicit loop with a lane a thread: shells of one point, those of four
// nodes with physical stabilisation, von Mises with
// hardening from a table, and their nodes. The same functions are compiled for the CPU (host.cpp) and for a GPU
// (cuda.cu), and take the same Problem.
//
// A cycle is three passes, each over lanes that know nothing of each other; tools make three more (tools.hpp):
//   move_node      a = (f_ext - f_int)/m, v += a h, x += v dt of one node
//   advance_shell  one shell over the move: its state, and its forces at its four corners
//   gather_forces  f_int of one node: the sum over a list of corners of shells, always in the same order
// So nothing is added by atomics, and the bits depend neither on the number of threads nor on the run. Arrays are as
// neighbouring lanes read them: a row of a shell's state is one number of every shell; a node's record is its own.
//
// Arithmetic is that of nodes.cpp and of the kernels in element/: results differ from those of the CPU's loop by
// round-off, since a node adds up its forces in another order.
#pragma once

#include <cstdint>
#include <variant>

#include "device/beads.hpp"
#include "device/tools.hpp"
#include "element/shell3_one_point.hpp"
#include "explicit/step.hpp"
#include "material/elastic_plastic_update.hpp"

namespace presswork::device {

using explicit_dynamics::Step;

inline constexpr int freedoms = 6;

// Real: of velocities, forces and shells; positions, work and what is done with a node in a step are double.
template <class Real>
struct Nodes {
  int n;
  double* position;          // (n, 4) [mm]; the last unused
  Real* motion;              // (n, 8): velocity [mm/s], angular velocity [1/s], 1/mass, 1/inertia
  Real* internal_force;      // (n, 6) [N, N mm]
  const Real* force;         // (n, 6) from outside
  const std::uint8_t* held;  // (n): a bit for each freedom whose velocity is prescribed
  const Real* prescribed;    // (n, 6)
  double* reaction_impulse;  // (n, 6) [N s, N mm s]
  double* work;              // (n, 2): of forces from outside, lost by mass damping, summed up over the cycles [N mm]
  const int* first_corner;   // (n + 1) into corner
  const int* corner;         // of the shells round each node: slots
  int n_slots;
  Real* corner_force;  // (6, n_slots): of the shells at their corners
};

// Shells of three or four nodes. Corner a of shell i has the slot first_slot + a n + i.
template <class Real>
struct Shells {
  int n, first_slot;
  const int* node;  // (corners, n)
  Real* state;      // (rows, n): those of shell4_one_point.hpp, then the layers
  std::variant<FastMises, GeneralSheet> law;
  LayerRule rule;
  const Real* temperature;  // (points, n) [degrees C]; null: none is given
  double slower;            // as LayerConditions has it
};

// A loop's nodes and shells for a call, in the memory of the host or of the device; rows: of a shell's state.
template <class Real>
struct Problem {
  Nodes<Real> nodes;
  Shells<Real> quadrilaterals, triangles;
  int rows;
  Tools tools;
  Beads beads{};

  int chunks() const { return (nodes.n + chunk - 1) / chunk; }
  // Thickness [mm], and spring of a node [N/mm], of a cell as the tools number them.
  PRESSWORK_DEVICE double thickness(int cell) const { return value(cell, shell4::thickness); }
  PRESSWORK_DEVICE double spring(int cell) const { return value(cell, shell4::spring); }

 private:
  PRESSWORK_DEVICE double value(int cell, int row) const {
    const bool is_first = cell < quadrilaterals.n;
    const Shells<Real>& of = is_first ? quadrilaterals : triangles;
    return of.state[std::size_t(row) * of.n + (is_first ? cell : cell - quadrilaterals.n)];
  }
};

// Cycles of dt, the step before was dt_before [s]; the scales (n) multiply forces and prescribed velocities.
struct Cycles {
  int n;
  double dt, dt_before, damping;
  const double *force_scale, *velocity_scale;

  Step step(int cycle) const {
    return {dt, cycle == 0 ? 0.5 * (dt_before + dt) : dt, damping, force_scale[cycle], velocity_scale[cycle]};
  }
};

// Gives the square of its speed.
template <class Real>
PRESSWORK_INLINE double move_node(const Nodes<Real>& nodes, const Step& step, int node) {
  const std::size_t row = std::size_t(freedoms) * node;
  Real* own = nodes.motion + 8 * std::size_t(node);
  const int held = nodes.held[node];
  double done = 0.0, damped = 0.0;
  for (int i = 0; i < freedoms; ++i) {
    const double before = own[i], inverse = own[i < 3 ? 6 : 7];
    const double given = step.force_scale * nodes.force[row + i];
    double outer = given,
           after = step.kept * before + step.push * inverse * (outer - double(nodes.internal_force[row + i]));
    if (held >> i & 1) {
      const double free = after;
      after = step.velocity_scale * nodes.prescribed[row + i];
      if (inverse > 0.0) outer += (after - free) / (step.push * inverse);
      nodes.reaction_impulse[row + i] += step.mean_dt * (outer - given);
    }
    done += outer * (before + after);
    if (step.damping > 0.0 && inverse > 0.0) damped += 0.25 * (before + after) * (before + after) / inverse;
    own[i] = static_cast<Real>(after);
    // by the velocity as it is kept: what moves a node is what strains its elements
    if (i < 3) nodes.position[4 * std::size_t(node) + i] += step.dt * own[i];
  }
  nodes.work[2 * std::size_t(node)] += 0.5 * step.mean_dt * done;
  nodes.work[2 * std::size_t(node) + 1] += step.mean_dt * step.damping * damped;
  return double(own[0]) * own[0] + double(own[1]) * own[1] + double(own[2]) * own[2];
}

// law: that of the shells. room_at: between tools, of the nodes; null where no tool squeezes the sheet.
template <int corners, class Real, class Law>
PRESSWORK_INLINE void advance_shell(const Nodes<Real>& nodes, const Shells<Real>& shells, const Law& law,
                                    const double* room_at, double dt, int shell) {
  const std::size_t n = shells.n;
  Real x[corners][3], v[corners][3], w[corners][3], state[shell4::head_rows], force[freedoms * corners];
  // positions less that of the first node: elements use differences alone
  const double* origin = nodes.position + 4 * std::size_t(shells.node[shell]);
  for (int a = 0; a < corners; ++a) {
    const std::size_t node = shells.node[a * n + shell];
    const double* at = nodes.position + 4 * node;
    const Real* motion = nodes.motion + 8 * node;
    for (int i = 0; i < 3; ++i) {
      x[a][i] = static_cast<Real>(at[i] - origin[i]);
      v[a][i] = motion[i], w[a][i] = motion[3 + i];
    }
  }
  Real* rows = shells.state + shell;
  for (int r = 0; r < shell4::head_rows; ++r) state[r] = rows[r * n];
  const auto layers = layers_apart(law, rows + shell4::head_rows * n, static_cast<std::ptrdiff_t>(n));
  LayerConditions<Real> now{dt, shells.temperature ? shells.temperature + shell : nullptr};
  now.slower = shells.slower, now.stride = static_cast<std::ptrdiff_t>(n);
  Real room[corners];
  for (int a = 0; room_at && a < corners; ++a) room[a] = static_cast<Real>(room_at[shells.node[a * n + shell]]);
  const Real* between = room_at ? room : nullptr;
  if constexpr (corners == 4)
    shell4::advance_stabilized(law, shells.rule, now, x, v, w, between, state, layers, force);
  else
    shell3::advance(law, shells.rule, now, x, v, w, between, state, layers, force);
  for (int r = 0; r < shell4::head_rows; ++r) rows[r * n] = state[r];
  for (int a = 0; a < corners; ++a)
    for (int i = 0; i < freedoms; ++i)
      nodes.corner_force[std::size_t(i) * nodes.n_slots + shells.first_slot + a * n + shell] = force[freedoms * a + i];
}

template <class Real>
PRESSWORK_INLINE void gather_forces(const Nodes<Real>& nodes, int node) {
  double sum[freedoms] = {};
  for (int s = nodes.first_corner[node]; s < nodes.first_corner[node + 1]; ++s)
    for (int i = 0; i < freedoms; ++i) sum[i] += nodes.corner_force[std::size_t(i) * nodes.n_slots + nodes.corner[s]];
  for (int i = 0; i < freedoms; ++i) nodes.internal_force[std::size_t(freedoms) * node + i] = static_cast<Real>(sum[i]);
}

// As tools.hpp has it.
template <class Real, class Take>
PRESSWORK_INLINE void touch_tools(const Problem<Real>& p, double dt, int cycle, int node, const Take& take) {
  const bool there = node < p.nodes.n;
  touch_tools(p.tools, p.nodes.n, p.nodes.position, p.nodes.motion, p.nodes.internal_force, p, dt, cycle, node, there,
              take);
}

template <class Real, class Take>
PRESSWORK_INLINE void touch_edges(const Problem<Real>& p, double dt, int edge, const Take& take) {
  touch_edges(p.tools, p.nodes.n, p.nodes.position, p.nodes.motion, dt, edge, edge < p.tools.edges.n, take);
}

}  // namespace presswork::device
