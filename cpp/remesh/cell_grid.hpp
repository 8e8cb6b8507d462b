// SPDX-License-Identifier: Apache-2.0
// In which cell of a mesh in the plane a point lies, or which is nearest to it: squares over the mesh, each with the
// cells whose boxes meet it, about as many squares as cells.
#pragma once

#include <vector>

#include "remesh/cells.hpp"

namespace presswork {

struct PlaceInCell {
  int cell;
  int nodes[3];     // corners of the triangle of that cell, (0, 1, 2) or (0, 2, 3)
  double share[3];  // barycentric coordinates in it, negative outside the mesh
};

class CellGrid {
 public:
  // points (n_points, 2) [mm] must outlive the grid, as the cells must.
  CellGrid(const double* points, Cells cells);

  PlaceInCell locate(const double* at) const;

 private:
  struct Box {
    double low[2], high[2];
  };
  bool contains(int cell, const double* at, PlaceInCell& place) const;
  double square_distance(int cell, const double* at) const;
  int nearest(const double* at) const;
  int square(int axis, double at) const;

  const double* points_;
  Cells cells_;
  double low_[2], step_;
  int count_[2];
  std::vector<Box> box_;
  std::vector<int> begin_, cell_;  // of each square
};

}  // namespace presswork
