// SPDX-License-Identifier: Apache-2.0
// A rigid tool in the explicit loop of solids in space: no node of their surface ends a cycle inside it.
//
// The constraint is kinematic, as that of plane/rigid_wall.hpp: a node that its velocity would take into the tool gets
// the velocity, along the tool's normal, that takes it onto the surface; the impulse is its mass times that change.
// Friction takes away sliding by at most mu times the normal impulse, and by no more than what the metal beneath the
// node can bear, where a limit is given. A node's own momentum towards the tool is
// lost when it strikes, as in a plastic impact. On a curved tool, or in a corner, the surface is asked once more.
//
// A node off the tool sleeps until the way that nodes and tool have gone together has grown by 0.9 of its gap.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "contact/tool_surface.hpp"
#include "explicit/interaction.hpp"
#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class SpaceNodes;

class SpaceWall final : public Interaction<SpaceNodes<double>> {
 public:
  // origin: where the tool's frame starts [mm]; reach: how far off it is looked for [mm]
  SpaceWall(std::string name, int n_nodes, std::shared_ptr<const contact::ToolSurface> surface, double mu, double reach,
            const double origin[3])
      : name(std::move(name)),
        mu(mu),
        force(3 * std::size_t(n_nodes)),
        reach_(reach),
        wake_(n_nodes),
        hint_(n_nodes, -1),
        chunk_force_(3 * std::size_t(count_chunks(n_nodes))),
        surface_(std::move(surface)) {
    std::copy_n(origin, 3, origin_);
  }
  SpaceWall(const SpaceWall&) = delete;
  SpaceWall& operator=(const SpaceWall&) = delete;

  // Nodes are moved in chunks; the force on those of each is summed up by itself.
  void open_chunk(int first_node) { std::fill_n(&chunk_force_[3 * std::size_t(first_node / chunk)], 3, 0.0); }
  void add_to_chunk(int node) {
    for (int i = 0; i < 3; ++i) chunk_force_[3 * std::size_t(node / chunk) + i] += force[3 * std::size_t(node) + i];
  }
  void move(const Step& step, int, double fastest) override {
    double speed = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double own = step.velocity_scale * velocity[i];
      offset[i] += step.dt * own, speed += own * own;
      for (std::size_t at = i; at < chunk_force_.size(); at += 3) impulse[i] += step.mean_dt * chunk_force_[at];
    }
    last_ = step.dt * (fastest + std::sqrt(speed));
    travel_ += last_;
  }
  void list_state(std::vector<StateField>& fields) override {
    fields.push_back(row_field(name, "offset", offset, 3));
    fields.push_back(row_field(name, "impulse", impulse, 3));
    fields.push_back(row_field(name, "force", force.data(), force.size()));
    fields.push_back(row_field(name, "travel", &travel_, 2));
    fields.push_back(row_field(name, "wake", wake_.data(), wake_.size()));
  }
  bool is_awake(int node) const { return wake_[node] <= travel_; }

  // Correct the velocity v of a node at x over a step dt, in which the tool moves at w; free: 1 or 0 for each freedom;
  // by_force: change of velocity by a force in this step [1/t s].
  // Returns whether it touches; normal and slide are the changes of velocity by the tool's pressure and friction.
  // whole: the step is taken, so that a node far off may sleep.
  bool constrain(int node, const double x[3], double dt, const double w[3], const double free[3], double v[3],
                 double normal[3], double slide[3], bool whole, double by_force) {
    const double before[3] = {v[0], v[1], v[2]};
    double push = 0.0, out[3];
    int hint = hint_[node];
    for (int round = 0; round < rounds; ++round) {
      double place[3];
      for (int i = 0; i < 3; ++i) place[i] = x[i] + dt * (v[i] - w[i]) - origin_[i] - offset[i];
      contact::Touch touch;
      const bool near = surface_->nearest(place, reach_, hint, touch);
      if (round == 0 && whole) {
        const double sleep = 0.9 * touch.gap - 4.0 * last_;
        wake_[node] = sleep > 0.0 ? travel_ + sleep : 0.0;
        if (near) hint_[node] = hint;
      }
      if (!near || !(touch.gap < 0.0)) break;
      const double change = push_out(touch.gap, touch.normal, dt, free, v);
      if (round == 0) {
        push = change;
        std::copy_n(touch.normal, 3, out);
      }
    }
    for (int i = 0; i < 3; ++i) normal[i] = v[i] - before[i], slide[i] = 0.0;
    if (push == 0.0) return false;
    // friction on what slides along the tangent plane
    double along[3], across = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) across += (v[i] - w[i]) * out[i];
    for (int i = 0; i < 3; ++i) along[i] = v[i] - w[i] - across * out[i], size += along[i] * along[i];
    size = std::sqrt(size);
    if (!(size > 0.0)) return true;
    const double most = friction_limit.empty() ? size : friction_limit[node] * by_force;
    const double held = std::min({size, mu * push, most}) / size;
    for (int i = 0; i < 3; ++i) slide[i] = -free[i] * held * along[i], v[i] += slide[i];
    return true;
  }

  std::string name;
  double mu;                             // of friction over pressure, infinite where nothing slides
  std::vector<double> friction_limit;    // (n_nodes), or none [N]
  double offset[3] = {0.0, 0.0, 0.0};    // displacement since the start [mm]
  double velocity[3] = {0.0, 0.0, 0.0};  // [mm/s]
  double impulse[3] = {0.0, 0.0, 0.0};   // given to the nodes since the start [N s]
  std::vector<double> force;             // (n_nodes, 3) on the nodes in the last cycle [N]

 private:
  static constexpr int rounds = 3;
  // Returns the change of velocity along the normal.
  static double push_out(double gap, const double normal[3], double dt, const double free[3], double v[3]) {
    double n[3], square = 0.0;
    for (int i = 0; i < 3; ++i) n[i] = free[i] * normal[i], square += n[i] * n[i];
    if (square < 1e-12) return 0.0;  // cannot move off
    const double change = -gap / (dt * square);
    for (int i = 0; i < 3; ++i) v[i] += change * n[i];
    return change;
  }

  double origin_[3];  // of the tool's frame at the start [mm]
  double reach_, travel_ = 0.0, last_ = 0.0;
  std::vector<double> wake_;         // (n_nodes): the travel at which a node may touch
  std::vector<int> hint_;            // (n_nodes)
  std::vector<double> chunk_force_;  // (chunks, 3)
  std::shared_ptr<const contact::ToolSurface> surface_;
};

}  // namespace presswork::explicit_dynamics
