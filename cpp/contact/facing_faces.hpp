// SPDX-License-Identifier: Apache-2.0
// Where faces of one body face those of another in space, across no gap or a narrow one: what facing.hpp is of edges.
//
// Both faces are projected along the normal at the middle of the own one, and their overlap has a rule of its own
// (face_mortar.hpp). Where several others cover a part of a face, each counts in proportion. Faces with a common node
// do not face each other.
#pragma once

#include <vector>

#include "contact/face_interface.hpp"

namespace presswork {

struct FacingFaces {
  std::vector<int> own, other;                 // faces (n)
  std::vector<double> own_shape, other_shape;  // of their nodes there (n, nodes)
  std::vector<double> gap;   // along the normal of the own face, negative where the bodies overlap [mm]
  std::vector<double> area;  // own surface that a point stands for [mm2]
};

// points (n_points, 3) [mm]; reach (own.n) [mm]: faces farther off do not face, overlaps count to half the root of the
// own face's area or to `reach`.
FacingFaces find_facing_faces(const double* points, const FaceList& own, const FaceList& other, const double* reach);

}  // namespace presswork
