// SPDX-License-Identifier: Apache-2.0
// Triangles rounded off: what implicit contact needs, whose iterations do not settle where normals jump.
//
// Each triangle carries a cubic patch over its corners' normals (the PN triangle of Vlachos, Peters, Boyd & Mitchell
// 2001) and the normals between them, linear and made unit. A point's place is found along these normals,
//
//     x = p(u, v) + g n(u, v),
//
// so gap and normal are continuous over edges, and of a tool meshed by chords the gap is that of the curve, not of the
// chords. A corner's normal is the mean of the triangles around it, by area and angle, so that large flats stay flat
// beside small facets; it ends at creases, edges where the triangles meet at more than 40 degrees. Beyond creases and
// open edges the triangles are taken as they are.
#pragma once

#include <vector>

#include "contact/touch.hpp"
#include "contact/triangulation.hpp"

namespace presswork::contact {

class SmoothTriangulation {
 public:
  explicit SmoothTriangulation(Triangulation triangles);

  // As ToolSurface::nearest; hint becomes the triangle.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    Slopes slopes;
    return nearest(x, reach, hint, touch, slopes);
  }
  bool nearest(const double x[3], double reach, int& hint, Touch& touch, Slopes& slopes) const;

  double depth() const { return flat_.depth(); }

  const Triangulation& flat() const { return flat_; }  // as it was before

 private:
  static constexpr int open = -1, crease = -2;  // instead of a neighbour
  struct Patch {
    double control[10][3];  // of the cubic; numbered as in smooth_triangulation.cpp
    double normal[3][3];    // unit, at the corners
    int neighbour[3];       // behind the edge from corner k
  };
  struct Place {
    double u, v, gap;  // weights of the second and third corner
  };

  void find_neighbours();
  void set_normals();
  void set_controls();
  bool project(const Patch& patch, const double x[3], Place& place, Touch& touch, Slopes& slopes) const;

  Triangulation flat_;
  std::vector<Patch> patches_;
  double bulge_ = 0.0;  // how far patches leave their triangles at most [mm]
};

}  // namespace presswork::contact
