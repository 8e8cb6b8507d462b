// SPDX-License-Identifier: Apache-2.0
// One slot of an interface in space: what its segments add to it, and the laws of contact with their derivatives.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/face_interface.hpp"
#include "contact/face_mortar.hpp"

namespace presswork::face_interface {

using face_mortar::Matrix;

inline void add_to(Matrix& sum, const Matrix& term, double factor) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) sum[r][c] += factor * term[r][c];
}

// What a pair of faces adds to one slot at one node.
struct Share {
  double push[3] = {}, drag = 0.0;                 // nodal force of a unit pressure, and over a unit shear
  double weight_slope[3] = {}, gap_slope[3] = {};  // by the node's position
  Matrix slip_slope{}, normal_slope{};             // of the slip, and of the area vector

  void add(const Share& other) {
    drag += other.drag;
    for (int k = 0; k < 3; ++k) {
      push[k] += other.push[k];
      weight_slope[k] += other.weight_slope[k], gap_slope[k] += other.gap_slope[k];
    }
    add_to(slip_slope, other.slip_slope, 1.0), add_to(normal_slope, other.normal_slope, 1.0);
  }
};

// What a slot gathers from its segments, and what follows from the contact laws.
struct Slot {
  double weight = 0, gap = 0, slip[3] = {}, normal[3] = {}, size = 0;
  std::vector<int> nodes;
  std::vector<Share> shares;
  double pressure = 0, shear[3] = {}, believed = 0, believed_shear[3] = {};
  double trial[3] = {}, pull[3] = {}, limit = 0;  // of the shear: along the surface, before that, and its largest
  bool is_active = false, follows_push = false;
  SlotStatus status = SlotStatus::apart;

  Share& at(int node) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i] == node) return shares[i];
    nodes.push_back(node);
    return shares.emplace_back();
  }
};

inline double tangential(const FaceInterfaceInput& in, int i) { return in.tangential_part * in.stiffness[i]; }

// Mean gap and slip of the slot, then pressure and shear by the multipliers, the penalties and the law of friction.
inline void apply_laws(const FaceInterfaceInput& in, int i, Slot& slot) {
  if (!(slot.weight > 0.0)) return;
  if (slot.weight < in.least_weight[i]) {
    slot.weight = in.least_weight[i];
    for (auto& share : slot.shares) std::fill_n(share.weight_slope, 3, 0.0);
  }
  slot.size = std::sqrt(contact::dot(slot.normal, slot.normal));
  for (double& n : slot.normal) n /= slot.size;
  slot.gap /= slot.weight;
  for (int k = 0; k < 3; ++k) slot.slip[k] = slot.slip[k] / slot.weight + in.slip[3 * i + k];
  const double trial = in.pressure[i] - in.stiffness[i] * slot.gap;
  const bool holds = in.held[i] == keeps_hold;
  const double touches = in.held[i] == let_go ? 0.0 : -in.stiffness[i] * in.touching;
  slot.is_active = holds || trial >= touches;
  slot.pressure = holds ? trial : std::max(trial, 0.0);
  slot.believed = holds ? in.believed[i] : slot.pressure;
  for (int k = 0; k < 3; ++k) slot.pull[k] = in.shear[3 * i + k] - tangential(in, i) * slot.slip[k];
  const double out = contact::dot(slot.pull, slot.normal);
  for (int k = 0; k < 3; ++k) slot.trial[k] = slot.pull[k] - out * slot.normal[k];
  // slip across the surface is no slip
  const double rise = contact::dot(slot.slip, slot.normal);
  for (int k = 0; k < 3; ++k) slot.slip[k] -= rise * slot.normal[k];
  if (!(slot.believed > 0.0)) return;
  const double by_push = in.mu * slot.believed, spring = std::sqrt(contact::dot(slot.trial, slot.trial));
  slot.limit = std::min(by_push, in.shear_limit[i]);
  slot.status = slot.limit > 0.0 && spring <= slot.limit ? SlotStatus::sticks : SlotStatus::slides;
  slot.follows_push = slot.status == SlotStatus::slides && by_push <= in.shear_limit[i];
  for (int k = 0; k < 3; ++k) {
    if (slot.status == SlotStatus::sticks) {
      slot.shear[k] = slot.believed_shear[k] = slot.trial[k];
    } else if (spring > 0.0) {
      slot.shear[k] = (slot.follows_push ? in.mu * slot.pressure : slot.limit) * slot.trial[k] / spring;
      slot.believed_shear[k] = slot.limit * slot.trial[k] / spring;
    }
  }
}

inline void find_pressure_slope(const FaceInterfaceInput& in, int i, const Slot& slot, const Share& share,
                                double (&by)[3]) {
  for (int k = 0; k < 3; ++k)
    by[k] = in.stiffness[i] / slot.weight * (slot.gap * share.weight_slope[k] - share.gap_slope[k]);
}

// Of the shear of a slot that sticks: by its slip, and by the turn of the surface.
inline Matrix find_trial_slope(const FaceInterfaceInput& in, int i, const Slot& slot, const Share& share) {
  const double k_t = tangential(in, i), out = contact::dot(slot.pull, slot.normal);
  Matrix of_pull, of_normal, slope;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const double way = (in.shear[3 * i + r] - slot.pull[r]) / k_t - in.slip[3 * i + r];
      of_pull[r][c] = -k_t / slot.weight * (share.slip_slope[r][c] - way * share.weight_slope[c]);
    }
  for (int c = 0; c < 3; ++c) {
    double rise = 0.0, pull = 0.0, turn = 0.0;
    for (int r = 0; r < 3; ++r) rise += slot.normal[r] * share.normal_slope[r][c];
    for (int r = 0; r < 3; ++r) of_normal[r][c] = (share.normal_slope[r][c] - slot.normal[r] * rise) / slot.size;
    for (int r = 0; r < 3; ++r) pull += slot.normal[r] * of_pull[r][c], turn += slot.pull[r] * of_normal[r][c];
    for (int r = 0; r < 3; ++r) slope[r][c] = of_pull[r][c] - slot.normal[r] * (pull + turn) - out * of_normal[r][c];
  }
  return slope;
}

// Of a slot that slides: the direction turns, and the size follows the pressure.
inline Matrix find_sliding_slope(const FaceInterfaceInput& in, int i, const Slot& slot, const Share& share,
                                 const double (&by)[3]) {
  const double spring = std::sqrt(contact::dot(slot.trial, slot.trial));
  if (!(spring > 0.0)) return {};
  const Matrix of_trial = find_trial_slope(in, i, slot, share);
  const double size = slot.follows_push ? in.mu * slot.pressure : slot.limit;
  Matrix slope;
  for (int c = 0; c < 3; ++c) {
    double along = 0.0;
    for (int r = 0; r < 3; ++r) along += slot.trial[r] / spring * of_trial[r][c];
    for (int r = 0; r < 3; ++r)
      slope[r][c] = size / spring * (of_trial[r][c] - along * slot.trial[r] / spring) +
                    (slot.follows_push ? in.mu * by[c] * slot.trial[r] / spring : 0.0);
  }
  return slope;
}

}  // namespace presswork::face_interface
