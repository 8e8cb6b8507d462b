// SPDX-License-Identifier: Apache-2.0
// A rigid tool in the explicit loop of solids in space: no node of their surface ends a cycle inside it.
//
// The constraint is kinematic, as that of plane/rigid_wall.hpp: a node that its velocity would take into the tool gets
// the velocity, along the tool's normal, that takes it onto the surface; the impulse is its mass times that change.
// Friction takes away sliding by at most mu times the normal impulse, and by no more than what the metal beneath the
// node can bear, where a limit is given. A node's own momentum towards the tool is
// lost when it strikes, as in a plastic impact. On a curved tool, or in a corner, the surface is asked once more.
//
// A node off the tool sleeps until the way that nodes and tool have gone together has grown by 0.9 of its gap. How the
// tool moves is said in wall_motion.hpp.
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
#include "explicit/space/held_along.hpp"
#include "explicit/space/wall_motion.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class SpaceNodes;

// What a tool does to a node that touches it: its velocity there, and the changes of the node's velocity by its
// pressure and friction [mm/s].
struct WallTouch {
  double w[3], normal[3], slide[3];
};

class SpaceWall final : public Interaction<SpaceNodes<double>> {
 public:
  // reach: how far off it is looked for [mm]
  SpaceWall(std::string name, int n_nodes, std::shared_ptr<const contact::ToolSurface> surface, double mu, double reach,
            const WallMotion& motion)
      : name(std::move(name)),
        mu(mu),
        motion(motion),
        force(3 * std::size_t(n_nodes)),
        pressed(n_nodes),
        rubbed(n_nodes),
        reach_(reach),
        wake_(n_nodes),
        hint_(n_nodes, -1),
        chunk_force_(4 * std::size_t(count_chunks(n_nodes))),
        surface_(std::move(surface)) {}
  SpaceWall(const SpaceWall&) = delete;
  SpaceWall& operator=(const SpaceWall&) = delete;

  // Nodes are moved in chunks; force and moment on those of each are summed up by themselves.
  void open_chunk(int first_node) { std::fill_n(&chunk_force_[4 * std::size_t(first_node / chunk)], 4, 0.0); }
  void add_to_chunk(int node, const double x[3]) {
    double* sum = &chunk_force_[4 * std::size_t(node / chunk)];
    const double* own = &force[3 * std::size_t(node)];
    for (int i = 0; i < 3; ++i) sum[i] += own[i];
    sum[3] += motion.moment(x, own);
  }
  // Count what a node that moves at v gets in a cycle, with its mass over the time of a change of velocity.
  void add_to_sums(int node, double mean_dt, double mass, const double v[3], const WallTouch& touch) {
    double square = 0.0;
    for (double change : touch.normal) square += change * change;
    pressed[node] += mean_dt * mass * std::sqrt(square);
    for (int i = 0; i < 3; ++i) rubbed[node] -= mean_dt * mass * touch.slide[i] * (v[i] - touch.w[i]);
  }
  void begin_sums() {
    std::fill(pressed.begin(), pressed.end(), 0.0);
    std::fill(rubbed.begin(), rubbed.end(), 0.0);
  }
  // Put it elsewhere, by a displacement since the start [mm].
  void place(const double displacement[3]) {
    std::copy_n(displacement, 3, motion.offset);
    std::fill(wake_.begin(), wake_.end(), 0.0);
  }
  void begin(SpaceNodes<double>& nodes, int) override;
  void move(const Step& step, int, double fastest) override {
    double on_tool[3];
    last_ = step.dt * (fastest + motion.fastest(step, radius_));
    for (int i = 0; i < 4; ++i) {
      double sum = 0.0;
      for (std::size_t at = i; at < chunk_force_.size(); at += 4) {
        impulse[i] += step.mean_dt * chunk_force_[at];
        sum += chunk_force_[at];
      }
      if (i < 3) on_tool[i] = -sum;
    }
    motion.advance(step, on_tool);
    travel_ += last_;
  }
  void list_state(std::vector<StateField>& fields) override {
    motion.list_state(name, fields);
    fields.push_back(row_field(name, "impulse", impulse, 4));
    fields.push_back(row_field(name, "force", force.data(), force.size()));
    fields.push_back(row_field(name, "travel", &travel_, 2));
    fields.push_back(row_field(name, "wake", wake_.data(), wake_.size()));
  }
  bool is_awake(int node) const { return wake_[node] <= travel_; }

