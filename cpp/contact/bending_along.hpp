// SPDX-License-Identifier: Apache-2.0
// The largest bending of a sheet to either side, on a line through each of some shells.
#pragma once

namespace presswork::contact {

struct BendingAlong {
  int n_cells;            // of the sheet
  const double* centre;   // (n_cells, 3) of the cells [mm]
  const double* bending;  // (n_cells, 6) bending strain: xx, yy, zz, xy, yz, xz

  int n, n_places;
  const int* own;        // (n) the cell through which the line leads
  const double* along;   // (n, 3) its direction, of length 1
  const double* way;     // (n, n_places) of places on it from the cell [mm], outwards to one side, then to the other
  const double* within;  // (n, n_places) distance beyond which no cell lies at the place [mm]

  // up, down (n): the largest bending along the line of the cells at the places and of the line's own cell, and the
  // largest of the opposite sign; zero where no cell is bent that way. The cell at a place is that with the nearest
  // centre. Threads share the lines.
  void find(double* up, double* down) const;
};

}  // namespace presswork::contact
