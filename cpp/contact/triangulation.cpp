// SPDX-License-Identifier: Apache-2.0
// Triangles and their pseudonormals, and the search for the nearest; the tree is made in triangulation_tree.cpp.
#include "contact/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

// A directed edge of a triangle under its undirected name.
struct HalfEdge {
  int low, high, triangle, k;
  bool along;  // from low to high
};

}  // namespace

Triangulation::Triangulation(int n_points, const double* points, int n, const int* triangles, double depth)
    : points_(points, points + 3 * static_cast<std::size_t>(n_points)) {
  tree_.depth = depth;
  if (n < 1) throw std::invalid_argument("a tool surface needs a triangle");
  if (!(depth > 0.0)) throw std::invalid_argument("depth must be positive");
  for (double p : points_)
    if (!std::isfinite(p)) throw std::invalid_argument("points of a tool surface must be finite");
  corners_.assign(triangles, triangles + 3 * static_cast<std::size_t>(n));
  for (int i : corners_)
    if (i < 0 || i >= n_points) throw std::invalid_argument("a triangle names a point that is not there");
  set_triangles();
  set_pseudonormals();
  // boxes of the triangles, relative to the middle of all
  double low[3], high[3], size = 0.0;
  for (int k = 0; k < 3; ++k) {
    low[k] = std::numeric_limits<double>::infinity(), high[k] = -low[k];
    for (int i : corners_) {
      low[k] = std::min(low[k], points_[3 * i + k]), high[k] = std::max(high[k], points_[3 * i + k]);
    }
    tree_.origin[k] = 0.5 * (low[k] + high[k]), size = std::max(size, high[k] - low[k]);
  }
  tree_.padding = static_cast<float>(1e-6 * size);
  std::vector<float> boxes(6 * static_cast<std::size_t>(n));
  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k) {
      double p[3];
      for (int c = 0; c < 3; ++c) p[c] = points_[3 * corners_[3 * t + c] + k] - tree_.origin[k];
      boxes[6 * t + k] = static_cast<float>(std::min({p[0], p[1], p[2]})) - tree_.padding;
      boxes[6 * t + 3 + k] = static_cast<float>(std::max({p[0], p[1], p[2]})) + tree_.padding;
    }
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  leaf_of_.resize(n);
  tree_.root = build(order.data(), n, boxes);
  set_surroundings(boxes);
  tree_.triangles = triangles_.data(), tree_.corners = corners_.data(), tree_.leaf_of = leaf_of_.data();
  tree_.edge_normals = edge_normals_.data(), tree_.vertex_normals = vertex_normals_.data();
  tree_.nodes = nodes_.data(), tree_.leaves = leaves_.data(), tree_.around = around_.data();
  tree_.n = n, tree_.n_points = n_points;
  tree_.n_nodes = static_cast<int>(nodes_.size()), tree_.n_leaves = static_cast<int>(leaves_.size());
}

void Triangulation::set_triangles() {
  const int n = static_cast<int>(corners_.size()) / 3;
  triangles_.resize(n);
  for (int t = 0; t < n; ++t) {
    Triangle& tri = triangles_[t];
    for (int k = 0; k < 3; ++k) {
      tri.at[k] = points_[3 * corners_[3 * t] + k];
      for (int c = 0; c < 2; ++c) tri.edge[c][k] = points_[3 * corners_[3 * t + 1 + c] + k] - tri.at[k];
    }
    cross(tri.edge[0], tri.edge[1], tri.normal);
    const double aa = dot(tri.edge[0], tri.edge[0]), ab = dot(tri.edge[0], tri.edge[1]);
    const double bb = dot(tri.edge[1], tri.edge[1]), twice_area = std::sqrt(dot(tri.normal, tri.normal));
    if (!(twice_area > 1e-14 * std::max(aa, bb)))
      throw std::invalid_argument("triangle " + std::to_string(t) + " of the tool surface has no area");
    const double det = twice_area * twice_area;
    for (int k = 0; k < 3; ++k) {
      tri.normal[k] /= twice_area;
      tri.slope[0][k] = (bb * tri.edge[0][k] - ab * tri.edge[1][k]) / det;
      tri.slope[1][k] = (aa * tri.edge[1][k] - ab * tri.edge[0][k]) / det;
    }
  }
}

void Triangulation::set_pseudonormals() {
  const int n = static_cast<int>(triangles_.size());
  // 1. edges: the sum of both triangles' normals
  std::vector<HalfEdge> edges;
  edges.reserve(corners_.size());
  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = corners_[3 * t + k], b = corners_[3 * t + (k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::pair(a.low, a.high) != std::pair(b.low, b.high) ? std::pair(a.low, a.high) < std::pair(b.low, b.high)
                                                                : a.triangle < b.triangle;
  });
  edge_normals_.assign(3 * corners_.size(), 0.0);
  std::vector<std::uint8_t> open(points_.size() / 3, 0);
  for (std::size_t i = 0; i < edges.size();) {
    const HalfEdge& a = edges[i];
    std::size_t after = i + 1;
    while (after < edges.size() && edges[after].low == a.low && edges[after].high == a.high) ++after;
    const std::string name = "edge of points " + std::to_string(a.low) + " and " + std::to_string(a.high);
    if (after > i + 2) throw std::invalid_argument(name + " belongs to more than two triangles");
    if (after == i + 1) {
      open[a.low] = open[a.high] = 1;
    } else {
      const HalfEdge& b = edges[i + 1];
      if (a.along == b.along)
        throw std::invalid_argument("the two triangles at " + name + " are wound against each other");
      for (const HalfEdge* e : {&a, &b})
        for (int k = 0; k < 3; ++k)
          edge_normals_[9 * e->triangle + 3 * e->k + k] =
              triangles_[a.triangle].normal[k] + triangles_[b.triangle].normal[k];
    }
    i = after;
  }
  // 2. vertices: the triangles' normals weighted by their angles
  vertex_normals_.assign(points_.size(), 0.0);
  for (int t = 0; t < n; ++t)
    for (int c = 0; c < 3; ++c) {
      const int here = corners_[3 * t + c];
      if (open[here]) continue;
      double u[3], v[3], w[3];
      for (int k = 0; k < 3; ++k) {
        u[k] = points_[3 * corners_[3 * t + (c + 1) % 3] + k] - points_[3 * here + k];
        v[k] = points_[3 * corners_[3 * t + (c + 2) % 3] + k] - points_[3 * here + k];
      }
      cross(u, v, w);
      const double angle = std::atan2(std::sqrt(dot(w, w)), dot(u, v));
      for (int k = 0; k < 3; ++k) vertex_normals_[3 * here + k] += angle * triangles_[t].normal[k];
    }
}

bool Triangulation::nearest(const double x[3], double reach, int& hint, Touch& touch) const {
  return tree_.nearest(x, reach, hint, touch);
}

}  // namespace presswork::contact
