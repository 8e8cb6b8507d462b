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

#include <vector>

#include "contact/swept_search.hpp"

namespace presswork::contact {

struct Plan {
  double half_width[2];  // along x and y [mm]; one of them may be infinite
  double corner_radius;  // [mm]; a strip has no corners
};

class SweptSurface {
 public:
  // segments (n, 7) as in profile.hpp. Throws std::invalid_argument.
  SweptSurface(const Plan& plan, int n, const double* segments, double depth);
  SweptSurface(SweptSurface&&) = default;  // not copied: the search knows where its pieces lie
  SweptSurface& operator=(SweptSurface&&) = default;

  // As ToolSurface::nearest; hint becomes the profile's segment, or n + i for the i-th of its corners.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    return search_.nearest(x, reach, hint, touch);
  }

  // Also the derivative of the normal to x, the second derivative of the distance [1/mm].
  bool nearest(const double x[3], double reach, int& hint, Touch& touch, double (&slope)[3][3]) const {
    PlanPlace plan;
    ProfilePlace place;
    const bool found = search_.find(x, reach, hint, touch, plan, place);
    if (!found) return false;
    const double* out = plan.outward;
    const double round[3] = {-out[1], out[0], 0.0};  // along the plan curve
    const double down[3] = {-place.normal[1] * out[0], -place.normal[1] * out[1], place.normal[0]};
    const double bend = place.normal[0] / plan.radius;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) slope[i][j] = bend * round[i] * round[j] + place.bend * down[i] * down[j];
    return true;
  }

  double depth() const { return search_.depth; }
  // The search, on the pieces of this surface: good for as long as it lives.
  const SweptSearch& search() const { return search_; }

  // Where the metal juts out and turns by more than an angle [rad] within a length [mm]: arcs and corners of the
  // profile by their hints, corners of the plan as -1.
  std::vector<int> find_sharp(double length, double angle) const;

 private:
  using Piece = SweptSearch::Piece;
  using Corner = SweptSearch::Corner;
  using PlanPlace = SweptSearch::PlanPlace;
  using ProfilePlace = SweptSearch::ProfilePlace;

  double slack() const { return 1e4 * search_.tolerance; }  // of drawings' dimensions
  void check_plan() const;
  void check_inside() const;
  void add_piece(const double* segment, const double* next);
  void add_end(double s, double z, const double* segment, int side);

  PlanPlace locate(double x, double y) const { return search_.locate(x, y); }

  std::vector<Piece> pieces_;
  std::vector<Corner> corners_;
  SweptSearch search_;
  Plan plan_;
};

}  // namespace presswork::contact
