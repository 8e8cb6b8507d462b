// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_under.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace presswork::contact {

SheetUnder::SheetUnder(std::vector<int> start, std::vector<int> corner, const std::vector<Hanging>& hanging)
    : start_(std::move(start)), corner_(std::move(corner)), neighbour_(corner_.size(), -1) {
  std::map<std::pair<int, int>, std::pair<int, int>> seen;  // edge: the cell that has it, its place in neighbour_
  for (int cell = 0; cell < n_cells(); ++cell)
    for (int a = 0; a < corners(cell); ++a) {
      const int at = start_[cell] + a, one = corner_[at], other = corner_[start_[cell] + (a + 1) % corners(cell)];
      const auto edge = std::minmax(one, other);
      const auto [found, is_new] = seen.try_emplace(edge, cell, at);
      if (is_new) continue;
      neighbour_[at] = found->second.first;
      neighbour_[found->second.second] = cell;
    }
  for (const Hanging& h : hanging) {
    const auto whole = seen.at(std::minmax(h.end[0], h.end[1]));
    for (int end : h.end) {
      const auto half = seen.at(std::minmax(h.node, end));
      neighbour_[half.second] = whole.first, neighbour_[whole.second] = half.first;
    }
  }
}

SheetUnder SheetUnder::in_part(const int* place) const {
  SheetUnder part = *this;
  for (int cell = 0; cell < n_cells(); ++cell) {
    const auto first = part.corner_.begin() + start_[cell], last = part.corner_.begin() + start_[cell + 1];
    std::transform(first, last, first, [&](int node) { return place[node]; });
    if (std::any_of(first, last, [](int node) { return node < 0; })) std::fill(first, last, -1);
  }
  return part;
}

}  // namespace presswork::contact
