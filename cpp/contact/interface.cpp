// SPDX-License-Identifier: Apache-2.0
#include "contact/interface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/mortar.hpp"

namespace presswork {

namespace {

struct Box {
  double low[2], high[2];
};

Box box_of(const EdgeList& list, int half_edge, const double* x) {
  int a, b;
  list.ends(half_edge, a, b);
  Box box;
  for (int k = 0; k < 2; ++k) {
    box.low[k] = std::min(x[2 * a + k], x[2 * b + k]);
    box.high[k] = std::max(x[2 * a + k], x[2 * b + k]);
  }
  return box;
}

// Whether two half-edges run against each other, or could after a turn of 30 degrees or so.
bool may_face(const EdgeList& slave, int s, const EdgeList& master, int m, const double* x) {
  int a, b, c, d;
  slave.ends(s, a, b);
  master.ends(m, c, d);
  const double sx = x[2 * b] - x[2 * a], sy = x[2 * b + 1] - x[2 * a + 1];
  const double mx = x[2 * d] - x[2 * c], my = x[2 * d + 1] - x[2 * c + 1];
  return sx * mx + sy * my < 0.3 * std::hypot(sx, sy) * std::hypot(mx, my);
}

bool are_neighbours(const EdgeList& list, int s, int m) {
  int a, b, c, d;
  list.ends(s, a, b);
  list.ends(m, c, d);
  return a == c || a == d || b == c || b == d;
}

// A vector at each of a few nodes; sums where a node comes again.
struct NodeVectors {
  std::vector<int> nodes;
  std::vector<double> values;  // 2 a node

  double* at(int node) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i] == node) return &values[2 * i];
    nodes.push_back(node);
    values.insert(values.end(), {0.0, 0.0});
    return &values[2 * (nodes.size() - 1)];
  }
  void add(int node, double x, double y) {
    double* v = at(node);
    v[0] += x, v[1] += y;
  }
  void add(const NodeVectors& other, double factor) {
    for (std::size_t i = 0; i < other.nodes.size(); ++i)
      add(other.nodes[i], factor * other.values[2 * i], factor * other.values[2 * i + 1]);
  }
};

using Variable = Dual<double, 8>;

// One pair that is in contact range, its integrals and their derivatives by the four ends.
template <int nodes>
struct Segment {
  int ends[4];
  int slave[nodes], master[nodes];
  int slots[2];
  mortar::Integrals<Variable, nodes> integrals;
};

// What a slot gathers from its segments, and what follows from the contact laws.
struct Slot {
  double weight = 0, gap = 0, slip = 0;
  NodeVectors weight_slope, gap_slope, slip_slope;  // by the nodes' positions
  NodeVectors push, drag;                           // nodal forces of a unit pressure and of a unit shear
  double pressure = 0, shear = 0;
  double believed = 0, believed_shear = 0;  // those of the geometric part of the tangent
  double way = 0;                           // sign of the shear
  bool is_active = false, follows_push = false;
  SlotStatus status = SlotStatus::apart;
};

template <int nodes>
class Interface {
 public:
  explicit Interface(const InterfaceInput& in) : in_(in), slots_(in.n_slots) {}

  InterfaceOutput evaluate() {
    out_.force.assign(2 * in_.n_points, 0.0);
    for (auto* field : {&out_.push, &out_.drag, &out_.area}) field->assign(in_.n_points, 0.0);
    for (const auto& pair : in_.pairs) integrate(pair);
    for (const auto& segment : segments_) gather(segment);
    for (int i = 0; i < in_.n_slots; ++i) apply_laws(i);
    for (const auto& segment : segments_) add_forces(segment);
    if (in_.with_tangent) {
      for (const auto& segment : segments_) add_geometric_blocks(segment);
      for (int i = 0; i < in_.n_slots; ++i) add_slot_blocks(i);
    }
    store();
    return std::move(out_);
  }

