// SPDX-License-Identifier: Apache-2.0
// Nodes of the two faces of a sector of cyclic symmetry: the second of a pair goes where the first would be, turned
// about z by the angle of the sector; the first has the mass and the forces of both.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "explicit/interaction.hpp"
#include "explicit/space/nodes.hpp"
#include "explicit/space/turn_about_z.hpp"

namespace presswork::explicit_dynamics {

class CyclicTies final : public Interaction<SpaceNodes<double>> {
 public:
  using Nodes = SpaceNodes<double>;

  // pairs (n, 2); angle: of the sector [rad]
  CyclicTies(std::vector<std::pair<int, int>> pairs, double angle)
      : pairs_(std::move(pairs)), cosine_(std::cos(angle)), sine_(std::sin(angle)) {}

  Phase phase() const override { return Phase::nodes; }
  int n_following() const override { return count_chunks(n()); }
  double follow(Nodes& nodes, const Step&, int piece) override {
    double fastest = 0.0;
    for (int i = piece * chunk; i < std::min(n(), (piece + 1) * chunk); ++i) {
      const auto [first, last] = pairs_[i];
      double* to = nodes.motion.data() + std::size_t(Nodes::motion_stride) * last;
      turn(nodes.motion.data() + std::size_t(Nodes::motion_stride) * first, sine_, to);
      turn(nodes.position.data() + std::size_t(Nodes::position_stride) * first, sine_,
           nodes.position.data() + std::size_t(Nodes::position_stride) * last);
      fastest = std::max(fastest, to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    }
    return fastest;
  }
  int n_rounds() const override { return 1; }
  int n_pieces(int) const override { return count_chunks(n()); }
  void act(Nodes& nodes, const Step&, int, int, int piece) override {
    for (int i = piece * chunk; i < std::min(n(), (piece + 1) * chunk); ++i) {
      double *to = nodes.internal_force.data() + row_at(pairs_[i].first),
             *from = nodes.internal_force.data() + row_at(pairs_[i].second), back[3];
      turn(from, -sine_, back);
      for (int k = 0; k < 3; ++k) to[k] += back[k], from[k] = 0.0;
    }
  }
  void share_masses(std::vector<double>& sum) override {
    for (const auto& [first, last] : pairs_) {
      sum[2 * std::size_t(first)] += sum[2 * std::size_t(last)];
      sum[2 * std::size_t(last)] = 0.0;
    }
  }

  const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }
  double cosine() const { return cosine_; }
  double sine() const { return sine_; }

 private:
  int n() const { return static_cast<int>(pairs_.size()); }
  void turn(const double from[3], double sine, double to[3]) const { turn_about_z(from, cosine_, sine, to); }

  std::vector<std::pair<int, int>> pairs_;
  double cosine_, sine_;
};

}  // namespace presswork::explicit_dynamics
