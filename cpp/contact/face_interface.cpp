// SPDX-License-Identifier: Apache-2.0
#include "contact/face_interface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/face_mortar.hpp"
#include "contact/face_slot.hpp"

namespace presswork {

namespace {

using face_interface::add_to;
using face_interface::Share;
using face_interface::Slot;
using face_mortar::AtPoint;
using face_mortar::Corners;
using face_mortar::Facing;
using face_mortar::Matrix;
using face_mortar::Overlap;
using face_mortar::Plane;
using face_mortar::RulePoint;

constexpr int few = 100;  // pairs or slots for which a second thread is not woken

// One pair that is in contact range: its points, and what it adds to its slots.
template <int nodes>
struct Segment {
  int slave = -1, master = -1;
  std::vector<RulePoint> points;
  double weight[nodes] = {}, gap[nodes] = {}, slip[nodes][3] = {}, normal[nodes][3] = {};
  std::vector<Share> shares;  // (nodes, 2 nodes)
};

template <int nodes>
class FaceInterface {
 public:
  explicit FaceInterface(const FaceInterfaceInput& in) : in_(in), segments_(in.pairs.size()), slots_(in.n_slots) {}

  FaceInterfaceOutput evaluate() {
    out_.force.assign(3 * in_.n_points, 0.0), out_.drag.assign(3 * in_.n_points, 0.0);
    for (auto* field : {&out_.push, &out_.area}) field->assign(in_.n_points, 0.0);
    const int n_pairs = static_cast<int>(in_.pairs.size());
    int too_deep = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : too_deep) if (n_pairs > few)
    for (int i = 0; i < n_pairs; ++i) too_deep += integrate(in_.pairs[i], segments_[i]);
    out_.too_deep = too_deep;
    std::erase_if(segments_, [](const Segment<nodes>& s) { return s.points.empty(); });
    gather();
    add_forces();
    if (in_.with_tangent) add_blocks();
    store();
    return std::move(out_);
  }

 private:
  bool rubs() const { return in_.mu > 0.0; }

  // Returns whether the faces have gone through each other in this increment.
  bool integrate(const FacePair& pair, Segment<nodes>& s) const {
    Corners<nodes> slave, master;
    slave.load(in_.x, in_.slave.at(pair.slave)), master.load(in_.x, in_.master.at(pair.master));
    const double depth = std::min(in_.slave_depth[pair.slave], in_.master_depth[pair.master]);
    Facing<nodes> facing(slave, master);
    const Overlap overlap = facing.find({in_.reach, depth});
    if (overlap == Overlap::too_deep) {
      Corners<nodes> slave_n, master_n;
      slave_n.load(in_.x_n, in_.slave.at(pair.slave)), master_n.load(in_.x_n, in_.master.at(pair.master));
      Facing<nodes> before(slave_n, master_n);
      return before.find({std::numeric_limits<double>::infinity(), 0.5 * depth}) == Overlap::found;
    }
    if (overlap != Overlap::found) return false;
    s.slave = pair.slave, s.master = pair.master;
    facing.list_points(s.points);
    s.shares.resize(in_.with_tangent ? 2 * nodes * nodes : 0);
    for (const auto& point : s.points) add_point(point, AtPoint<nodes>(slave, master, facing.plane, point), s);
    return false;
  }

  int node_of(const Segment<nodes>& s, int b) const {
    return b < nodes ? in_.slave.at(s.slave)[b] : in_.master.at(s.master)[b - nodes];
  }

  // Way of the slave along the master at a point in this increment, and its derivative by the master's coordinates.
  void find_way(const Segment<nodes>& s, const AtPoint<nodes>& q, double (&way)[3], double (&bend)[3][2]) const {
    for (int k = 0; k < 3; ++k) {
      way[k] = bend[k][0] = bend[k][1] = 0.0;
      for (int b = 0; b < 2 * nodes; ++b) {
        const int at = 3 * node_of(s, b) + k;
        const double moved = in_.x[at] - in_.x_n[at];
        way[k] += q.shape[b] * moved;
        for (int r = 0; r < 2; ++r) bend[k][r] += q.shape_slope[b][r] * moved;
      }
    }
  }

