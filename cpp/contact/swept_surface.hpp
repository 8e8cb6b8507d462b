// SPDX-License-Identifier: Apache-2.0
// Surface of a rigid tool as plan times profile: a wall profile carried round a plan curve.
//
// The plan is a rectangle in x, y with rounded corners, centred at the origin: a circle where both half widths equal
// the corner radius, a strip where one of them is infinite. s is the signed distance from it, positive outside. The
// profile is a chain of lines and arcs in (s, z) as in profile.hpp, metal on the right. Since |grad s| = 1, the
// distance in (s, z) is the distance in space, if the way from the point to its foot stays clear of the plan's medial
// axis. So inside by more than the corner radius the profile must be flat (z constant): there the foot is straight
// above or below. Gap, normal and curvature are exact.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "contact/touch.hpp"

namespace presswork::contact {

struct Plan {
  double half_width[2];  // along x and y [mm]; one of them may be infinite
  double corner_radius;  // [mm]; a strip has no corners
};

class SweptSurface {
 public:
  // segments (n, 7) as in profile.hpp. Throws std::invalid_argument.
  SweptSurface(const Plan& plan, int n, const double* segments, double depth);

  // As ToolSurface::nearest; hint becomes the profile's segment, or n + i for the i-th of its corners.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    PlanPlace plan;
    ProfilePlace place;
    return find(x, reach, hint, touch, plan, place);
  }

