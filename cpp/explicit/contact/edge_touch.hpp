// SPDX-License-Identifier: Apache-2.0
// The inside of edges and one tool: where along an edge the tool is nearest, what presses it, friction.
//
// The equations are those of edge_contact.hpp. V is a pack of edges, or one edge: the loop of the CPU and the cycle of
// a card (cpp/device) share them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "explicit/contact/node_touch.hpp"

namespace presswork::explicit_dynamics {

namespace edge_touch {

inline constexpr double share = 0.4;   // of a node's stiffness
inline constexpr int samples = 5;      // along an edge that is new to a tool
inline constexpr double level = 2e-3;  // slope of the gap along the edge that is none
inline constexpr int most_steps = 12;  // of a search for the lowest place
inline constexpr double alike = 1e-6;  // difference of gaps that is none, over the memory

}  // namespace edge_touch

// What an edge remembers of a tool: two records of eight numbers.
struct alignas(64) EdgeTouching {
  // Off the sharp places; near them, but off the tool; awake, s followed from ask to ask.
  static constexpr double off = 0.0, near = 1.0, followed = 2.0;
  // 1. since the surface was asked last
  double s = 0.0, normal[3] = {0.0, 0.0, 0.0}, offset = 0.0;
  double tilt = 0.0;                        // normal.(x_b - x_a) then
  double seen = off;                        // what is known of it, as above
  std::int32_t hint = -1, sharp_hint = -1;  // of the surface and of its sharp places; -1: none
  // 2. what changes in every cycle
  double shear[3] = {0.0, 0.0, 0.0};
  double left = 0.0;     // slip until the surface is asked again [mm]
  double pressed = 0.0;  // [mm]; 0 off the tool
  double viscous = 0.0;  // [N]
  double half = 0.0;     // thickness at s when it was pressed [mm]
  double spared = 0.0;   // depth at which it came to the sharp places [mm]
};

// An edge in a tool's frame.
struct EdgeSegment {
  double start[3], way[3], length;

