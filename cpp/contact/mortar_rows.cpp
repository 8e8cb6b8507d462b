// SPDX-License-Identifier: Apache-2.0
#include "contact/mortar_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "contact/face_mortar.hpp"
#include "contact/interface.hpp"
#include "contact/mortar.hpp"

namespace presswork {

namespace {

constexpr int few = 100;  // pairs for which a second thread is not woken

// What a pair of faces adds to the slots of its slave.
template <int nodes>
struct PairRows {
  int slave = -1, master = -1;
  double weight[nodes][2 * nodes] = {}, area[nodes] = {}, normal[nodes][3] = {};
  bool passed = false;
};

template <int nodes>
using Pairs = std::vector<PairRows<nodes>>;

double least_depth(const MortarSurfaces& in, int slave, int master) {
  return std::min(in.slave_depth[slave], in.master_depth[master]);
}

template <int nodes>
void integrate_faces(const MortarSurfaces& in, const double* x, const double* before, PairRows<nodes>& out) {
  using namespace face_mortar;
  Corners<nodes> slave, master;
  slave.load(x, in.slave.at(out.slave)), master.load(x, in.master.at(out.master));
  const double depth = least_depth(in, out.slave, out.master);
  Facing<nodes> facing(slave, master);
  const Overlap overlap = facing.find({in.reach, depth});
  if (overlap == Overlap::too_deep && before) {
    Corners<nodes> slave_n, master_n;
    slave_n.load(before, in.slave.at(out.slave)), master_n.load(before, in.master.at(out.master));
    Facing<nodes> earlier(slave_n, master_n);
    out.passed = earlier.find({std::numeric_limits<double>::infinity(), 0.5 * depth}) == Overlap::found;
  }
  if (overlap != Overlap::found) return;
  thread_local std::vector<RulePoint> rule;
  rule.clear();
  facing.list_points(rule);
  for (const RulePoint& at : rule) {
    double N[nodes], M[nodes], dN[nodes][2], p[3], t[2][3], c[3];
    master.place(at.master, M, dN, p, t);
    slave.place(at.slave, N, dN, p, t);
    contact::cross(t[0], t[1], c);
    const double size = at.weight * std::sqrt(contact::dot(c, c));
    for (int A = 0; A < nodes; ++A) {
      const double phi = size * N[A];
      out.area[A] += phi;
      for (int b = 0; b < nodes; ++b) out.weight[A][b] += phi * N[b], out.weight[A][nodes + b] -= phi * M[b];
      for (int k = 0; k < 3; ++k) out.normal[A][k] += at.weight * N[A] * c[k];
    }
  }
}

void integrate_edges(const MortarSurfaces& in, const double* x, const double* before, PairRows<2>& out) {
  const int *s = in.slave.at(out.slave), *m = in.master.at(out.master);
  const auto load = [&](const double* points) {
    std::array<double, 8> corner;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k)
        corner[2 * i + k] = points[3 * s[i] + k], corner[4 + 2 * i + k] = points[3 * m[i] + k];
    return corner;
  };
  const auto now = load(x);
  const double depth = least_depth(in, out.slave, out.master);
  mortar::Integrals<double, 2> found;
  const auto overlap =
      mortar::integrate<double, 2>(now.data(), now.data(), 0, 0, {in.reach, depth}, in.thickness, found);
  if (overlap == mortar::Overlap::too_deep && before) {
    const auto then = load(before);
    mortar::Facing<double> earlier;
    out.passed = mortar::face<double>(then.data(), {std::numeric_limits<double>::infinity(), 0.5 * depth}, earlier) ==
                 mortar::Overlap::found;
  }
  if (overlap != mortar::Overlap::found) return;
  for (int A = 0; A < 2; ++A) {
    out.area[A] = found.weight[A];
    for (int b = 0; b < 2; ++b) out.weight[A][b] = found.slave[b][A], out.weight[A][2 + b] = -found.master[b][A];
    for (int k = 0; k < 2; ++k) out.normal[A][k] = found.weight[A] * found.normal[k];
  }
}

// Pairs that may touch, without what they add.
template <int nodes>
Pairs<nodes> list_pairs(const MortarSurfaces& in, const double* x) {
  Pairs<nodes> pairs;
  const auto add = [&](int slave, int master) {
    pairs.emplace_back();
    pairs.back().slave = slave, pairs.back().master = master;
  };
  if constexpr (nodes == 2) {
    std::vector<double> flat(2 * std::size_t(in.n_points));
    for (int i = 0; i < in.n_points; ++i) flat[2 * i] = x[3 * i], flat[2 * i + 1] = x[3 * i + 1];
    const EdgeList own{in.slave.n, 2, in.slave.faces}, other{in.master.n, 2, in.master.faces};
    for (const auto& [s, m] : find_edge_pairs(own, other, flat.data(), in.margin, in.self)) add(s, m);
  } else {
    for (const auto& [s, m] : find_face_pairs(in.slave, in.master, x, in.margin, in.self)) add(s, m);
  }
  return pairs;
}

// The entries of one slot, summed up in the order of the pairs.
struct Row {
  std::vector<int> node;
  std::vector<double> weight, size;
  void add(int at, double value) {
    const auto found = std::find(node.begin(), node.end(), at);
    const auto place = found - node.begin();
    if (found == node.end()) node.push_back(at), weight.push_back(0.0), size.push_back(0.0);
    weight[place] += value, size[place] += std::abs(value);
  }
};

template <int nodes>
MortarRows cut(const MortarSurfaces& in, const double* x, const double* before) {
  // 1. pairs, each by itself
  Pairs<nodes> pairs = list_pairs<nodes>(in, x);
  const int n_pairs = static_cast<int>(pairs.size());
#pragma omp parallel for schedule(dynamic, 16) if (n_pairs > few)
  for (int i = 0; i < n_pairs; ++i) {
    if constexpr (nodes == 2)
      integrate_edges(in, x, before, pairs[i]);
    else
      integrate_faces<nodes>(in, x, before, pairs[i]);
  }
  // 2. rows
  MortarRows out;
  std::vector<Row> rows(in.n_slots);
  out.area.assign(in.n_slots, 0.0), out.normal.assign(3 * std::size_t(in.n_slots), 0.0);
  for (const auto& pair : pairs) {
    out.passed = out.passed || pair.passed;
    for (int A = 0; A < nodes; ++A) {
      if (!(pair.area[A] > 0.0)) continue;
      const int slot = in.slots[pair.slave * nodes + A];
      out.area[slot] += pair.area[A];
      for (int k = 0; k < 3; ++k) out.normal[3 * slot + k] += pair.normal[A][k];
      for (int b = 0; b < 2 * nodes; ++b)
        rows[slot].add(b < nodes ? in.slave.at(pair.slave)[b] : in.master.at(pair.master)[b - nodes],
                       pair.weight[A][b]);
    }
  }
  // 3. entries one after the other
  out.start.push_back(0), out.node_area.assign(in.n_points, 0.0);
  for (int slot = 0; slot < in.n_slots; ++slot) {
    const Row& row = rows[slot];
    out.node.insert(out.node.end(), row.node.begin(), row.node.end());
    out.weight.insert(out.weight.end(), row.weight.begin(), row.weight.end());
    for (std::size_t i = 0; i < row.node.size(); ++i) out.node_area[row.node[i]] += row.size[i];
    out.start.push_back(static_cast<int>(out.node.size()));
    double* n = &out.normal[3 * std::size_t(slot)];
    const double size = std::sqrt(contact::dot(n, n));
    if (size > 0.0)
      for (int k = 0; k < 3; ++k) n[k] /= size;
  }
  return out;
}

}  // namespace

MortarRows cut_mortar_rows(const MortarSurfaces& surfaces, const double* x, const double* before) {
  switch (surfaces.slave.nodes) {
    case 2:
      return cut<2>(surfaces, x, before);
    case 3:
      return cut<3>(surfaces, x, before);
    default:
      return cut<4>(surfaces, x, before);
  }
}

}  // namespace presswork
