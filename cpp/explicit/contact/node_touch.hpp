// SPDX-License-Identifier: Apache-2.0
// Points of the sheet and one tool: the tangent plane, what presses a point, friction, and two tools that squeeze it.
//
// The equations are those of tool_contact.hpp. V is a pack of points, or one point: the loop of the CPU and the cycle
// of a card (cpp/device) share them.
#pragma once

#include <limits>

#include "explicit/contact/tools.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

inline constexpr double reach_awake = 0.9;  // of its gap a point sleeps

// What points remember of a tool. The tangent plane is normal.x = offset in the tool's frame.
template <class V>
struct Touching {
  V normal[3], offset;
  V shear[3];  // friction on the sheet [N]
  V left;      // slip until the surface is asked again [mm]
  V pressed;   // [mm]; 0 off the tool
  V viscous;   // damping force [N]
  V squeezed;  // force of the springs of squeezed shells [N]
  V wake;      // the tool's travel at which the point may touch
};

// The two tools that hold points from opposite faces.
template <class V>
struct Pinch {
  V tool[2];  // their numbers; -1: none
  V room;     // between them [mm], infinite where there are none
  V next;     // room after another step like the last one
  V excess;   // thickness less room, not below 0 [mm]
  V force;    // of either tool [N]
  V borne;    // by the faces alone, where one of them is pushed [N]
};

// Force of a tool's damper, for a node's mass over dt^2 and a unit of way in a step of dt; step: of the stiffness.
PRESSWORK_DEVICE inline double damper(const Grip& grip, double step, double dt) {
  return grip.damping > 0.0 && dt > 0.0 ? 2.0 * grip.damping * std::sqrt(grip.penalty) * step / dt : 0.0;
}

// What is summed up of a touch: work lost, work on its spring that is not of motion, force on the sheet.
template <class V>
struct TouchSums {
  V friction, damping, squeeze, force[3];
};

