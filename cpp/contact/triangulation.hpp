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

#include "contact/triangle_search.hpp"

namespace presswork::contact {

class Triangulation {
 public:
  // points (n_points, 3) [mm], triangles (n, 3). Throws std::invalid_argument where a triangle has no area, an edge
  // belongs to more than two triangles or neighbours are wound against each other.
  Triangulation(int n_points, const double* points, int n, const int* triangles, double depth);
  Triangulation(Triangulation&&) = default;  // not copied: the tree knows where its parts lie
  Triangulation& operator=(Triangulation&&) = default;

  // As ToolSurface::nearest; hint becomes the triangle.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const;
  // The search, on the tree of this surface: good for as long as it lives.
  const TriangleTree& tree() const { return tree_; }

  double depth() const { return tree_.depth; }

  const std::vector<double>& points() const { return points_; }          // (n_points, 3)
  const std::vector<std::int32_t>& corners() const { return corners_; }  // (n, 3)

  int size() const { return static_cast<int>(triangles_.size()); }
  int corner(int triangle, int k) const { return corners_[3 * triangle + k]; }
  const double* point(int triangle, int k) const { return &points_[3 * corner(triangle, k)]; }
  const double* normal(int triangle) const { return triangles_[triangle].normal; }

 private:
  static constexpr int width = TriangleTree::width;
  using Triangle = TriangleTree::Triangle;
  using Node = TriangleTree::Node;
  using Leaf = TriangleTree::Leaf;
  using Around = TriangleTree::Around;

  void set_triangles();
  void set_pseudonormals();
  std::int32_t build(std::int32_t* order, int n, const std::vector<float>& boxes);
  std::int32_t make_leaf(const std::int32_t* triangles, int n);
  void set_surroundings(const std::vector<float>& boxes);
  std::vector<double> points_;
  std::vector<std::int32_t> corners_;  // (n, 3)
  std::vector<Triangle> triangles_;
  std::vector<double> edge_normals_;    // (n, 3, 3): of the edge from corner k; zero on an open edge
  std::vector<double> vertex_normals_;  // (n_points, 3); zero on an open edge
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<Around> around_;         // (n_leaves)
  std::vector<std::int32_t> leaf_of_;  // (n): the leaf of each triangle
  TriangleSearch<eights::AtOnce> tree_;
};

}  // namespace presswork::contact
