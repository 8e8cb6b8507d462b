// SPDX-License-Identifier: Apache-2.0
#include "contact/near_shells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace presswork::contact {

namespace {

// Centres of cells in cubes, each cube's cells in a bucket of a hash table in rising order.
class Cubes {
 public:
  Cubes(std::size_t n, double size) : size_(size), at_(n), start_(buckets_for(n) + 1, 0) {}

  void place(int cell, const double centre[3]) {
    at_[cell] = cube_of(centre);
    ++start_[bucket(at_[cell]) + 1];
  }
  void close(const std::vector<char>& placed) {
    for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
    cells_.resize(start_.back());
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (int c = 0; c < static_cast<int>(at_.size()); ++c)
      if (placed[c]) cells_[next[bucket(at_[c])]++] = c;
  }
  // Append the cells of the 27 cubes round a place to a list.
  void list_around(const double x[3], std::vector<int>& found) const {
    const Cube middle = cube_of(x);
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k) {
          const Cube cube{middle.i + i, middle.j + j, middle.k + k};
          const std::size_t b = bucket(cube);
          for (int s = start_[b]; s < start_[b + 1]; ++s)
            if (at_[cells_[s]] == cube) found.push_back(cells_[s]);
        }
  }

 private:
  struct Cube {
    std::int64_t i, j, k;
    bool operator==(const Cube&) const = default;
  };
  static std::size_t buckets_for(std::size_t n) {
    std::size_t buckets = 16;
    while (buckets < 2 * n) buckets *= 2;
    return buckets;
  }
  Cube cube_of(const double x[3]) const {
    const auto of = [this](double along) {
      const double cube = std::floor(along / size_);
      return std::abs(cube) < 1e15 ? static_cast<std::int64_t>(cube) : 0;  // what flies off to infinity
    };
    return {of(x[0]), of(x[1]), of(x[2])};
  }
  std::size_t bucket(const Cube& c) const {
    const auto mixed = static_cast<std::uint64_t>(c.i) * 73856093u ^ static_cast<std::uint64_t>(c.j) * 19349663u ^
                       static_cast<std::uint64_t>(c.k) * 83492791u;
    return mixed & (start_.size() - 2);
  }

  double size_;
  std::vector<Cube> at_;
  std::vector<int> start_, cells_;
};

}  // namespace

// From each node over cells whose closest place lies within the radius, and that hang together with it so near.
void NearShells::leave_out_near(const double* undeformed, double radius) {
  left_out_start_.assign(1, 0);
  std::vector<int> seen(cell_start_.size(), -1), found;
  for (int node = 0; node < n_nodes_; ++node) {
    const double* x = undeformed + 3 * std::size_t(node);
    found.clear();
    const auto enter = [&](int of) {
      for (int s = node_start_[of]; s < node_start_[of + 1]; ++s) {
        const int cell = node_cell_[s], n = corners(cell);
        if (seen[cell] == node) continue;
        seen[cell] = node;
        double corner[4][3];
        for (int a = 0; a < n; ++a)
          std::copy_n(undeformed + 3 * std::size_t(cell_node_[cell_start_[cell] + a]), 3, corner[a]);
        if (find_closest_on_cell(x, n, corner).squared < radius * radius) found.push_back(cell);
      }
    };
    enter(node);
    for (std::size_t i = 0; i < found.size(); ++i)
      for (int s = cell_start_[found[i]]; s < cell_start_[found[i] + 1]; ++s) enter(cell_node_[s]);
    std::sort(found.begin(), found.end());
    left_out_.insert(left_out_.end(), found.begin(), found.end());
    left_out_start_.push_back(static_cast<int>(left_out_.size()));
  }
}

