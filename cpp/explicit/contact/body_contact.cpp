// SPDX-License-Identifier: Apache-2.0
#include "explicit/contact/body_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explicit/plane/nodes.hpp"
#include "explicit/space/nodes.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr double STIFFNESS = 0.35;    // of m/(A dt^2)
constexpr double longest_way = 0.01;  // of the mean edge, that a node goes with the same weights

// What the two kinds of nodes keep.
const double* position_of(const PlaneNodes& nodes, int i) { return nodes.position.data() + 4 * std::size_t(i); }
const double* position_of(const SpaceNodes<double>& nodes, int i) { return nodes.position.data() + 4 * std::size_t(i); }
const double* velocity_of(const PlaneNodes& nodes, int i) { return nodes.velocity.data() + 2 * std::size_t(i); }
const double* velocity_of(const SpaceNodes<double>& nodes, int i) { return nodes.motion.data() + 8 * std::size_t(i); }
double* force_of(PlaneNodes& nodes, int i) { return nodes.internal_force.data() + 2 * std::size_t(i); }
double* force_of(SpaceNodes<double>& nodes, int i) { return nodes.internal_force.data() + row_at(i); }
double mass_of(const PlaneNodes& nodes, int i) { return nodes.mass[i]; }
double mass_of(const SpaceNodes<double>& nodes, int i) {
  const double inverse = nodes.motion.data()[8 * std::size_t(i) + 6];
  return inverse > 0.0 ? 1.0 / inverse : std::numeric_limits<double>::infinity();
}

}  // namespace

template <class Nodes>
BodyContact<Nodes>::BodyContact(std::string name, int n_nodes, TouchingSurfaces surfaces, double reach, double margin)
    : name(std::move(name)), surfaces_(std::move(surfaces)), reach_(reach), margin_(margin) {
  // 1. nodes of both surfaces in rising order, and faces by their numbers there
  node_ = surfaces_.slave;
  node_.insert(node_.end(), surfaces_.master.begin(), surfaces_.master.end());
  std::sort(node_.begin(), node_.end());
  node_.erase(std::unique(node_.begin(), node_.end()), node_.end());
  std::vector<int> place(n_nodes, -1);
  for (std::size_t i = 0; i < node_.size(); ++i) place[node_[i]] = static_cast<int>(i);
  for (auto* faces : {&surfaces_.slave, &surfaces_.master})
    for (int& node : *faces) node = place[node];
  // 2. slots
  slot_node_ = surfaces_.slave;
  std::sort(slot_node_.begin(), slot_node_.end());
  slot_node_.erase(std::unique(slot_node_.begin(), slot_node_.end()), slot_node_.end());
  std::vector<int> slot(node_.size(), -1);
  for (std::size_t i = 0; i < slot_node_.size(); ++i) slot[slot_node_[i]] = static_cast<int>(i);
  for (int node : surfaces_.slave) slots_.push_back(slot[node]);
  is_master_.assign(node_.size(), 0);
  if (!surfaces_.self)
    for (int node : surfaces_.master) is_master_[node] = 1;
  // 3. what persists
  const std::size_t n = node_.size(), s = slot_node_.size();
  pressure.assign(s, 0.0), shear.assign(3 * s, 0.0), push.assign(3 * n, 0.0), rub.assign(3 * n, 0.0);
  impulse.assign(3, 0.0), cut_position_.assign(3 * n, 0.0);
  slave_depth_.assign(surfaces_.slave.size() / surfaces_.nodes, 0.0);
  master_depth_.assign(surfaces_.master.size() / surfaces_.nodes, 0.0);
  rows_.node_area.assign(n, 0.0);
  chunk_sums_.assign(5 * std::size_t(count_chunks(static_cast<int>(node_.size()))), 0.0);
}

template <class Nodes>
void BodyContact<Nodes>::take_positions(const Nodes& nodes) {
  for (std::size_t i = 0; i < node_.size(); ++i)
    for (int k = 0; k < dimension; ++k) cut_position_[3 * i + k] = position_of(nodes, node_[i])[k];
}