 private:
  void integrate(const HalfEdgePair& pair) {
    Segment<nodes> s;
    in_.slave.ends(pair.slave, s.ends[0], s.ends[1]);
    in_.master.ends(pair.master, s.ends[2], s.ends[3]);
    double x[8], x_n[8];
    for (int i = 0; i < 8; ++i) x[i] = in_.x[2 * s.ends[i / 2] + i % 2], x_n[i] = in_.x_n[2 * s.ends[i / 2] + i % 2];
    const int slave_edge = pair.slave / in_.slave.halves(), master_edge = pair.master / in_.master.halves();
    const mortar::Limits limits{in_.reach, std::min(in_.slave_depth[slave_edge], in_.master_depth[master_edge])};
    // 1. without derivatives: most candidates are apart
    mortar::Facing<double> facing;
    const auto overlap = mortar::face(x, limits, facing);
    if (overlap == mortar::Overlap::too_deep) {
      mortar::Facing<double> before;
      const mortar::Limits halfway{std::numeric_limits<double>::infinity(), 0.5 * limits.depth};
      if (mortar::face(x_n, halfway, before) == mortar::Overlap::found) ++out_.too_deep;
    }
    if (overlap != mortar::Overlap::found) return;
    // 2. with them
    Variable v[8];
    for (int i = 0; i < 8; ++i) v[i] = Variable::variable(x[i], i);
    mortar::integrate<Variable, nodes>(v, x_n, pair.slave % in_.slave.halves(), pair.master % in_.master.halves(),
                                       limits, in_.thickness, s.integrals);
    std::copy_n(in_.slave.edges + slave_edge * nodes, nodes, s.slave);
    std::copy_n(in_.master.edges + master_edge * nodes, nodes, s.master);
    std::copy_n(in_.slots + 2 * slave_edge, 2, s.slots);
    segments_.push_back(s);
  }

  void gather(const Segment<nodes>& s) {
    const auto& q = s.integrals;
    for (int A = 0; A < 2; ++A) {
      Slot& slot = slots_[s.slots[A]];
      slot.weight += q.weight[A].value, slot.gap += q.gap[A].value, slot.slip += q.slip[A].value;
      if (!in_.with_tangent) continue;
      for (int i = 0; i < 4; ++i) {
        slot.weight_slope.add(s.ends[i], q.weight[A].slope[2 * i], q.weight[A].slope[2 * i + 1]);
        slot.gap_slope.add(s.ends[i], q.gap[A].slope[2 * i], q.gap[A].slope[2 * i + 1]);
        slot.slip_slope.add(s.ends[i], q.slip[A].slope[2 * i], q.slip[A].slope[2 * i + 1]);
      }
      const double n[2] = {q.normal[0].value, q.normal[1].value}, t[2] = {q.tangent[0].value, q.tangent[1].value};
      for (int i = 0; i < nodes; ++i) {
        const double m_s = q.slave[i][A].value, m_m = q.master[i][A].value;
        slot.push.add(s.slave[i], -m_s * n[0], -m_s * n[1]);
        slot.push.add(s.master[i], m_m * n[0], m_m * n[1]);
        slot.drag.add(s.slave[i], m_s * t[0], m_s * t[1]);
        slot.drag.add(s.master[i], -m_m * t[0], -m_m * t[1]);
      }
    }
  }

