// SPDX-License-Identifier: Apache-2.0
// Segment-to-segment contact of two faces in space: where they lie opposite each other, and the terms of a mortar
// method at the points of a rule there.
//
// Faces are triangles or bilinear quadrilaterals, wound outwards. Both are projected along the normal at the middle of
// the slave onto the plane there; the overlap is a polygon (Sutherland & Hodgman 1974), which is cut into triangles
// with a rule each that integrates products of two shape functions exactly on parallelograms. Puso & Laursen 2004,
// Computer Methods in Applied Mechanics and Engineering 193.
//
// Derivatives hold a point at its place on the slave: what leaves one master face enters the next, and the integrand is
// the same on both sides, so the sums of all faces have the derivatives of the integrals. Only where the master ends
// on a slave face is the motion of that rim left out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include "contact/vectors.hpp"
#include "reference/quad.hpp"
#include "reference/tri.hpp"

namespace presswork::face_mortar {

using contact::cross;
using contact::dot;

// Cosine between the faces' normals above which they do not face each other, and below which they do in full.
inline constexpr double facing = -0.3, facing_in_full = -0.7;

enum class Overlap { none, apart, too_deep, found };

struct Limits {
  double reach;  // a gap in the middle larger than this counts as no contact [mm]
  double depth;  // and so does a penetration deeper than this
};

template <int nodes>
using Face = std::conditional_t<nodes == 3, Tri3, Quad4>;

using Matrix = std::array<std::array<double, 3>, 3>;

// A point of the rule: its coordinates on both faces, and its weight for the slave's coordinates.
struct RulePoint {
  double slave[2], master[2], weight;
};

struct Point2 {
  double x, y;
};

template <int nodes>
struct Corners {
  double x[nodes][3];

  void load(const double* points, const int* face) {
    for (int i = 0; i < nodes; ++i) std::copy_n(points + 3 * face[i], 3, x[i]);
  }
  void middle(double (&at)[2]) const { at[0] = at[1] = nodes == 3 ? 1.0 / 3.0 : 0.0; }
  // Place and tangents at a point of the face.
  void place(const double* at, double* N, double (*dN)[2], double (&p)[3], double (&t)[2][3]) const {
    Face<nodes>::shape(at, N, dN);
    for (int k = 0; k < 3; ++k) {
      p[k] = t[0][k] = t[1][k] = 0.0;
      for (int i = 0; i < nodes; ++i)
        p[k] += N[i] * x[i][k], t[0][k] += dN[i][0] * x[i][k], t[1][k] += dN[i][1] * x[i][k];
    }
  }
};

// d (t_1 x t_2) / d x_i with t_k = sum_i dN_ik x_i.
inline Matrix area_slope(const double (&t)[2][3], const double (&dN)[2]) {
  double a[3];
  for (int k = 0; k < 3; ++k) a[k] = dN[1] * t[0][k] - dN[0] * t[1][k];
  return {{{0.0, -a[2], a[1]}, {a[2], 0.0, -a[0]}, {-a[1], a[0], 0.0}}};
}

// The plane at the middle of the slave.
template <int nodes>
struct Plane {
  double origin[3], normal[3], along[2][3];
  Matrix slope[nodes];  // d normal / d x_i of the slave

