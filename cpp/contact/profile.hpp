// SPDX-License-Identifier: Apache-2.0
// Rigid tool profiles in the plane: directed lines and arcs, the tool's metal on the right, free space on the left.
//
// A point's gap is its signed distance from the closest point of the profile, positive on the free side; its normal
// points from the metal into free space. In an inner corner (one that free space fills) a point behind it touches both
// faces: two gaps and two normals. Where a profile turns by less than `smooth` it has no corner: its pieces are taken
// for tangent. Beyond an open end of a profile there is no tool. Segment: x0 y0 x1 y1 cx cy turn; turn 0 is a line, +1
// an arc that runs counter-clockwise, -1 clockwise.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace presswork {

struct Touch {
  double gap = std::numeric_limits<double>::infinity();
  double normal[2] = {0, 0};
  double second_gap = std::numeric_limits<double>::infinity();  // the other face of an inner corner
  double second_normal[2] = {0, 0};
  int segment = -1, second_segment = -1;
};

namespace profile {

// Sine of the turn below which two pieces are tangent: drawings have tangents to a few decimals only.
constexpr double smooth = 1e-3;

inline bool is_line(const double* s) { return s[6] == 0.0; }

// Left normal at an end of the segment (0 first, 1 last).
inline void normal_at(const double* s, int end, double n[2]) {
  if (is_line(s)) {
    const double tx = s[2] - s[0], ty = s[3] - s[1], length = std::hypot(tx, ty);
    n[0] = -ty / length, n[1] = tx / length;
  } else {
    const double rx = s[2 * end] - s[4], ry = s[2 * end + 1] - s[5], r = std::hypot(rx, ry);
    n[0] = -s[6] * rx / r, n[1] = -s[6] * ry / r;  // counter-clockwise: left is towards the centre
  }
}

inline double wrap(double angle) { return angle < 0 ? angle + 2 * std::numbers::pi : angle; }

// What the closest-point search needs of a segment again and again.
struct Prepared {
  double from, sweep;          // arc: angle of its start, angle swept from there in its turn
  double radius;               // arc
  double bisector[2], cosine;  // arc: direction of its middle from the centre, cosine of half the sweep
  double normal[2][2];         // left normals at both ends
  double turn;                 // sine of the turn from its end to the next segment; infinite at an open end
};

inline void prepare(const double* s, const double* next, Prepared& p) {
  normal_at(s, 0, p.normal[0]);
  normal_at(s, 1, p.normal[1]);
  p.turn = std::numeric_limits<double>::infinity();
  if (next) {
    double nb[2];
    normal_at(next, 0, nb);
    p.turn = p.normal[1][0] * nb[1] - p.normal[1][1] * nb[0];  // > 0: turns left, free space lies in the corner
  }
  if (is_line(s)) return;
  p.from = std::atan2(s[1] - s[5], s[0] - s[4]);
  p.sweep = wrap(s[6] * (std::atan2(s[3] - s[5], s[2] - s[4]) - p.from));
  p.radius = std::hypot(s[0] - s[4], s[1] - s[5]);
  const double middle = p.from + 0.5 * s[6] * p.sweep;
  p.bisector[0] = std::cos(middle), p.bisector[1] = std::sin(middle), p.cosine = std::cos(0.5 * p.sweep);
}

// Signed gap if the foot of (x, y) lies inside the segment; false otherwise.
inline bool project(const double* s, const Prepared& p, double x, double y, double& gap, double n[2]) {
  if (is_line(s)) {
    const double tx = s[2] - s[0], ty = s[3] - s[1], l2 = tx * tx + ty * ty;
    const double f = ((x - s[0]) * tx + (y - s[1]) * ty) / l2;
    if (f < 0 || f > 1) return false;
    n[0] = p.normal[0][0], n[1] = p.normal[0][1];
    gap = (x - s[0]) * n[0] + (y - s[1]) * n[1];
    return true;
  }
  const double rx = x - s[4], ry = y - s[5], r = std::hypot(rx, ry);
  if (r < 1e-12 * p.radius) return false;
  const double off = (rx * p.bisector[0] + ry * p.bisector[1]) / r - p.cosine;
  if (off < -1e-9) return false;
  if (off < 1e-9) {  // at an end of the arc: by the angle itself
    const double at = wrap(s[6] * (std::atan2(ry, rx) - p.from));
    if (at > p.sweep + 1e-12) return false;
  }
  n[0] = -s[6] * rx / r, n[1] = -s[6] * ry / r;
  gap = s[6] * (p.radius - r);
  return true;
}

// Whether nothing is closer to a point at d from an inner corner than the corner: it lies beyond the end of the face
// with normal na and before the start of that with nb, or behind both.
inline bool is_behind(const double d[2], const double na[2], const double nb[2]) {
  const double slack = 1e-9 * (std::abs(d[0]) + std::abs(d[1]));
  if (d[0] * na[1] - d[1] * na[0] >= -slack && d[0] * nb[1] - d[1] * nb[0] <= slack) return true;
  return d[0] * na[0] + d[1] * na[1] <= 0 && d[0] * nb[0] + d[1] * nb[1] <= 0;
}

// The vertex where segment i ends and j begins. In an inner corner a point on one face and at the vertex touches both.
inline void touch_vertex(const double* a, const Prepared& pa, const Prepared& pb, int i, int j, double x, double y,
                         double tolerance, Touch& best) {
  const double d[2] = {x - a[2], y - a[3]}, distance = std::hypot(d[0], d[1]);
  if (distance > std::max(std::abs(best.gap), tolerance)) return;
  const double *na = pa.normal[1], *nb = pb.normal[0];
  const double ga = d[0] * na[0] + d[1] * na[1], gb = d[0] * nb[0] + d[1] * nb[1];
  if (pa.turn > smooth) {
    if (distance > tolerance && !is_behind(d, na, nb)) return;  // beside one face: that face alone
    best.gap = ga, best.second_gap = gb, best.segment = i, best.second_segment = j;
    for (int k = 0; k < 2; ++k) best.normal[k] = na[k], best.second_normal[k] = nb[k];
    return;
  }
  if (distance >= std::abs(best.gap)) return;  // a face is as close
  best = Touch{};
  best.segment = i;
  if (distance < tolerance) {
    best.gap = 0.5 * (ga + gb);
    const double length = std::hypot(na[0] + nb[0], na[1] + nb[1]);
    for (int k = 0; k < 2; ++k) best.normal[k] = (na[k] + nb[k]) / length;
    return;
  }
  const double sign = ga + gb > 0 ? 1.0 : -1.0;
  best.gap = sign * distance;
  best.normal[0] = sign * d[0] / distance;
  best.normal[1] = sign * d[1] / distance;
}

// A box round a run of neighbouring segments.
struct Box {
  double low[2], high[2];

