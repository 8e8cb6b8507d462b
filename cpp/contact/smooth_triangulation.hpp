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

#include "contact/smooth_search.hpp"
#include "contact/triangulation.hpp"

namespace presswork::contact {

class SmoothTriangulation {
 public:
  explicit SmoothTriangulation(Triangulation triangles);

  // As ToolSurface::nearest; hint becomes the triangle.
  bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    return search().nearest(flat_, x, reach, hint, touch, nullptr);
  }
  bool nearest(const double x[3], double reach, int& hint, Touch& touch, Slopes& slopes) const {
    return search().nearest(flat_, x, reach, hint, touch, &slopes);
  }
  // The search, on patches of this surface: good for as long as it lives.
  SmoothSearch search() const { return {patches_.data(), flat_.size(), bulge_, flat_.depth()}; }

  double depth() const { return flat_.depth(); }

  const Triangulation& flat() const { return flat_; }  // as it was before

 private:
  using Patch = SmoothPatch;

  void find_neighbours();
  void set_normals();
  void set_controls();

  Triangulation flat_;
  std::vector<Patch> patches_;
  double bulge_ = 0.0;  // how far patches leave their triangles at most [mm]
};

}  // namespace presswork::contact
