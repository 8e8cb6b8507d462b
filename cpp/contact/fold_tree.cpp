// SPDX-License-Identifier: Apache-2.0
#include "contact/fold_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

// Squared distance between two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
double FoldTree::distance2(const Line& fold, const Line& segment) {
  double apart[3];
  for (int k = 0; k < 3; ++k) apart[k] = segment.start[k] - fold.start[k];
  const double a = segment.length2, b = dot(segment.way, fold.way), e = fold.length2;
  const double c = dot(segment.way, apart), f = dot(fold.way, apart), determinant = a * e - b * b;
  double s = determinant > 1e-12 * a * e ? std::clamp((b * f - c * e) / determinant, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((b * t - c) / a, 0.0, 1.0);
  }
  for (int k = 0; k < 3; ++k) apart[k] += s * segment.way[k] - t * fold.way[k];
  return dot(apart, apart);
}

double FoldTree::distance(const double a[3], const double b[3], double near, int& hint) const {
  Line segment{{a[0], a[1], a[2]}, {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, 0.0};
  segment.length2 = dot(segment.way, segment.way);
  double low[3], high[3];
  for (int k = 0; k < 3; ++k) low[k] = std::min(a[k], b[k]), high[k] = std::max(a[k], b[k]);
  const auto to_box = [&](int box) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double off = std::max(std::max(boxes_[box].low[k] - high[k], low[k] - boxes_[box].high[k]), 0.0);
      sum += off * off;
    }
    return sum;
  };
  double least = hint >= 0 ? distance2(lines_[hint], segment) : std::numeric_limits<double>::infinity();
  struct Entry {
    int box;
    double distance2;
  } stack[64];
  int count = 0;
  stack[count++] = {0, to_box(0)};
  while (count > 0 && least >= near * near) {
    const auto [box, away2] = stack[--count];
    if (away2 >= least) continue;
    if (boxes_[box].right == 0) {
      for (int i = boxes_[box].first; i < boxes_[box].last; ++i)
        if (const double d2 = distance2(lines_[i], segment); d2 < least) least = d2, hint = i;
      continue;
    }
    Entry nearer{box + 1, to_box(box + 1)}, farther{boxes_[box].right, to_box(boxes_[box].right)};
    if (farther.distance2 < nearer.distance2) std::swap(nearer, farther);
    stack[count++] = farther, stack[count++] = nearer;
  }
  return std::sqrt(least);
}

}  // namespace presswork::contact
