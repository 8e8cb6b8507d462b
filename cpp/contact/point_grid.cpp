// SPDX-License-Identifier: Apache-2.0
#include "contact/point_grid.hpp"

#include <algorithm>
#include <cmath>

namespace presswork::contact {

PointGrid::PointGrid(const double* point, int n) {
  double size[3], longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    low_[k] = point[k];
    double high = point[k];
    for (int i = 1; i < n; ++i) {
      low_[k] = std::min(low_[k], point[3 * std::size_t(i) + k]);
      high = std::max(high, point[3 * std::size_t(i) + k]);
    }
    size[k] = high - low_[k], longest = std::max(longest, size[k]);
  }
  // 1. the smallest cubes that are no more than wanted; a flat box is one cube thick, and so is one without end
  const auto cubes = [&](double side, int axis) { return std::floor(size[axis] / side) + 1.0; };
  const auto all = [&](double side) { return cubes(side, 0) * cubes(side, 1) * cubes(side, 2); };
  const bool is_finite = longest > 0.0 && std::isfinite(longest);
  side_ = is_finite ? longest : 1.0;
  while (is_finite && side_ > 1e-6 * longest && all(0.8 * side_) <= double(cubes_a_point) * n) side_ *= 0.8;
  for (int k = 0; k < 3; ++k) count_[k] = is_finite ? static_cast<int>(cubes(side_, k)) : 1;

  // 2. points by cubes, in each by rising number
  start_.assign(row(0, count_[2]) + 1, 0);
  std::vector<std::size_t> home(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double* x = point + 3 * std::size_t(i);
    home[i] = row(cube(x[1], 1), cube(x[2], 2)) + cube(x[0], 0);
    ++start_[home[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  point_.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double* x = point + 3 * std::size_t(i);
    point_[next[home[i]]++] = {{x[0], x[1], x[2]}, i};
  }
}

int PointGrid::cube(double x, int axis) const {
  const double at = (x - low_[axis]) / side_;
  return at > 0.0 ? static_cast<int>(std::min(at, count_[axis] - 1.0)) : 0;
}

void PointGrid::compare_all(std::size_t first_cube, std::size_t last_cube, const double place[3], Found& found) const {
  for (int i = start_[first_cube]; i < start_[last_cube + 1]; ++i) compare(point_[i].x, point_[i].number, place, found);
}

void PointGrid::find(const double place[3], Found& found) const {
  // 1. the place's own cube, if anything is there, bounds the rest
  const std::size_t own = row(cube(place[1], 1), cube(place[2], 2)) + cube(place[0], 0);
  compare_all(own, own, place, found);

  // 2. all cubes that a point as near may lie in, row by row
  const double reach = std::sqrt(found.away2) * (1.0 + 1e-12);
  int low[3], high[3];
  for (int k = 0; k < 3; ++k) low[k] = cube(place[k] - reach, k), high[k] = cube(place[k] + reach, k);
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y) compare_all(row(y, z) + low[0], row(y, z) + high[0], place, found);
}

}  // namespace presswork::contact
