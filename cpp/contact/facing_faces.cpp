// SPDX-License-Identifier: Apache-2.0
#include "contact/facing_faces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "contact/face_mortar.hpp"

namespace presswork {

namespace {

using contact::cross;
using contact::dot;
using face_mortar::Corners;

template <int nodes>
double measure(const Corners<nodes>& face) {
  double a[3], b[3], c[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = face.x[nodes == 3 ? 1 : 2][k] - face.x[0][k];
    b[k] = face.x[nodes == 3 ? 2 : 3][k] - face.x[nodes == 3 ? 0 : 1][k];
  }
  cross(a, b, c);
  return 0.5 * std::sqrt(dot(c, c));
}

bool share_node(const int* a, const int* b, int nodes) {
  return std::any_of(a, a + nodes, [&](int node) { return std::find(b, b + nodes, node) != b + nodes; });
}

template <int nodes>
FacingFaces find(const double* points, const FaceList& own, const FaceList& other, const double* reach) {
  // 1. faces, and how deep they may overlap
  std::vector<Corners<nodes>> faces(own.n);
  std::vector<double> area(own.n), depth(own.n), covered(own.n, 0.0);
  double margin = 0.0;
  for (int i = 0; i < own.n; ++i) {
    faces[i].load(points, own.at(i));
    area[i] = measure<nodes>(faces[i]);
    depth[i] = std::max(reach[i], 0.5 * std::sqrt(area[i]));
    margin = std::max(margin, depth[i]);
  }
  // 2. points on the overlaps
  const face_mortar::Limits all{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::vector<face_mortar::RulePoint> rule;
  FacingFaces found;
  for (const auto& [i, j] : find_face_pairs(own, other, points, margin, false)) {
    if (share_node(own.at(i), other.at(j), nodes)) continue;
    Corners<nodes> opposite;
    opposite.load(points, other.at(j));
    face_mortar::Facing<nodes> pair(faces[i], opposite);
    if (pair.find(all) != face_mortar::Overlap::found) continue;
    rule.clear();
    pair.list_points(rule);
    for (const auto& at : rule) {
      double N[nodes], M[nodes], dN[nodes][2], x[3], y[3], t[2][3], s[2][3], normal[3];
      faces[i].place(at.slave, N, dN, x, t);
      cross(t[0], t[1], normal);
      opposite.place(at.master, M, dN, y, s);
      const double way[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, gap = dot(pair.plane.normal, way);
      if (gap > reach[i] || gap < -depth[i]) continue;
      found.own.push_back(i), found.other.push_back(j);
      found.own_shape.insert(found.own_shape.end(), N, N + nodes);
      found.other_shape.insert(found.other_shape.end(), M, M + nodes);
      found.gap.push_back(gap);
      found.area.push_back(at.weight / pair.share * std::sqrt(dot(normal, normal)));  // all of it counts
      covered[i] += found.area.back() / area[i];
    }
  }
  // 3. parts that several others cover
  for (std::size_t p = 0; p < found.own.size(); ++p) found.area[p] /= std::max(covered[found.own[p]], 1.0);
  return found;
}

}  // namespace

FacingFaces find_facing_faces(const double* points, const FaceList& own, const FaceList& other, const double* reach) {
  return own.nodes == 3 ? find<3>(points, own, other, reach) : find<4>(points, own, other, reach);
}

}  // namespace presswork
