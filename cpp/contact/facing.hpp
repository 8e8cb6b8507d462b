// SPDX-License-Identifier: Apache-2.0
// Where straight boundary edges of one body face those of another, across no gap or a narrow one: three points of
// Gauss's rule on every common part of two edges.
//
// Each body is on the left of its edges, so that edges that face each other run against each other. Parts are projected
// along the normal of the own edge; where several others cover a part, each counts in proportion. Every edge is
// compared with every other by their boxes, which for the surfaces of a section is faster than a tree.
#pragma once

#include <vector>

namespace presswork {

struct Edges {
  int n;
  const int* nodes;  // (n, 2)
};

struct Facing {
  int own, other;                       // edges
  double own_shape[2], other_shape[2];  // of the ends there
  double gap;                           // along the normal of the own edge, negative where the bodies overlap [mm]
  double area;                          // own surface that the point stands for [mm2]
};

// points (n_points, 2) [mm]; reach (own.n) [mm]: edges farther off do not face, overlaps count to half the own edge or
// to `reach`; thickness out of the plane [mm], 0 of rings.
std::vector<Facing> find_facing(const double* points, Edges own, Edges other, const double* reach, double thickness);

}  // namespace presswork
