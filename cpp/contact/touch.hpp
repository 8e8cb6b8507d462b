// SPDX-License-Identifier: Apache-2.0
// What the search for the nearest place of a rigid tool's surface finds.
#pragma once

namespace presswork::contact {

struct Touch {
  double gap;        // signed distance [mm], positive off the tool; without a touch a bound, see ToolSurface
  double normal[3];  // unit vector out of the tool's metal
  double point[3];   // of the surface [mm]
  // How far the point may move along the tangent plane until another part of the surface may be nearer [mm], as far as
  // the flat part that it is nearest to and its neighbours tell; not above zero where it is nearest to no flat part.
  double flat;
  bool past_rim = false;  // no touch: the nearest place is an open rim of triangles, and the point lies beyond it
};

// How gap and normal change with the point [1, 1/mm].
struct Slopes {
  double gap[3];
  double normal[3][3];  // row: component of the normal
};

}  // namespace presswork::contact
