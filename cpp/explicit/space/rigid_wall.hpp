// SPDX-License-Identifier: Apache-2.0
// A rigid tool in the explicit loop of solids in space: no node of their surface ends a cycle inside it. What it does
// to a node stands in wall_touch.hpp.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "contact/tool_surface.hpp"
#include "explicit/exact_sum.hpp"
#include "explicit/interaction.hpp"
#include "explicit/nodes.hpp"
#include "explicit/space/wall_touch.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class SpaceNodes;

class SpaceWall final : public Interaction<SpaceNodes<double>>, public WallBody {
 public:
  SpaceWall(std::string name, int n_nodes, std::shared_ptr<const contact::ToolSurface> surface, const WallBody& body)
      : WallBody(body),
        name(std::move(name)),
        force(3 * std::size_t(n_nodes)),
        pressed(n_nodes),
        rubbed(n_nodes),
        wake_(n_nodes),
        hint_(n_nodes, -1),
        chunk_force_(4 * std::size_t(count_chunks(n_nodes))),
        surface_(std::move(surface)) {}
  SpaceWall(const SpaceWall&) = delete;
  SpaceWall& operator=(const SpaceWall&) = delete;

  // Nodes are moved in chunks; force and moment on those of each are summed up by themselves, and then together.
  void open_chunk(int first_node) { std::fill_n(&chunk_force_[4 * std::size_t(first_node / chunk)], 4, 0.0); }
  void add_to_chunk(int node, const double x[3]) {
    double* sum = &chunk_force_[4 * std::size_t(node / chunk)];
    const double* own = &force[3 * std::size_t(node)];
    for (int i = 0; i < 3; ++i) sum[i] += round_force(own[i]);
    sum[3] += round_force(motion.moment(x, own));
  }
  void sum_chunks(double sum[4]) const {
    std::fill_n(sum, 4, 0.0);
    for (std::size_t at = 0; at < chunk_force_.size(); ++at) sum[at % 4] += chunk_force_[at];
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
  // How far the farthest node is from the centre of a wall that turns [mm]; negative: it does not.
  double measure_radius(const SpaceNodes<double>& nodes) const;
  void move(const Step& step, int, double fastest) override {
    double own[4];
    if (!of_all_parts) sum_chunks(own);
    advance(step, fastest, of_all_parts ? of_all_parts : own);
  }
  void list_state(std::vector<StateField>& fields) override {
    motion.list_state(name, fields);
    fields.push_back(row_field(name, "impulse", impulse, 4));
    fields.push_back(column_field(name, "force", force.data(), force.size() / 3, 3, 3));
    fields.push_back(row_field(name, "travel", &travel, 2));
    fields.push_back(row_field(name, "wake", wake_.data(), wake_.size()));
  }
  // What its nodes remember of it, where a lane can reach it.
  WallNodes lend() {
    return {force.data(), pressed.data(), rubbed.data(),
            wake_.data(), hint_.data(),   friction_limit.empty() ? nullptr : friction_limit.data()};
  }
  const contact::ToolSurface& surface() const { return *surface_; }

  std::string name;
  std::vector<double> friction_limit;    // (n_nodes), or none [N]
  std::vector<double> force;             // (n_nodes, 3) on the nodes in the last cycle [N]
  const double* of_all_parts = nullptr;  // force and moment of this cycle, where the mesh is divided
  double radius_of_others = 0.0;         // measure_radius of the other parts of a mesh that is divided
  // (n_nodes) since begin_sums: impulse of the pressure [N s], work that friction has taken [N mm]
  std::vector<double> pressed, rubbed;

 private:
  std::vector<double> wake_;         // (n_nodes): the travel at which a node may touch
  std::vector<int> hint_;            // (n_nodes)
  std::vector<double> chunk_force_;  // (chunks, 4)
  std::shared_ptr<const contact::ToolSurface> surface_;
};

}  // namespace presswork::explicit_dynamics
