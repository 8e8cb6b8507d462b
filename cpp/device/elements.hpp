// SPDX-License-Identifier: Apache-2.0
// What blocks of elements of all kinds have in common in the device's cycle. A kind is a struct with Elements in it and
//   n_corners                         static: nodes of an element
//   advance(nodes, room, dt, i)       one element over the move of its nodes: its state, its forces at its corners;
//                                     room: between tools, of the nodes; null where no tool squeezes a sheet
//   for_each_table(f)                 calls f(pointer, n) for the tables of its law, which lie in memory of their own
//   bound(nodes, i)                   bound of an element's squared frequency [1/s2]
//   first_measure, n_measures         static: rows of the state that rows of cycles are judged by
// A kind of shells besides has thickness_row and spring_row, as the tools ask. Its Law names the kernel.
#pragma once

#include "device/damage.hpp"
#include "device/nodes.hpp"
#include "material/umat.hpp"

namespace presswork::device {

using explicit_dynamics::reasons;

// Arrays are as neighbouring lanes read them: a row is one number of every element. Corner a of element i has the slot
// first_slot + a n + i.
template <class Real>
struct Elements {
  int n, rows, first_slot;
  const int* node;                   // (corners, n)
  Real* state;                       // (rows, n)
  int points;                        // that have a temperature
  const Real* temperature;           // (points, n) [degrees C]; null: none is given
  double slower;                     // by which the process takes longer than it is computed
  int work_row, hourglass_row;       // of the state; -1: there are none
  const Real *mass, *inertia_ratio;  // (n) [t], [mm2]; null: of no stable step
  int* failed = nullptr;             // (n): when and why each has failed; null: its law always finds a stress
  DamageOfBlock damage{};

  // An element that fails in a cycle says why, and counts the cycles from that on: `reasons` times their number plus a
  // LawStatus; 0 of one that has not failed. From the next cycle on no element that may fail is computed; the call
  // ends, and then says which failed first.
  PRESSWORK_INLINE void fail(const Nodes<Real>& nodes, int i, LawStatus why) const {
    nodes.stop[1] = 1;
    failed[i] = reasons + static_cast<int>(why);
  }
  // Whether an element, this one or another, has failed in a cycle before.
  PRESSWORK_INLINE bool is_over(const Nodes<Real>& nodes, int i) const {
    if (nodes.stop[0] == 0) return false;
    if (failed[i] != 0) failed[i] += reasons;
    return true;
  }
};

// Positions of the corners less that of the first, since elements use differences alone, and velocities.
template <int corners, class Real>
PRESSWORK_INLINE void gather_corners(const Nodes<Real>& nodes, const Elements<Real>& of, int i, Real x[corners][3],
                                     Real v[corners][3], Real w[corners][3]) {
  const std::size_t n = of.n;
  const double* origin = nodes.position + 4 * std::size_t(of.node[i]);
  for (int a = 0; a < corners; ++a) {
    const std::size_t node = of.node[a * n + i];
    const double* at = nodes.position + 4 * node;
    const Real* motion = nodes.motion + 8 * node;
    for (int k = 0; k < 3; ++k) {
      x[a][k] = static_cast<Real>(at[k] - origin[k]);
      v[a][k] = motion[k], w[a][k] = motion[3 + k];
    }
  }
}

template <int corners, class Real>
PRESSWORK_INLINE void leave_forces(const Nodes<Real>& nodes, const Elements<Real>& of, int i, const Real* force) {
  for (int a = 0; a < corners; ++a)
    for (int k = 0; k < freedoms; ++k)
      nodes.corner_force[std::size_t(k) * nodes.n_slots + of.first_slot + std::size_t(a) * of.n + i] =
          force[freedoms * a + k];
}

// Of solids, which have no moments.
template <int corners>
PRESSWORK_INLINE void leave_solid_forces(const Nodes<double>& nodes, const Elements<double>& of, int i,
                                         const double* force) {
  for (int a = 0; a < corners; ++a)
    for (int k = 0; k < freedoms; ++k)
      nodes.corner_force[std::size_t(k) * nodes.n_slots + of.first_slot + std::size_t(a) * of.n + i] =
          k < 3 ? force[3 * a + k] : 0.0;
}

}  // namespace presswork::device
