// SPDX-License-Identifier: Apache-2.0
#include "contact/facing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace presswork {

namespace {

constexpr double least_part = 1e-9;  // of an edge: shorter common parts are none
const double gauss[3][2] = {{-std::sqrt(0.6), 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {std::sqrt(0.6), 5.0 / 9.0}};

struct Box {
  double low[2], high[2];
  bool meets(const Box& b) const {
    return low[0] <= b.high[0] && b.low[0] <= high[0] && low[1] <= b.high[1] && b.low[1] <= high[1];
  }
};

Box box_of(const double* a, const double* b, double margin) {
  Box box;
  for (int i = 0; i < 2; ++i) box.low[i] = std::min(a[i], b[i]) - margin, box.high[i] = std::max(a[i], b[i]) + margin;
  return box;
}

// The part of an own edge that another covers.
struct Part {
  int own, other;
  double ends[2], gaps[2];  // of the other edge's ends, along the own edge over its length, and across
  double low, high;
};

}  // namespace

std::vector<Facing> find_facing(const double* points, Edges own, Edges other, const double* reach, double thickness) {
  const auto end = [&](Edges edges, int edge, int k) { return points + 2 * std::size_t(edges.nodes[2 * edge + k]); };
  std::vector<Box> boxes(other.n);
  for (int j = 0; j < other.n; ++j) boxes[j] = box_of(end(other, j, 0), end(other, j, 1), 0.0);
  // 1. common parts
  std::vector<Part> parts;
  std::vector<double> length(own.n), depth(own.n), covered(own.n, 0.0);
  for (int i = 0; i < own.n; ++i) {
    const double *a = end(own, i, 0), *b = end(own, i, 1);
    const double along[2] = {b[0] - a[0], b[1] - a[1]};
    length[i] = std::sqrt(along[0] * along[0] + along[1] * along[1]);
    depth[i] = std::max(reach[i], 0.5 * length[i]);
    const double square = length[i] * length[i];
    const Box box = box_of(a, b, depth[i]);
    for (int j = 0; j < other.n; ++j) {
      if (!box.meets(boxes[j])) continue;
      Part part{i, j, {}, {}, 0.0, 0.0};
      bool shared = false;
      for (int k = 0; k < 2; ++k) {
        const double *p = end(other, j, k), way[2] = {p[0] - a[0], p[1] - a[1]};
        part.ends[k] = (way[0] * along[0] + way[1] * along[1]) / square;
        part.gaps[k] = (way[0] * along[1] - way[1] * along[0]) / length[i];
        shared |= p == a || p == b;
      }
      part.low = std::clamp(part.ends[1], 0.0, 1.0), part.high = std::clamp(part.ends[0], 0.0, 1.0);
      const bool near =
          std::min(part.gaps[0], part.gaps[1]) <= reach[i] && std::max(part.gaps[0], part.gaps[1]) >= -depth[i];
      if (shared || !near || !(part.high - part.low > least_part)) continue;
      covered[i] += part.high - part.low;
      parts.push_back(part);
    }
  }
  // 2. points on them
  std::vector<Facing> found;
  found.reserve(3 * parts.size());
  for (const auto& [s, weight] : gauss)
    for (const Part& part : parts) {
      const int i = part.own;
      const double width = part.high - part.low, at = part.low + 0.5 * (1.0 + s) * width;
      const double place = (at - part.ends[0]) / (part.ends[1] - part.ends[0]);
      const double gap = part.gaps[0] + place * (part.gaps[1] - part.gaps[0]);
      if (gap > reach[i] || gap < -depth[i]) continue;
      const double *a = end(own, i, 0), *b = end(own, i, 1);
      const double across = thickness > 0.0 ? thickness : 2.0 * std::numbers::pi * (a[0] + at * (b[0] - a[0]));
      const double area = 0.5 * weight * width / std::max(covered[i], 1.0) * length[i] * across;
      found.push_back({i, part.other, {1.0 - at, at}, {1.0 - place, place}, gap, area});
    }
  return found;
}

}  // namespace presswork