  double squared_distance(double x, double y) const {
    const double dx = std::max(std::max(low[0] - x, x - high[0]), 0.0);
    const double dy = std::max(std::max(low[1] - y, y - high[1]), 0.0);
    return dx * dx + dy * dy;
  }
};

// A box that holds the segment: an arc of less than half a turn strays from its chord's box by its sagitta at most.
inline Box enclose(const double* s, const Prepared& p) {
  Box box;
  const bool wide = !is_line(s) && p.cosine <= 0;
  const double reach = is_line(s) ? 0.0 : p.radius * (wide ? 1.0 : 1.0 - p.cosine);
  for (int k = 0; k < 2; ++k) {
    const double slack = reach + 1e-12 * (std::abs(s[k]) + std::abs(s[2 + k]) + reach);
    box.low[k] = (wide ? s[4 + k] : std::min(s[k], s[2 + k])) - slack;
    box.high[k] = (wide ? s[4 + k] : std::max(s[k], s[2 + k])) + slack;
  }
  return box;
}

}  // namespace profile

// A profile's boxes as a heap: node i holds nodes 2i and 2i + 1; the leaves are its segments, in order.
class ProfileSearch {
 public:
  // Numbers of n segments' Prepared and Box, which the caller provides.
  static int count_leaves(int n) {
    int leaves = 1;
    while (leaves < n) leaves *= 2;
    return leaves;
  }

  ProfileSearch(int n, const double* segments, profile::Prepared* prepared, profile::Box* boxes)
      : n_(n), leaves_(count_leaves(n)), segments_(segments), prepared_(prepared), boxes_(boxes) {
    const double* last = segments + 7 * (n - 1);
    const double size = std::abs(last[2]) + std::abs(last[3]) + 1.0;
    tolerance_ = 1e-9 * size;
    const bool closed = std::hypot(last[2] - segments[0], last[3] - segments[1]) < tolerance_;
    constexpr double far = std::numeric_limits<double>::infinity();
    for (int i = 0; i < leaves_; ++i) {
      profile::Box& box = boxes_[leaves_ + i];
      box = {{far, far}, {-far, -far}};
      if (i >= n) continue;
      profile::prepare(segment(i), i + 1 < n ? segment(i + 1) : closed ? segments : nullptr, prepared_[i]);
      box = profile::enclose(segment(i), prepared_[i]);
    }
    for (int i = leaves_ - 1; i > 0; --i)
      for (int k = 0; k < 2; ++k) {
        boxes_[i].low[k] = std::min(boxes_[2 * i].low[k], boxes_[2 * i + 1].low[k]);
        boxes_[i].high[k] = std::max(boxes_[2 * i].high[k], boxes_[2 * i + 1].high[k]);
      }
  }

