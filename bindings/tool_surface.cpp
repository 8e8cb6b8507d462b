// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>

#include <array>
#include <limits>
#include <optional>

#include "arrays.hpp"
#include "contact/sharp_places.hpp"
#include "contact/tool_surface.hpp"

namespace presswork::bindings {

namespace {

using contact::ToolSurface;
using contact::Touch;

std::size_t count_points(const Doubles& points) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n, 3)");
  return points.shape(0);
}

// A hint for each point: the caller's, or -1.
std::vector<int> copy_hints(const std::optional<Ints>& hints, std::size_t n) {
  if (!hints) return std::vector<int>(n, -1);
  require(hints->size() == n, "hints must have shape (n)");
  return {hints->data(), hints->data() + n};
}

auto find_nearest(const ToolSurface& self, Doubles points, double reach, std::optional<Ints> hints) {
  const std::size_t n = count_points(points);
  const std::vector<int> from = copy_hints(hints, n);
  double *gap, *normal, *point;
  int* hint;
  auto gaps = new_array({n}, &gap);
  auto normals = new_array({n, 3}, &normal);
  auto places = new_array({n, 3}, &point);
  auto new_hints = new_array({n}, &hint);
#pragma omp parallel for schedule(static) if (n > 2000)  // waking a thread takes longer than a short loop
  for (std::size_t i = 0; i < n; ++i) {
    Touch touch;
    hint[i] = from[i];
    gap[i] = std::numeric_limits<double>::infinity();
    if (!self.nearest(points.data() + 3 * i, reach, hint[i], touch)) continue;
    gap[i] = touch.gap;
    for (int k = 0; k < 3; ++k) normal[3 * i + k] = touch.normal[k], point[3 * i + k] = touch.point[k];
  }
  return std::make_tuple(gaps, normals, places, new_hints);
}

NewDoubles find_distance_bound(const ToolSurface& self, Doubles points, double reach) {
  const std::size_t n = count_points(points);
  double* bound;
  auto bounds = new_array({n}, &bound);
  for (std::size_t i = 0; i < n; ++i) {
    Touch touch;
    int hint = -1;
    self.nearest(points.data() + 3 * i, reach, hint, touch);
    bound[i] = touch.gap;
  }
  return bounds;
}

auto find_slopes(const ToolSurface& self, Doubles points, double reach) {
  const std::size_t n = count_points(points);
  double *of_gap, *of_normal;
  auto gap_slopes = new_array({n, 3}, &of_gap);
  auto normal_slopes = new_array({n, 3, 3}, &of_normal);
  for (std::size_t i = 0; i < n; ++i) {
    Touch touch;
    int hint = -1;
    contact::Slopes slopes;
    if (!self.nearest(points.data() + 3 * i, reach, hint, touch, slopes)) continue;
    for (int r = 0; r < 3; ++r) {
      of_gap[3 * i + r] = slopes.gap[r];
      for (int c = 0; c < 3; ++c) of_normal[9 * i + 3 * r + c] = slopes.normal[r][c];
    }
  }
  return std::make_tuple(gap_slopes, normal_slopes);
}

}  // namespace

void bind_tool_surface(nb::module_& m) {
  constexpr double far = std::numeric_limits<double>::infinity();
  nb::class_<ToolSurface>(m, "ToolSurface", "Surface of a rigid tool in its own frame; see tool_surface.hpp.")
      .def_static(
          "triangles",
          [](Doubles points, Ints triangles, double depth, bool smooth) {
            require(triangles.ndim() == 2 && triangles.shape(1) == 3, "triangles must have shape (n, 3)");
            contact::Triangulation flat(static_cast<int>(count_points(points)), points.data(),
                                        static_cast<int>(triangles.shape(0)), triangles.data(), depth);
            return smooth ? ToolSurface(contact::SmoothTriangulation(std::move(flat))) : ToolSurface(std::move(flat));
          },
          nb::arg("points"), nb::arg("triangles"), nb::kw_only(), nb::arg("depth") = far, nb::arg("smooth") = false,
          "Surface of triangles (n, 3) over points (n_points, 3) [mm], counter-clockwise as seen from free space. "
          "smooth: rounded off, with normals that do not jump; see smooth_triangulation.hpp. "
          "Penetrations deeper than depth [mm] are not found. Raises ValueError where a triangle has no area, an edge "
          "has more than two triangles, or neighbours are wound against each other.")
      .def_static(
          "swept",
          [](std::array<double, 2> half_widths, double corner_radius, Doubles segments, double depth) {
            require(segments.ndim() == 2 && segments.shape(1) == 7, "segments must have shape (n_segments, 7)");
            return ToolSurface(contact::SweptSurface({{half_widths[0], half_widths[1]}, corner_radius},
                                                     static_cast<int>(segments.shape(0)), segments.data(), depth));
          },
          nb::arg("half_widths"), nb::arg("corner_radius"), nb::arg("segments"), nb::kw_only(), nb::arg("depth") = far,
          "A profile carried round a rectangle of half widths along x and y (one may be infinite) with rounded corners "
          "[mm]. segments (n, 7) as in model.Tool, in (s, z): s the signed distance from the plan curve, positive "
          "outside. Penetrations deeper than depth [mm] are not found. Raises ValueError.")
      .def("nearest", &find_nearest, nb::arg("points"), nb::arg("reach") = far, nb::arg("hints") = nb::none(),
           "Nearest places to points (n, 3) that are closer than reach [mm]: gap (n,), positive off the tool and "
           "infinite where there is none, normal (n, 3) out of the tool, place (n, 3), and hints (n,) for the next "
           "call.")
      .def("distance_bound", &find_distance_bound, nb::arg("points"), nb::arg("reach") = far,
           "The gap, or where nothing is closer than reach how far each point is from the surface at least (n,) [mm].")
      .def(
          "is_sharp",
          [](const ToolSurface& self, double edge) {
            const std::shared_ptr<const ToolSurface> borrowed(std::shared_ptr<void>(), &self);
            return contact::SharpPlaces(borrowed, edge).any();
          },
          nb::arg("edge"),
          "Whether edges of a sheet of this mean length [mm] touch the tool between their nodes: it turns by more than "
          "29 degrees within half of it.")
      .def("slopes", &find_slopes, nb::arg("points"), nb::arg("reach") = far,
           "Derivatives of the gap (n, 3) and of the normal (n, 3, 3: component, direction) [1/mm] to points (n, 3); "
           "zero where nothing is near, and of the normal on triangles that are not smooth.")
      .def_prop_ro("depth", &ToolSurface::depth, "Penetrations deeper than this [mm] are not found.");
}

}  // namespace presswork::bindings