  // Also the derivative of the normal to x, the second derivative of the distance [1/mm].
  bool nearest(const double x[3], double reach, int& hint, Touch& touch, double (&slope)[3][3]) const {
    PlanPlace plan;
    ProfilePlace place;
    const bool found = find(x, reach, hint, touch, plan, place);
    if (!found) return false;
    const double* out = plan.outward;
    const double round[3] = {-out[1], out[0], 0.0};  // along the plan curve
    const double down[3] = {-place.normal[1] * out[0], -place.normal[1] * out[1], place.normal[0]};
    const double bend = place.normal[0] / plan.radius;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) slope[i][j] = bend * round[i] * round[j] + place.bend * down[i] * down[j];
    return true;
  }

  double depth() const { return depth_; }

  // Where the metal juts out and turns by more than an angle [rad] within a length [mm]: arcs and corners of the
  // profile by their hints, corners of the plan as -1.
  std::vector<int> find_sharp(double length, double angle) const;
  // At least how far x is from such places [mm].
  double distance_to(const std::vector<int>& sharp, const double x[3]) const;

 private:
  struct Piece {
    double start[2], tangent[2], normal[2], length;  // line
    double centre[2], radius, bisector[2], cosine;   // arc: direction of its middle, cosine of half its sweep
    double turn;                                     // 0 line, +1 arc counter-clockwise, -1 clockwise
  };
  // Where two pieces meet at an angle; sign is that of the gap of points that are closest to it.
  struct Corner {
    double at[2], mean_normal[2], sign, angle;
  };
  struct PlanPlace {
    double s, outward[2];
    double radius;          // of the curve of equal s through the point; infinite along straight sides
    double straight = 0.0;  // how far the side is straight
  };
  struct ProfilePlace {
    double gap, normal[2], bend;  // bend: derivative of the normal along the tangent
    double to_end;                // of a line, from the foot
  };

  double slack() const { return 1e4 * tolerance_; }  // of drawings' dimensions
  void check_plan() const;
  void check_inside() const;
  void add_piece(const double* segment, const double* next);
  void add_end(double s, double z, const double* segment, int side);

  PlanPlace locate(double x, double y) const {
    constexpr double straight = std::numeric_limits<double>::infinity();
    const double a = std::abs(x) - core_[0], b = std::abs(y) - core_[1];
    if (a >= 0.0 && b >= 0.0) {
      const double r = std::sqrt(a * a + b * b);
      if (!(r > 0.0)) return {-plan_.corner_radius, {std::copysign(1.0, x), 0.0}, straight};
      return {r - plan_.corner_radius, {std::copysign(a / r, x), std::copysign(b / r, y)}, r};
    }
    constexpr double half_root = 0.7071067811865476;  // to the diagonal where the next side is as near
    const double left = std::min(-std::min(a, b), half_root * std::abs(a - b));
    if (a >= b) return {a - plan_.corner_radius, {std::copysign(1.0, x), 0.0}, straight, left};
    return {b - plan_.corner_radius, {0.0, std::copysign(1.0, y)}, straight, left};
  }

  // Distance of (s, z) from the box of the profile, squared.
  double distance2_to_box(double s, double z) const {
    const double ds = std::max(std::max(low_[0] - s, s - high_[0]), 0.0);
    const double dz = std::max(std::max(low_[1] - z, z - high_[1]), 0.0);
    return ds * ds + dz * dz;
  }

  bool find(const double x[3], double reach, int& hint, Touch& touch, PlanPlace& plan, ProfilePlace& place) const {
    plan = locate(x[0], x[1]);
    const double s = plan.s, z = x[2];
    double bound = std::max(reach, depth_);  // of the gap's size, while nothing closer is found
    const double to_box2 = distance2_to_box(s, z);
    if (to_box2 > bound * bound) {
      touch.gap = std::sqrt(to_box2);
      return false;
    }
    // 1. the closest piece on which the foot lies
    int found = -1;
    const int n = static_cast<int>(pieces_.size());
    for (int i = 0; i < n; ++i) {
      const Piece& p = pieces_[i];
      double gap, to_end = 0.0;
      if (p.turn == 0.0) {
        const double ds = s - p.start[0], dz = z - p.start[1];
        const double along = ds * p.tangent[0] + dz * p.tangent[1];
        if (along < -tolerance_ || along > p.length + tolerance_) continue;
        gap = ds * p.normal[0] + dz * p.normal[1], to_end = std::min(along, p.length - along);
      } else {
        const double ds = s - p.centre[0], dz = z - p.centre[1], r2 = ds * ds + dz * dz;
        const double middle = ds * p.bisector[0] + dz * p.bisector[1];
        if (middle * std::abs(middle) < p.cosine * std::abs(p.cosine) * r2 - tolerance_ * p.radius) continue;
        gap = p.turn * (p.radius - std::sqrt(r2));
      }
      if (std::abs(gap) < bound) bound = std::abs(gap), place.gap = gap, place.to_end = to_end, found = i;
    }
    // 2. the corners, and the open ends, beyond which there is no tool
    for (int i = 0; i < static_cast<int>(corners_.size()); ++i) {
      const double ds = s - corners_[i].at[0], dz = z - corners_[i].at[1], d2 = ds * ds + dz * dz;
      if (d2 >= bound * bound) continue;
      bound = std::sqrt(d2), found = n + i, place.gap = corners_[i].sign * bound;
    }
    for (int i = 0; i < n_ends_; ++i) {
      const double ds = s - ends_[i][0], dz = z - ends_[i][1], d2 = ds * ds + dz * dz;
      const double slack = bound - tolerance_;
      if (slack > 0.0 && d2 < slack * slack) bound = std::sqrt(d2), found = -1;
    }
    if (found < 0 || place.gap >= reach || place.gap < -depth_) {
      touch.gap = found < 0 ? bound : place.gap > 0.0 ? place.gap : bound - depth_;
      return false;
    }
    // 3. its normal
    if (found >= n)
      bend_at_corner(corners_[found - n], s, z, place);
    else if (pieces_[found].turn == 0.0)
      place.normal[0] = pieces_[found].normal[0], place.normal[1] = pieces_[found].normal[1], place.bend = 0.0;
    else
      bend_at_arc(pieces_[found], s, z, place);
    hint = found;
    touch.gap = place.gap;
    touch.normal[0] = place.normal[0] * plan.outward[0];
    touch.normal[1] = place.normal[0] * plan.outward[1];
    touch.normal[2] = place.normal[1];
    for (int k = 0; k < 3; ++k) touch.point[k] = x[k] - place.gap * touch.normal[k];
    const bool flat = found < n && pieces_[found].turn == 0.0, level = flat && pieces_[found].normal[0] == 0.0;
    const double along = place.to_end - std::abs(place.gap);  // the next piece may rise
    touch.flat = !flat ? 0.0 : level ? along : std::min(along, plan.straight - std::abs(place.gap));
    return true;
  }

  static void bend_at_arc(const Piece& p, double s, double z, ProfilePlace& place) {
    const double ds = s - p.centre[0], dz = z - p.centre[1], r = std::abs(p.radius - p.turn * place.gap);
    const bool at_centre = !(r > 1e-12 * p.radius);
    place.normal[0] = -p.turn * (at_centre ? p.bisector[0] : ds / r);
    place.normal[1] = -p.turn * (at_centre ? p.bisector[1] : dz / r);
    place.bend = at_centre ? 0.0 : -p.turn / r;
  }

  void bend_at_corner(const Corner& c, double s, double z, ProfilePlace& place) const {
    const bool on_it = std::abs(place.gap) < tolerance_;
    place.normal[0] = on_it ? c.mean_normal[0] : (s - c.at[0]) / place.gap;
    place.normal[1] = on_it ? c.mean_normal[1] : (z - c.at[1]) / place.gap;
    place.bend = on_it ? 0.0 : 1.0 / place.gap;
  }

  std::vector<Piece> pieces_;
  std::vector<Corner> corners_;
  double ends_[2][2];
  int n_ends_;
  double low_[2], high_[2];  // box of the profile in (s, z)
  double core_[2];           // half widths of the rectangle of the corners' centres
  double depth_, tolerance_;
  Plan plan_;
};

}  // namespace presswork::contact