  PRESSWORK_DEVICE EdgeSegment(const double a[3], const double b[3], const double displacement[3]) {
    for (int k = 0; k < 3; ++k) start[k] = a[k] - displacement[k], way[k] = b[k] - a[k];
    length = std::sqrt(contact::dot(way, way));
  }
  PRESSWORK_DEVICE void locate(double s, double x[3]) const {
    for (int k = 0; k < 3; ++k) x[k] = start[k] + s * way[k];
  }
};

// Slip after which a surface is asked again, and how far away it is looked for [mm].
struct EdgeSight {
  double memory, reach;
};

// Force of a tool's damper, as damper() of node_touch.hpp.
PRESSWORK_DEVICE inline double edge_damper(const Grip& grip, double step, double dt) {
  return grip.damping > 0.0 && dt > 0.0 ? 2.0 * edge_touch::share * grip.damping * std::sqrt(grip.penalty) * step / dt
                                        : 0.0;
}

// The place of least gap along an edge: from s on where it is known to be near, else from the least of some
// edge_touch::samples. False where the surface is out of reach; then found.gap is a bound for the edge_touch::samples.
template <class Surface>
PRESSWORK_DEVICE bool find_lowest(const Surface& surface, const EdgeSight& sight, const EdgeSegment& edge, bool known,
                                  double& s, int& hint, contact::Touch& found) {
  struct Place {
    double s, slope;  // slope of the gap, over the edge's length
    bool is_near;
    contact::Touch touch;
  };
  auto look = [&](double at) {
    Place place{at, 0.0, false, {}};
    double x[3];
    edge.locate(at, x);
    place.is_near = surface.nearest(x, sight.reach, hint, place.touch);
    if (place.is_near) place.slope = contact::dot(place.touch.normal, edge.way) / edge.length;
    return place;
  };
  auto done = [&](const Place& place) {
    s = place.s, found = place.touch;
    return place.is_near;
  };
  // 1. a bracket low.s < high.s whose slopes point to the inside
  Place low, high, best;
  if (known) {
    best = look(s);
    if (!best.is_near || std::abs(best.slope) < edge_touch::level) return done(best);
    low = high = best;
    const double towards = best.slope > 0.0 ? -1.0 : 1.0;
    // to where it is opposite the place touched, which is the lowest if that is a corner; from there in growing steps
    double opposite = 0.0;
    for (int k = 0; k < 3; ++k) opposite += (best.touch.point[k] - edge.start[k]) * edge.way[k];
    const double aside = std::abs(opposite / (edge.length * edge.length) - best.s);
    for (double step = aside; step < 8.0; step = std::max(4.0 * step, 0.01)) {
      const Place next = look(std::clamp(best.s + towards * step, 0.0, 1.0));
      if (!next.is_near) return done(best);
      if (std::abs(next.slope) < edge_touch::level) return done(next);
      (towards < 0.0 ? low : high) = next;
      if (next.slope * best.slope <= 0.0) break;
      if (next.s == 0.0 || next.s == 1.0) return done(next);
      (towards < 0.0 ? high : low) = next;
    }
  } else {
    Place all[edge_touch::samples];
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < edge_touch::samples; ++i) {
      all[i] = look(i / (edge_touch::samples - 1.0));
      lowest = std::min(lowest, all[i].touch.gap);
    }
    int least = 0, last = edge_touch::samples - 1;
    const auto is_lowest = [&](const Place& place) {
      return place.touch.gap <= lowest + edge_touch::alike * sight.memory;
    };
    while (!is_lowest(all[least])) ++least;
    while (!is_lowest(all[last])) --last;
    // where part of the edge lies on a plane its middle is taken, whichever end comes first
    if (last > least) {
      best = look(0.5 * (all[least].s + all[last].s));
      if (best.is_near && std::abs(best.slope) < edge_touch::level && is_lowest(best)) return done(best);
    }
    best = all[least];
    if (!best.is_near || std::abs(best.slope) < edge_touch::level) return done(best);
    const int other = best.slope > 0.0 ? least - 1 : least + 1;
    if (other < 0 || other == edge_touch::samples || !all[other].is_near) return done(best);
    low = all[std::min(least, other)], high = all[std::max(least, other)];
  }
  // 2. its slopes closed in on zero: regula falsi, halved in turn
  for (int i = 0; i < edge_touch::most_steps; ++i) {
    const double drop = high.slope - low.slope;
    const bool halve = i % 2 == 1 || !(low.slope < 0.0 && high.slope > 0.0 && drop > 0.0);
    const Place next = look(halve ? 0.5 * (low.s + high.s) : low.s - low.slope / drop * (high.s - low.s));
    if (!next.is_near) break;
    if (next.touch.gap < best.touch.gap) best = next;
    if (std::abs(next.slope) < edge_touch::level || (high.s - low.s) * edge.length < 0.1 * sight.memory) break;
    (next.slope > 0.0 ? high : low) = next;
  }
  return done(best);
}

// Ask a surface about one edge in its tool's frame. half: thickness at its ends, 0 where the sheet touches with its
// mid-surface. Where it is off it falls asleep until the tool has travelled to `wake`, and is forgotten. False where an
// edge that was pressed has gone through.
template <class Surface, class Sharp>
PRESSWORK_DEVICE bool ask_edge(const Surface& surface, const Sharp& sharp, const EdgeSight& sight, double travel,
                               const EdgeSegment& seen, const double half[2], EdgeTouching& p, double& wake) {
  const bool was_pressed = p.pressed > 0.0;
  const double most = half[0] < half[1] ? half[1] : half[0];
  const auto half_at = [&](double s) { return (1.0 - s) * half[0] + s * half[1]; };
  const auto sleep = [&](double away, double known) {
    wake = travel + reach_awake * away;
    const std::int32_t hint = p.hint, sharp_hint = p.sharp_hint;
    p = EdgeTouching{};
    p.seen = known, p.hint = hint, p.sharp_hint = sharp_hint;
  };
  if (!was_pressed) {
    double end[3];
    seen.locate(1.0, end);
    const double away = sharp.distance(seen.start, end, most + sight.memory, p.sharp_hint) - most;
    if (away > sight.memory) {
      sleep(away, EdgeTouching::off);
      return true;
    }
  }
  contact::Touch found;
  if (!find_lowest(surface, sight, seen, p.seen == EdgeTouching::followed, p.s, p.hint, found)) {
    const bool through = was_pressed && !found.past_rim;
    sleep(std::max(found.gap - most - 0.25 * seen.length, sight.memory), EdgeTouching::near);
    return !through;
  }
  if (!was_pressed) p.half = half_at(p.s);
  // a little more than its depth, which `press_edge` cuts down to it: rounding must not say whether the edge is pressed
  if (p.seen == EdgeTouching::off)
    p.spared = std::max(half_at(p.s) - found.gap, 0.0) + edge_touch::alike * sight.memory;
  p.seen = EdgeTouching::followed;
  p.left = sight.memory;  // were it flat here, it need not be along the edge
  p.tilt = contact::dot(found.normal, seen.way);
  p.offset = contact::dot(found.normal, seen.start) + p.s * p.tilt - found.gap;
  for (int k = 0; k < 3; ++k) p.normal[k] = found.normal[k];
  return true;
}

