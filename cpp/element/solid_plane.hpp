// SPDX-License-Identifier: Apache-2.0
// What the plane is to a solid (solid.hpp): plane strain and axisymmetry. x is the radius and y the axis in
// axisymmetry; integrals carry 2 pi r, so that nodal forces are those of the whole ring; in plane strain they carry the
// depth.
#pragma once

#include "element/point_response.hpp"
#include "element/solid2d_forces.hpp"

namespace presswork {

template <class Cell, int n_points, class T>
struct SolidPlane : SolidGeometry<Cell, n_points, T> {
  using Geometry = SolidGeometry<Cell, n_points, T>;
  static constexpr int dim = 2, nodes = Cell::nodes, freedoms = 2 * nodes, components = 4, gradients = 5;
  using Forces = SolidForces<nodes, T>;
  using Point = typename Geometry::PointGeometry;
  using Gradients = T[nodes][3];  // and N/r
  using Response = PointResponse<T>;

  static Mask<T> deform(const T du[][2], bool small, Point& g) { return Geometry::deform(du, g, small); }
  static void push_forward(const Point& g, bool small, Gradients& now) { Geometry::push_forward(g, now, small); }
  static void add_force(const Gradients& now, const T s[4], T dv, T* force) { Forces::add_force(now, s, dv, force); }
  static void add_stiffness(const Gradients& now, const Response& r, T dv, T* K) {
    Forces::add_stiffness(now, r.modulus, dv, K);
  }
  static void add_fbar(const SolidSection& section, const Gradients& now, const Response& r, T dv, const T* mean_div,
                       T* K) {
    Forces::add_fbar(section, now, r.modulus, r.stress, dv, mean_div, K);
  }
  static void add_bbar(const SolidSection& section, const Gradients& now, const Response& r, T dv, const T* mean_div,
                       T* force, T* K) {
    Forces::add_bbar(section, now, r.modulus, r.stress, dv, mean_div, force, K);
  }
};

}  // namespace presswork
