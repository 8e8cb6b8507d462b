// SPDX-License-Identifier: Apache-2.0
#include "explicit/edge_contact.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double reach_awake = 0.9;  // of its gap an edge sleeps
constexpr int samples = 5;           // along an edge that is new to a tool
constexpr double level = 2e-3;       // slope of the gap along the edge that is none
constexpr int most_steps = 12;       // of a search for the lowest place

using contact::dot;

}  // namespace

EdgeContact::EdgeContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node,
                         double length, double memory, double reach)
    : n_nodes_(n_nodes), length_(length), memory_(memory), reach_(reach), node_start_(std::size_t(n_nodes) + 1, 0) {
  std::set<std::pair<int, int>> sorted;
  for (std::size_t i = 0; i + 1 < cell_start.size(); ++i)
    for (int a = cell_start[i], last = cell_start[i + 1]; a < last; ++a) {
      const int here = cell_node[a], next = cell_node[a + 1 < last ? a + 1 : cell_start[i]];
      sorted.insert(std::minmax(here, next));
    }
  for (const auto& [a, b] : sorted) edges_.insert(edges_.end(), {a, b});
  for (int node : edges_) ++node_start_[node + 1];
  for (int i = 0; i < n_nodes; ++i) node_start_[i + 1] += node_start_[i];
  node_end_.resize(edges_.size());
  std::vector<int> next(node_start_.begin(), node_start_.end() - 1);
  std::vector<std::set<int>> near((std::size_t(n_nodes) + chunk - 1) / chunk);
  for (int i = 0; i < static_cast<int>(edges_.size()); ++i) {
    node_end_[next[edges_[i]]++] = i;
    near[edges_[i] / chunk].insert(i / 2 / chunk);
  }
  near_start_.push_back(0);
  for (const auto& chunks : near) {
    near_.insert(near_.end(), chunks.begin(), chunks.end());
    near_start_.push_back(static_cast<int>(near_.size()));
  }
  touches_.assign((std::size_t(n_edges()) + chunk - 1) / chunk, 0);
}

void EdgeContact::add(const Tool& tool) {
  Pairs of;
  if (tool.grip.edges) of.sharp = std::make_unique<contact::SharpPlaces>(tool.surface, 0.5 * length_, turn);
  if (of.sharp && !of.sharp->any()) of.sharp.reset();
  if (of.sharp) {
    of.wake.assign(n_edges(), 0.0), of.at.assign(n_edges(), Touching{});
    of.hint.assign(n_edges(), -1), of.sharp_hint.assign(n_edges(), -1);
    force_.resize(6 * std::size_t(n_edges()), 0.0);
    any_ = true;
  }
  pairs_.push_back(std::move(of));
  sums_.assign(touches_.size() * pairs_.size(), {});
}

bool EdgeContact::touches(int node_chunk) const {
  for (int i = near_start_[node_chunk]; i < near_start_[node_chunk + 1]; ++i)
    if (touches_[near_[i]]) return true;
  return false;
}

void EdgeContact::add_to_node(int node, double force[3]) const {
  for (int i = node_start_[node]; i < node_start_[node + 1]; ++i)
    for (int k = 0; k < 3; ++k) force[k] += force_[3 * std::size_t(node_end_[i]) + k];
}

EdgeContact::Sums EdgeContact::sum_up(int tool) const {
  Sums sum;
  for (int c = 0; c < chunks(); ++c) {
    const Sums& of = sums_[std::size_t(c) * pairs_.size() + tool];
    sum.friction += of.friction, sum.damping += of.damping, sum.squeeze += of.squeeze;
    for (int k = 0; k < 3; ++k) sum.force[k] += of.force[k];
    sum.lost = std::min(sum.lost, of.lost);
  }
  return sum;
}

double EdgeContact::stiffness(const Grip& grip, const Nodes& nodes, int edge) const {
  return share * grip.penalty * std::min(nodes.base[node(edge, 0)], nodes.base[node(edge, 1)]);
}

double EdgeContact::half_at(const Grip& grip, const Nodes& nodes, int edge, double s) const {
  return grip.thickness ? (1.0 - s) * nodes.half[node(edge, 0)] + s * nodes.half[node(edge, 1)] : 0.0;
}

void EdgeContact::add_stored(int tool, const Grip& grip, const Nodes& nodes, double& normal, double& shear) const {
  const Pairs& of = pairs_[tool];
  for (int e = 0; e < static_cast<int>(of.at.size()); ++e) {
    const Touching& p = of.at[e];
    if (!(p.pressed > 0.0)) continue;
    const double k = stiffness(grip, nodes, e);
    normal += 0.5 * k * p.pressed * p.pressed;
    shear += 0.5 * dot(p.shear, p.shear) / k;
  }
}