  void add_point(const RulePoint& point, const AtPoint<nodes>& q, Segment<nodes>& s) const {
    double way[3], bend[3][2];
    find_way(s, q, way, bend);
    Matrix way_slope[2 * nodes];
    for (int b = 0; b < 2 * nodes && in_.with_tangent; ++b)
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k)
          way_slope[b][r][k] =
              (r == k ? q.shape[b] : 0.0) + bend[r][0] * q.way_slope[0][b][k] + bend[r][1] * q.way_slope[1][b][k];
    for (int A = 0; A < nodes; ++A) {
      const double phi = point.weight * q.N[A], area = phi * q.area;
      s.weight[A] += area, s.gap[A] += area * q.gap;
      for (int k = 0; k < 3; ++k) s.slip[A][k] += area * way[k], s.normal[A][k] += phi * q.area_vector[k];
      if (!in_.with_tangent) continue;
      for (int b = 0; b < 2 * nodes; ++b) {
        Share& share = s.shares[2 * nodes * A + b];
        share.drag += area * q.shape[b];
        for (int k = 0; k < 3; ++k) {
          share.push[k] -= phi * q.shape[b] * q.area_vector[k];
          share.gap_slope[k] += area * q.gap_slope[b][k];
        }
        if (rubs()) add_to(share.slip_slope, way_slope[b], area);
        if (b >= nodes) continue;
        for (int k = 0; k < 3; ++k) {
          double growth = 0.0;
          for (int j = 0; j < 3; ++j) growth += q.unit[j] * q.area_slope[b][j][k];
          share.weight_slope[k] += phi * growth;
          share.gap_slope[k] += phi * growth * q.gap;
          for (int r = 0; r < 3; ++r) share.slip_slope[r][k] += phi * growth * way[r];
        }
        add_to(share.normal_slope, q.area_slope[b], phi);
      }
    }
  }

  // Sum the segments of every slot in their order, and apply the laws.
  void gather() {
    std::vector<std::vector<std::pair<int, int>>> of_slot(in_.n_slots);
    for (int i = 0; i < static_cast<int>(segments_.size()); ++i)
      for (int A = 0; A < nodes; ++A) of_slot[slot_of(segments_[i], A)].push_back({i, A});
#pragma omp parallel for schedule(dynamic, 16) if (in_.n_slots > few)
    for (int i = 0; i < in_.n_slots; ++i) {
      Slot& slot = slots_[i];
      for (const auto& [segment, A] : of_slot[i]) {
        const auto& s = segments_[segment];
        slot.weight += s.weight[A], slot.gap += s.gap[A];
        for (int k = 0; k < 3; ++k) slot.slip[k] += s.slip[A][k], slot.normal[k] += s.normal[A][k];
        if (!in_.with_tangent) continue;
        for (int b = 0; b < 2 * nodes; ++b) slot.at(node_of(s, b)).add(s.shares[2 * nodes * A + b]);
      }
      apply_laws(in_, i, slot);
    }
  }

  int slot_of(const Segment<nodes>& s, int A) const { return in_.slots[s.slave * nodes + A]; }

  void load(const Segment<nodes>& s, Corners<nodes>& slave, Corners<nodes>& master) const {
    slave.load(in_.x, in_.slave.at(s.slave)), master.load(in_.x, in_.master.at(s.master));
  }

  void add_forces() {
    for (const auto& s : segments_) {
      bool acts = false;
      for (int A = 0; A < nodes; ++A) acts = acts || slots_[slot_of(s, A)].pressure != 0.0;
      if (!acts) continue;
      Corners<nodes> slave, master;
      load(s, slave, master);
      const Plane<nodes> plane(slave);
      for (const auto& point : s.points) {
        const AtPoint<nodes> q(slave, master, plane, point);
        double push = 0.0, shear[3] = {};
        for (int A = 0; A < nodes; ++A) {
          const Slot& slot = slots_[slot_of(s, A)];
          if (slot.pressure == 0.0) continue;
          push += q.N[A] * slot.pressure;
          for (int k = 0; k < 3; ++k) shear[k] += q.N[A] * slot.shear[k];
        }
        for (int k = 0; k < 3; ++k) {
          const double drag = point.weight * q.area * shear[k];
          const double on_slave = drag - point.weight * push * q.area_vector[k];
          out_.master_force[k] -= on_slave;
          for (int b = 0; b < 2 * nodes; ++b) {
            out_.force[3 * node_of(s, b) + k] += q.shape[b] * on_slave;
            if (b >= nodes) out_.drag[3 * node_of(s, b) + k] -= q.shape[b] * drag;
          }
        }
        for (int b = nodes; b < 2 * nodes; ++b) {
          out_.push[node_of(s, b)] -= q.shape[b] * point.weight * q.area * push;
          out_.area[node_of(s, b)] -= q.shape[b] * point.weight * q.area;
        }
      }
    }
  }

  void add_blocks() {
    std::vector<std::int64_t> start(1, 0), slope_start(1, 0);
    for (const auto& s : segments_) start.push_back(start.back() + (is_believed(s) ? 4 * nodes * nodes : 0));
    for (const Slot& slot : slots_) {
      const auto n = static_cast<std::int64_t>(slot.weight > 0.0 ? slot.nodes.size() : 0);
      slope_start.push_back(slope_start.back() + n);
      start.push_back(start.back() + (slot.is_active ? n * n : 0));
    }
    out_.block_pairs.resize(2 * start.back()), out_.blocks.resize(9 * start.back());
    out_.slope_places.resize(2 * slope_start.back()), out_.pressure_slopes.resize(3 * slope_start.back());
    const int n = static_cast<int>(segments_.size());
#pragma omp parallel for schedule(dynamic, 16) if (n > few)
    for (int i = 0; i < n; ++i)
      if (is_believed(segments_[i])) add_geometric_blocks(segments_[i], start[i]);
#pragma omp parallel for schedule(dynamic, 16) if (in_.n_slots > few)
    for (int i = 0; i < in_.n_slots; ++i) add_slot_blocks(i, start[n + i], slope_start[i]);
  }

