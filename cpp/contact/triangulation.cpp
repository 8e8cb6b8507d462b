// SPDX-License-Identifier: Apache-2.0
// Triangles and their pseudonormals, and the search for the nearest; the tree is made in triangulation_tree.cpp.
#include "contact/triangulation.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

constexpr int none = std::numeric_limits<int>::max();  // triangle

// A directed edge of a triangle under its undirected name.
struct HalfEdge {
  int low, high, triangle, k;
  bool along;  // from low to high
};

// Bits of the lanes below the bound; empty lanes are infinite.
template <class V>
unsigned lanes_within(V values, float bound) {
  const auto mask = values < bound;
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (mask[i] != 0 ? 1u : 0u) << i;
  return bits;
#endif
}

}  // namespace

Triangulation::Triangulation(int n_points, const double* points, int n, const int* triangles, double depth)
    : depth_(depth), points_(points, points + 3 * static_cast<std::size_t>(n_points)) {
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
    origin_[k] = 0.5 * (low[k] + high[k]), size = std::max(size, high[k] - low[k]);
  }
  padding_ = static_cast<float>(1e-6 * size);
  std::vector<float> boxes(6 * static_cast<std::size_t>(n));
  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k) {
      double p[3];
      for (int c = 0; c < 3; ++c) p[c] = points_[3 * corners_[3 * t + c] + k] - origin_[k];
      boxes[6 * t + k] = static_cast<float>(std::min({p[0], p[1], p[2]})) - padding_;
      boxes[6 * t + 3 + k] = static_cast<float>(std::max({p[0], p[1], p[2]})) + padding_;
    }
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  leaf_of_.resize(n);
  root_ = build(order.data(), n, boxes);
  set_surroundings(boxes);
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

// Take the triangle if it is nearer than what is known, or as near with a lower number.
void Triangulation::measure(int t, const double x[3], Near& near) const {
  const Triangle& tri = triangles_[t];
  const double d[3] = {x[0] - tri.at[0], x[1] - tri.at[1], x[2] - tri.at[2]};
  const double height = dot(d, tri.normal);
  if (height * height > near.distance2) return;
  double v = dot(d, tri.slope[0]), w = dot(d, tri.slope[1]);
  int feature = 0;
  if (v < 0.0 || w < 0.0 || v + w > 1.0) {
    // the nearest place of the sides beyond which the point lies; side k goes from corner k to the next
    const double *a = tri.edge[0], *b = tri.edge[1];
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), along_a = dot(d, a), along_b = dot(d, b);
    double least = std::numeric_limits<double>::infinity(), foot[2] = {0.0, 0.0};
    auto take_side = [&](int k, double along, double v0, double w0, double dv, double dw) {
      const double f = std::min(std::max(along, 0.0), 1.0);
      const double p = v0 + f * dv, q = w0 + f * dw;
      const double size = (p - v) * (p - v) * aa + 2.0 * (p - v) * (q - w) * ab + (q - w) * (q - w) * bb;
      if (size >= least) return;
      least = size, foot[0] = p, foot[1] = q, feature = f == 0.0 ? 4 + k : f == 1.0 ? 4 + (k + 1) % 3 : 1 + k;
    };
    if (w < 0.0) take_side(0, along_a / aa, 0.0, 0.0, 1.0, 0.0);
    if (v + w > 1.0) take_side(1, (along_b - along_a - ab + aa) / (aa - 2.0 * ab + bb), 1.0, 0.0, -1.0, 1.0);
    if (v < 0.0) take_side(2, 1.0 - along_b / bb, 0.0, 1.0, 0.0, -1.0);
    v = foot[0], w = foot[1];
  }
  double point[3], off2 = 0.0;
  for (int k = 0; k < 3; ++k) {
    point[k] = v * tri.edge[0][k] + w * tri.edge[1][k];
    off2 += (d[k] - point[k]) * (d[k] - point[k]);
  }
  off2 = feature == 0 ? height * height : std::max(off2, height * height);  // as above: no order may matter
  if (off2 > near.distance2 || (off2 == near.distance2 && t > near.triangle)) return;
  near.distance2 = off2, near.triangle = t, near.feature = feature;
  for (int k = 0; k < 3; ++k) near.point[k] = tri.at[k] + point[k];
}

void Triangulation::measure_leaf(int index, const float at[3], const double x[3], Near& near, float& bound) const {
  const Leaf& leaf = leaves_[index];
  Floats off[4];
  for (int p = 0; p < 4; ++p)
    off[p] = leaf.plane[p][0] * at[0] + leaf.plane[p][1] * at[1] + leaf.plane[p][2] * at[2] + leaf.plane[p][3];
  const Floats beyond = larger(larger(off[1], off[2]), larger(off[3], Floats{}));
  unsigned within = lanes_within(off[0] * off[0] + beyond * beyond, bound);
  for (; within != 0; within &= within - 1) measure(leaf.triangle[std::countr_zero(within)], x, near);
  bound = widen(near.distance2);
}

