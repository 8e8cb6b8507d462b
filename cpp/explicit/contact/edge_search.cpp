// SPDX-License-Identifier: Apache-2.0
// Which edges may touch a tool, and where along them they are nearest to it.
#include <algorithm>
#include <cmath>

#include "explicit/contact/edge_contact.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr int samples = 5;      // along an edge that is new to a tool
constexpr double level = 2e-3;  // slope of the gap along the edge that is none
constexpr int most_steps = 12;  // of a search for the lowest place
constexpr double alike = 1e-6;  // difference of gaps that is none, over the memory

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

EdgeContact::Segment::Segment(const double a[3], const double b[3], const double displacement[3]) {
  for (int k = 0; k < 3; ++k) start[k] = a[k] - displacement[k], way[k] = b[k] - a[k];
  length = std::sqrt(dot(way, way));
}

int EdgeContact::find_awake(int c, Pairs& of, double travel, int found[chunk + 1]) const {
  int n = 0;
  const int groups = static_cast<int>(of.wake_group.size()), first = c * (chunk / group);
  for (int g = first; g < std::min(groups, first + chunk / group); ++g) {
    if (of.wake_group[g] > travel) continue;
    const double* wake = &of.wake[g * std::size_t(group)];
    const int before = n;
    for (int i = 0; i < group; ++i) found[n] = g * group + i, n += wake[i] <= travel ? 1 : 0;
    if (n == before) of.wake_group[g] = *std::min_element(wake, wake + group);
  }
  for (int i = 0; i < n; ++i) {
    const auto* record = reinterpret_cast<const char*>(&of.at[found[i]]);
    for (std::size_t line = 0; line < sizeof(Touching); line += 64) __builtin_prefetch(record + line, 1);
  }
  return n;
}

// The place of least gap along an edge: from s on where it is known to be near, else from the least of some samples.
// False where the surface is out of reach; then found.gap is a bound for the samples.
bool EdgeContact::find_lowest(const contact::ToolSurface& surface, const Segment& edge, bool known, double& s,
                              int& hint, contact::Touch& found) const {
  struct Place {
    double s, slope;  // slope of the gap, over the edge's length
    bool is_near;
    contact::Touch touch;
  };
  auto look = [&](double at) {
    Place place{at, 0.0, false, {}};
    double x[3];
    edge.locate(at, x);
    place.is_near = surface.nearest(x, reach_, hint, place.touch);
    if (place.is_near) place.slope = dot(place.touch.normal, edge.way) / edge.length;
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
    if (!best.is_near || std::abs(best.slope) < level) return done(best);
    low = high = best;
    const double towards = best.slope > 0.0 ? -1.0 : 1.0;
    // to where it is opposite the place touched, which is the lowest if that is a corner; from there in growing steps
    double opposite = 0.0;
    for (int k = 0; k < 3; ++k) opposite += (best.touch.point[k] - edge.start[k]) * edge.way[k];
    const double aside = std::abs(opposite / (edge.length * edge.length) - best.s);
    for (double step = aside; step < 8.0; step = std::max(4.0 * step, 0.01)) {
      const Place next = look(std::clamp(best.s + towards * step, 0.0, 1.0));
      if (!next.is_near) return done(best);
      if (std::abs(next.slope) < level) return done(next);
      (towards < 0.0 ? low : high) = next;
      if (next.slope * best.slope <= 0.0) break;
      if (next.s == 0.0 || next.s == 1.0) return done(next);
      (towards < 0.0 ? high : low) = next;
    }
  } else {
    Place all[samples];
    double lowest = never;
    for (int i = 0; i < samples; ++i) {
      all[i] = look(i / (samples - 1.0));
      lowest = std::min(lowest, all[i].touch.gap);
    }
    int least = 0, last = samples - 1;
    const auto is_lowest = [&](const Place& place) { return place.touch.gap <= lowest + alike * memory_; };
    while (!is_lowest(all[least])) ++least;
    while (!is_lowest(all[last])) --last;
    // where part of the edge lies on a plane its middle is taken, whichever end comes first
    if (last > least) {
      best = look(0.5 * (all[least].s + all[last].s));
      if (best.is_near && std::abs(best.slope) < level && is_lowest(best)) return done(best);
    }
    best = all[least];
    if (!best.is_near || std::abs(best.slope) < level) return done(best);
    const int other = best.slope > 0.0 ? least - 1 : least + 1;
    if (other < 0 || other == samples || !all[other].is_near) return done(best);
    low = all[std::min(least, other)], high = all[std::max(least, other)];
  }
  // 2. its slopes closed in on zero: regula falsi, halved in turn
  for (int i = 0; i < most_steps; ++i) {
    const double drop = high.slope - low.slope;
    const bool halve = i % 2 == 1 || !(low.slope < 0.0 && high.slope > 0.0 && drop > 0.0);
    const Place next = look(halve ? 0.5 * (low.s + high.s) : low.s - low.slope / drop * (high.s - low.s));
    if (!next.is_near) break;
    if (next.touch.gap < best.touch.gap) best = next;
    if (std::abs(next.slope) < level || (high.s - low.s) * edge.length < 0.1 * memory_) break;
    (next.slope > 0.0 ? high : low) = next;
  }
  return done(best);
}

// Ask the surface about one edge. Where it is off it falls asleep, and is forgotten.
void EdgeContact::ask(const Tool& tool, Pairs& of, int edge, const Segment& seen, const double* half, int& lost) const {
  Touching& p = of.at[edge];
  const bool was_pressed = p.pressed > 0.0;
  const double most = std::max(half_at(tool.grip, half, edge, 0.0), half_at(tool.grip, half, edge, 1.0));
  const auto sleep = [&](double away, double known) {
    of.wake[edge] = tool.travel + reach_awake * away;
    const std::int32_t hint = p.hint, sharp_hint = p.sharp_hint;
    p = untouched;
    p.seen = known, p.hint = hint, p.sharp_hint = sharp_hint;
  };
  if (!was_pressed) {
    double end[3];
    seen.locate(1.0, end);
    const double away = of.sharp->distance(seen.start, end, most + memory_, p.sharp_hint) - most;
    if (away > memory_) return sleep(away, off);
  }
  contact::Touch found;
  if (!find_lowest(*tool.surface, seen, p.seen == followed, p.s, p.hint, found)) {
    if (was_pressed && !found.past_rim) lost = std::min(lost, n_nodes_ + edge);
    return sleep(std::max(found.gap - most - 0.25 * seen.length, memory_), near);
  }
  if (!was_pressed) p.half = half_at(tool.grip, half, edge, p.s);
  // a little more than its depth, which `touch` cuts down to it: rounding must not say whether the edge is pressed
  if (p.seen == off) p.spared = std::max(half_at(tool.grip, half, edge, p.s) - found.gap, 0.0) + alike * memory_;
  p.seen = followed;
  p.left = memory_;  // were it flat here, it need not be along the edge
  p.tilt = dot(found.normal, seen.way);
  p.offset = dot(found.normal, seen.start) + p.s * p.tilt - found.gap;
  std::copy_n(found.normal, 3, p.normal);
}

}  // namespace presswork::explicit_dynamics