  // Correct the velocity v of a node at x over a step; by_force: change of velocity by a force in this step [1/t s].
  // Returns whether it touches. whole: the step is taken, so that a node far off may sleep.
  bool constrain(int node, const double x[3], const Step& step, const FreeMotion& free, double by_force, bool whole,
                 double v[3], WallTouch& done) {
    const double before[3] = {v[0], v[1], v[2]}, dt = step.dt;
    const WallPose pose(motion, step);
    double push = 0.0, out[3];
    int hint = hint_[node];
    for (int round = 0; round < rounds; ++round) {
      double place[3];
      pose.find_place(x, v, place);
      contact::Touch touch;
      const bool near = surface_->nearest(place, reach_, hint, touch);
      if (round == 0 && whole) {
        const double sleep = 0.9 * touch.gap - 4.0 * last_;
        wake_[node] = sleep > 0.0 ? travel_ + sleep : 0.0;
        if (near) hint_[node] = hint;
      }
      if (!near || !(touch.gap < 0.0)) break;
      pose.carry(touch.normal);
      const double change = push_out(touch.gap, touch.normal, dt, free, v);
      if (round == 0) {
        push = change;
        std::copy_n(touch.normal, 3, out);
      }
    }
    if (push == 0.0) return false;
    double *w = done.w, *slide = done.slide;
    pose.find_velocity(x, w);
    for (int i = 0; i < 3; ++i) done.normal[i] = v[i] - before[i], slide[i] = 0.0;
    // friction on what slides along the tangent plane
    double along[3], able[3], across = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) across += (v[i] - w[i]) * out[i];
    for (int i = 0; i < 3; ++i) along[i] = v[i] - w[i] - across * out[i], size += along[i] * along[i];
    size = std::sqrt(size);
    if (!(size > 0.0)) return true;
    const double most = friction_limit.empty() ? size : friction_limit[node] * by_force;
    const double held = std::min({size, mu * push, most}) / size;
    free.project(along, able);
    for (int i = 0; i < 3; ++i) slide[i] = -held * able[i], v[i] += slide[i];
    return true;
  }

  std::string name;
  double mu;                           // of friction over pressure, infinite where nothing slides
  std::vector<double> friction_limit;  // (n_nodes), or none [N]
  WallMotion motion;
  double impulse[4] = {0.0, 0.0, 0.0, 0.0};  // given to the nodes since the start [N s], and about the axis [N mm s]
  std::vector<double> force;                 // (n_nodes, 3) on the nodes in the last cycle [N]
  // (n_nodes) since begin_sums: impulse of the pressure [N s], work that friction has taken [N mm]
  std::vector<double> pressed, rubbed;

 private:
  static constexpr int rounds = 3;
  // Returns the change of velocity along the normal.
  static double push_out(double gap, const double normal[3], double dt, const FreeMotion& free, double v[3]) {
    double n[3], square = 0.0;
    free.project(normal, n);
    for (double each : n) square += each * each;
    if (square < 1e-12) return 0.0;  // cannot move off
    const double change = -gap / (dt * square);
    for (int i = 0; i < 3; ++i) v[i] += change * n[i];
    return change;
  }

  double reach_, travel_ = 0.0, last_ = 0.0;
  double radius_ = 0.0;              // how far nodes are from the centre of a tool that turns [mm]
  std::vector<double> wake_;         // (n_nodes): the travel at which a node may touch
  std::vector<int> hint_;            // (n_nodes)
  std::vector<double> chunk_force_;  // (chunks, 4)
  std::shared_ptr<const contact::ToolSurface> surface_;
};

}  // namespace presswork::explicit_dynamics