void Triangulation::search(const double x[3], int hint, Near& near) const {
  float at[3];
  for (int k = 0; k < 3; ++k) at[k] = static_cast<float>(x[k] - origin_[k]);
  float bound = widen(near.distance2);
  if (hint >= 0 && hint < static_cast<int>(triangles_.size())) {
    const int home = leaf_of_[hint];
    measure(hint, x, near);
    bound = widen(near.distance2);
    measure_leaf(home, at, x, near, bound);
    const Around& around = around_[home];
    const float around2 = near.triangle == none ? std::numeric_limits<float>::infinity() : 4.0f * bound;
    if (around2 < around.distance2[Around::packs]) {
      for (int p = 0; p < Around::packs && around.distance2[p] <= around2; ++p) {
        const Node& pack = around.pack[p];
        for (unsigned within = lanes_within(distance2_to(pack, at, at), bound); within != 0; within &= within - 1)
          measure_leaf(-1 - pack.child[std::countr_zero(within)], at, x, near, bound);
      }
      return;
    }
  }
  descend(at, x, near, bound);
}

void Triangulation::descend(const float at[3], const double x[3], Near& near, float& bound) const {
  struct Entry {
    std::int32_t node;
    float distance2;
  } stack[128];
  int count = 0;
  stack[count++] = {root_, 0.0f};
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.distance2 > bound) continue;
    if (entry.node < 0) {
      measure_leaf(-1 - entry.node, at, x, near, bound);
      continue;
    }
    const Node& node = nodes_[entry.node];
    const Floats distance2 = distance2_to(node, at, at);
    // the nearest child goes on top of the stack
    const int from = count;
    for (unsigned within = lanes_within(distance2, bound); within != 0; within &= within - 1) {
      const int c = std::countr_zero(within);
      const float d2 = distance2[c];
      int i = count++;
      for (; i > from && stack[i - 1].distance2 < d2; --i) stack[i] = stack[i - 1];
      stack[i] = {node.child[c], d2};
    }
  }
}

bool Triangulation::nearest(const double x[3], double reach, int& hint, Touch& touch) const {
  const double bound = std::max(reach, depth_);
  Near near{bound * bound, none, 0, {}};
  search(x, hint, near);
  touch.gap = std::sqrt(near.distance2), touch.past_rim = false;
  if (near.triangle == none) return false;
  hint = near.triangle;
  // the normal of the feature gives the sign, and the normal of the touch when the point lies on it
  const Triangle& tri = triangles_[near.triangle];
  const int k = near.feature == 0 ? 0 : (near.feature - 1) % 3;
  const double* normal = near.feature == 0  ? tri.normal
                         : near.feature < 4 ? &edge_normals_[9 * near.triangle + 3 * k]
                                            : &vertex_normals_[3 * corners_[3 * near.triangle + k]];
  const double from[3] = {x[0] - near.point[0], x[1] - near.point[1], x[2] - near.point[2]};
  double height = dot(from, tri.normal);
  double length2 = dot(normal, normal);
  const double distance = touch.gap, tolerance = 1e-3 * padding_;
  if (length2 == 0.0) {  // an open edge: straight above it counts as inside
    touch.past_rim = near.distance2 - height * height > tolerance * tolerance + 1e-14 * near.distance2;
    if (touch.past_rim) return false;
    normal = tri.normal, length2 = 1.0;
  } else if (near.feature != 0) {
    height = std::copysign(distance, dot(from, normal));
  }
  if (height >= reach || height < -depth_) {
    touch.gap = height > 0.0 ? distance : distance - depth_;
    return false;
  }
  touch.gap = height;
  const bool on_it = near.feature == 0 || distance < tolerance;
  const double scale = on_it ? 1.0 / std::sqrt(length2) : 1.0 / height;
  for (int i = 0; i < 3; ++i) touch.normal[i] = scale * (on_it ? normal[i] : from[i]), touch.point[i] = near.point[i];
  touch.flat = near.feature == 0 ? distance_to_sides(near.triangle, near.point, distance) : 0.0;
  return true;
}

// How far a point at this distance above a place inside the triangle may move along it until it is as near to the
// neighbour behind one of the sides, should that one rise.
double Triangulation::distance_to_sides(int t, const double place[3], double distance) const {
  const Triangle& tri = triangles_[t];
  double d[3], both[3];
  for (int k = 0; k < 3; ++k) d[k] = place[k] - tri.at[k], both[k] = tri.slope[0][k] + tri.slope[1][k];
  const double v = dot(d, tri.slope[0]), w = dot(d, tri.slope[1]);
  const double to_side[3] = {w / std::sqrt(dot(tri.slope[1], tri.slope[1])), (1.0 - v - w) / std::sqrt(dot(both, both)),
                             v / std::sqrt(dot(tri.slope[0], tri.slope[0]))};
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double* sum = &edge_normals_[9 * t + 3 * k];  // of the two unit normals: 2 cos of half the angle between them
    const double length2 = dot(sum, sum), tangent2 = length2 > 0.0 ? std::max(0.0, 4.0 / length2 - 1.0) : 0.0;
    least = std::min(least, to_side[k] - distance * std::sqrt(tangent2));
  }
  return least;
}

}  // namespace presswork::contact
