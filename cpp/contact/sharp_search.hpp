// SPDX-License-Identifier: Apache-2.0
// How far a segment is from the sharp places of a tool (sharp_places.hpp), kept in any memory: that of the CPU, or of a
// card.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/swept_search.hpp"
#include "contact/vectors.hpp"

namespace presswork::contact {

// The nearest of folds, in a binary tree of boxes.
struct FoldSearch {
  struct Line {
    double start[3], way[3], length2;
  };
  struct Box {
    double low[3], high[3];
    // children are the next box and `right`; of a leaf, whose `right` is 0, lines first to last - 1
    int right, first, last;
  };

  // Squared distance between two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
  PRESSWORK_DEVICE static double distance2(const Line& fold, const Line& segment) {
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

  PRESSWORK_DEVICE double distance(const double a[3], const double b[3], double near, int& hint) const {
    Line segment{{a[0], a[1], a[2]}, {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, 0.0};
    segment.length2 = dot(segment.way, segment.way);
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) low[k] = std::min(a[k], b[k]), high[k] = std::max(a[k], b[k]);
    const auto to_box = [&](int box) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double off = std::max(std::max(boxes[box].low[k] - high[k], low[k] - boxes[box].high[k]), 0.0);
        sum += off * off;
      }
      return sum;
    };
    double least = hint >= 0 ? distance2(lines[hint], segment) : std::numeric_limits<double>::infinity();
    struct Entry {
      int box;
      double distance2;
    } stack[64];
    int count = 0;
    stack[count++] = {0, to_box(0)};
    while (count > 0 && least >= near * near) {
      const auto [box, away2] = stack[--count];
      if (away2 >= least) continue;
      if (boxes[box].right == 0) {
        for (int i = boxes[box].first; i < boxes[box].last; ++i)
          if (const double d2 = distance2(lines[i], segment); d2 < least) least = d2, hint = i;
        continue;
      }
      const Entry nearer{box + 1, to_box(box + 1)}, farther{boxes[box].right, to_box(boxes[box].right)};
      const bool swapped = farther.distance2 < nearer.distance2;
      stack[count++] = swapped ? nearer : farther, stack[count++] = swapped ? farther : nearer;
    }
    return std::sqrt(least);
  }

  const Line* lines = nullptr;
  const Box* boxes = nullptr;
  int n_lines = 0, n_boxes = 0;
};

// Sharp places of a swept surface, or folds of triangles.
struct SharpSearch {
  static constexpr int parts = 4;  // of a segment near a swept surface

  // As SharpPlaces::distance.
  PRESSWORK_DEVICE double distance(const double a[3], const double b[3], double near, int& hint) const {
    if (folds.n_lines > 0) return folds.distance(a, b, near, hint);
    // the middle of each part is as far as said, the rest by half its length less
    double middle[3], way[3], least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) way[k] = (b[k] - a[k]) / parts;
    for (int i = 0; i < parts; ++i) {
      for (int k = 0; k < 3; ++k) middle[k] = a[k] + (i + 0.5) * way[k];
      least = std::min(least, swept.distance_to(pieces, n_pieces, middle));
    }
    return std::max(least - 0.5 * std::sqrt(dot(way, way)), 0.0);
  }

  SweptSearch swept = {};
  const int* pieces = nullptr;
  int n_pieces = 0;
  FoldSearch folds = {};
};

}  // namespace presswork::contact
