// SPDX-License-Identifier: Apache-2.0
#include "remesh/smoothing.hpp"

#include <algorithm>
#include <limits>

namespace presswork {

namespace {

// The nodes at the other ends of the sides that meet at each node, in ascending order.
Rows find_linked_nodes(int n_points, Cells cells) {
  std::vector<int> first, second;
  first.reserve(8 * static_cast<std::size_t>(cells.n)), second.reserve(first.capacity());
  for (int cell = 0; cell < cells.n; ++cell)
    for (int a = 0; a < cells.corners; ++a) {
      const int here = cells.of(cell)[a], there = cells.of(cell)[(a + 1) % cells.corners];
      first.push_back(here), second.push_back(there), first.push_back(there), second.push_back(here);
    }
  const Rows ends = gather_by_key(first.data(), static_cast<int>(first.size()), n_points);
  Rows linked;
  linked.begin.push_back(0);
  for (int node = 0; node < n_points; ++node) {
    const auto begin = linked.value.size();
    for (int end : ends[node]) linked.value.push_back(second[end]);
    std::sort(linked.value.begin() + begin, linked.value.end());
    linked.value.erase(std::unique(linked.value.begin() + begin, linked.value.end()), linked.value.end());
    linked.begin.push_back(static_cast<int>(linked.value.size()));
  }
  return linked;
}

}  // namespace

double measure_quality(const double* points, const int* nodes) {
  double side[4][2], least = std::numeric_limits<double>::infinity(), square = 0.0;
  for (int a = 0; a < 4; ++a)
    for (int k = 0; k < 2; ++k) side[a][k] = points[2 * nodes[(a + 1) % 4] + k] - points[2 * nodes[a] + k];
  for (int a = 0; a < 4; ++a) {
    const double *out = side[a], *into = side[(a + 3) % 4];
    least = std::min(least, into[0] * out[1] - into[1] * out[0]);
    square += out[0] * out[0] + out[1] * out[1];
  }
  return 4.0 * least / square;
}

void smooth_cells(double* points, int n_points, Cells cells, int n_fixed, SmoothingRounds rounds) {
  const Rows linked = find_linked_nodes(n_points, cells);
  std::vector<double> moved(points, points + 2 * static_cast<std::size_t>(n_points)), quality(cells.n), now(cells.n);
  std::vector<char> back(n_points);
  for (int cell = 0; cell < cells.n; ++cell) quality[cell] = measure_quality(points, cells.of(cell));
  for (int round = 0; round < rounds.most; ++round) {
    for (int node = n_fixed; node < n_points; ++node)
      for (int k = 0; k < 2; ++k) {
        double sum = 0.0;
        for (int other : linked[node]) sum += points[2 * other + k];
        const double mean = sum / std::max<double>(1.0, static_cast<double>(linked[node].size()));
        moved[2 * node + k] = 0.5 * (points[2 * node + k] + mean);
      }
    for (int cell = 0; cell < cells.n; ++cell) now[cell] = measure_quality(moved.data(), cells.of(cell));
    bool is_settled = false;
    for (int retreat = 0; retreat < rounds.most_retreats && !is_settled; ++retreat) {
      is_settled = true;
      std::fill(back.begin(), back.end(), 0);
      for (int cell = 0; cell < cells.n; ++cell)
        if (now[cell] < quality[cell] && now[cell] < rounds.good) {
          is_settled = false;
          for (int a = 0; a < 4; ++a) back[cells.of(cell)[a]] = 1;
        }
      if (is_settled) break;
      for (int node = 0; node < n_points; ++node)
        if (back[node]) std::copy(points + 2 * node, points + 2 * node + 2, moved.data() + 2 * node);
      for (int cell = 0; cell < cells.n; ++cell) {
        const int* nodes = cells.of(cell);
        if (back[nodes[0]] || back[nodes[1]] || back[nodes[2]] || back[nodes[3]])
          now[cell] = measure_quality(moved.data(), nodes);
      }
    }
    if (!is_settled) return;
    std::copy(moved.begin(), moved.end(), points);
    quality.swap(now);
  }
}

}  // namespace presswork
