// SPDX-License-Identifier: Apache-2.0
// Drawbeads in a cycle with a lane a thread: two passes, after the shells have left their forces at the nodes and
// before the tools.
//
//   hold_bead   one point of a bead: what lies beneath it, and the force that it holds the sheet with
//   push_sheet  a lane goes through the points and takes the forces off the nodes that are its own, in the points'
//   order
//
// The arithmetic is that of the CPU's loop (explicit/contact/drawbeads.hpp). The bits do not depend on the lanes.
#pragma once

#include "device/tools.hpp"
#include "explicit/contact/drawbeads.hpp"

namespace presswork::device {

using explicit_dynamics::BeadPoint;

// All points of all beads.
struct Beads {
  int n = 0, n_beads = 0;  // points; no points: nothing else is set
  contact::SheetSearch sheet;
  const double* cell_mass;  // (sheet.n) [t]
  const int *bead, *tool;   // of a point, and of a bead the tool that it moves with, or -1
  const double* limit;      // (n): full force of a point [N]
  const double* share;      // (cycles, n_beads): of the full force
  BeadPoint* point;         // (n)
  double* work;             // (n): put into the sheet, summed up over the cycles of a call [N mm]
};

// cycle: of the call; since: of those since the beads began.
template <class Real>
PRESSWORK_INLINE void hold_bead(const Beads& beads, const Tools& tools, const double* position, const Real* motion,
                                double dt, int cycle, int since, int i) {
  BeadPoint& p = beads.point[i];
  if (cycle == 0) beads.work[i] = 0.0;
  const bool look = since % explicit_dynamics::Drawbeads::refresh == 0;
  if (look || p.beneath.cell < 0)
    p.look_beneath(beads.sheet, beads.cell_mass, dt, position, 4);
  else
    beads.sheet.stand_on(p.beneath.cell, p.beneath);  // where the corners lie in this memory
  if (!p.beneath.inside) {
    p.force = 0.0;
    return;
  }
  const int bead = beads.bead[i], tool = beads.tool[bead];
  const double limit = beads.share[std::size_t(beads.n_beads) * cycle + bead] * beads.limit[i];
  beads.work[i] += p.hold(motion, 8, tool >= 0 ? tools.tool[tool].velocity : nullptr, limit, dt);
}

// Lane `lane` of so many.
template <class Real>
PRESSWORK_INLINE void push_sheet(const Beads& beads, Real* net, int lane, int lanes) {
  for (int i = 0; i < beads.n; ++i) {
    const BeadPoint& p = beads.point[i];
    if (!p.beneath.inside) continue;
    for (int a = 0; a < p.beneath.corners; ++a) {
      const int node = p.beneath.node[a];
      if (node % lanes != lane) continue;
      for (int j = 0; j < 3; ++j) net[6 * std::size_t(node) + j] -= static_cast<Real>(p.push(a, j));
    }
  }
}

}  // namespace presswork::device
