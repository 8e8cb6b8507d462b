// SPDX-License-Identifier: Apache-2.0
#include "explicit/contact/edge_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/vectors.hpp"
#include "tensor/records.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

template <class T>
T dot(const T a[3], const T b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Pack size_of(Pack x) { return select(x < Pack(0.0), -x, x); }

}  // namespace

EdgeContact::EdgeContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node,
                         double length, double memory, double reach)
    : n_nodes_(n_nodes),
      length_(length),
      memory_(memory),
      reach_(reach),
      cell_start_(cell_start),
      node_start_(std::size_t(n_nodes) + 1, 0) {
  std::vector<std::pair<int, int>> round, sorted;  // edges round the cells; each once
  for (std::size_t i = 0; i + 1 < cell_start.size(); ++i)
    for (int a = cell_start[i], last = cell_start[i + 1]; a < last; ++a)
      round.push_back(std::minmax(cell_node[a], cell_node[a + 1 < last ? a + 1 : cell_start[i]]));
  sorted = round;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  for (const auto& [a, b] : sorted) edges_.insert(edges_.end(), {a, b});
  for (const auto& edge : round)
    cell_edge_.push_back(static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), edge) - sorted.begin()));
  base_.resize(sorted.size());
  for (int node : edges_) ++node_start_[node + 1];
  for (int i = 0; i < n_nodes; ++i) node_start_[i + 1] += node_start_[i];
  end_slot_.resize(edges_.size());
  std::vector<int> next(node_start_.begin(), node_start_.end() - 1);
  for (std::size_t i = 0; i < edges_.size(); ++i) end_slot_[i] = next[edges_[i]]++;
}

void EdgeContact::add(const Tool& tool) {
  Pairs of;
  if (tool.grip.edges) of.sharp = std::make_unique<contact::SharpPlaces>(tool.surface, 0.5 * length_, turn);
  if (of.sharp && !of.sharp->any()) of.sharp.reset();
  if (of.sharp) {
    of.at.assign(n_edges(), untouched);
    of.wake_group.assign((n_edges() + group - 1) / group, 0.0);
    of.wake.assign(of.wake_group.size() * group, never);
    std::fill_n(of.wake.begin(), n_edges(), 0.0);
    force_.resize(3 * edges_.size()), bears_.resize(edges_.size());
    bearing_.resize((std::size_t(n_edges()) + chunk - 1) / chunk);
    needed_ = true;
  }
  pairs_.push_back(std::move(of));
  sums_.assign(std::size_t(chunks()) * pairs_.size(), {});
}

ContactSums EdgeContact::sum_up(int tool) const {
  ContactSums sum;
  for (int c = 0; c < chunks(); ++c) sum += sums_[std::size_t(c) * pairs_.size() + tool];
  return sum;
}

void EdgeContact::set_stiffness(const std::vector<double>& cell_mass, double dt) {
  step_ = dt;
  std::fill(base_.begin(), base_.end(), 0.0);
  for (std::size_t i = 0; i < cell_mass.size(); ++i) {
    const double part = 2.0 / (cell_start_[i + 1] - cell_start_[i]) * cell_mass[i] / (dt * dt);
    for (int a = cell_start_[i]; a < cell_start_[i + 1]; ++a) base_[cell_edge_[a]] += part;
  }
}

double EdgeContact::half_at(const Grip& grip, const double* half, int edge, double s) const {
  return grip.thickness ? (1.0 - s) * half[node(edge, 0)] + s * half[node(edge, 1)] : 0.0;
}

void EdgeContact::add_stored(int tool, const Grip& grip, double& normal, double& shear) const {
  const Pairs& of = pairs_[tool];
  for (int e = 0; e < static_cast<int>(of.at.size()); ++e) {
    const Touching& p = of.at[e];
    if (!(p.pressed > 0.0)) continue;
    const double k = stiffness(grip, e);
    normal += 0.5 * k * p.pressed * p.pressed;
    shear += 0.5 * dot(p.shear, p.shear) / k;
  }
}

