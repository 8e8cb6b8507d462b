// SPDX-License-Identifier: Apache-2.0
// The tree of boxes over a triangulation, and the leaves around each leaf.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "contact/triangulation.hpp"

namespace presswork::contact {

// A node or leaf over n triangles of `order`; children are filled to the brim, parts split across their longest side.
std::int32_t Triangulation::build(std::int32_t* order, int n, const std::vector<float>& boxes) {
  if (n <= width) return -1 - make_leaf(order, n);
  int capacity = width;  // of a child
  while (capacity * width < n) capacity *= width;
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  std::vector<std::pair<int, int>> parts{{0, n}};
  for (std::size_t i = 0; i < parts.size();) {
    const auto [from, to] = parts[i];
    if (to - from <= capacity) {
      ++i;
      continue;
    }
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::numeric_limits<float>::infinity(), high[k] = -low[k];
      for (int j = from; j < to; ++j) {
        const float middle = boxes[6 * order[j] + k] + boxes[6 * order[j] + 3 + k];
        low[k] = std::min(low[k], middle), high[k] = std::max(high[k], middle);
      }
    }
    int k = 0;
    for (int other = 1; other < 3; ++other)
      if (high[other] - low[other] > high[k] - low[k]) k = other;
    const int children = (to - from + capacity - 1) / capacity, cut = from + (children / 2) * capacity;
    std::nth_element(order + from, order + cut, order + to, [&](int a, int b) {
      const float at_a = boxes[6 * a + k] + boxes[6 * a + 3 + k], at_b = boxes[6 * b + k] + boxes[6 * b + 3 + k];
      return at_a != at_b ? at_a < at_b : a < b;
    });
    parts[i] = {from, cut};
    parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1, {cut, to});
  }
  for (int c = 0; c < width; ++c) {
    constexpr float far = std::numeric_limits<float>::infinity();
    for (int k = 0; k < 3; ++k) nodes_[index].low[k][c] = far, nodes_[index].high[k][c] = -far;
    nodes_[index].child[c] = -1;  // whose distance is infinite
    if (c >= static_cast<int>(parts.size())) continue;
    const auto [from, to] = parts[c];
    for (int j = from; j < to; ++j)
      for (int k = 0; k < 3; ++k) {
        nodes_[index].low[k][c] = std::min<float>(nodes_[index].low[k][c], boxes[6 * order[j] + k]);
        nodes_[index].high[k][c] = std::max<float>(nodes_[index].high[k][c], boxes[6 * order[j] + 3 + k]);
      }
    const std::int32_t child = build(order + from, to - from, boxes);
    nodes_[index].child[c] = child;
  }
  return index;
}

std::int32_t Triangulation::make_leaf(const std::int32_t* triangles, int n) {
  Leaf leaf{};
  for (int c = 0; c < width; ++c) {
    leaf.triangle[c] = c < n ? triangles[c] : -1;
    if (c >= n) {  // infinitely far
      leaf.plane[0][3][c] = std::numeric_limits<float>::infinity();
      continue;
    }
    leaf_of_[triangles[c]] = static_cast<std::int32_t>(leaves_.size());
    const Triangle& t = triangles_[triangles[c]];
    double planes[4][3], on[4][3], side[3];
    for (int k = 0; k < 3; ++k) {
      planes[0][k] = t.normal[k], side[k] = t.edge[1][k] - t.edge[0][k];
      on[0][k] = on[1][k] = on[3][k] = t.at[k] - tree_.origin[k];
      on[2][k] = on[0][k] + t.edge[0][k];
    }
    cross(t.edge[0], t.normal, planes[1]);
    cross(side, t.normal, planes[2]);
    cross(t.normal, t.edge[1], planes[3]);
    for (int p = 0; p < 4; ++p) {
      const double length = std::sqrt(dot(planes[p], planes[p]));
      for (int k = 0; k < 3; ++k) leaf.plane[p][k][c] = static_cast<float>(planes[p][k] / length);
      leaf.plane[p][3][c] = static_cast<float>(-dot(planes[p], on[p]) / length);
    }
  }
  leaves_.push_back(leaf);
  return static_cast<std::int32_t>(leaves_.size()) - 1;
}

void Triangulation::set_surroundings(const std::vector<float>& boxes) {
  constexpr int most = Around::packs * width;
  constexpr float far = std::numeric_limits<float>::infinity();
  std::vector<std::array<float, 6>> box(leaves_.size());  // low, high
  for (std::size_t l = 0; l < leaves_.size(); ++l) {
    for (int k = 0; k < 3; ++k) box[l][k] = far, box[l][3 + k] = -far;
    for (std::int32_t t : leaves_[l].triangle)
      for (int k = 0; t >= 0 && k < 3; ++k) {
        box[l][k] = std::min(box[l][k], boxes[6 * t + k]),
        box[l][3 + k] = std::max(box[l][3 + k], boxes[6 * t + 3 + k]);
      }
  }
  around_.resize(leaves_.size());
  std::vector<std::pair<float, std::int32_t>> nearest, stack;  // squared distance, leaf or node
  for (std::size_t l = 0; l < leaves_.size(); ++l) {
    // the `most` nearest leaves, and how far the next is, kept as a heap with the farthest on top
    nearest.clear();
    stack.assign(1, {0.0f, tree_.root});
    while (!stack.empty()) {
      const auto [distance2, node] = stack.back();
      stack.pop_back();
      const bool full = nearest.size() > most;
      if (full && distance2 >= nearest.front().first) continue;
      if (node < 0) {
        if (-1 - node == static_cast<std::int32_t>(l)) continue;
        if (full) std::pop_heap(nearest.begin(), nearest.end()), nearest.pop_back();
        nearest.emplace_back(distance2, node);
        std::push_heap(nearest.begin(), nearest.end());
        continue;
      }
      const eights::AtOnce to_children =
          TriangleTree::distance2_to<eights::AtOnce>(nodes_[node], box[l].data(), box[l].data() + 3);
      const std::size_t from = stack.size();
      for (int c = 0; c < width; ++c)
        if (to_children[c] < far) stack.emplace_back(to_children[c], nodes_[node].child[c]);
      std::sort(stack.begin() + static_cast<std::ptrdiff_t>(from), stack.end(), std::greater<>());
    }
    std::sort(nearest.begin(), nearest.end());
    Around& around = around_[l];
    around.distance2[Around::packs] = nearest.size() > most ? nearest.back().first : far;
    for (int i = 0; i < most; ++i) {
      Node& pack = around.pack[i / width];
      const int c = i % width;
      const bool there = i < static_cast<int>(nearest.size());
      if (c == 0) around.distance2[i / width] = there ? nearest[i].first : far;
      for (int k = 0; k < 3; ++k) {
        pack.low[k][c] = there ? box[-1 - nearest[i].second][k] : far;
        pack.high[k][c] = there ? box[-1 - nearest[i].second][3 + k] : -far;
      }
      pack.child[c] = there ? nearest[i].second : -1;
    }
  }
}

}  // namespace presswork::contact
