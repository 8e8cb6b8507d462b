// SPDX-License-Identifier: Apache-2.0
// Delaunay's triangulation of points that have moved a little, from the triangles of the points before: sides are
// flipped until no triangle's circle holds the point beyond a side (Lawson 1977). Points on one circle stay as they
// are.
#pragma once

namespace presswork {

// points (n_points, 2) [mm]; corners (n, 3), counter-clockwise, and beside (n, 3), the triangle opposite to each corner
// or -1, are changed in place. False where a triangle is inside out: the points have moved too far.
bool restore_delaunay(const double* points, int n, int* corners, int* beside);

}  // namespace presswork
