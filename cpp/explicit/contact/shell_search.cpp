// SPDX-License-Identifier: Apache-2.0
// Which shells a node of a sheet may touch before the next search.
#include <algorithm>

#include "explicit/contact/shell_contact.hpp"

namespace presswork::explicit_dynamics {

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