void EdgeContact::add_forces(int tool, const Grip& grip, double* force) const {
  const Pairs& of = pairs_[tool];
  for (int e = 0; e < static_cast<int>(of.at.size()); ++e) {
    const Touching& p = of.at[e];
    if (!(p.pressed > 0.0)) continue;
    const double pressure = stiffness(grip, e) * p.pressed + p.viscous;
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
  std::fill(of.at.begin(), of.at.end(), untouched);
}

void EdgeContact::wake(int tool) {
  for (double& wake : pairs_[tool].wake) wake = wake < never ? 0.0 : wake;
  for (Touching& p : pairs_[tool].at) p.left = 0.0;
  std::fill(pairs_[tool].wake_group.begin(), pairs_[tool].wake_group.end(), 0.0);
}

void EdgeContact::touch(const Tool& tool, Pairs& of, EdgePack& edges, const double* half_of, double dt, int slot,
                        LaneSums& sums, std::vector<int>& bearing) {
  const Grip& grip = tool.grip;
  const int n = edges.n;
  const Pack zero(0.0);
  // 1. ends in the tool's frame, and the pairs' two records
  Pack at[2][4], velocity[2][4], start[3], way[3], moved[2][3], part_half[2] = {zero, zero}, base;
  for (int end = 0; end < 2; ++end) {
    const double *places[width], *speeds[width];
    for (int lane = 0; lane < width; ++lane) places[lane] = edges.x[end][lane], speeds[lane] = edges.v[end][lane];
    load_records<4>(places, at[end]), load_records<4>(speeds, velocity[end]);
    for (int k = 0; k < 3; ++k) moved[end][k] = Pack(dt) * (velocity[end][k] - Pack(tool.velocity[k]));
    if (grip.thickness) std::memcpy(&part_half[end], edges.half[end], sizeof(Pack));
  }
  std::memcpy(&base, edges.base, sizeof base);
  for (int k = 0; k < 3; ++k) start[k] = at[0][k] - Pack(tool.displacement[k]), way[k] = at[1][k] - at[0][k];
  Touching nothing = untouched;  // for lanes that are left alone
  Pack::Mask awake;
  for (int lane = 0; lane < width; ++lane) awake[lane] = lane < n ? -1 : 0;
  for (int lane = n; lane < width; ++lane) edges.pair[lane] = &nothing;
  Pack asked[8], changing[8];
  const auto load = [&] {
    const double *first[width], *second[width];
    for (int lane = 0; lane < width; ++lane)
      first[lane] = records_of(*edges.pair[lane]), second[lane] = first[lane] + 8;
    load_records<8>(first, asked), load_records<8>(second, changing);
  };
  load();
  const Pack &s = asked[0], *normal = asked + 1, &offset = asked[4], &tilt = asked[5];
  Pack *shear = changing, &left = changing[3], &pressed = changing[4], &viscous = changing[5];
  Pack &half_then = changing[6], &spared = changing[7];
  // 2. the lowest place, asked for anew where an end has slipped or the edge turned on
  Pack slip = zero;
  for (const auto& of_end : moved) {
    const Pack out = dot(normal, of_end);
    Pack size = zero;
    for (int k = 0; k < 3; ++k) size += size_of(of_end[k] - out * normal[k]);
    slip = larger(slip, size);
  }
  left -= slip;
  const Pack::Mask turned = size_of(dot(normal, way) - tilt) > Pack(0.1 * memory_);
  const Pack::Mask asking = both(awake, either(left.v <= zero.v, turned));
  if (any(asking)) {
    const Pack known = left;
    for (int lane = 0; lane < n; ++lane) {
      if (!asking[lane]) continue;
      const int edge = edges.edge[lane];
      ask(tool, of, edge, Segment(edges.x[0][lane], edges.x[1][lane], tool.displacement), half_of, sums.lost);
      if (of.wake[edge] > tool.travel) edges.pair[lane] = &nothing, awake[lane] = 0;
    }
    load();
    left = select(asking, left, known);
  }
  Pack dx[3], place[3];
  for (int k = 0; k < 3; ++k) {
    dx[k] = moved[0][k] + s * (moved[1][k] - moved[0][k]);
    place[k] = start[k] + s * way[k];
  }
  const Pack half = part_half[0] + s * (part_half[1] - part_half[0]), in = half - (dot(normal, place) - offset);
  spared = smaller(spared, larger(in, zero));
  const Pack depth = in - spared, k = Pack(share * grip.penalty) * base;
  // 3. what a change of thickness does to the spring is no work of the edge
  const Pack then = pressed, squeezed = larger(then + half - half_then, zero);
  const Pack stored = Pack(0.5) * k * (squeezed * squeezed - then * then);
  sums.add(LaneSums::squeeze, slot, select(then > zero, stored, zero));
  half_then = half;
  // 4. off the tool: sleep, unless so near that it would be for a few cycles
  const Pack::Mask off_it = both(awake, depth < Pack(-memory_));
  if (any(off_it))
    for (int lane = 0; lane < n; ++lane)
      if (off_it[lane])
        of.wake[edges.edge[lane]] = tool.travel - reach_awake * depth[lane], edges.pair[lane]->seen = near;
  left = select(off_it, zero, left);
  // 5. normal force; the damper never pulls
  const Pack::Mask on = both(awake, depth > zero);
  pressed = select(on, depth, zero);
  const Pack closing = dot(normal, dx), damped = viscous;
  viscous = zero;
  if (grip.damping > 0.0 && dt > 0.0) {
    const double factor = 2.0 * share * grip.damping * std::sqrt(grip.penalty) * step_ / dt;
    viscous = select(on, larger(-Pack(factor) * base * closing, -k * pressed), zero);
  }
  const Pack pressure = k * pressed + viscous;
  sums.add(LaneSums::damping, slot, Pack(-0.5) * (damped + viscous) * closing);
  // 6. friction: elastic trial in the present tangent plane, shortened to mu N
  const Pack out = dot<Pack>(normal, shear), limit = Pack(grip.friction) * pressure;
  Pack trial[3], work = zero, force[3];
  for (int i = 0; i < 3; ++i) trial[i] = shear[i] - out * normal[i] - k * (dx[i] - closing * normal[i]);
  const Pack size = dot(trial, trial);
  const Pack::Mask slips = size > limit * limit;
  const Pack ratio = select(slips, limit / square_root(select(slips, size, Pack(1.0))), Pack(1.0));
  const Pack scale = select(on, ratio, zero);
  for (int i = 0; i < 3; ++i) {
    const Pack now = scale * trial[i];
    work += (shear[i] + now) * dx[i];
    shear[i] = now;
    force[i] = pressure * normal[i] + now;
    sums.add(static_cast<LaneSums::Row>(LaneSums::force + i), slot, force[i]);
  }
  sums.add(LaneSums::friction, slot, Pack(-0.5) * work);
  // 7. what has changed, and the nodes' parts
  double* second[width];
  for (int lane = 0; lane < width; ++lane) second[lane] = records_of(*edges.pair[lane]) + 8;
  store_records<8>(changing, second);
  for (int lane = 0; lane < n; ++lane)
    if (on[lane]) {
      const double f[3] = {force[0][lane], force[1][lane], force[2][lane]};
      give(edges.edge[lane], s[lane], f, bearing);
    }
}

void EdgeContact::give(int edge, double s, const double force[3], std::vector<int>& bearing) {
  const int slots[2] = {end_slot_[2 * std::size_t(edge)], end_slot_[2 * std::size_t(edge) + 1]};
  const bool is_first = !bears_[slots[0]];
  if (is_first) bearing.push_back(edge);
  for (int end = 0; end < 2; ++end) {
    double* sum = &force_[3 * std::size_t(slots[end])];
    for (int k = 0; k < 3; ++k) sum[k] = (is_first ? 0.0 : sum[k]) + (end == 0 ? 1.0 - s : s) * force[k];
    bears_[slots[end]] = 1;
  }
}

}  // namespace presswork::explicit_dynamics