  explicit Plane(const Corners<nodes>& slave) {
    double at[2], N[nodes], dN[nodes][2], t[2][3], c[3];
    slave.middle(at);
    slave.place(at, N, dN, origin, t);
    cross(t[0], t[1], c);
    const double size = std::sqrt(dot(c, c)), length = std::sqrt(dot(t[0], t[0]));
    for (int k = 0; k < 3; ++k) normal[k] = c[k] / size, along[0][k] = t[0][k] / length;
    cross(normal, along[0], along[1]);
    for (int i = 0; i < nodes; ++i) {
      const Matrix of_area = area_slope(t, dN[i]);
      for (int j = 0; j < 3; ++j) {
        double out = 0.0;
        for (int k = 0; k < 3; ++k) out += normal[k] * of_area[k][j];
        for (int k = 0; k < 3; ++k) slope[i][k][j] = (of_area[k][j] - normal[k] * out) / size;
      }
    }
  }
  Point2 project(const double* x) const {
    const double d[3] = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    return {dot(along[0], d), dot(along[1], d)};
  }
};

// A convex polygon: two quadrilaterals share at most eight corners.
struct Polygon {
  Point2 corner[12];
  int n = 0;
};

// Keep what lies on the left of the line from a to b.
inline void clip(Polygon& polygon, const Point2& a, const Point2& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  double side[12];
  for (int i = 0; i < polygon.n; ++i) side[i] = dx * (polygon.corner[i].y - a.y) - dy * (polygon.corner[i].x - a.x);
  Polygon kept;
  for (int i = 0; i < polygon.n && kept.n < 11; ++i) {
    const int j = (i + 1) % polygon.n;
    const Point2 &p = polygon.corner[i], &q = polygon.corner[j];
    if (side[i] >= 0.0) kept.corner[kept.n++] = p;
    if ((side[i] > 0.0 && side[j] < 0.0) || (side[i] < 0.0 && side[j] > 0.0)) {
      const double part = side[i] / (side[i] - side[j]);
      kept.corner[kept.n++] = {p.x + part * (q.x - p.x), p.y + part * (q.y - p.y)};
    }
  }
  polygon = kept;
}

// Coordinates on a projected face at a place of the plane, by Newton's method; returns the determinant of the map.
template <int nodes>
double locate(const Point2 (&corner)[nodes], const Point2& p, double (&at)[2]) {
  at[0] = at[1] = nodes == 3 ? 1.0 / 3.0 : 0.0;
  double det = 0.0;
  for (int iteration = 0; iteration < 12; ++iteration) {
    double N[nodes], dN[nodes][2], J[2][2] = {}, r[2] = {p.x, p.y};
    Face<nodes>::shape(at, N, dN);
    for (int i = 0; i < nodes; ++i) {
      r[0] -= N[i] * corner[i].x, r[1] -= N[i] * corner[i].y;
      for (int k = 0; k < 2; ++k) J[0][k] += dN[i][k] * corner[i].x, J[1][k] += dN[i][k] * corner[i].y;
    }
    det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    const double step[2] = {(J[1][1] * r[0] - J[0][1] * r[1]) / det, (J[0][0] * r[1] - J[1][0] * r[0]) / det};
    at[0] += step[0], at[1] += step[1];
    if (std::abs(step[0]) + std::abs(step[1]) < 1e-14) break;
  }
  // a face that has turned over on itself has no inverse: stay near it
  for (double& a : at) a = std::clamp(a, nodes == 3 ? -0.5 : -1.5, 1.5);
  return det;
}

// 0 below 0, 1 above 1, smooth between.
inline double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Points of the rule on the overlap of two faces, and in `share` (0 to 1) what counts of them.
template <int nodes>
class Facing {
 public:
  Facing(const Corners<nodes>& slave, const Corners<nodes>& master) : slave_(slave), master_(master), plane(slave) {}

  Overlap find(const Limits& limits) {
    const Plane<nodes> other(master_);
    const double cosine = dot(plane.normal, other.normal);
    if (!(cosine < facing)) return Overlap::none;
    share = ramp((facing - cosine) / (facing - facing_in_full));
    for (int i = 0; i < nodes; ++i) own_[i] = plane.project(slave_.x[i]), opposite_[i] = plane.project(master_.x[i]);
    if (!cut()) return Overlap::none;
    const double gap = find_gap(middle_);
    if (gap > limits.reach) return Overlap::apart;
    if (gap < -limits.depth) return Overlap::too_deep;
    return Overlap::found;
  }

