// SPDX-License-Identifier: Apache-2.0
// Waves of a sheet along the lines on which it is compressed: how far it bends to one side between two places where it
// bends to the other.
#pragma once

namespace presswork::contact {

// A line through a cell follows the most compressed direction from place to place, and goes straight on where the sheet
// is not compressed or that direction turns by more than 60 degrees. It ends where no cell is near.
struct SheetWaves {
  static constexpr int most_places = 64;  // of a line, to either side

  int n_cells;            // of the sheet
  const double* centre;   // (n_cells, 3) of the cells [mm]
  const double* bending;  // (n_cells, 6) bending strain: xx, yy, zz, xy, yz, xz
  const double* along;    // (n_cells, 3) most compressed direction, of length 1; zero: not compressed

  int n, n_places;          // lines; places to either side, at most most_places
  const int* own;           // (n) the cell through which the line leads, which is compressed
  const double* step;       // (n) from place to place [mm]
  const double* size;       // (n) distance from a place beyond which no cell lies there, grows by a third of the way
  const double* thickness;  // (n) [mm]
  double least_height;      // of a wave, over the thickness: of a sine with its bending and length

  // amplitude (n): the largest bending strain that the line has to one side between two places to the other which have
  // as much, the own cell between them or one of them; 0: no wave. side (n): bending of the own cell along its line.
  // Threads share the lines.
  void find(double* amplitude, double* side) const;
};

}  // namespace presswork::contact
