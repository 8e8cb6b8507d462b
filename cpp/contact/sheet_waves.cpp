// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_waves.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "contact/point_grid.hpp"
#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

constexpr double follows = 0.5;  // cosine up to which a line turns
constexpr double full = 0.5;     // bending over that of the wave from which a place is an end of it
constexpr double widens = 0.35;  // distance of a cell over the way from the own one

double bend(const double b[6], const double d[3]) {
  return d[0] * d[0] * b[0] + d[1] * d[1] * b[1] + d[2] * d[2] * b[2] +
         2.0 * (d[0] * d[1] * b[3] + d[1] * d[2] * b[4] + d[0] * d[2] * b[5]);
}

// The wave with the largest bending of a line of `n` places, `step` apart, that has place `own` in it.
double find_largest(const double* bent, int n, int own, double step, double thickness, double least_height) {
  double largest = 0.0;
  for (int middle = 0; middle < n; ++middle) {
    const double sign = bent[middle] < 0.0 ? -1.0 : 1.0;
    int ends[2] = {-1, -1};  // where it bends most to the other side, the nearest if alike
    for (int i = middle - 1; i >= 0; --i)
      if (ends[0] < 0 || -sign * bent[i] > -sign * bent[ends[0]]) ends[0] = i;
    for (int i = middle + 1; i < n; ++i)
      if (ends[1] < 0 || -sign * bent[i] > -sign * bent[ends[1]]) ends[1] = i;
    if (ends[0] < 0 || ends[1] < 0) continue;
    const double strain = std::min({sign * bent[middle], -sign * bent[ends[0]], -sign * bent[ends[1]]});
    if (!(strain > largest)) continue;
    for (const int way : {0, 1})  // the wave's own ends: further on another wave may be higher
      for (ends[way] = middle; -sign * bent[ends[way]] < full * strain;) ends[way] += 2 * way - 1;
    if (own < ends[0] || own > ends[1]) continue;
    const double length = step * (ends[1] - ends[0]) / (2.0 * std::numbers::pi);
    if (2.0 * strain / thickness * length * length >= least_height * thickness) largest = strain;
  }
  return largest;
}

}  // namespace

void SheetWaves::find(double* amplitude, double* side) const {
  const PointGrid grid(centre, n_cells);
#pragma omp parallel for schedule(dynamic, 64)
  for (int i = 0; i < n; ++i) {
    double bent[2 * most_places + 1];
    int first = most_places, last = most_places;
    const int middle = own[i];
    bent[first] = side[i] = bend(bending + 6 * std::size_t(middle), along + 3 * std::size_t(middle));
    for (const int way : {-1, 1}) {
      double place[3], heading[3];
      for (int k = 0; k < 3; ++k) {
        place[k] = centre[3 * std::size_t(middle) + k];
        heading[k] = way * along[3 * std::size_t(middle) + k];
      }
      int cell = middle;  // at the place before: bounds the search at the next
      for (int p = 1; p <= n_places; ++p) {
        for (int k = 0; k < 3; ++k) place[k] += step[i] * heading[k];
        const double within = std::max(size[i], widens * p * step[i]);
        PointGrid::Found nearest{within * within};
        PointGrid::compare(centre + 3 * std::size_t(cell), cell, place, nearest);
        grid.find(place, nearest);
        if (nearest.point < 0) break;
        // the nearest cells of places lie to either side of the line: one that lies behind the last is not another
        // place
        double ahead = 0.0;
        for (int k = 0; k < 3; ++k)
          ahead += heading[k] * (centre[3 * std::size_t(nearest.point) + k] - centre[3 * std::size_t(cell) + k]);
        if (ahead > 0.0) cell = nearest.point;
        const double* here = along + 3 * std::size_t(cell);
        const double turn = dot(here, heading);
        if (std::abs(turn) > follows)
          for (int k = 0; k < 3; ++k) heading[k] = turn < 0.0 ? -here[k] : here[k];
        bent[most_places + way * p] = bend(bending + 6 * std::size_t(cell), heading);
        (way < 0 ? first : last) += way;
      }
    }
    amplitude[i] =
        find_largest(bent + first, last - first + 1, most_places - first, step[i], thickness[i], least_height);
  }
}

}  // namespace presswork::contact
