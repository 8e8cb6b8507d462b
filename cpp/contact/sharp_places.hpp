// SPDX-License-Identifier: Apache-2.0
// Where a tool's metal juts out so sharply that a straight edge of the sheet rests on it between its nodes: it turns by
// more than an angle within the length of the edge. At those places, and nowhere else, nodes alone are not enough.
//
// Of a swept surface they are arcs and corners of the profile and corners of the plan. Of triangles they are folds:
// sides between two triangles that have, within the length of a fold and over convex folds, triangles whose normals are
// more than the angle apart.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "contact/fold_tree.hpp"
#include "contact/tool_surface.hpp"

namespace presswork::contact {

class SharpPlaces {
 public:
  static constexpr double turn = 0.5053605102841573;  // 29 degrees: 2 asin(1/4)

  // Of a tool that edges of this length touch [mm].
  SharpPlaces(std::shared_ptr<const ToolSurface> surface, double edge)
      : SharpPlaces(std::move(surface), 0.5 * edge, turn) {}
  // length [mm], angle [rad]
  SharpPlaces(std::shared_ptr<const ToolSurface> surface, double length, double angle);
  SharpPlaces(const SharpPlaces&) = delete;  // the search knows where they lie
  SharpPlaces& operator=(const SharpPlaces&) = delete;

  bool any() const { return folds_ || !pieces_.empty(); }
  // At least how far the segment from a to b, in the tool's frame, is from the nearest of them [mm]: exact for folds, a
  // bound by an eighth of its length less for a swept surface; where it is nearer than `near` any value below that.
  // hint
  // (-1: unknown) speeds it up.
  double distance(const double a[3], const double b[3], double near, int& hint) const {
    return search_.distance(a, b, near, hint);
  }
  // The search, on these places: good for as long as they live.
  const SharpSearch& search() const { return search_; }

 private:
  SharpSearch make_search() const;

  std::shared_ptr<const ToolSurface> surface_;
  std::vector<int> pieces_;          // of a swept surface
  std::unique_ptr<FoldTree> folds_;  // of triangles
  SharpSearch search_;
};

}  // namespace presswork::contact
