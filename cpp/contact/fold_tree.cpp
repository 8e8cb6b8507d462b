// SPDX-License-Identifier: Apache-2.0
#include "contact/fold_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/vectors.hpp"

namespace presswork::contact {

FoldTree::FoldTree(const std::vector<Fold>& folds) {
  std::vector<Fold> sorted = folds;
  build(sorted, 0, static_cast<int>(sorted.size()));
  for (const auto& [a, b] : sorted) {
    Line line{{a[0], a[1], a[2]}, {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, 0.0};
    line.length2 = dot(line.way, line.way);
    lines_.push_back(line);
  }
}

// Boxes over some folds, which are halved by their middles along the longest side.
void FoldTree::build(std::vector<Fold>& folds, int first, int last) {
  const auto index = boxes_.size();
  Box box{{}, {}, 0, first, last};
  for (int k = 0; k < 3; ++k) {
    box.low[k] = std::numeric_limits<double>::infinity(), box.high[k] = -box.low[k];
    for (int i = first; i < last; ++i)
      for (const double* end : folds[i])
        box.low[k] = std::min(box.low[k], end[k]), box.high[k] = std::max(box.high[k], end[k]);
  }
  boxes_.push_back(box);
  if (last - first <= leaf) return;
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if (box.high[k] - box.low[k] > box.high[longest] - box.low[longest]) longest = k;
  const auto middle = [longest](const Fold& fold) { return fold[0][longest] + fold[1][longest]; };
  const int half = first + (last - first) / 2;
  std::nth_element(folds.begin() + first, folds.begin() + half, folds.begin() + last,
                   [&](const Fold& a, const Fold& b) { return middle(a) < middle(b); });
  build(folds, first, half);
  boxes_[index].right = static_cast<int>(boxes_.size());
  build(folds, half, last);
}

double FoldTree::distance(const double a[3], const double b[3], double near, int& hint) const {
  return search().distance(a, b, near, hint);
}

}  // namespace presswork::contact