  // Closest touch of (x, y); its gap is infinite where there is none.
  Touch touch(double x, double y) const {
    // 1. the closest face, and how far off the closest feature is: no farther than any vertex, unless the closest is
    //    an open end, which nothing touches
    Touch best;
    Near near{std::numeric_limits<double>::infinity(), true, 0, {}};
    descend(x, y, near.bound2, true, [&](int i) { touch_face(i, x, y, near, best); });
    const double to_open_end2 =
        std::isinf(prepared_[n_ - 1].turn)
            ? std::min(squared_distance(segments_, x, y), squared_distance(segment(n_ - 1) + 2, x, y))
            : std::numeric_limits<double>::infinity();
    if (to_open_end2 <= near.bound2 * (1 + 1e-9)) {
      best = Touch{};
      near = {std::numeric_limits<double>::infinity(), false, 0, {}};
      descend(x, y, near.bound2, true, [&](int i) { touch_face(i, x, y, near, best); });
    }
    // 2. the vertices that are as close, and no farther than an open end, in their order along the profile
    auto touch_end = [&](int i) {
      const int next = next_to(i);
      const double d2 = squared_distance(segment(i) + 2, x, y);
      if (std::isinf(prepared_[i].turn) || d2 > near.bound2 * (1 + 1e-9)) return;
      if (d2 > std::max(to_open_end2, tolerance_ * tolerance_)) return;
      profile::touch_vertex(segment(i), prepared_[i], prepared_[next], i, next, x, y, tolerance_, best);
    };
    if (near.count > Near::capacity) {
      descend(x, y, near.bound2, false, touch_end);
    } else {
      std::sort(near.vertices, near.vertices + near.count);
      for (int k = 0; k < near.count; ++k) touch_end(near.vertices[k]);
    }
    return best;
  }

 private:
  // How far off the closest feature is at most (squared, and no less than the tolerance), and vertices met so near.
  struct Near {
    static constexpr int capacity = 12;
    double bound2;
    bool by_any_vertex;
    int count;  // one more than the capacity: there were more
    int vertices[capacity];
  };

  const double* segment(int i) const { return segments_ + 7 * i; }
  static double squared_distance(const double* point, double x, double y) {
    return (x - point[0]) * (x - point[0]) + (y - point[1]) * (y - point[1]);
  }
  int next_to(int i) const { return i + 1 < n_ ? i + 1 : 0; }

  void touch_face(int i, double x, double y, Near& near, Touch& best) const {
    const profile::Prepared& p = prepared_[i];
    const double d[2] = {x - segment(i)[2], y - segment(i)[3]}, d2 = d[0] * d[0] + d[1] * d[1];
    auto draw_in = [&](double distance2) {
      near.bound2 = std::min(near.bound2, std::max(distance2, tolerance_ * tolerance_));
    };
    if (d2 <= near.bound2 * (1 + 1e-9) && !std::isinf(p.turn)) {
      if (near.count < Near::capacity) near.vertices[near.count] = i;
      near.count = std::min(near.count + 1, Near::capacity + 1);
      if (near.by_any_vertex || p.turn <= profile::smooth ||
          profile::is_behind(d, p.normal[1], prepared_[next_to(i)].normal[0]))
        draw_in(d2);
    }
    double gap, normal[2];
    if (!profile::project(segment(i), p, x, y, gap, normal)) return;
    const double size = std::abs(gap), former = std::abs(best.gap);
    if (size > former || (size == former && i > best.segment)) return;  // of equals the first along the profile
    best.gap = gap, best.segment = i, best.normal[0] = normal[0], best.normal[1] = normal[1];
    draw_in(gap * gap);
  }

  // Visit the segments whose boxes come within the root of bound2, which may shrink on the way: the nearest child
  // first, or in their order along the profile.
  template <class Visit>
  void descend(double x, double y, const double& bound2, bool nearest_first, Visit visit) const {
    struct Entry {
      int node;
      double distance2;
    } stack[64];
    int depth = 0;
    stack[depth++] = {1, 0.0};
    while (depth > 0) {
      const Entry entry = stack[--depth];
      if (entry.distance2 > bound2 * (1 + 1e-9)) continue;
      if (entry.node >= leaves_) {
        if (entry.node - leaves_ < n_) visit(entry.node - leaves_);
        continue;
      }
      const Entry left{2 * entry.node, boxes_[2 * entry.node].squared_distance(x, y)};
      const Entry right{2 * entry.node + 1, boxes_[2 * entry.node + 1].squared_distance(x, y)};
      const bool left_first = !nearest_first || left.distance2 <= right.distance2;
      stack[depth++] = left_first ? right : left;
      stack[depth++] = left_first ? left : right;
    }
  }

  int n_, leaves_;
  const double* segments_;
  profile::Prepared* prepared_;
  profile::Box* boxes_;
  double tolerance_;
};

}  // namespace presswork
