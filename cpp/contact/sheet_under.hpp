// SPDX-License-Identifier: Apache-2.0
// Which shell of a sheet lies beneath a place in the plan x, y, and where in it.
//
// Cells have 3 or 4 corners. The search walks from the cell found last over the edges that the place lies beyond: a
// sheet that flows a little takes a step or none. Where the sheet ends on the way, nothing lies beneath, and the walk
// begins at that edge the next time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "contact/sheet_search.hpp"

namespace presswork::contact {

class SheetUnder {
 public:
  struct Hanging {
    int node, end[2];
  };
  // The corners of cell i are corner[start[i]] to corner[start[i + 1] - 1], in turn round it. hanging: nodes in the
  // middle of sides that one cell has whole and two others in halves.
  SheetUnder(std::vector<int> start, std::vector<int> corner, const std::vector<Hanging>& hanging = {});

  // The same cells of which a part of the sheet has some; place: number in it of each node, -1 where it has none.
  SheetUnder in_part(const int* place) const;

  // As SheetSearch.
  void find(const double place[2], const double* position, int stride, Beneath& from) const {
    search().find(place, position, stride, from);
  }
  void stand_on(int cell, Beneath& at) const { search().stand_on(cell, at); }
  SheetSearch search() const { return {n_cells(), start_.data(), corner_.data(), neighbour_.data()}; }
  bool has(int cell) const { return search().has(cell); }
  int n_cells() const { return static_cast<int>(start_.size()) - 1; }
  int last_node() const { return *std::max_element(corner_.begin(), corner_.end()); }

 private:
  int corners(int cell) const { return start_[cell + 1] - start_[cell]; }

  std::vector<int> start_, corner_;
  std::vector<int> neighbour_;  // over the edge from each corner to the next; -1 where the sheet ends
};

}  // namespace presswork::contact
