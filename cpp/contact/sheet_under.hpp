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

namespace presswork::contact {

struct Beneath {
  int cell = -1;        // the last one found, or where the walk ended
  bool inside = false;  // whether it lies beneath
  int corners = 0;
  const int* node = nullptr;  // of the cell
  double weight[4] = {};      // shape functions of its corners
  double normal[3] = {};      // of the sheet, of any length
};

class SheetUnder {
 public:
  struct Hanging {
    int node, end[2];
  };
  // The corners of cell i are corner[start[i]] to corner[start[i + 1] - 1], in turn round it. hanging: nodes in the
  // middle of sides that one cell has whole and two others in halves.
  SheetUnder(std::vector<int> start, std::vector<int> corner, const std::vector<Hanging>& hanging = {});

  // position: records of `stride` numbers, x, y, z first. from.cell: where to begin, or -1 to look at every cell.
  void find(const double place[2], const double* position, int stride, Beneath& from) const;
  // Take a cell, or none (-1), for the one found last.
  void stand_on(int cell, Beneath& at) const;
  int n_cells() const { return static_cast<int>(start_.size()) - 1; }
  int last_node() const { return *std::max_element(corner_.begin(), corner_.end()); }

 private:
  int corners(int cell) const { return start_[cell + 1] - start_[cell]; }
  void take_corners(int cell, const double* position, int stride, double x[4][3]) const;
  // How far inside the edge that the place is beyond most [mm2], and its neighbour; edges without one come last.
  double worst_edge(int cell, const double place[2], const double x[4][3], int& neighbour) const;
  int nearest_cell(const double place[2], const double* position, int stride) const;
  void interpolate(const double place[2], const double x[4][3], Beneath& found) const;

  std::vector<int> start_, corner_;
  std::vector<int> neighbour_;  // over the edge from each corner to the next; -1 where the sheet ends
};

}  // namespace presswork::contact
