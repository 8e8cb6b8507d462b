// SPDX-License-Identifier: Apache-2.0
// Which shells a node of a sheet may touch before the next search.
#include <algorithm>
#include <utility>

#include "explicit/contact/shell_contact.hpp"

namespace presswork::explicit_dynamics {

bool ShellContact::pass(double dt, double fastest) {
  travel_ += 2.0 * dt * fastest;
  return is_due_ = !searched_ || travel_ > next_search_;
}

void ShellContact::list_awake() {
  knows_node_.resize(n_nodes_, 0), knows_cell_.resize(cell_start_.size() - 1, 0);
  for (int node : nodes_awake_) knows_node_[node] = 0;
  for (int cell : cells_awake_) knows_cell_[cell] = 0;
  nodes_awake_.clear(), cells_awake_.clear();
  const auto add_node = [this](int node) {
    if (!std::exchange(knows_node_[node], 1)) nodes_awake_.push_back(node);
  };
  const auto add_cell = [this](int cell) {
    if (!std::exchange(knows_cell_[cell], 1)) cells_awake_.push_back(cell);
  };
  for (int node : near_) {
    bool looks = false;
    const auto look_at = [&](int cell) {
      looks = true;
      add_cell(cell);
      for (int a = cell_start_[cell]; a < cell_start_[cell + 1]; ++a) add_node(cell_node_[a]);
    };
    for (int f = 0; f < faces; ++f)
      if (const Slot& slot = slots_[std::size_t(node) * faces + f]; slot.cell >= 0) look_at(slot.cell);
    for (int e = entries_.start[node]; e < entries_.start[node + 1]; ++e)
      if (wake_[e] <= travel_) look_at(entries_.cell[e]);
    if (!looks) continue;
    add_node(node);
    for (int s = node_start_[node]; s < node_start_[node + 1]; ++s) add_cell(node_cell_[s]);
  }
}

void ShellContact::search(const double* position, const std::vector<double>& half_node,
                          const std::vector<double>& half_cell) {
  const int n_cells = static_cast<int>(half_cell.size());
  // 1. shells near each node
  list_near(position, 4, half_node, half_cell, margin_, entries_);
  wake_.clear();
  for (double gap : entries_.gap) wake_.push_back(travel_ + reach_awake * std::max(gap, 0.0));
  // 2. nodes near each cell
  const int n_entries = static_cast<int>(entries_.cell.size());
  of_cell_start_.assign(n_cells + 1, 0), of_cell_.resize(n_entries), active_.assign(n_entries, -1);
  for (int cell : entries_.cell) ++of_cell_start_[cell + 1];
  for (int c = 0; c < n_cells; ++c) of_cell_start_[c + 1] += of_cell_start_[c];
  std::vector<int> next(of_cell_start_.begin(), of_cell_start_.end() - 1);
  for (int e = 0; e < n_entries; ++e) of_cell_[next[entries_.cell[e]]++] = e;
  // 3. nodes that may have a force
  near_start_.assign(1, 0), near_.clear();
  for (int node = 0; node < n_nodes_; ++node) {
    bool is_near = entries_.start[node] < entries_.start[node + 1] || slots_[std::size_t(node) * faces].cell >= 0;
    for (int s = node_start_[node]; s < node_start_[node + 1] && !is_near; ++s)
      is_near = of_cell_start_[node_cell_[s]] < of_cell_start_[node_cell_[s] + 1];
    if (is_near) near_.push_back(node);
    if ((node + 1) % chunk == 0 || node + 1 == n_nodes_) near_start_.push_back(static_cast<int>(near_.size()));
  }
  for (Slot& slot : slots_) slot.entry = -1;  // forces are found anew before they are gathered
  searched_ = true, next_search_ = travel_ + reach_awake * margin_;
}

}  // namespace presswork::explicit_dynamics
