// SPDX-License-Identifier: Apache-2.0
// Folds of a surface, straight lines between two points, in a binary tree of boxes: how far is the nearest from a
// segment?
#pragma once

#include <array>
#include <vector>

namespace presswork::contact {

class FoldTree {
 public:
  using Fold = std::array<const double*, 2>;  // its ends

  // At least one fold; their points are copied.
  explicit FoldTree(const std::vector<Fold>& folds);

  // Distance between the segment from a to b and the nearest fold [mm], or to any fold that is nearer than `near`.
  // hint is the fold found last (-1: unknown) and is updated; it speeds the search up.
  double distance(const double a[3], const double b[3], double near, int& hint) const;

 private:
  static constexpr int leaf = 4;  // folds
  struct Line {
    double start[3], way[3], length2;
  };
  struct Box {
    double low[3], high[3];
    // children are the next box and `right`; of a leaf, whose `right` is 0, lines first to last - 1
    int right, first, last;
  };

  void build(std::vector<Fold>& folds, int first, int last);
  static double distance2(const Line& fold, const Line& segment);

  std::vector<Line> lines_;
  std::vector<Box> boxes_;
};

}  // namespace presswork::contact