// Of V edges, as records of EdgeTouching: asked and changing are its two, eight numbers each.
template <class V>
struct EdgePress {
  V start[3], way[3];  // in the tool's frame
  V moved[2][3];       // steps of the ends relative to the tool
  V half[2], base;     // thickness at the ends, mass/dt^2
  V asked[8], changing[8];

  PRESSWORK_INLINE V& left() { return changing[3]; }
  // Way of the end that has slipped on farther along the tangent plane: the sum of its components' sizes.
  PRESSWORK_INLINE V slip() const {
    V most(0.0);
    for (const auto& of_end : moved) most = larger(most, measure_slip(asked + 1, of_end));
    return most;
  }
  // By how much the edge has turned to the plane [mm].
  PRESSWORK_INLINE V turn() const {
    const V by = touching::dot(asked + 1, way) - asked[5];
    return select(by < V(0.0), -by, by);
  }

  // Pressure and friction of those that are awake. Gives the force on the sheet, at s; squeeze: what a change of
  // thickness does to the spring; on: which are pressed; depth: in the tool.
  PRESSWORK_INLINE TouchSums<V> press(const Grip& grip, Mask<V> awake, double damper, double memory, V& squeeze,
                                      Mask<V>& on, V& depth) {
    using touching::dot;
    const V zero(0.0), &s = asked[0], *normal = asked + 1, &offset = asked[4];
    V *shear = changing, &pressed = changing[4], &viscous = changing[5], &half_then = changing[6],
      &spared = changing[7];
    TouchSums<V> sums;
    V dx[3], place[3];
    for (int k = 0; k < 3; ++k) {
      dx[k] = moved[0][k] + s * (moved[1][k] - moved[0][k]);
      place[k] = start[k] + s * way[k];
    }
    const V at = half[0] + s * (half[1] - half[0]), in = at - (dot(normal, place) - offset);
    spared = smaller(spared, larger(in, zero));
    depth = in - spared;
    const V k = V(edge_touch::share * grip.penalty) * base;
    // 1. what a change of thickness does to the spring is no work of the edge
    const V then = pressed, squeezed = larger(then + at - half_then, zero);
    squeeze = select(then > zero, V(0.5) * k * (squeezed * squeezed - then * then), zero);
    half_then = at;
    // 2. off the tool it sleeps, unless so near that it would be for a few cycles
    left() = select(both(awake, depth < V(-memory)), zero, left());
    // 3. normal force; the damper never pulls
    on = both(awake, depth > zero);
    pressed = select(on, depth, zero);
    const V closing = dot(normal, dx), damped = viscous;
    viscous = zero;
    if (damper > 0.0) viscous = select(on, larger(-V(damper) * base * closing, -k * pressed), zero);
    const V pressure = k * pressed + viscous;
    sums.damping = V(-0.5) * (damped + viscous) * closing;
    // 4. friction: elastic trial in the present tangent plane, shortened to mu N
    const V out = dot<V>(normal, shear), limit = V(grip.friction) * pressure;
    V trial[3], work = zero;
    for (int i = 0; i < 3; ++i) trial[i] = shear[i] - out * normal[i] - k * (dx[i] - closing * normal[i]);
    const V size = dot(trial, trial);
    const Mask<V> slips = size > limit * limit;
    const V ratio = select(slips, limit / square_root(select(slips, size, V(1.0))), V(1.0));
    const V scale = select(on, ratio, zero);
    for (int i = 0; i < 3; ++i) {
      const V now = scale * trial[i];
      work += (shear[i] + now) * dx[i];
      shear[i] = now;
      sums.force[i] = pressure * normal[i] + now;
    }
    sums.friction = V(-0.5) * work;
    return sums;
  }
};

}  // namespace presswork::explicit_dynamics
