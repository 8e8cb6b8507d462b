// SPDX-License-Identifier: Apache-2.0
// Surface of a rigid tool as triangles, counter-clockwise as seen from free space: closed or open.
//
// The nearest triangle is found by a tree of boxes with eight children, tested at once in single precision, as are the
// eight triangles of a leaf by a lower bound of their distance; those that remain are measured in double precision.
// Where the point was found last bounds the search: at a distance d from there nothing farther from it than 2 d can be
// nearer, so next to a warm hint its leaf and the leaves around are looked at instead of the tree. Sign and normal come
// from the nearest feature: a triangle's normal inside it, on an edge or vertex the pseudonormals of Baerentzen &
// Aanaes (2005), the sum of the triangles' normals weighted by their angles there, which give the right sign for every
// manifold. Equal distances go to the triangle with the lower number: so the answer does not depend on the hint. Beyond
// an open edge there is no tool.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/touch.hpp"
#include "contact/vectors.hpp"

namespace presswork::contact {

class Triangulation {
 public:
  // points (n_points, 3) [mm], triangles (n, 3). Throws std::invalid_argument where a triangle has no area, an edge
  // belongs to more than two triangles or neighbours are wound against each other.
  Triangulation(int n_points, const double* points, int n, const int* triangles, double depth);

  // As ToolSurface::nearest; hint becomes the triangle.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const;

  double depth() const { return depth_; }

  const std::vector<double>& points() const { return points_; }          // (n_points, 3)
  const std::vector<std::int32_t>& corners() const { return corners_; }  // (n, 3)

  int size() const { return static_cast<int>(triangles_.size()); }
  int corner(int triangle, int k) const { return corners_[3 * triangle + k]; }
  const double* point(int triangle, int k) const { return &points_[3 * corner(triangle, k)]; }
  const double* normal(int triangle) const { return triangles_[triangle].normal; }

 private:
  static constexpr int width = 8;
  typedef float Floats __attribute__((vector_size(width * sizeof(float))));
  struct Triangle {
    double at[3], normal[3];  // first corner, unit normal
    double slope[2][3];       // of the barycentric coordinates of the second and third corner
    double edge[2][3];        // to the second and third corner
  };
  struct Node {
    Floats low[3], high[3];     // relative to origin_
    std::int32_t child[width];  // node, or -1 - leaf
  };
  // Planes of its triangles: their own, and the three through their sides at right angles to it, outside positive. The
  // root of the squares of the distance from the first and from the farthest of the others is a lower bound.
  struct Leaf {
    Floats plane[4][4];  // unit normal, offset
    std::int32_t triangle[width];
  };
  // The leaves around a leaf, nearest boxes first, and how far the first box of each pack is, and the first left out.
  struct Around {
    static constexpr int packs = 4;
    Node pack[packs];
    float distance2[packs + 1];
  };
  // The nearest place: distance squared, triangle, and feature: 0 inside, 1 + k edge from corner k, 4 + k corner k.
  struct Near {
    double distance2;
    int triangle, feature;
    double point[3];
  };

  void set_triangles();
  void set_pseudonormals();
  std::int32_t build(std::int32_t* order, int n, const std::vector<float>& boxes);
  std::int32_t make_leaf(const std::int32_t* triangles, int n);
  void set_surroundings(const std::vector<float>& boxes);
  // Squared distances of a node's boxes from the box between low and high.
  static Floats distance2_to(const Node& node, const float low[3], const float high[3]) {
    Floats distance2{};
    for (int k = 0; k < 3; ++k) {
      const Floats off = larger(larger(node.low[k] - high[k], low[k] - node.high[k]), Floats{});
      distance2 += off * off;
    }
    return distance2;
  }
  double distance_to_sides(int triangle, const double place[3], double distance) const;
  void measure(int triangle, const double x[3], Near& near) const;
  void measure_leaf(int leaf, const float at[3], const double x[3], Near& near, float& bound) const;
  void search(const double x[3], int hint, Near& near) const;
  void descend(const float at[3], const double x[3], Near& near, float& bound) const;
  // A bound of squared distances for single precision, which takes less than p, the boxes' padding, from a distance d:
  // (d + p)^2 < (1 + e) d^2 + (1 + 1/e) p^2.
  float widen(double distance2) const { return static_cast<float>(distance2) * 1.001f + 1001.0f * padding_ * padding_; }

  double depth_;
  std::vector<double> points_;
  std::vector<std::int32_t> corners_;  // (n, 3)
  std::vector<Triangle> triangles_;
  std::vector<double> edge_normals_;    // (n, 3, 3): of the edge from corner k; zero on an open edge
  std::vector<double> vertex_normals_;  // (n_points, 3); zero on an open edge
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<Around> around_;         // (n_leaves)
  std::vector<std::int32_t> leaf_of_;  // (n): the leaf of each triangle
  std::int32_t root_;
  double origin_[3];
  float padding_;  // of boxes for single precision
};

}  // namespace presswork::contact
