// SPDX-License-Identifier: Apache-2.0
// Nodes that two tools hold from opposite faces (squeezed_section.hpp).
#include "explicit/contact/tool_contact.hpp"

namespace presswork::explicit_dynamics {

namespace {

Pack dot(const Pack a[3], const Pack b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

// The tool that the sheet is deepest in, and the deepest of those opposite to it.
ToolContact::Pinch ToolContact::find_pinch(int slot, const Pack x[3], const Pack v[3], double dt) const {
  constexpr double opposite = -0.97, none = -1e30, near = 1.1;  // near: room over thickness
  const Pack half = load(half_, slot);
  Pinch pinch;
  Pack depth[2] = {Pack(none), Pack(none)}, way[2] = {Pack(0.0), Pack(0.0)},
       normal[3] = {Pack(0.0), Pack(0.0), Pack(0.0)};
  pinch.tool[0] = pinch.tool[1] = Pack(-1.0);
  for (int side = 0; side < 2; ++side)
    for (std::size_t t = 0; t < tools.size(); ++t) {
      const Touching& p = pairs_[t].packs[slot / width];
      const Mask awake = both(p.wake.v <= Pack(tools[t].travel).v, dot(p.normal, p.normal) > Pack(0.5));
      if (!tools[t].grip.thickness || !any(awake)) continue;
      Pack place[3], dx[3];
      for (int i = 0; i < 3; ++i) {
        place[i] = x[i] - Pack(tools[t].displacement[i]);
        dx[i] = Pack(dt) * (v[i] - Pack(tools[t].velocity[i]));
      }
      const Pack found = half - (dot(p.normal, place) - p.offset);
      Mask deeper = both(awake, found > depth[side]);
      if (side == 1) deeper = both(deeper, dot(p.normal, normal) < Pack(opposite));
      depth[side] = select(deeper, found, depth[side]);
      way[side] = select(deeper, dot(p.normal, dx), way[side]);
      pinch.tool[side] = select(deeper, Pack(static_cast<double>(t)), pinch.tool[side]);
      for (int i = 0; side == 0 && i < 3; ++i) normal[i] = select(deeper, p.normal[i], normal[i]);
    }
  const Pack room = Pack(2.0) * half - depth[0] - depth[1], excess = Pack(2.0) * half - room;
  pinch.room = select(room < Pack(2.0 * near) * half, room, Pack(std::numeric_limits<double>::infinity()));
  pinch.next = pinch.room + way[0] + way[1];
  pinch.excess = select(excess > Pack(0.0), excess, Pack(0.0));
  return pinch;
}

}  // namespace presswork::explicit_dynamics
