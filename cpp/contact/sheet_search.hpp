// SPDX-License-Identifier: Apache-2.0
// The search of sheet_under.hpp, on arrays that lie in any memory: that of the CPU, or of a card.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "contact/vectors.hpp"
#include "tensor/pack.hpp"

namespace presswork::contact {

struct Beneath {
  int cell = -1;        // the last one found, or where the walk ended
  bool inside = false;  // whether it lies beneath
  int corners = 0;
  const int* node = nullptr;  // of the cell
  double weight[4] = {};      // shape functions of its corners
  double normal[3] = {};      // of the sheet, of any length
};

// As SheetUnder has its arrays. A cell in another part of the sheet has corners below zero: a walk ends there.
struct SheetSearch {
  int n = 0;                  // cells
  const int *start, *corner;  // (n + 1), (start[n])
  const int* neighbour;       // (start[n])

  static constexpr double on_edge = 1e-10;  // of the cell's size squared: so far beyond an edge is still inside
  static constexpr int most_steps = 1000, newton_steps = 20;

  PRESSWORK_DEVICE int corners(int cell) const { return start[cell + 1] - start[cell]; }
  PRESSWORK_DEVICE bool has(int cell) const { return corner[start[cell]] >= 0; }

  // Take a cell, or none (-1), for the one found last.
  PRESSWORK_DEVICE void stand_on(int cell, Beneath& at) const {
    at.cell = cell;
    at.corners = cell >= 0 ? corners(cell) : 0;
    at.node = cell >= 0 ? corner + start[cell] : nullptr;
  }

  // position: records of `stride` numbers, x, y, z first. from.cell: where to begin, or -1 to look at every cell.
  PRESSWORK_DEVICE void find(const double place[2], const double* position, int stride, Beneath& from) const {
    int cell = from.cell >= 0 ? from.cell : nearest_cell(place, position, stride);
    double x[4][3];
    from.inside = false;
    for (int step = 0; step < most_steps && has(cell); ++step) {
      int next = -1;
      take_corners(cell, position, stride, x);
      from.inside = !(worst_edge(cell, place, x, next) < 0.0);
      if (from.inside || next < 0) break;
      cell = next;
    }
    stand_on(cell, from);
    if (from.inside) interpolate(place, x, from);
  }

  // The cell whose middle is nearest to a place.
  PRESSWORK_DEVICE int nearest_cell(const double place[2], const double* position, int stride) const {
    int nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int cell = 0; cell < n; ++cell) {
      double x[4][3], middle[2] = {0.0, 0.0};
      take_corners(cell, position, stride, x);
      for (int a = 0; a < corners(cell); ++a)
        for (int i = 0; i < 2; ++i) middle[i] += x[a][i] / corners(cell);
      const double away = std::hypot(middle[0] - place[0], middle[1] - place[1]);
      if (away < least) least = away, nearest = cell;
    }
    return nearest;
  }

 private:
  PRESSWORK_DEVICE static double cross2(const double a[2], const double b[2]) { return a[0] * b[1] - a[1] * b[0]; }
  PRESSWORK_DEVICE static double clamped(double r) { return smaller(presswork::larger(r, -1.0), 1.0); }

  PRESSWORK_DEVICE void take_corners(int cell, const double* position, int stride, double x[4][3]) const {
    for (int a = 0; a < corners(cell); ++a)
      for (int i = 0; i < 3; ++i) x[a][i] = position[std::size_t(stride) * corner[start[cell] + a] + i];
  }

  // How far inside the edge that the place is beyond most [mm2], and its neighbour; edges without one come last.
  PRESSWORK_DEVICE double worst_edge(int cell, const double place[2], const double x[4][3], int& next) const {
    const int n_edges = corners(cell);
    double area = 0.0, size = 0.0;
    for (int a = 0; a < n_edges; ++a) {
      const double *p = x[a], *q = x[(a + 1) % n_edges];
      area += cross2(p, q);
      size = presswork::larger(size, std::hypot(q[0] - p[0], q[1] - p[1]));
    }
    const double sign = area < 0.0 ? -1.0 : 1.0;  // seen from above or from below
    double worst = 0.0, worst_with = 0.0;
    next = -1;
    for (int a = 0; a < n_edges; ++a) {
      const double *p = x[a], *q = x[(a + 1) % n_edges];
      const double along[2] = {q[0] - p[0], q[1] - p[1]}, to[2] = {place[0] - p[0], place[1] - p[1]};
      const double within = sign * cross2(along, to) + on_edge * size * size;
      worst = smaller(worst, within);
      if (within < worst_with && neighbour[start[cell] + a] >= 0)
        worst_with = within, next = neighbour[start[cell] + a];
    }
    return worst;
  }

  PRESSWORK_DEVICE static void interpolate(const double place[2], const double x[4][3], Beneath& found) {
    double g[2][3];  // slopes of the surface
    if (found.corners == 3) {
      for (int i = 0; i < 3; ++i) g[0][i] = x[1][i] - x[0][i], g[1][i] = x[2][i] - x[0][i];
      const double to[2] = {place[0] - x[0][0], place[1] - x[0][1]}, area = cross2(g[0], g[1]);
      const double r = cross2(to, g[1]) / area, s = cross2(g[0], to) / area;
      found.weight[0] = 1.0 - r - s, found.weight[1] = r, found.weight[2] = s, found.weight[3] = 0.0;
    } else {
      const double at[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
      double r[2] = {0.0, 0.0};
      for (int step = 0; step < newton_steps; ++step) {  // x(r) = place, bilinear in the plan
        double miss[2] = {place[0], place[1]};
        for (auto& slope : g) slope[0] = slope[1] = slope[2] = 0.0;
        for (int a = 0; a < 4; ++a) {
          const double u = 1.0 + at[a][0] * r[0], v = 1.0 + at[a][1] * r[1];
          found.weight[a] = 0.25 * u * v;
          for (int i = 0; i < 3; ++i)
            g[0][i] += 0.25 * at[a][0] * v * x[a][i], g[1][i] += 0.25 * at[a][1] * u * x[a][i];
          for (int i = 0; i < 2; ++i) miss[i] -= found.weight[a] * x[a][i];
        }
        const double area = cross2(g[0], g[1]), dr = cross2(miss, g[1]) / area, ds = cross2(g[0], miss) / area;
        if (std::fabs(dr) + std::fabs(ds) < 1e-12 || !std::isfinite(dr + ds)) break;
        r[0] = clamped(r[0] + dr), r[1] = clamped(r[1] + ds);
      }
    }
    cross(g[0], g[1], found.normal);
  }
};

}  // namespace presswork::contact
