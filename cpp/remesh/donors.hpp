// SPDX-License-Identifier: Apache-2.0
// Which points of an old mesh a new point takes its value from, and how much of each: quadratic moving least squares
// (Lancaster & Salkauskas 1981).
//
// Donors are the `most_donors` nearest points, looked for cell by cell from the one in which the new point lies, at
// most `rings` neighbours away: what lies beyond a fold is never reached. Beyond a cell that is farther than all donors
// nothing is looked for. Weights max(1 - (d / 1.05 d_last)^2, 1e-3)^2, d_last the distance of the farthest; basis 1, x,
// y, x^2, x y, y^2 about the new point, over d_last. 1e-13 of the trace on the diagonal of the normal equations keeps
// fits over few places solvable. With fewer than 8 donors the fit is linear, with fewer than 4 the nearest value holds.
#pragma once

#include <vector>

#include "remesh/cells.hpp"

namespace presswork {

constexpr int most_donors = 12, rings = 4;

struct Fit {
  int donor[most_donors];  // the nearest first, and again where there are fewer
  double weight[most_donors], linear_weight[most_donors];
};

class Donors {
 public:
  // position (n, 2) [mm]; cell_of (n,): the cell of each point.
  Donors(const double* position, const int* cell_of, int n, Cells cells);

  // What each thread needs of its own.
  struct Scratch {
    std::vector<int> stamp, front, next;
    int now = 0;
  };
  Scratch make_scratch() const { return {std::vector<int>(box_.size(), 0), {}, {}, 0}; }

  // Fits at pack_width new points (n, 2) at most; home: the cell in or beside which each lies.
  void fit(const double* at, const int* home, int n, Scratch& scratch, Fit* fits) const;

  // Says whether the value of a point (values: of all of them) is above those of all its other donors.
  bool is_peak(int point, int home, const double* position, const double* values, Scratch& scratch) const;

 private:
  struct Box {
    double low[2], high[2];
  };
  struct Near {
    double square;
    int place;  // among the points in the order of their cells
  };
  int find(const double* at, int home, Scratch& scratch, Near* found) const;

  Rows neighbours_, of_cell_;
  std::vector<double> position_;  // in the order of their cells
  std::vector<Box> box_;          // of the points of each cell
};

// Weighs the donors that n new points (n, 2), pack_width at most, have already, once all have moved a little.
// position (n_old, 2) [mm]: of the old points.
void refit(const double* position, const double* at, int n, Fit* fits);

// Values (n_old, m) at new points (n_new, m): the fit's, clipped to the range of the donors and of the linear fit, so
// that a linear field is kept beyond the outermost donors too. Values are counted from the nearest donor's, so that a
// constant stays one. donor, weight, linear_weight (n_new, most_donors).
void apply_fit(const int* donor, const double* weight, const double* linear_weight, int n_new, const double* values,
               int m, double* result);

}  // namespace presswork
