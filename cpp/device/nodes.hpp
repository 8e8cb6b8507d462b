// SPDX-License-Identifier: Apache-2.0
// Nodes of the device's cycle: they move, and gather the forces of their elements.
#pragma once

#include <cstddef>
#include <cstdint>

#include "explicit/step.hpp"
#include "tensor/on_device.hpp"

namespace presswork::device {

using explicit_dynamics::Step;

inline constexpr int freedoms = 6;

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
  Real* corner_force;  // (6, n_slots): of the elements at their corners
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

template <class Real>
PRESSWORK_INLINE void gather_forces(const Nodes<Real>& nodes, int node) {
  double sum[freedoms] = {};
  for (int s = nodes.first_corner[node]; s < nodes.first_corner[node + 1]; ++s)
    for (int i = 0; i < freedoms; ++i) sum[i] += nodes.corner_force[std::size_t(i) * nodes.n_slots + nodes.corner[s]];
  for (int i = 0; i < freedoms; ++i) nodes.internal_force[std::size_t(freedoms) * node + i] = static_cast<Real>(sum[i]);
}

}  // namespace presswork::device