  // Points of the rule, appended.
  void list_points(std::vector<RulePoint>& points) const {
    static const auto rule = Tri3::rule<(nodes == 3 ? 3 : 6)>();
    // about the middle: quadrilaterals are not integrated exactly, and what is left must not jump with the corners
    const int n = overlap_.n, first = nodes == 3 ? 1 : 0;
    const Point2 o = nodes == 3 ? overlap_.corner[0] : middle_;
    for (int i = first; i < n - first; ++i) {
      const Point2 &p = overlap_.corner[i], &q = overlap_.corner[(i + 1) % n];
      const double twice = (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
      for (const auto& [place, weight] : rule) {
        const double r = place[0], s = place[1], rest = 1.0 - r - s;
        const Point2 at{rest * o.x + r * p.x + s * q.x, rest * o.y + r * p.y + s * q.y};
        RulePoint point;
        point.weight = share * weight * twice / locate(own_, at, point.slave);
        locate(opposite_, at, point.master);
        points.push_back(point);
      }
    }
  }

 private:
  bool cut() {
    double whole = 0.0, left = 0.0;
    for (int i = 0; i < nodes; ++i) {
      const auto &p = own_[i], &q = own_[(i + 1) % nodes];
      whole += 0.5 * (p.x * q.y - p.y * q.x);
      overlap_.corner[i] = p;
    }
    overlap_.n = nodes;
    for (int i = nodes; i-- > 0 && overlap_.n > 2;) clip(overlap_, opposite_[(i + 1) % nodes], opposite_[i]);
    if (overlap_.n < 3) return false;
    const Point2& o = overlap_.corner[0];
    middle_ = {0.0, 0.0};
    for (int i = 1; i + 1 < overlap_.n; ++i) {
      const Point2 &p = overlap_.corner[i], &q = overlap_.corner[i + 1];
      const double area = 0.5 * ((p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x));
      left += area, middle_.x += area * (o.x + p.x + q.x) / 3.0, middle_.y += area * (o.y + p.y + q.y) / 3.0;
    }
    middle_.x /= left, middle_.y /= left;
    return left > 1e-9 * whole;
  }

  double find_gap(const Point2& at) const {
    double s[2], m[2], N[nodes], dN[nodes][2], t[2][3], x[3], y[3];
    locate(own_, at, s), locate(opposite_, at, m);
    slave_.place(s, N, dN, x, t), master_.place(m, N, dN, y, t);
    const double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    return dot(plane.normal, d);
  }

  const Corners<nodes>&slave_, &master_;
  Point2 own_[nodes], opposite_[nodes], middle_;
  Polygon overlap_;

 public:
  Plane<nodes> plane;
  double share = 0.0;
};

// All that a point of the rule gives, with derivatives by the nodes of the slave, then those of the master.
template <int nodes>
struct AtPoint {
  double N[nodes];                       // of the slave
  double shape[2 * nodes];               // of the slave, then those of the master, negative
  double shape_slope[2 * nodes][2];      // by the coordinates on the master
  double area_vector[3], area, unit[3];  // t_1 x t_2 of the slave, its length and direction
  Matrix area_slope[nodes];              // d area_vector / d x of the slave's nodes
  double gap;
  double gap_slope[2 * nodes][3];
  double way_slope[2][2 * nodes][3];  // d (coordinate k on the master) / d x

  AtPoint(const Corners<nodes>& slave, const Corners<nodes>& master, const Plane<nodes>& plane, const RulePoint& at) {
    double dN[nodes][2], M[nodes], dM[nodes][2], x[3], y[3], t[2][3], s[2][3], m[3];
    slave.place(at.slave, N, dN, x, t);
    cross(t[0], t[1], area_vector);
    area = std::sqrt(dot(area_vector, area_vector));
    for (int k = 0; k < 3; ++k) unit[k] = area_vector[k] / area;
    for (int i = 0; i < nodes; ++i) area_slope[i] = face_mortar::area_slope(t, dN[i]);
    master.place(at.master, M, dM, y, s);
    for (int i = 0; i < nodes; ++i) {
      shape[i] = N[i], shape[nodes + i] = -M[i];
      for (int k = 0; k < 2; ++k) shape_slope[i][k] = 0.0, shape_slope[nodes + i][k] = -dM[i][k];
    }
    cross(s[0], s[1], m);
    const double across = dot(m, plane.normal), d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    gap = dot(plane.normal, d);
    double dual[2][3];
    cross(s[1], plane.normal, dual[0]), cross(plane.normal, s[0], dual[1]);
    const double* of[3] = {m, dual[0], dual[1]};
    for (int b = 0; b < 2 * nodes; ++b)
      for (int k = 0; k < 3; ++k)
        for (int r = 0; r < 3; ++r) {  // of x_s + g n - x_m along three directions
          double along = shape[b] * of[r][k];
          for (int j = 0; j < 3 && b < nodes; ++j) along += of[r][j] * gap * plane.slope[b % nodes][j][k];
          (r == 0 ? gap_slope[b][k] : way_slope[r - 1][b][k]) = (r == 0 ? -along : along) / across;
        }
  }
};

}  // namespace presswork::face_mortar
