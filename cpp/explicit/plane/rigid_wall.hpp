// SPDX-License-Identifier: Apache-2.0
// A rigid tool profile in the explicit loop of solids: no node ends a cycle behind it.
//
// The constraint is kinematic: a node that its velocity would take through the profile gets the velocity, along the
// profile's normal, that takes it onto it; the impulse is its mass times that change. Coulomb friction takes away
// sliding by at most mu times the normal impulse. Exact for straight profiles; a node's own momentum towards the wall
// is lost when it strikes, as in a plastic impact.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "contact/profile.hpp"
#include "explicit/exact_sum.hpp"
#include "explicit/interaction.hpp"
#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

class PlaneNodes;

class RigidWall final : public Interaction<PlaneNodes> {
 public:
  // segments (n, 7) as in contact/profile.hpp [mm]; name: of its state
  RigidWall(std::string name, int n_nodes, std::vector<double> segments, double mu)
      : name(std::move(name)),
        mu(mu),
        force(2 * std::size_t(n_nodes)),
        friction(2 * std::size_t(n_nodes)),
        pressed(n_nodes),
        rubbed(n_nodes),
        chunk_force_(2 * std::size_t(count_chunks(n_nodes))),
        segments_(std::move(segments)),
        prepared_(segments_.size() / 7),
        boxes_(2 * ProfileSearch::count_leaves(static_cast<int>(prepared_.size()))),
        search_(static_cast<int>(prepared_.size()), segments_.data(), prepared_.data(), boxes_.data()) {}
  RigidWall(const RigidWall&) = delete;
  RigidWall& operator=(const RigidWall&) = delete;

  // Nodes are moved in chunks; the force on those of each is summed up by itself, and then together.
  void open_chunk(int first_node) { std::fill_n(&chunk_force_[2 * std::size_t(first_node / chunk)], 2, 0.0); }
  void add_to_chunk(int node) {
    for (int i = 0; i < 2; ++i)
      chunk_force_[2 * std::size_t(node / chunk) + i] += round_force(force[2 * std::size_t(node) + i]);
  }
  void sum_chunks(double sum[2]) const {
    sum[0] = sum[1] = 0.0;
    for (std::size_t at = 0; at < chunk_force_.size(); ++at) sum[at % 2] += chunk_force_[at];
  }
  // Add what a node has got in a cycle over dt, in which it moved at v and the wall at w.
  void add_to_sums(int node, double dt, const double v[2], const double w[2]) {
    const double *whole = &force[2 * std::size_t(node)], *rub = &friction[2 * std::size_t(node)];
    pressed[node] += dt * std::hypot(whole[0] - rub[0], whole[1] - rub[1]);
    for (int i = 0; i < 2; ++i) rubbed[node] -= dt * rub[i] * (v[i] - w[i]);
  }
  void begin_sums() {
    std::fill(pressed.begin(), pressed.end(), 0.0);
    std::fill(rubbed.begin(), rubbed.end(), 0.0);
  }
  void move(const Step& step, int, double) override {
    double own[2];
    if (!of_all_parts) sum_chunks(own);
    for (int i = 0; i < 2; ++i) {
      offset[i] += step.dt * step.velocity_scale * velocity[i];
      impulse[i] += step.mean_dt * (of_all_parts ? of_all_parts : own)[i];
    }
  }
  void list_state(std::vector<StateField>& fields) override {
    fields.push_back(row_field(name, "offset", offset, 2));
    fields.push_back(row_field(name, "impulse", impulse, 2));
    fields.push_back(column_field(name, "force", force.data(), force.size() / 2, 2, 2));
  }

  std::string name;
  double mu;                             // Coulomb
  double offset[2] = {0.0, 0.0};         // displacement since the start [mm]
  double velocity[2] = {0.0, 0.0};       // [mm/s]
  double impulse[2] = {0.0, 0.0};        // given to the nodes since the start [N s]
  std::vector<double> force;             // (n_nodes, 2) on the nodes in the last cycle [N]
  std::vector<double> friction;          // (n_nodes, 2) of that the friction [N]
  const double* of_all_parts = nullptr;  // force of this cycle (2), where the mesh is divided
  // (n_nodes) since begin_sums: impulse of the pressure [N s], work that friction has taken [N mm]
  std::vector<double> pressed, rubbed;

  // Correct the velocity v of a node at x over a step dt, in which the wall moves at w; free: 1 or 0 for each freedom.
  // Returns whether it touches; normal and slide are the changes of velocity by the wall's pressure and friction.
  bool constrain(const double x[2], double dt, const double w[2], const double free[2], double v[2], double normal[2],
                 double slide[2]) const {
    const double before[2] = {v[0], v[1]};
    const Touch touch =
        search_.touch(x[0] + dt * v[0] - offset[0] - dt * w[0], x[1] + dt * v[1] - offset[1] - dt * w[1]);
    const double push = push_out(touch.gap, touch.normal, dt, free, v);
    push_out(touch.second_gap, touch.second_normal, dt, free, v);
    for (int i = 0; i < 2; ++i) normal[i] = v[i] - before[i], slide[i] = 0.0;
    if (push == 0.0) return false;
    const double* n = touch.normal;
    const double sliding = (v[1] - w[1]) * n[0] - (v[0] - w[0]) * n[1];  // along (-n1, n0)
    const double held = std::copysign(std::min(std::abs(sliding), mu * push), sliding);
    slide[0] = free[0] * held * n[1], slide[1] = -free[1] * held * n[0];
    for (int i = 0; i < 2; ++i) v[i] += slide[i];
    return true;
  }

 private:
  // Returns the change of velocity along the normal.
  static double push_out(double gap, const double normal[2], double dt, const double free[2], double v[2]) {
    if (!(gap < 0.0)) return 0.0;
    const double n[2] = {free[0] * normal[0], free[1] * normal[1]}, square = n[0] * n[0] + n[1] * n[1];
    if (square < 1e-12) return 0.0;  // cannot move off
    const double change = -gap / (dt * square);
    for (int i = 0; i < 2; ++i) v[i] += change * n[i];
    return change;
  }

  std::vector<double> chunk_force_;  // (chunks, 2)
  std::vector<double> segments_;
  std::vector<profile::Prepared> prepared_;
  std::vector<profile::Box> boxes_;
  ProfileSearch search_;
};

}  // namespace presswork::explicit_dynamics
