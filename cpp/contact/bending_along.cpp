// SPDX-License-Identifier: Apache-2.0
#include "contact/bending_along.hpp"

#include <algorithm>
#include <cstddef>

#include "contact/point_grid.hpp"

namespace presswork::contact {

void BendingAlong::find(double* up, double* down) const {
  const PointGrid grid(centre, n_cells);
#pragma omp parallel for schedule(dynamic, 64)
  for (int i = 0; i < n; ++i) {
    const double *d = along + 3 * std::size_t(i), *x = centre + 3 * std::size_t(own[i]);
    const double share[6] = {d[0] * d[0],       d[1] * d[1],       d[2] * d[2],
                             2.0 * d[0] * d[1], 2.0 * d[1] * d[2], 2.0 * d[0] * d[2]};
    up[i] = down[i] = 0.0;
    const auto bend = [&](int cell) {
      double b = 0.0;
      for (int s = 0; s < 6; ++s) b += share[s] * bending[6 * std::size_t(cell) + s];
      up[i] = std::max(up[i], b), down[i] = std::max(down[i], -b);
    };
    bend(own[i]);
    int last = own[i];  // found at the place before: bounds the search at the next
    for (int p = 0; p < n_places; ++p) {
      const std::size_t at = std::size_t(i) * n_places + p;
      const double place[3] = {x[0] + way[at] * d[0], x[1] + way[at] * d[1], x[2] + way[at] * d[2]};
      PointGrid::Found nearest{within[at] * within[at]};
      for (const int known : {own[i], last}) PointGrid::compare(centre + 3 * std::size_t(known), known, place, nearest);
      grid.find(place, nearest);
      if (nearest.point < 0) continue;
      last = nearest.point;
      bend(last);
    }
  }
}

}  // namespace presswork::contact