void EdgeContact::add_forces(int tool, const Grip& grip, const Nodes& nodes, double* force) const {
  const Pairs& of = pairs_[tool];
  for (int e = 0; e < static_cast<int>(of.at.size()); ++e) {
    const Touching& p = of.at[e];
    if (!(p.pressed > 0.0)) continue;
    const double pressure = stiffness(grip, nodes, e) * p.pressed + p.viscous;
    for (int k = 0; k < 3; ++k) {
      const double f = pressure * p.normal[k] + p.shear[k];
      force[3 * std::size_t(node(e, 0)) + k] += (1.0 - p.s) * f;
      force[3 * std::size_t(node(e, 1)) + k] += p.s * f;
    }
  }
}

void EdgeContact::forget(int tool) {
  Pairs& of = pairs_[tool];
  std::fill(of.wake.begin(), of.wake.end(), never);
  std::fill(of.at.begin(), of.at.end(), Touching{});
}

void EdgeContact::wake(int tool) {
  for (double& wake : pairs_[tool].wake) wake = wake < never ? 0.0 : wake;
  for (Touching& p : pairs_[tool].at) p.left = 0.0;
}

EdgeContact::Segment EdgeContact::see(const Tool& tool, const Ends& ends) {
  Segment seen;
  for (int k = 0; k < 3; ++k) {
    seen.start[k] = ends.x[0][k] - tool.displacement[k];
    seen.way[k] = ends.x[1][k] - ends.x[0][k];
  }
  seen.length = std::sqrt(dot(seen.way, seen.way));
  return seen;
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
    for (int k = 0; k < 3; ++k) x[k] = edge.start[k] + at * edge.way[k];
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
    for (double step = 0.01; step < 8.0; step *= 4.0) {
      const Place next = look(std::clamp(best.s + towards * step, 0.0, 1.0));
      if (!next.is_near) return done(best);
      (towards < 0.0 ? low : high) = next;
      if (next.slope * best.slope <= 0.0) break;
      if (next.s == 0.0 || next.s == 1.0) return done(next);
      (towards < 0.0 ? high : low) = next;
    }
  } else {
    Place all[samples];
    int least = 0;
    for (int i = 0; i < samples; ++i) {
      all[i] = look(i / (samples - 1.0));
      if (all[i].touch.gap < all[least].touch.gap) least = i;
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

// Ask the surface about one edge. Where it is off it falls asleep.
void EdgeContact::ask(const Tool& tool, Pairs& of, int edge, const Segment& seen, const Nodes& nodes,
                      Sums& sums) const {
  Touching& p = of.at[edge];
  const bool was_pressed = p.pressed > 0.0;
  const double half = std::max(half_at(tool.grip, nodes, edge, 0.0), half_at(tool.grip, nodes, edge, 1.0));
  if (!was_pressed) {
    double middle[3];
    for (int k = 0; k < 3; ++k) middle[k] = seen.start[k] + 0.5 * seen.way[k];
    const double away = of.sharp->distance(middle, of.sharp_hint[edge]) - 0.5 * seen.length - half;
    if (away > memory_) {
      of.wake[edge] = tool.travel + reach_awake * away;
      p.seen = off;
      return;
    }
  }
  contact::Touch found;
  double s = p.s;
  if (!find_lowest(*tool.surface, seen, p.seen == followed, s, of.hint[edge], found)) {
    if (was_pressed) sums.lost = std::min(sums.lost, n_nodes_ + edge);
    p.seen = near;
    of.wake[edge] = tool.travel + reach_awake * std::max(found.gap - half - 0.25 * seen.length, memory_);
    return;
  }
  p.s = s;
  if (!was_pressed) p.half = half_at(tool.grip, nodes, edge, s);
  if (p.seen == off) p.spared = std::max(half_at(tool.grip, nodes, edge, s) - found.gap, 0.0);
  p.seen = followed;
  p.left = memory_;  // were it flat here, it need not be along the edge
  p.offset = -found.gap, p.tilt = dot(found.normal, seen.way);
  for (int k = 0; k < 3; ++k) {
    p.normal[k] = found.normal[k];
    p.offset += found.normal[k] * (seen.start[k] + s * seen.way[k]);
  }
}

void EdgeContact::touch(const Tool& tool, Pairs& of, int edge, const Ends& ends, const Nodes& nodes, double dt,
                        Sums& sums, double force[3]) {
  const Grip& grip = tool.grip;
  Touching& p = of.at[edge];
  const Segment seen = see(tool, ends);
  // 1. the lowest place, asked for anew where an end has slipped or turned on
  double way[2][3], slip = 0.0;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) way[i][k] = dt * (ends.v[i][k] - tool.velocity[k]);
  for (const auto& of_end : way) {
    double aside = 0.0;
    const double out = dot(p.normal, of_end);
    for (int k = 0; k < 3; ++k) aside += std::abs(of_end[k] - out * p.normal[k]);
    slip = std::max(slip, aside);
  }
  p.left -= slip;
  if (p.left <= 0.0 || std::abs(dot(p.normal, seen.way) - p.tilt) > 0.1 * memory_) {
    ask(tool, of, edge, seen, nodes, sums);
    if (of.wake[edge] > tool.travel) {  // nothing is near
      const double known = p.seen;
      p = Touching{};
      p.seen = known;
      return;
    }
  }
  double dx[3], place[3];
  for (int k = 0; k < 3; ++k) {
    dx[k] = (1.0 - p.s) * way[0][k] + p.s * way[1][k];
    place[k] = seen.start[k] + p.s * seen.way[k];
  }
  const double half = half_at(grip, nodes, edge, p.s), in = half - (dot(p.normal, place) - p.offset);
  p.spared = std::min(p.spared, std::max(in, 0.0));
  const double depth = in - p.spared;
  const double k = stiffness(grip, nodes, edge);
  // 2. what a change of thickness does to the spring is no work of the edge
  if (p.pressed > 0.0) {
    const double then = p.pressed, now = std::max(then + half - p.half, 0.0);
    sums.squeeze += 0.5 * k * (now * now - then * then);
  }
  p.half = half;
  if (depth < -memory_) {
    of.wake[edge] = tool.travel - reach_awake * depth;
    p.left = 0.0, p.seen = near;
  }
  // 3. normal force; the damper never pulls
  const bool on = depth > 0.0;
  const double pressed = on ? depth : 0.0, closing = dot(p.normal, dx);
  double viscous = 0.0;
  if (on && grip.damping > 0.0 && dt > 0.0)
    viscous = std::max(-2.0 * grip.damping * k / std::sqrt(grip.penalty) * nodes.step / dt * closing, -k * pressed);
  const double normal = k * pressed + viscous;
  sums.damping -= 0.5 * (p.viscous + viscous) * closing;
  // 4. friction: elastic trial in the present tangent plane, shortened to mu N
  const double out = dot(p.normal, p.shear), limit = grip.friction * normal;
  double shear[3], work = 0.0;
  for (int i = 0; i < 3; ++i) shear[i] = p.shear[i] - out * p.normal[i] - k * (dx[i] - closing * p.normal[i]);
  const double size = std::sqrt(dot(shear, shear)), ratio = !on ? 0.0 : size > limit ? limit / size : 1.0;
  for (int i = 0; i < 3; ++i) {
    const double now = ratio * shear[i];
    work += (p.shear[i] + now) * dx[i];
    p.shear[i] = now;
    force[i] = normal * p.normal[i] + now;
    sums.force[i] += force[i];
  }
  sums.friction -= 0.5 * work;
  p.pressed = pressed, p.viscous = viscous;
}

std::size_t EdgeContact::dump_size() const {
  std::size_t size = 0;
  for (const Pairs& of : pairs_) size += (rows + 3) * of.at.size();
  return size;
}

void EdgeContact::dump(int tool, std::vector<double>& to) const {
  const Pairs& of = pairs_[tool];
  for (std::size_t e = 0; e < of.at.size(); ++e) {
    const auto* row = reinterpret_cast<const double*>(&of.at[e]);
    to.insert(to.end(), row, row + rows);
    for (double x : {of.wake[e], double(of.hint[e]), double(of.sharp_hint[e])}) to.push_back(x);
  }
}

void EdgeContact::restore(int tool, const double*& from) {
  Pairs& of = pairs_[tool];
  for (std::size_t e = 0; e < of.at.size(); ++e) {
    auto* row = reinterpret_cast<double*>(&of.at[e]);
    for (int r = 0; r < rows; ++r) row[r] = *from++;
    of.wake[e] = *from++;
    of.hint[e] = static_cast<int>(*from++), of.sharp_hint[e] = static_cast<int>(*from++);
  }
}

}  // namespace presswork::explicit_dynamics
