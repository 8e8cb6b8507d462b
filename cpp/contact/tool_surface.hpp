// SPDX-License-Identifier: Apache-2.0
// The surface of a rigid tool in space, and where it is nearest to a point.
#pragma once

#include <utility>
#include <variant>

#include "contact/smooth_triangulation.hpp"
#include "contact/swept_surface.hpp"
#include "contact/touch.hpp"
#include "contact/triangulation.hpp"

namespace presswork::contact {

// In the tool's own frame; immutable once made, so many threads may ask at once.
class ToolSurface {
 public:
  ToolSurface(SweptSurface surface) : surface_(std::move(surface)) {}
  ToolSurface(Triangulation surface) : surface_(std::move(surface)) {}
  ToolSurface(SmoothTriangulation surface) : surface_(std::move(surface)) {}

  // Nearest place of the surface to x [mm] if it is closer than `reach`, a penetration up to depth() included. `hint`
  // is where it was found last (-1: unknown) and is updated; it speeds the search up and changes nothing else. Without
  // a touch, touch.past_rim alone is set, and touch.gap: how far x is at least from the surface, or, too deep in the
  // metal, from where it would be found. A point comes no nearer than it moves: so it need not be asked about again
  // before it and the tool have moved by its gap against each other.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    return std::visit([&](const auto& surface) { return surface.nearest(x, reach, hint, touch); }, surface_);
  }

  // Also how gap and normal change with x; the normal of triangles that are not rounded off does not.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch, Slopes& slopes) const {
    if (const auto* smooth = std::get_if<SmoothTriangulation>(&surface_))
      return smooth->nearest(x, reach, hint, touch, slopes);
    for (auto& row : slopes.normal)
      for (double& value : row) value = 0.0;
    const auto* swept = std::get_if<SweptSurface>(&surface_);
    const bool found = swept ? swept->nearest(x, reach, hint, touch, slopes.normal) : nearest(x, reach, hint, touch);
    for (int i = 0; i < 3; ++i) slopes.gap[i] = touch.normal[i];
    return found;
  }

  // A point deeper in the metal than this [mm] is not taken for penetrating: it lies below a face that is open, or
  // behind a wall.
  double depth() const {
    return std::visit([](const auto& surface) { return surface.depth(); }, surface_);
  }

  const SmoothTriangulation* smooth() const { return std::get_if<SmoothTriangulation>(&surface_); }
  const SweptSurface* swept() const { return std::get_if<SweptSurface>(&surface_); }
  const Triangulation* triangles() const {
    if (const auto* smooth = std::get_if<SmoothTriangulation>(&surface_)) return &smooth->flat();
    return std::get_if<Triangulation>(&surface_);
  }

 private:
  std::variant<SweptSurface, Triangulation, SmoothTriangulation> surface_;
};

}  // namespace presswork::contact
