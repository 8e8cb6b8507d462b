// SPDX-License-Identifier: Apache-2.0
// Nodes of the device's cycle: they move, and gather the forces of their elements.
#pragma once

#include <cstddef>
#include <cstdint>

#include "explicit/space/held_along.hpp"
#include "explicit/step.hpp"
#include "tensor/on_device.hpp"

namespace presswork::device {

using explicit_dynamics::FreeMotion;
using explicit_dynamics::HeldAlong;
using explicit_dynamics::Step;

inline constexpr int freedoms = 6, askew = freedoms;  // the bit of a node that is held along directions

// Real: of velocities, forces and elements; positions, work and what is done with a node in a step are double.
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
  const int* corner;         // of the elements round each node: slots
  int n_slots;
  Real* corner_force;                // (6, n_slots): of the elements at their corners
  const int* first_along = nullptr;  // (n + 1) into along; null: no node is held along a direction
  const HeldAlong* along = nullptr;
  int* stop = nullptr;            // (2): whether an element has failed in a cycle before, and up to now
  const char* follows = nullptr;  // (n): nodes that others lead; null: there are none
};

// What prescribed velocities and directions leave of a node's motion.
template <class Real>
PRESSWORK_INLINE FreeMotion find_free_motion(const Nodes<Real>& nodes, int node) {
  FreeMotion free{{}, nullptr, 0};
  for (int i = 0; i < 3; ++i) free.axis[i] = nodes.held[node] >> i & 1 ? 0.0 : 1.0;
  if (nodes.held[node] >> askew & 1) {
    const int first = nodes.first_along[node];
    free.held = nodes.along + first, free.n_held = nodes.first_along[node + 1] - first;
  }
  return free;
}

// Velocity half a step on of one node, as it is now (before), and its outer force at present.
template <class Real>
PRESSWORK_INLINE void next_velocity(const Nodes<Real>& nodes, const Step& step, int node, double (&outer)[freedoms],
                                    double (&before)[freedoms], double (&after)[freedoms]) {
  const std::size_t row = std::size_t(freedoms) * node;
  const Real* own = nodes.motion + 8 * std::size_t(node);
  const int held = nodes.held[node];
  for (int i = 0; i < freedoms; ++i) {
    const double inverse = own[i < 3 ? 6 : 7];
    before[i] = own[i], outer[i] = step.force_scale * nodes.force[row + i];
    after[i] = step.kept * before[i] + step.push * inverse * (outer[i] - double(nodes.internal_force[row + i]));
    if (held >> i & 1) {
      const double free = after[i];
      after[i] = step.velocity_scale * nodes.prescribed[row + i];
      if (inverse > 0.0) outer[i] += (after[i] - free) / (step.push * inverse);
    }
  }
  if (held >> askew & 1) hold_along(find_free_motion(nodes, node), step, own[6], after, outer);
}

// Gives the square of its speed. meet(before, inverse, after): corrects the velocity after the step, of freedoms of
// displacement, and gives work from outside; before it: the velocity at its start, and the inverse of its mass.
template <class Real, class Meet>
PRESSWORK_INLINE double move_node(const Nodes<Real>& nodes, const Step& step, int node, const Meet& meet) {
  if (nodes.follows && nodes.follows[node]) return 0.0;
  const std::size_t row = std::size_t(freedoms) * node;
  Real* own = nodes.motion + 8 * std::size_t(node);
  const int held = nodes.held[node];
  double outer[freedoms], before[freedoms], after[freedoms], damped = 0.0;
  // 1. velocity half a step on
  next_velocity(nodes, step, node, outer, before, after);
  const double done = meet(before, double(own[6]), after);
  // 2. work and move
  double moved = 0.0;
  const int reacts = held >> askew & 1 ? held | 7 : held;
  for (int i = 0; i < freedoms; ++i) {
    const double inverse = own[i < 3 ? 6 : 7], sum = before[i] + after[i];
    if (reacts >> i & 1)
      nodes.reaction_impulse[row + i] += step.mean_dt * (outer[i] - step.force_scale * nodes.force[row + i]);
    moved += outer[i] * sum;
    if (step.damping > 0.0 && inverse > 0.0) damped += 0.25 * sum * sum / inverse;
    own[i] = static_cast<Real>(after[i]);
    // by the velocity as it is kept: what moves a node is what strains its elements
    if (i < 3) nodes.position[4 * std::size_t(node) + i] += step.dt * own[i];
  }
  nodes.work[2 * std::size_t(node)] += 0.5 * step.mean_dt * moved + done;
  nodes.work[2 * std::size_t(node) + 1] += step.mean_dt * step.damping * damped;
  return double(own[0]) * own[0] + double(own[1]) * own[1] + double(own[2]) * own[2];
}

template <class Real>
PRESSWORK_INLINE double move_node(const Nodes<Real>& nodes, const Step& step, int node) {
  return move_node(nodes, step, node, [](const double*, double, double*) { return 0.0; });
}

template <class Real>
PRESSWORK_INLINE void gather_forces(const Nodes<Real>& nodes, int node) {
  if (node == 0) nodes.stop[0] = nodes.stop[1];
  double sum[freedoms] = {};
  for (int s = nodes.first_corner[node]; s < nodes.first_corner[node + 1]; ++s)
    for (int i = 0; i < freedoms; ++i) sum[i] += nodes.corner_force[std::size_t(i) * nodes.n_slots + nodes.corner[s]];
  for (int i = 0; i < freedoms; ++i) nodes.internal_force[std::size_t(freedoms) * node + i] = static_cast<Real>(sum[i]);
}

}  // namespace presswork::device