  // Mean gap and slip of the slot, then pressure and shear by the multipliers, the penalties and the law of friction.
  void apply_laws(int i) {
    Slot& slot = slots_[i];
    if (!(slot.weight > 0.0)) return;
    if (slot.weight < in_.least_weight[i]) slot.weight = in_.least_weight[i], slot.weight_slope = {};
    slot.gap /= slot.weight;
    slot.slip = slot.slip / slot.weight + in_.slip[i];
    const double trial = in_.pressure[i] - in_.stiffness[i] * slot.gap;
    const bool holds = in_.held[i] == keeps_hold;
    const double touches = in_.held[i] == let_go ? 0.0 : -in_.stiffness[i] * in_.touching;
    slot.is_active = holds || trial >= touches;
    slot.pressure = holds ? trial : std::max(trial, 0.0);
    slot.believed = holds ? in_.believed[i] : slot.pressure;
    if (!(slot.believed > 0.0)) return;
    const double by_push = in_.mu * slot.believed, limit = std::min(by_push, in_.shear_limit[i]);
    const double spring = in_.shear[i] - tangential(i) * slot.slip;
    slot.status = limit > 0.0 && std::abs(spring) <= limit ? SlotStatus::sticks : SlotStatus::slides;
    slot.follows_push = slot.status == SlotStatus::slides && by_push <= in_.shear_limit[i];
    slot.way = std::copysign(1.0, spring);
    if (slot.status == SlotStatus::sticks)
      slot.shear = slot.believed_shear = spring;
    else
      slot.shear = slot.way * (slot.follows_push ? in_.mu * slot.pressure : limit),
      slot.believed_shear = slot.way * limit;
  }

  double tangential(int i) const { return in_.tangential_part * in_.stiffness[i]; }

  void add_forces(const Segment<nodes>& s) {
    const auto& q = s.integrals;
    for (int A = 0; A < 2; ++A) {
      const Slot& slot = slots_[s.slots[A]];
      if (slot.pressure == 0.0) continue;
      double traction[2];  // on the slave
      for (int k = 0; k < 2; ++k) traction[k] = -slot.pressure * q.normal[k].value + slot.shear * q.tangent[k].value;
      for (int i = 0; i < nodes; ++i) {
        const double m_m = q.master[i][A].value;
        for (int k = 0; k < 2; ++k) {
          out_.force[2 * s.slave[i] + k] += q.slave[i][A].value * traction[k];
          out_.force[2 * s.master[i] + k] -= m_m * traction[k];
          out_.master_force[k] -= m_m * traction[k];
        }
        out_.push[s.master[i]] += m_m * slot.pressure;
        out_.drag[s.master[i]] += m_m * slot.shear;
        out_.area[s.master[i]] += m_m;
      }
    }
  }

  void add_block(int row, int column, const double k[4]) {
    out_.block_pairs.insert(out_.block_pairs.end(), {row, column});
    out_.blocks.insert(out_.blocks.end(), k, k + 4);
  }