namespace touching {

template <class V>
PRESSWORK_INLINE V dot(const V a[3], const V b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace touching

// Way along the tangent plane in a step, relative to the tool: the sum of its components' sizes.
template <class V>
PRESSWORK_INLINE V measure_slip(const V normal[3], const V dx[3]) {
  const V zero(0.0), along = touching::dot(normal, dx);
  V way = zero;
  for (int i = 0; i < 3; ++i) {
    const V slip = dx[i] - along * normal[i];
    way += select(slip < zero, -slip, slip);
  }
  return way;
}

// Take the tangent plane of a surface at x, in the tool's frame. Where nothing is near the plane has no normal, and
// offset the bound of the distance; a point that was pressed has gone through then, unless it is past the rim: false.
template <class Surface>
PRESSWORK_INLINE bool take_plane(const Surface& surface, const double x[3], double reach, double memory, double half,
                                 int& hint, double normal[3], double& offset, double& left) {
  contact::Touch found;
  if (!surface.nearest(x, reach, hint, found)) {
    normal[0] = normal[1] = normal[2] = 0.0;
    offset = -(found.gap > half + memory ? found.gap : half + memory);
    left = 0.0;
    return found.past_rim;
  }
  left = found.flat < memory ? memory : found.flat > 20.0 * memory ? 20.0 * memory : found.flat;
  for (int i = 0; i < 3; ++i) normal[i] = found.normal[i];
  offset = contact::dot(found.normal, x) - found.gap;
  return true;
}

// Press the points of a tool that are awake. place: in the tool's frame; dx: the step relative to it; damper: of a
// node's mass over dt^2 for a unit of dx, or 0; near: how far off the tool a point stays awake [mm]. The forces on the
// sheet are added.
template <class V>
PRESSWORK_INLINE TouchSums<V> press(const RigidTool& tool, double number, Mask<V> awake, const V place[3],
                                    const V dx[3], const V& half, const V& base, double damper, double near,
                                    const Pinch<V>& pinch, Touching<V>& p, V on_sheet[3]) {
  using touching::dot;
  const Grip& grip = tool.grip;
  const V zero(0.0);
  TouchSums<V> sums;
  // 1. off the tool: sleep, unless so near that it would be for a few cycles
  const V depth = half - (dot(p.normal, place) - p.offset);
  const Mask<V> off = both(awake, depth < V(-near));
  const V sleep = V(reach_awake) * depth;
  p.wake = select(off, V(tool.travel) - sleep, p.wake);
  p.left = select(off, p.left + sleep, p.left);  // it may travel as far meanwhile
  // 2. normal force; the damper never pulls
  const V k = V(grip.penalty) * base, handed_on = smaller(V(0.5) * pinch.force, pinch.borne);
  const V off_centre = depth - V(0.5) * pinch.excess - handed_on / k;
  const V pressed = select(both(awake, off_centre > zero), off_centre, zero), mine(number);
  const Mask<V> holds = either(both(pinch.tool[0] > mine - V(0.5), pinch.tool[0] < mine + V(0.5)),
                               both(pinch.tool[1] > mine - V(0.5), pinch.tool[1] < mine + V(0.5)));
  const V squeezed = select(both(awake, holds), pinch.force, zero), elastic = k * pressed + squeezed;
  const Mask<V> on = elastic > zero;
  const V closing = dot(p.normal, dx);
  V viscous = zero;
  if (damper > 0.0) {
    viscous = -V(damper) * base * closing;
    viscous = select(on, select(viscous < -elastic, -elastic, viscous), zero);
  }
  const V normal = elastic + viscous;
  sums.damping = V(-0.5) * (p.viscous + viscous) * closing;
  const Mask<V> yields = both(pinch.borne > zero, either(squeezed > zero, p.squeezed > zero));
  sums.squeeze = select(yields, V(0.5) * k * (p.pressed + pressed) * (pressed - p.pressed + closing), zero);
  // 3. friction: elastic trial in the present tangent plane, shortened to mu N
  const V out = dot(p.normal, p.shear), limit = V(grip.friction) * normal;
  V shear[3], work = zero;
  for (int i = 0; i < 3; ++i) shear[i] = p.shear[i] - out * p.normal[i] - k * (dx[i] - closing * p.normal[i]);
  const V size = dot(shear, shear);
  const Mask<V> slips = size > limit * limit;
  const V ratio = select(slips, limit / square_root(select(slips, size, V(1.0))), V(1.0));
  const V scale = select(on, ratio, zero);
  for (int i = 0; i < 3; ++i) {
    const V now = scale * shear[i];
    sums.force[i] = normal * p.normal[i] + now;
    work += (p.shear[i] + now) * dx[i];
    p.shear[i] = now;
    on_sheet[i] += sums.force[i];
  }
  sums.friction = V(-0.5) * work;
  p.pressed = pressed, p.viscous = viscous, p.squeezed = squeezed;
  return sums;
}

// The tool that the sheet is deepest in, and the deepest of those opposite to it, of n tools. pair(t): what the points
// remember of tool(t). bearing: force that the faces bear under a pushed tool [N], for which they give way by the
// penalty springs; the room is counted from there.
template <class V, class ToolAt, class PairAt>
PRESSWORK_INLINE Pinch<V> find_pinch(int n, const ToolAt& tool_at, const PairAt& pair_at, const V x[3], const V v[3],
                                     const V& half, const V& base, const V& bearing, double dt) {
  using touching::dot;
  constexpr double opposite = -0.97, none = -1e30, near = 1.1;  // near: room over thickness
  Pinch<V> pinch;
  V depth[2] = {V(none), V(none)}, way[2] = {V(0.0), V(0.0)}, normal[3] = {V(0.0), V(0.0), V(0.0)};
  V soft[2] = {V(0.0), V(0.0)}, pushed[2] = {V(0.0), V(0.0)};
  pinch.tool[0] = pinch.tool[1] = V(-1.0);
  for (int side = 0; side < 2; ++side)
    for (int t = 0; t < n; ++t) {
      const RigidTool& tool = tool_at(t);
      const auto& p = pair_at(t);
      if (!tool.grip.thickness || !any(invert(p.wake > V(tool.travel)))) continue;  // the rest of p is not looked at
      const Mask<V> awake = both(invert(p.wake > V(tool.travel)), dot(p.normal, p.normal) > V(0.5));
      V place[3], dx[3];
      for (int i = 0; i < 3; ++i) {
        place[i] = x[i] - V(tool.displacement[i]);
        dx[i] = V(dt) * (v[i] - V(tool.velocity[i]));
      }
      const V found = half - (dot(p.normal, place) - p.offset);
      Mask<V> deeper = both(awake, found > depth[side]);
      if (side == 1) deeper = both(deeper, dot(p.normal, normal) < V(opposite));
      depth[side] = select(deeper, found, depth[side]);
      way[side] = select(deeper, dot(p.normal, dx), way[side]);
      soft[side] = select(deeper, V(1.0 / tool.grip.penalty), soft[side]);
      pushed[side] = select(deeper, V(static_cast<double>(tool.was_pushed)), pushed[side]);
      pinch.tool[side] = select(deeper, V(static_cast<double>(t)), pinch.tool[side]);
      for (int i = 0; side == 0 && i < 3; ++i) normal[i] = select(deeper, p.normal[i], normal[i]);
    }
  pinch.borne = select(pushed[0] + pushed[1] > V(0.5), bearing, V(0.0));
  const V give = pinch.borne * (soft[0] + soft[1]) / base;
  const V room = V(2.0) * half - depth[0] - depth[1] + give, excess = V(2.0) * half - room;
  pinch.room = select(room < V(2.0 * near) * half, room, V(std::numeric_limits<double>::infinity()));
  pinch.next = pinch.room + way[0] + way[1];
  pinch.excess = select(excess > V(0.0), excess, V(0.0));
  pinch.force = V(0.0);
  return pinch;
}

// Force and energy of the springs of the shells round a squeezed node.
struct Squeeze {
  double force = 0.0, energy = 0.0;
};
template <class Sheet>
PRESSWORK_INLINE Squeeze squeeze_node(const int* cell, const int* last, double room, const Sheet& sheet) {
  Squeeze found;
  for (; cell != last; ++cell) {
    const double over = sheet.thickness(*cell) - room;
    if (!(over > 0.0)) continue;
    const double spring = sheet.spring(*cell);
    found.force += spring * over, found.energy += 0.5 * spring * over * over;
  }
  return found;
}

// Half the mean thickness of cells.
template <class Sheet>
PRESSWORK_INLINE double half_thickness(const int* cell, const int* last, const Sheet& sheet) {
  double sum = 0.0;
  const auto n = last - cell;
  for (; cell != last; ++cell) sum += sheet.thickness(*cell);
  return n > 0 ? 0.5 * sum / n : 0.0;
}

// Work of pressure where the half thickness of points pressed in by `then` changes.
template <class V>
PRESSWORK_INLINE V press_thicker(double penalty, const V& base, const V& then, Mask<V> on, const V& half,
                                 const V& half_before) {
  const V zero(0.0), moved = then + half - half_before, now = select(moved > zero, moved, zero);
  const V k = V(0.5 * penalty) * base;
  return select(on, k * (now * now - then * then), zero);
}

}  // namespace presswork::explicit_dynamics