NearShells::NearShells(int n_nodes, std::vector<int> cell_start, std::vector<int> cell_node, const double* undeformed,
                       double thickness)
    : n_nodes_(n_nodes),
      cell_start_(std::move(cell_start)),
      cell_node_(std::move(cell_node)),
      node_start_(n_nodes + 1, 0),
      node_cell_(cell_node_.size()),
      node_corner_(cell_node_.size()) {
  for (int node : cell_node_) ++node_start_[node + 1];
  for (int i = 0; i < n_nodes; ++i) node_start_[i + 1] += node_start_[i];
  std::vector<int> next(node_start_.begin(), node_start_.end() - 1);
  for (int c = 0; c + 1 < static_cast<int>(cell_start_.size()); ++c)
    for (int at = cell_start_[c]; at < cell_start_[c + 1]; ++at) {
      const int to = next[cell_node_[at]]++;
      node_cell_[to] = c, node_corner_[to] = at - cell_start_[c];
    }
  leave_out_near(undeformed, fold * thickness);
}

void NearShells::list_near(const double* position, int stride, const std::vector<double>& half_node,
                           const std::vector<double>& half_cell, double margin, Entries& entries) const {
  const int n_cells = static_cast<int>(half_cell.size());
  // 1. cells as spheres, in cubes as large as the farthest that any node may look
  std::vector<double> centre(3 * std::size_t(n_cells), 0.0), radius(n_cells, 0.0);
  std::vector<char> placed(n_cells, 0);
  double largest = 0.0, thickest = 0.0;
  for (int c = 0; c < n_cells; ++c) {
    const int n = corners(c);
    if (n == 0) continue;
    double* middle = &centre[3 * std::size_t(c)];
    const auto place = [&](int a) { return position + stride * std::size_t(cell_node_[cell_start_[c] + a]); };
    for (int a = 0; a < n; ++a)
      for (int i = 0; i < 3; ++i) middle[i] += place(a)[i] / n;
    double squared = 0.0;
    for (int a = 0; a < n; ++a) {
      double d[3];
      for (int i = 0; i < 3; ++i) d[i] = place(a)[i] - middle[i];
      squared = std::max(squared, dot(d, d));
    }
    radius[c] = std::sqrt(squared), placed[c] = 1;
    largest = std::max(largest, radius[c]), thickest = std::max(thickest, half_cell[c]);
  }
  for (double half : half_node) thickest = std::max(thickest, half);
  Cubes cubes(n_cells, 2.0 * thickest + margin + largest);
  for (int c = 0; c < n_cells; ++c)
    if (placed[c]) cubes.place(c, &centre[3 * std::size_t(c)]);
  cubes.close(placed);
  // 2. cells near each node
  entries.start.assign(1, 0), entries.cell.clear(), entries.node.clear(), entries.gap.clear();
  std::vector<int> near;
  for (int node = 0; node < n_nodes_; ++node) {
    near.clear();
    const double* x = position + stride * std::size_t(node);
    if (node_start_[node] < node_start_[node + 1]) cubes.list_around(x, near);
    std::sort(near.begin(), near.end());
    const auto out = left_out_.begin() + left_out_start_[node], out_end = left_out_.begin() + left_out_start_[node + 1];
    for (int cell : near) {
      const double touching = half_node[node] + half_cell[cell], reach = touching + margin + radius[cell];
      double d[3];
      for (int i = 0; i < 3; ++i) d[i] = x[i] - centre[3 * std::size_t(cell) + i];
      if (dot(d, d) > reach * reach || std::binary_search(out, out_end, cell)) continue;
      double corner[4][3];
      for (int a = 0; a < corners(cell); ++a)
        std::copy_n(position + stride * std::size_t(cell_node_[cell_start_[cell] + a]), 3, corner[a]);
      const double gap = std::sqrt(find_closest_on_cell(x, corners(cell), corner).squared) - touching;
      if (gap > margin) continue;
      entries.cell.push_back(cell), entries.node.push_back(node), entries.gap.push_back(gap);
    }
    entries.start.push_back(static_cast<int>(entries.cell.size()));
  }
}

}  // namespace presswork::contact