  // Pressure and shear held, the geometry changes.
  void add_geometric_blocks(const Segment<nodes>& s) {
    const auto& q = s.integrals;
    if (slots_[s.slots[0]].believed == 0.0 && slots_[s.slots[1]].believed == 0.0) return;
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < nodes; ++i) {
        Variable force[2] = {0.0, 0.0};
        for (int A = 0; A < 2; ++A) {
          const Slot& slot = slots_[s.slots[A]];
          const Variable& m = side == 0 ? q.slave[i][A] : q.master[i][A];
          for (int k = 0; k < 2; ++k)
            force[k] += m * (Variable(slot.believed_shear) * q.tangent[k] - Variable(slot.believed) * q.normal[k]);
        }
        const double sign = side == 0 ? -1.0 : 1.0;  // of -force
        for (int j = 0; j < 4; ++j) {
          const double k[4] = {sign * force[0].slope[2 * j], sign * force[0].slope[2 * j + 1],
                               sign * force[1].slope[2 * j], sign * force[1].slope[2 * j + 1]};
          add_block(side == 0 ? s.slave[i] : s.master[i], s.ends[j], k);
        }
      }
  }

  // The geometry held, pressure and shear of the slot change with its gap and slip.
  void add_slot_blocks(int i) {
    const Slot& slot = slots_[i];
    if (!(slot.weight > 0.0)) return;
    NodeVectors pressure_slope, shear_slope;
    pressure_slope.add(slot.gap_slope, -in_.stiffness[i] / slot.weight);
    pressure_slope.add(slot.weight_slope, in_.stiffness[i] * slot.gap / slot.weight);
    store_slopes(i, pressure_slope);
    if (!slot.is_active) return;
    const bool will_stick = in_.held[i] == by_gap && slot.believed <= 0.0 && in_.mu > 1.0;
    if (slot.status == SlotStatus::sticks || will_stick) {
      shear_slope.add(slot.slip_slope, -tangential(i) / slot.weight);
      shear_slope.add(slot.weight_slope, tangential(i) * (slot.slip - in_.slip[i]) / slot.weight);
    } else if (slot.follows_push) {
      shear_slope.add(pressure_slope, slot.way * in_.mu);
    }
    add_product(slot.push, pressure_slope);
    if (!shear_slope.nodes.empty()) add_product(slot.drag, shear_slope);
  }

  void store_slopes(int i, const NodeVectors& slope) {
    for (std::size_t k = 0; k < slope.nodes.size(); ++k)
      out_.slope_places.insert(out_.slope_places.end(), {i, slope.nodes[k]});
    out_.pressure_slopes.insert(out_.pressure_slopes.end(), slope.values.begin(), slope.values.end());
  }

  void add_product(const NodeVectors& force, const NodeVectors& slope) {
    for (std::size_t r = 0; r < force.nodes.size(); ++r)
      for (std::size_t c = 0; c < slope.nodes.size(); ++c) {
        const double *f = &force.values[2 * r], *g = &slope.values[2 * c];
        const double k[4] = {-f[0] * g[0], -f[0] * g[1], -f[1] * g[0], -f[1] * g[1]};
        add_block(force.nodes[r], slope.nodes[c], k);
      }
  }

  void store() {
    for (const Slot& slot : slots_) {
      out_.pressure.push_back(slot.pressure);
      out_.shear.push_back(slot.shear);
      out_.gap.push_back(slot.weight > 0.0 ? slot.gap : std::numeric_limits<double>::infinity());
      out_.slip.push_back(slot.slip);
      out_.status.push_back(static_cast<std::uint8_t>(slot.status));
      out_.weight.push_back(slot.weight);
    }
  }

  const InterfaceInput& in_;
  InterfaceOutput out_;
  std::vector<Segment<nodes>> segments_;
  std::vector<Slot> slots_;
};

}  // namespace

std::vector<HalfEdgePair> find_edge_pairs(const EdgeList& slave, const EdgeList& master, const double* x, double margin,
                                          bool self) {
  const int n_slave = slave.n * slave.halves(), n_master = master.n * master.halves();
  std::vector<Box> boxes(n_master);
  std::vector<int> order(n_master);
  double widest = 0.0;
  for (int m = 0; m < n_master; ++m) {
    boxes[m] = box_of(master, m, x);
    order[m] = m;
    widest = std::max(widest, boxes[m].high[0] - boxes[m].low[0]);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return boxes[a].low[0] < boxes[b].low[0] || (boxes[a].low[0] == boxes[b].low[0] && a < b);
  });
  std::vector<HalfEdgePair> pairs;
  for (int s = 0; s < n_slave; ++s) {
    const Box box = box_of(slave, s, x);
    const double from = box.low[0] - margin - widest;
    auto it = std::lower_bound(order.begin(), order.end(), from, [&](int m, double v) { return boxes[m].low[0] < v; });
    const auto first = pairs.size();
    for (; it != order.end() && boxes[*it].low[0] <= box.high[0] + margin; ++it) {
      const int m = *it;
      if (self && (m <= s || are_neighbours(slave, s, m))) continue;
      bool meet = true;
      for (int k = 0; k < 2; ++k)
        meet = meet && boxes[m].low[k] <= box.high[k] + margin && box.low[k] <= boxes[m].high[k] + margin;
      if (meet && may_face(slave, s, master, m, x)) pairs.push_back({s, m});
    }
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end(),
              [](const HalfEdgePair& a, const HalfEdgePair& b) { return a.master < b.master; });
  }
  return pairs;
}

InterfaceOutput evaluate_interface(const InterfaceInput& in) {
  return in.slave.nodes == 2 ? Interface<2>(in).evaluate() : Interface<3>(in).evaluate();
}

}  // namespace presswork
