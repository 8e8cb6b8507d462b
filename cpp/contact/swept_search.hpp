// SPDX-License-Identifier: Apache-2.0
// The search for the nearest place of a swept surface (swept_surface.hpp), on pieces that lie in any memory: that of
// the CPU, or of a card.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/touch.hpp"
#include "tensor/on_device.hpp"

namespace presswork::contact {

struct SweptSearch {
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

  // As ToolSurface::nearest.
  PRESSWORK_DEVICE bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    PlanPlace plan;
    ProfilePlace place;
    return find(x, reach, hint, touch, plan, place);
  }

  PRESSWORK_DEVICE PlanPlace locate(double x, double y) const {
    constexpr double straight = std::numeric_limits<double>::infinity();
    const double a = std::abs(x) - core[0], b = std::abs(y) - core[1];
    if (a >= 0.0 && b >= 0.0) {
      const double r = std::sqrt(a * a + b * b);
      if (!(r > 0.0)) return {-corner_radius, {std::copysign(1.0, x), 0.0}, straight};
      return {r - corner_radius, {std::copysign(a / r, x), std::copysign(b / r, y)}, r};
    }
    constexpr double half_root = 0.7071067811865476;  // to the diagonal where the next side is as near
    const double left = std::min(-std::min(a, b), half_root * std::abs(a - b));
    if (a >= b) return {a - corner_radius, {std::copysign(1.0, x), 0.0}, straight, left};
    return {b - corner_radius, {0.0, std::copysign(1.0, y)}, straight, left};
  }

  // Distance of (s, z) from the box of the profile, squared.
  PRESSWORK_DEVICE double distance2_to_box(double s, double z) const {
    const double ds = std::max(std::max(low[0] - s, s - high[0]), 0.0);
    const double dz = std::max(std::max(low[1] - z, z - high[1]), 0.0);
    return ds * ds + dz * dz;
  }

  PRESSWORK_DEVICE bool find(const double x[3], double reach, int& hint, Touch& touch, PlanPlace& plan,
                             ProfilePlace& place) const {
    plan = locate(x[0], x[1]);
    const double s = plan.s, z = x[2];
    double bound = std::max(reach, depth);  // of the gap's size, while nothing closer is found
    const double to_box2 = distance2_to_box(s, z);
    if (to_box2 > bound * bound) {
      touch.gap = std::sqrt(to_box2);
      return false;
    }
    // 1. the closest piece on which the foot lies
    int found = -1;
    for (int i = 0; i < n; ++i) {
      const Piece& p = pieces[i];
      double gap, to_end = 0.0;
      if (p.turn == 0.0) {
        const double ds = s - p.start[0], dz = z - p.start[1];
        const double along = ds * p.tangent[0] + dz * p.tangent[1];
        if (along < -tolerance || along > p.length + tolerance) continue;
        gap = ds * p.normal[0] + dz * p.normal[1], to_end = std::min(along, p.length - along);
      } else {
        const double ds = s - p.centre[0], dz = z - p.centre[1], r2 = ds * ds + dz * dz;
        const double middle = ds * p.bisector[0] + dz * p.bisector[1];
        if (middle * std::abs(middle) < p.cosine * std::abs(p.cosine) * r2 - tolerance * p.radius) continue;
        gap = p.turn * (p.radius - std::sqrt(r2));
      }
      if (std::abs(gap) < bound) bound = std::abs(gap), place.gap = gap, place.to_end = to_end, found = i;
    }
    // 2. the corners, and the open ends, beyond which there is no tool
    for (int i = 0; i < n_corners; ++i) {
      const double ds = s - corners[i].at[0], dz = z - corners[i].at[1], d2 = ds * ds + dz * dz;
      if (d2 >= bound * bound) continue;
      bound = std::sqrt(d2), found = n + i, place.gap = corners[i].sign * bound;
    }
    for (int i = 0; i < n_ends; ++i) {
      const double ds = s - ends[i][0], dz = z - ends[i][1], d2 = ds * ds + dz * dz;
      const double slack = bound - tolerance;
      if (slack > 0.0 && d2 < slack * slack) bound = std::sqrt(d2), found = -1;
    }
    if (found < 0 || place.gap >= reach || place.gap < -depth) {
      touch.gap = found < 0 ? bound : place.gap > 0.0 ? place.gap : bound - depth;
      return false;
    }
    // 3. its normal
    if (found >= n)
      bend_at_corner(corners[found - n], s, z, place);
    else if (pieces[found].turn == 0.0)
      place.normal[0] = pieces[found].normal[0], place.normal[1] = pieces[found].normal[1], place.bend = 0.0;
    else
      bend_at_arc(pieces[found], s, z, place);
    hint = found;
    touch.gap = place.gap;
    touch.normal[0] = place.normal[0] * plan.outward[0];
    touch.normal[1] = place.normal[0] * plan.outward[1];
    touch.normal[2] = place.normal[1];
    for (int k = 0; k < 3; ++k) touch.point[k] = x[k] - place.gap * touch.normal[k];
    const bool flat = found < n && pieces[found].turn == 0.0, level = flat && pieces[found].normal[0] == 0.0;
    const double along = place.to_end - std::abs(place.gap);  // the next piece may rise
    touch.flat = !flat ? 0.0 : level ? along : std::min(along, plan.straight - std::abs(place.gap));
    return true;
  }

