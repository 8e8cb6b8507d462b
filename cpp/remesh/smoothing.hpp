// SPDX-License-Identifier: Apache-2.0
// Inner nodes of quadrilaterals move half-way to the middle of their neighbours, all at once, again and again. Where a
// cell that is not good becomes worse, its nodes go back; a round in which this does not end is the last, and dropped.
#pragma once

#include "remesh/cells.hpp"

namespace presswork {

struct SmoothingRounds {
  int most, most_retreats;
  double good;  // quality from which on a cell may become worse
};

// Quality of a quadrilateral: four times the least Jacobian at a corner over the sum of the squared sides.
double measure_quality(const double* points, const int* nodes);

// points (n_points, 2) [mm] are changed in place, but for the first n_fixed; cells are quadrilaterals.
void smooth_cells(double* points, int n_points, Cells cells, int n_fixed, SmoothingRounds rounds);

}  // namespace presswork
