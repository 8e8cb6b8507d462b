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
  if (tool.grip.edges) of.sharp = std::make_unique<contact::SharpPlaces>(tool.surface, length_);
  if (of.sharp && !of.sharp->any()) of.sharp.reset();
  if (of.sharp) {
    of.at.assign(n_edges(), EdgeTouching{});
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

void EdgeContact::leave_to_others(const std::vector<char>& is_left) {
  counts_.clear();
  for (int e = 0; e < n_edges(); ++e) counts_.push_back(is_left[node(e, 0)] ? 0.0 : 1.0);
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
    if (!(p.pressed > 0.0) || (!counts_.empty() && counts_[e] == 0.0)) continue;
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
  std::fill(of.at.begin(), of.at.end(), EdgeTouching{});
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
  EdgePress<Pack> p;
  Pack at[2][4], velocity[2][4];
  p.half[0] = p.half[1] = zero;
  for (int end = 0; end < 2; ++end) {
    const double *places[width], *speeds[width];
    for (int lane = 0; lane < width; ++lane) places[lane] = edges.x[end][lane], speeds[lane] = edges.v[end][lane];
    load_records<4>(places, at[end]), load_records<4>(speeds, velocity[end]);
    for (int k = 0; k < 3; ++k) p.moved[end][k] = Pack(dt) * (velocity[end][k] - Pack(tool.velocity[k]));
    if (grip.thickness) std::memcpy(&p.half[end], edges.half[end], sizeof(Pack));
  }
  std::memcpy(&p.base, edges.base, sizeof p.base);
  for (int k = 0; k < 3; ++k) p.start[k] = at[0][k] - Pack(tool.displacement[k]), p.way[k] = at[1][k] - at[0][k];
  Touching nothing;  // for lanes that are left alone
  Pack::Mask awake;
  for (int lane = 0; lane < width; ++lane) awake[lane] = lane < n ? -1 : 0;
  for (int lane = n; lane < width; ++lane) edges.pair[lane] = &nothing;
  const auto load = [&] {
    const double *first[width], *second[width];
    for (int lane = 0; lane < width; ++lane)
      first[lane] = records_of(*edges.pair[lane]), second[lane] = first[lane] + 8;
    load_records<8>(first, p.asked), load_records<8>(second, p.changing);
  };
  load();
  // 2. the lowest place, asked for anew where an end has slipped or the edge turned on
  p.left() -= p.slip();
  const Pack::Mask asking = both(awake, either(p.left().v <= zero.v, p.turn() > Pack(0.1 * memory_)));
  if (any(asking)) {
    const Pack known = p.left();
    for (int lane = 0; lane < n; ++lane) {
      if (!asking[lane]) continue;
      const int edge = edges.edge[lane];
      ask(tool, of, edge, Segment(edges.x[0][lane], edges.x[1][lane], tool.displacement), half_of, sums.lost);
      if (of.wake[edge] > tool.travel) edges.pair[lane] = &nothing, awake[lane] = 0;
    }
    load();
    p.left() = select(asking, p.left(), known);
  }
  // 3. forces; those off the tool fall asleep
  Pack squeeze, depth;
  Pack::Mask on;
  const auto found = p.press(grip, awake, edge_damper(grip, step_, dt), memory_, squeeze, on, depth);
  const Pack::Mask off_it = both(awake, depth < Pack(-memory_));
  if (any(off_it))
    for (int lane = 0; lane < n; ++lane)
      if (off_it[lane])
        of.wake[edges.edge[lane]] = tool.travel - reach_awake * depth[lane], edges.pair[lane]->seen = Touching::near;
  Pack counts(1.0);
  for (int lane = 0; !counts_.empty() && lane < n; ++lane) counts.set(lane, counts_[edges.edge[lane]]);
  const Pack force[3] = {counts * found.force[0], counts * found.force[1], counts * found.force[2]};
  sums.add(LaneSums::squeeze, slot, counts * squeeze), sums.add(LaneSums::damping, slot, counts * found.damping);
  sums.add_force(force, slot);
  sums.add(LaneSums::friction, slot, counts * found.friction);
  // 4. what has changed, and the nodes' parts
  double* second[width];
  for (int lane = 0; lane < width; ++lane) second[lane] = records_of(*edges.pair[lane]) + 8;
  store_records<8>(p.changing, second);
  for (int lane = 0; lane < n; ++lane)
    if (on[lane]) {
      const double f[3] = {found.force[0][lane], found.force[1][lane], found.force[2][lane]};
      give(edges.edge[lane], p.asked[0][lane], f, bearing);
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