  PRESSWORK_DEVICE static void bend_at_arc(const Piece& p, double s, double z, ProfilePlace& place) {
    const double ds = s - p.centre[0], dz = z - p.centre[1], r = std::abs(p.radius - p.turn * place.gap);
    const bool at_centre = !(r > 1e-12 * p.radius);
    place.normal[0] = -p.turn * (at_centre ? p.bisector[0] : ds / r);
    place.normal[1] = -p.turn * (at_centre ? p.bisector[1] : dz / r);
    place.bend = at_centre ? 0.0 : -p.turn / r;
  }

  PRESSWORK_DEVICE void bend_at_corner(const Corner& c, double s, double z, ProfilePlace& place) const {
    const bool on_it = std::abs(place.gap) < tolerance;
    place.normal[0] = on_it ? c.mean_normal[0] : (s - c.at[0]) / place.gap;
    place.normal[1] = on_it ? c.mean_normal[1] : (z - c.at[1]) / place.gap;
    place.bend = on_it ? 0.0 : 1.0 / place.gap;
  }

  // At least how far x is from sharp places, by their numbers as SweptSurface::find_sharp has them [mm].
  PRESSWORK_DEVICE double distance_to(const int* sharp, int n_sharp, const double x[3]) const {
    const double s = locate(x[0], x[1]).s, z = x[2];
    double least = std::numeric_limits<double>::infinity();
    auto take = [&](double at_s, double at_z) { least = std::min(least, std::hypot(s - at_s, z - at_z)); };
    for (int which = 0; which < n_sharp; ++which) {
      const int i = sharp[which];
      if (i < 0) {
        const double a = std::abs(x[0]) - core[0], b = std::abs(x[1]) - core[1];
        const double off = std::max(std::max(low[1] - z, z - high[1]), 0.0);
        const double aside = a >= 0.0 && b >= 0.0 ? std::abs(std::hypot(a, b) - corner_radius)
                                                  : std::max(std::hypot(a, b) - corner_radius, 0.0);
        least = std::min(least, std::hypot(aside, off));
      } else if (i >= n) {
        take(corners[i - n].at[0], corners[i - n].at[1]);
      } else {
        const Piece& p = pieces[i];
        const double ds = s - p.centre[0], dz = z - p.centre[1], r = std::hypot(ds, dz);
        if (ds * p.bisector[0] + dz * p.bisector[1] >= p.cosine * r) least = std::min(least, std::abs(r - p.radius));
        take(p.start[0], p.start[1]);
        take(p.start[0] + p.length * p.tangent[0], p.start[1] + p.length * p.tangent[1]);
      }
    }
    return least;
  }

  const Piece* pieces = nullptr;
  const Corner* corners = nullptr;
  int n = 0, n_corners = 0, n_ends = 0;
  double ends[2][2];
  double low[2], high[2];  // box of the profile in (s, z)
  double core[2];          // half widths of the rectangle of the corners' centres
  double corner_radius, depth, tolerance;
};

}  // namespace presswork::contact
