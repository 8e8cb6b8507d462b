// SPDX-License-Identifier: Apache-2.0
// Where a tool's metal juts out so sharply that a straight edge of the sheet rests on it between its nodes: it turns by
// more than an angle within the length of the edge. At those places, and nowhere else, nodes alone are not enough.
//
// Of a swept surface they are arcs and corners of the profile and corners of the plan. Of triangles they are folds:
// sides between two triangles that have, within the length of a fold and over convex folds, triangles whose normals are
// more than the angle apart.
#pragma once

#include <memory>
#include <vector>

#include "contact/tool_surface.hpp"

namespace presswork::contact {

class SharpPlaces {
 public:
  // length [mm], angle [rad]
  SharpPlaces(std::shared_ptr<const ToolSurface> surface, double length, double angle);

  bool any() const { return folds_ || !pieces_.empty(); }
  // At least how far x, in the tool's frame, is from the nearest of them [mm]; hint (-1: unknown) speeds it up.
  double distance(const double x[3], int& hint) const {
    return folds_ ? folds_->distance(x, hint) : surface_->swept()->distance_to(pieces_, x);
  }

 private:
  std::shared_ptr<const ToolSurface> surface_;
  std::vector<int> pieces_;               // of a swept surface
  std::unique_ptr<Triangulation> folds_;  // of triangles: slivers along the folds
};

}  // namespace presswork::contact
