// SPDX-License-Identifier: Apache-2.0
#include "remesh/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace presswork {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double on_side = -1e-12;  // barycentric coordinate of what still counts as inside

// Barycentric coordinates of a point in a triangle; false if the triangle has no area.
bool find_share(const double* a, const double* b, const double* c, const double* at, double* share) {
  const double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - a[0], c[1] - a[1]};
  const double w[2] = {at[0] - a[0], at[1] - a[1]}, twice = u[0] * v[1] - u[1] * v[0];
  if (!(twice > 0.0)) return false;
  share[1] = (w[0] * v[1] - w[1] * v[0]) / twice;
  share[2] = (u[0] * w[1] - u[1] * w[0]) / twice;
  share[0] = 1.0 - share[1] - share[2];
  return true;
}

double square_to_side(const double* a, const double* b, const double* at) {
  const double along[2] = {b[0] - a[0], b[1] - a[1]}, way[2] = {at[0] - a[0], at[1] - a[1]};
  const double length = along[0] * along[0] + along[1] * along[1];
  const double part = length > 0.0 ? std::clamp((along[0] * way[0] + along[1] * way[1]) / length, 0.0, 1.0) : 0.0;
  const double off[2] = {way[0] - part * along[0], way[1] - part * along[1]};
  return off[0] * off[0] + off[1] * off[1];
}

}  // namespace

CellGrid::CellGrid(const double* points, Cells cells) : points_(points), cells_(cells), box_(cells.n) {
  double high[2] = {-infinity, -infinity};
  low_[0] = low_[1] = infinity;
  for (int cell = 0; cell < cells.n; ++cell) {
    Box& box = box_[cell] = {{infinity, infinity}, {-infinity, -infinity}};
    for (int a = 0; a < cells.corners; ++a)
      for (int k = 0; k < 2; ++k) {
        const double x = points[2 * static_cast<std::size_t>(cells.of(cell)[a]) + k];
        box.low[k] = std::min(box.low[k], x), box.high[k] = std::max(box.high[k], x);
      }
    for (int k = 0; k < 2; ++k) low_[k] = std::min(low_[k], box.low[k]), high[k] = std::max(high[k], box.high[k]);
  }
  const double width = high[0] - low_[0], height = high[1] - low_[1];
  step_ = std::max({std::sqrt(width * height / std::max(cells.n, 1)), 1e-3 * std::max(width, height), 1e-300});
  for (int k = 0; k < 2; ++k) count_[k] = static_cast<int>((high[k] - low_[k]) / step_) + 1;
  begin_.assign(count_[0] * count_[1] + 1, 0);
  const auto for_squares = [&](auto&& act) {
    for (int cell = 0; cell < cells_.n; ++cell) {
      const Box& box = box_[cell];
      for (int i = square(0, box.low[0]); i <= square(0, box.high[0]); ++i)
        for (int j = square(1, box.low[1]); j <= square(1, box.high[1]); ++j) act(i * count_[1] + j, cell);
    }
  };
  for_squares([&](int place, int) { ++begin_[place + 1]; });
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  cell_.resize(begin_.back());
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  for_squares([&](int place, int cell) { cell_[next[place]++] = cell; });
}

int CellGrid::square(int axis, double at) const {
  const double place = std::clamp((at - low_[axis]) / step_, 0.0, static_cast<double>(count_[axis] - 1));
  return static_cast<int>(place);
}

bool CellGrid::contains(int cell, const double* at, PlaceInCell& place) const {
  const int* nodes = cells_.of(cell);
  double best = -infinity;
  for (int second = 1; second + 1 < cells_.corners; ++second) {
    const int corners[3] = {nodes[0], nodes[second], nodes[second + 1]};
    double share[3];
    if (!find_share(points_ + 2 * corners[0], points_ + 2 * corners[1], points_ + 2 * corners[2], at, share)) continue;
    const double least = std::min({share[0], share[1], share[2]});
    if (least <= best) continue;
    best = least;
    place.cell = cell;
    std::copy(corners, corners + 3, place.nodes);
    std::copy(share, share + 3, place.share);
  }
  return best >= on_side;
}

double CellGrid::square_distance(int cell, const double* at) const {
  const int* nodes = cells_.of(cell);
  double least = infinity;
  for (int a = 0; a < cells_.corners; ++a) {
    const double* begin = points_ + 2 * nodes[a];
    least = std::min(least, square_to_side(begin, points_ + 2 * nodes[(a + 1) % cells_.corners], at));
  }
  return least;
}

int CellGrid::nearest(const double* at) const {
  const int middle[2] = {square(0, at[0]), square(1, at[1])};
  double least = infinity;
  int found = 0;
  for (int ring = 0; ring < std::max(count_[0], count_[1]); ++ring) {
    const double reach = std::max(ring - 1, 0) * step_;
    if (least < reach * reach) break;
    for (int i = std::max(middle[0] - ring, 0); i <= std::min(middle[0] + ring, count_[0] - 1); ++i)
      for (int j = std::max(middle[1] - ring, 0); j <= std::min(middle[1] + ring, count_[1] - 1); ++j) {
        if (std::max(std::abs(i - middle[0]), std::abs(j - middle[1])) < ring) continue;
        for (int k = begin_[i * count_[1] + j]; k < begin_[i * count_[1] + j + 1]; ++k) {
          const double distance = square_distance(cell_[k], at);
          if (distance < least || (distance == least && cell_[k] < found)) least = distance, found = cell_[k];
        }
      }
  }
  return found;
}

PlaceInCell CellGrid::locate(const double* at) const {
  PlaceInCell place{};
  const int here = square(0, at[0]) * count_[1] + square(1, at[1]);
  for (int k = begin_[here]; k < begin_[here + 1]; ++k) {
    const Box& box = box_[cell_[k]];
    const double edge = -on_side * (box.high[0] - box.low[0] + box.high[1] - box.low[1]);
    if (at[0] < box.low[0] - edge || at[0] > box.high[0] + edge) continue;
    if (at[1] < box.low[1] - edge || at[1] > box.high[1] + edge) continue;
    if (contains(cell_[k], at, place)) return place;
  }
  contains(nearest(at), at, place);
  return place;
}

}  // namespace presswork