// Half the height of the cell behind each face: from the middle of a hexahedron or quadrilateral it is twice, of a
// tetrahedron four times and of a triangle three times as far to the opposite side as to the face.
template <class Nodes>
void BodyContact<Nodes>::measure_depths(const Nodes& nodes) {
  const int each = surfaces_.nodes, cell = surfaces_.cell_nodes;
  const double part = cell == 8 ? 1.0 : cell == 3 ? 1.5 : dimension == 3 ? 2.0 : 1.0;
  const auto measure = [&](const std::vector<int>& faces, const std::vector<int>& cells, std::vector<double>& depth) {
    for (std::size_t f = 0; f < depth.size(); ++f) {
      double x[4][3] = {}, from[3] = {}, out[3] = {};
      for (int i = 0; i < each; ++i)
        for (int k = 0; k < dimension; ++k) {
          x[i][k] = position_of(nodes, node_[faces[f * each + i]])[k];
          from[k] += x[i][k] / each;
        }
      for (int i = 0; i < cell; ++i)
        for (int k = 0; k < dimension; ++k) from[k] -= position_of(nodes, cells[f * cell + i])[k] / cell;
      if (each == 2) {
        out[0] = x[1][1] - x[0][1], out[1] = x[0][0] - x[1][0];
      } else {
        double a[3], b[3];
        for (int k = 0; k < 3; ++k)
          a[k] = x[each == 4 ? 2 : 1][k] - x[0][k], b[k] = x[each - 1][k] - x[each == 4 ? 1 : 0][k];
        contact::cross(a, b, out);
      }
      depth[f] = part * std::abs(contact::dot(from, out)) / std::sqrt(contact::dot(out, out));
    }
  };
  measure(surfaces_.slave, surfaces_.slave_cells, slave_depth_);
  measure(surfaces_.master, surfaces_.master_cells, master_depth_);
}

template <class Nodes>
void BodyContact<Nodes>::cut(const double* before) {
  const auto list = [&](const std::vector<int>& faces) {
    return FaceList{static_cast<int>(faces.size()) / surfaces_.nodes, surfaces_.nodes, faces.data()};
  };
  const MortarSurfaces in{list(surfaces_.slave),
                          list(surfaces_.master),
                          slots_.data(),
                          n_slots(),
                          n_nodes(),
                          surfaces_.self,
                          margin_ * surfaces_.edge,
                          reach_ * surfaces_.edge,
                          surfaces_.thickness,
                          slave_depth_.data(),
                          master_depth_.data()};
  rows_ = cut_mortar_rows(in, cut_position_.data(), before);
  passed = passed || rows_.passed;
  first_.assign(node_.size() + 1, 0);
  for (int i : rows_.node) ++first_[i + 1];
  for (std::size_t i = 0; i < node_.size(); ++i) first_[i + 1] += first_[i];
  entries_.resize(rows_.node.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int slot = 0; slot < n_slots(); ++slot)
    for (int e = rows_.start[slot]; e < rows_.start[slot + 1]; ++e)
      entries_[next[rows_.node[e]]++] = {slot, rows_.weight[e]};
  stale_ = false;
}

template <class Nodes>
void BodyContact<Nodes>::set_stiffness(const Nodes& nodes) {
  std::vector<double> of_node(node_.size());
  for (std::size_t i = 0; i < node_.size(); ++i) of_node[i] = mass_of(nodes, node_[i]) / rows_.node_area[i];
  stiffness_.assign(n_slots(), 0.0);
  for (int slot = 0; slot < n_slots(); ++slot) {
    double least = std::numeric_limits<double>::infinity();
    for (int e = rows_.start[slot]; e < rows_.start[slot + 1]; ++e) least = std::min(least, of_node[rows_.node[e]]);
    if (rows_.area[slot] > 0.0) stiffness_[slot] = STIFFNESS * least;
  }
}

template <class Nodes>
void BodyContact<Nodes>::begin(Nodes& nodes, int) {
  nodes_ = &nodes;
  if (since_cut_[1] == 0.0) {
    take_positions(nodes), measure_depths(nodes);
    since_cut_[1] = 1.0;
  }
  if (stale_) cut(nullptr);
  set_stiffness(nodes);
}

template <class Nodes>
std::vector<double> BodyContact<Nodes>::find_stiffness(Nodes& nodes) {
  begin(nodes, 0);
  std::vector<double> found = stiffness_;
  for (double& each : found) each /= step * step;
  return found;
}

template <class Nodes>
double BodyContact<Nodes>::find_fastest() const {
  double square = 0.0;
  for (int node : node_) {
    const double* v = velocity_of(*nodes_, node);
    square = std::max(square, v[0] * v[0] + v[1] * v[1]);
  }
  return std::sqrt(square);
}

template <class Nodes>
void BodyContact<Nodes>::move(const Step& step, int, double fastest) {
  step_of_close_ = step.mean_dt;
  if constexpr (dimension == 2) fastest = find_fastest();  // nodes in the plane do not tell
  since_cut_[0] += fastest * step.dt;
  if (since_cut_[0] < longest_way * surfaces_.edge) return;
  const std::vector<double> before = cut_position_;
  take_positions(*nodes_), measure_depths(*nodes_);
  cut(before.data());
  set_stiffness(*nodes_);
  since_cut_[0] = 0.0;
}

