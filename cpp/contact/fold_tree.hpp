// SPDX-License-Identifier: Apache-2.0
// Folds of a surface, straight lines between two points, in a binary tree of boxes: how far is the nearest from a
// segment?
#pragma once

#include <array>
#include <vector>

#include "contact/sharp_search.hpp"

namespace presswork::contact {

class FoldTree {
 public:
  using Fold = std::array<const double*, 2>;  // its ends

  // At least one fold; their points are copied.
  explicit FoldTree(const std::vector<Fold>& folds);

  // Distance between the segment from a to b and the nearest fold [mm], or to any fold that is nearer than `near`.
  // hint is the fold found last (-1: unknown) and is updated; it speeds the search up.
  double distance(const double a[3], const double b[3], double near, int& hint) const;

  // The search, on the tree: good for as long as it lives.
  FoldSearch search() const {
    return {lines_.data(), boxes_.data(), static_cast<int>(lines_.size()), static_cast<int>(boxes_.size())};
  }

 private:
  static constexpr int leaf = 4;  // folds
  using Line = FoldSearch::Line;
  using Box = FoldSearch::Box;
  void build(std::vector<Fold>& folds, int first, int last);

  std::vector<Line> lines_;
  std::vector<Box> boxes_;
};

}  // namespace presswork::contact
