// SPDX-License-Identifier: Apache-2.0
// Rigid tool profiles in the plane: directed lines and arcs, the tool's metal on the right, free space on the left.
//
// A point's gap is its signed distance from the closest point of the profile, positive on the free side; its normal
// points from the metal into free space. In an inner corner (one that free space fills) a point behind it touches both
// faces: two gaps and two normals. Beyond an open end of a profile there is no tool. Segment: x0 y0 x1 y1 cx cy turn;
// turn 0 is a line, +1 an arc that runs counter-clockwise, -1 clockwise.
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
  int segment = -1;
};

namespace profile {

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

// Signed gap if the foot of (x, y) lies inside the segment; false otherwise.
inline bool project(const double* s, double x, double y, double& gap, double n[2]) {
  if (is_line(s)) {
    const double tx = s[2] - s[0], ty = s[3] - s[1], l2 = tx * tx + ty * ty;
    const double f = ((x - s[0]) * tx + (y - s[1]) * ty) / l2;
    if (f < 0 || f > 1) return false;
    normal_at(s, 0, n);
    gap = (x - s[0]) * n[0] + (y - s[1]) * n[1];
    return true;
  }
  const double rx = x - s[4], ry = y - s[5], r = std::hypot(rx, ry), radius = std::hypot(s[0] - s[4], s[1] - s[5]);
  if (r < 1e-12 * radius) return false;
  const double from = std::atan2(s[1] - s[5], s[0] - s[4]), to = std::atan2(s[3] - s[5], s[2] - s[4]);
  auto wrap = [](double a) { return a < 0 ? a + 2 * std::numbers::pi : a; };
  const double sweep = wrap(s[6] * (to - from)), at = wrap(s[6] * (std::atan2(ry, rx) - from));
  if (at > sweep + 1e-12) return false;
  n[0] = -s[6] * rx / r, n[1] = -s[6] * ry / r;
  gap = s[6] * (radius - r);
  return true;
}

// The vertex where segment a ends and b begins. In an inner corner a point on one face and at the vertex touches both.
inline void touch_vertex(const double* a, const double* b, double x, double y, int segment, double tolerance,
                         Touch& best) {
  const double dx = x - a[2], dy = y - a[3], distance = std::hypot(dx, dy);
  if (distance > std::max(std::abs(best.gap), tolerance)) return;
  double na[2], nb[2];
  normal_at(a, 1, na);
  normal_at(b, 0, nb);
  const double turn = na[0] * nb[1] - na[1] * nb[0];  // > 0: the profile turns left, free space lies in the corner
  const double ga = dx * na[0] + dy * na[1], gb = dx * nb[0] + dy * nb[1];
  if (turn > 1e-6) {
    if (distance > tolerance && (ga > 0 || gb > 0)) return;  // beside one face: that face alone
    best.gap = ga, best.second_gap = gb, best.segment = segment;
    for (int i = 0; i < 2; ++i) best.normal[i] = na[i], best.second_normal[i] = nb[i];
    return;
  }
  if (distance >= std::abs(best.gap)) return;  // a face is as close
  best.segment = segment;
  if (distance < tolerance) {
    best.gap = 0.5 * (ga + gb);
    const double length = std::hypot(na[0] + nb[0], na[1] + nb[1]);
    for (int i = 0; i < 2; ++i) best.normal[i] = (na[i] + nb[i]) / length;
    return;
  }
  const double sign = ga + gb > 0 ? 1.0 : -1.0;
  best.gap = sign * distance;
  best.normal[0] = sign * dx / distance;
  best.normal[1] = sign * dy / distance;
}

}  // namespace profile

// Closest touch of (x, y) with a chain of n segments; gap is infinite where there is none.
inline Touch touch_profile(int n, const double* segments, double x, double y) {
  Touch best;
  for (int i = 0; i < n; ++i) {
    const double* s = segments + 7 * i;
    double gap, normal[2];
    if (!profile::project(s, x, y, gap, normal)) continue;
    if (std::abs(gap) < std::abs(best.gap)) {
      best = Touch{};
      best.gap = gap, best.segment = i;
      best.normal[0] = normal[0], best.normal[1] = normal[1];
    }
  }
  const double* last = segments + 7 * (n - 1);
  const double size = std::abs(last[2]) + std::abs(last[3]) + 1.0;
  const bool closed = std::hypot(last[2] - segments[0], last[3] - segments[1]) < 1e-9 * size;
  for (int i = 0; i < n; ++i) {
    if (i == n - 1 && !closed) break;
    profile::touch_vertex(segments + 7 * i, segments + 7 * ((i + 1) % n), x, y, i, 1e-9 * size, best);
  }
  return best;
}

}  // namespace presswork