template <class Nodes>
void BodyContact<Nodes>::press_slot(const Nodes& nodes, const Step& at, int slot) {
  double *t = &shear[3 * std::size_t(slot)], &p = pressure[slot];
  const double area = rows_.area[slot], *n = &rows_.normal[3 * std::size_t(slot)];
  // 1. mean way from the master to the slave, and its rate
  double way[3] = {}, rate[3] = {};
  for (int e = rows_.start[slot]; e < rows_.start[slot + 1] && area > 0.0; ++e) {
    const double w = rows_.weight[e] / area, *x = position_of(nodes, node_[rows_.node[e]]),
                 *v = velocity_of(nodes, node_[rows_.node[e]]);
    for (int k = 0; k < dimension; ++k) way[k] += w * x[k], rate[k] += w * v[k];
  }
  // 2. pressure
  const double k = stiffness_[slot] / (step * step);
  p = area > 0.0 ? k * std::max(0.0, contact::dot(way, n)) : 0.0;
  if (p == 0.0 || surfaces_.mu == 0.0) {
    std::fill_n(t, 3, 0.0);
    return;
  }
  // 3. friction: what the spring would have, along the surface, then the law's limit
  for (int i = 0; i < 3; ++i) t[i] -= k * at.dt * rate[i];
  const double out = contact::dot(t, n);
  for (int i = 0; i < 3; ++i) t[i] -= out * n[i];
  const double limit = std::min(surfaces_.mu * p, shear_limit.empty() ? surfaces_.mu * p : shear_limit[slot]);
  const double size = std::sqrt(contact::dot(t, t));
  if (size > limit)
    for (int i = 0; i < 3; ++i) t[i] *= limit / size;
}

template <class Nodes>
void BodyContact<Nodes>::load_node(Nodes& nodes, const Step& at, int i, double* sums) {
  double by_push[3] = {}, by_rub[3] = {};
  for (int e = first_[i]; e < first_[i + 1]; ++e) {
    const auto [slot, w] = entries_[e];
    if (pressure[slot] == 0.0) continue;
    const double *n = &rows_.normal[3 * std::size_t(slot)], *t = &shear[3 * std::size_t(slot)];
    for (int k = 0; k < 3; ++k) by_push[k] -= w * pressure[slot] * n[k], by_rub[k] += w * t[k];
  }
  double *f = force_of(nodes, node_[i]), *old_push = &push[3 * std::size_t(i)], *old_rub = &rub[3 * std::size_t(i)];
  const double* v = velocity_of(nodes, node_[i]);
  for (int k = 0; k < dimension; ++k) {
    f[k] -= by_push[k] + by_rub[k];
    sums[0] -= 0.5 * at.dt * v[k] * (old_push[k] + by_push[k]);
    sums[1] -= 0.5 * at.dt * v[k] * (old_rub[k] + by_rub[k]);
    if (is_master_[i]) sums[2 + k] += by_push[k] + by_rub[k];
  }
  std::copy_n(by_push, 3, old_push), std::copy_n(by_rub, 3, old_rub);
}

template <class Nodes>
void BodyContact<Nodes>::act(Nodes& nodes, const Step& at, int, int round, int piece) {
  const int last = std::min(round == 0 ? n_slots() : n_nodes(), (piece + 1) * chunk);
  double* sums = &chunk_sums_[5 * std::size_t(piece)];
  if (round == 1) std::fill_n(sums, 5, 0.0);
  for (int i = piece * chunk; i < last; ++i)
    if (round == 0)
      press_slot(nodes, at, i);
    else
      load_node(nodes, at, i, sums);
}

template <class Nodes>
void BodyContact<Nodes>::close() {
  for (std::size_t c = 0; c < chunk_sums_.size(); c += 5) {
    for (int k = 0; k < 2; ++k) work_[k] += chunk_sums_[c + k];
    for (int k = 0; k < 3; ++k) impulse[k] += step_of_close_ * chunk_sums_[c + 2 + k];
  }
}

template <class Nodes>
void BodyContact<Nodes>::list_state(std::vector<StateField>& fields) {
  const auto add = [&](const char* what, std::vector<double>& values, bool are_vectors = false) {
    fields.push_back(row_field(name, what, values.data(), values.size()));
    if (are_vectors) fields.back().shape = {values.size() / 3, 3};
  };
  fields.push_back(row_field(name, "work", work_, 2));
  add("pressure", pressure), add("shear", shear, true), add("push", push, true), add("rub", rub, true);
  add("impulse", impulse);
  add("slave_depth", slave_depth_), add("master_depth", master_depth_);
  fields.push_back(row_field(name, "since_cut", since_cut_, 2));
  add("cut_position", cut_position_);
  const auto write = fields.back().write;
  fields.back().write = [this, write](const double* from) {
    write(from);
    stale_ = true;
  };
}

template class BodyContact<PlaneNodes>;
template class BodyContact<SpaceNodes<double>>;

}  // namespace presswork::explicit_dynamics