  bool is_believed(const Segment<nodes>& s) const {
    for (int A = 0; A < nodes; ++A)
      if (slots_[slot_of(s, A)].believed != 0.0) return true;
    return false;
  }

  // Pressure and shear held, the geometry changes.
  void add_geometric_blocks(const Segment<nodes>& s, std::int64_t start) {
    Corners<nodes> slave, master;
    load(s, slave, master);
    const Plane<nodes> plane(slave);
    double* blocks = out_.blocks.data() + 9 * start;
    for (int a = 0; a < 2 * nodes; ++a)
      for (int b = 0; b < 2 * nodes; ++b) {
        int* pair = out_.block_pairs.data() + 2 * (start + a * 2 * nodes + b);
        pair[0] = node_of(s, a), pair[1] = node_of(s, b);
      }
    for (const auto& point : s.points) {
      const AtPoint<nodes> q(slave, master, plane, point);
      double push = 0.0, shear[3] = {}, force[3];
      for (int A = 0; A < nodes; ++A) {
        const Slot& slot = slots_[slot_of(s, A)];
        push += q.N[A] * slot.believed;
        for (int k = 0; k < 3; ++k) shear[k] += q.N[A] * slot.believed_shear[k];
      }
      for (int k = 0; k < 3; ++k) force[k] = point.weight * (q.area * shear[k] - push * q.area_vector[k]);
      for (int b = 0; b < 2 * nodes; ++b) {
        Matrix slope{};  // of the force on the slave
        for (int r = 0; r < 3 && b < nodes; ++r)
          for (int c = 0; c < 3; ++c) {
            double growth = 0.0;
            for (int j = 0; j < 3; ++j) growth += q.unit[j] * q.area_slope[b][j][c];
            slope[r][c] = point.weight * (shear[r] * growth - push * q.area_slope[b][r][c]);
          }
        for (int a = 0; a < 2 * nodes; ++a) {
          double* block = blocks + 9 * (a * 2 * nodes + b);
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) {
              block[3 * r + c] -= q.shape[a] * slope[r][c];
              for (int k = 0; k < 2; ++k) block[3 * r + c] -= force[r] * q.shape_slope[a][k] * q.way_slope[k][b][c];
            }
        }
      }
    }
  }

  // The geometry held, pressure and shear of the slot change with its gap and slip.
  void add_slot_blocks(int i, std::int64_t start, std::int64_t slope_start) {
    const Slot& slot = slots_[i];
    if (!(slot.weight > 0.0)) return;
    const std::size_t n = slot.nodes.size();
    const bool will_stick = in_.held[i] == by_gap && slot.believed <= 0.0 && in_.mu > 1.0;
    for (std::size_t c = 0; c < n; ++c) {
      double by[3];
      find_pressure_slope(in_, i, slot, slot.shares[c], by);
      out_.slope_places[2 * (slope_start + c)] = i, out_.slope_places[2 * (slope_start + c) + 1] = slot.nodes[c];
      std::copy_n(by, 3, out_.pressure_slopes.data() + 3 * (slope_start + c));
      if (!slot.is_active) continue;
      Matrix of_shear{};
      if (slot.status == SlotStatus::sticks || will_stick)
        of_shear = find_trial_slope(in_, i, slot, slot.shares[c]);
      else if (slot.status == SlotStatus::slides)
        of_shear = find_sliding_slope(in_, i, slot, slot.shares[c], by);
      for (std::size_t r = 0; r < n; ++r) {
        const Share& share = slot.shares[r];
        const std::int64_t place = start + static_cast<std::int64_t>(r * n + c);
        out_.block_pairs[2 * place] = slot.nodes[r], out_.block_pairs[2 * place + 1] = slot.nodes[c];
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k)
            out_.blocks[9 * place + 3 * j + k] = -share.push[j] * by[k] - share.drag * of_shear[j][k];
      }
    }
  }

  void store() {
    for (const Slot& slot : slots_) {
      out_.pressure.push_back(slot.pressure);
      out_.gap.push_back(slot.weight > 0.0 ? slot.gap : std::numeric_limits<double>::infinity());
      out_.status.push_back(static_cast<std::uint8_t>(slot.status));
      out_.weight.push_back(slot.weight);
      for (int k = 0; k < 3; ++k) {
        out_.shear.push_back(slot.shear[k]);
        out_.slip.push_back(slot.slip[k]);
        out_.normal.push_back(slot.normal[k]);
      }
    }
  }

  const FaceInterfaceInput& in_;
  FaceInterfaceOutput out_;
  std::vector<Segment<nodes>> segments_;
  std::vector<Slot> slots_;
};

}  // namespace

FaceInterfaceOutput evaluate_face_interface(const FaceInterfaceInput& in) {
  return in.slave.nodes == 3 ? FaceInterface<3>(in).evaluate() : FaceInterface<4>(in).evaluate();
}

}  // namespace presswork
