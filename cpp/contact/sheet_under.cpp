// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_under.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

constexpr double on_edge = 1e-10;  // of the cell's size squared: so far beyond an edge is still inside
constexpr int most_steps = 1000;
constexpr int newton_steps = 20;

double cross2(const double a[2], const double b[2]) { return a[0] * b[1] - a[1] * b[0]; }

}  // namespace

SheetUnder::SheetUnder(std::vector<int> start, std::vector<int> corner, const std::vector<Hanging>& hanging)
    : start_(std::move(start)), corner_(std::move(corner)), neighbour_(corner_.size(), -1) {
  std::map<std::pair<int, int>, std::pair<int, int>> seen;  // edge: the cell that has it, its place in neighbour_
  for (int cell = 0; cell < n_cells(); ++cell)
    for (int a = 0; a < corners(cell); ++a) {
      const int at = start_[cell] + a, one = corner_[at], other = corner_[start_[cell] + (a + 1) % corners(cell)];
      const auto edge = std::minmax(one, other);
      const auto [found, is_new] = seen.try_emplace(edge, cell, at);
      if (is_new) continue;
      neighbour_[at] = found->second.first;
      neighbour_[found->second.second] = cell;
    }
  for (const Hanging& h : hanging) {
    const auto whole = seen.at(std::minmax(h.end[0], h.end[1]));
    for (int end : h.end) {
      const auto half = seen.at(std::minmax(h.node, end));
      neighbour_[half.second] = whole.first, neighbour_[whole.second] = half.first;
    }
  }
}

void SheetUnder::take_corners(int cell, const double* position, int stride, double x[4][3]) const {
  for (int a = 0; a < corners(cell); ++a)
    for (int i = 0; i < 3; ++i) x[a][i] = position[std::size_t(stride) * corner_[start_[cell] + a] + i];
}

double SheetUnder::worst_edge(int cell, const double place[2], const double x[4][3], int& neighbour) const {
  const int n = corners(cell);
  double area = 0.0, size = 0.0;
  for (int a = 0; a < n; ++a) {
    const double *p = x[a], *q = x[(a + 1) % n];
    area += cross2(p, q);
    size = std::max(size, std::hypot(q[0] - p[0], q[1] - p[1]));
  }
  const double sign = area < 0.0 ? -1.0 : 1.0;  // seen from above or from below
  double worst = 0.0, worst_with = 0.0;
  neighbour = -1;
  for (int a = 0; a < n; ++a) {
    const double *p = x[a], *q = x[(a + 1) % n];
    const double along[2] = {q[0] - p[0], q[1] - p[1]}, to[2] = {place[0] - p[0], place[1] - p[1]};
    const double within = sign * cross2(along, to) + on_edge * size * size;
    worst = std::min(worst, within);
    if (within < worst_with && neighbour_[start_[cell] + a] >= 0)
      worst_with = within, neighbour = neighbour_[start_[cell] + a];
  }
  return worst;
}

int SheetUnder::nearest_cell(const double place[2], const double* position, int stride) const {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int cell = 0; cell < n_cells(); ++cell) {
    double x[4][3], middle[2] = {0.0, 0.0};
    take_corners(cell, position, stride, x);
    for (int a = 0; a < corners(cell); ++a)
      for (int i = 0; i < 2; ++i) middle[i] += x[a][i] / corners(cell);
    const double away = std::hypot(middle[0] - place[0], middle[1] - place[1]);
    if (away < least) least = away, nearest = cell;
  }
  return nearest;
}

void SheetUnder::interpolate(const double place[2], const double x[4][3], Beneath& found) const {
  double g[2][3];  // slopes of the surface
  if (found.corners == 3) {
    for (int i = 0; i < 3; ++i) g[0][i] = x[1][i] - x[0][i], g[1][i] = x[2][i] - x[0][i];
    const double to[2] = {place[0] - x[0][0], place[1] - x[0][1]}, area = cross2(g[0], g[1]);
    const double r = cross2(to, g[1]) / area, s = cross2(g[0], to) / area;
    found.weight[0] = 1.0 - r - s, found.weight[1] = r, found.weight[2] = s, found.weight[3] = 0.0;
  } else {
    static constexpr double at[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double r[2] = {0.0, 0.0};
    for (int step = 0; step < newton_steps; ++step) {  // x(r) = place, bilinear in the plan
      double miss[2] = {place[0], place[1]};
      for (auto& slope : g) slope[0] = slope[1] = slope[2] = 0.0;
      for (int a = 0; a < 4; ++a) {
        const double u = 1.0 + at[a][0] * r[0], v = 1.0 + at[a][1] * r[1];
        found.weight[a] = 0.25 * u * v;
        for (int i = 0; i < 3; ++i) g[0][i] += 0.25 * at[a][0] * v * x[a][i], g[1][i] += 0.25 * at[a][1] * u * x[a][i];
        for (int i = 0; i < 2; ++i) miss[i] -= found.weight[a] * x[a][i];
      }
      const double area = cross2(g[0], g[1]), dr = cross2(miss, g[1]) / area, ds = cross2(g[0], miss) / area;
      if (std::fabs(dr) + std::fabs(ds) < 1e-12 || !std::isfinite(dr + ds)) break;
      r[0] = std::clamp(r[0] + dr, -1.0, 1.0), r[1] = std::clamp(r[1] + ds, -1.0, 1.0);
    }
  }
  cross(g[0], g[1], found.normal);
}

void SheetUnder::stand_on(int cell, Beneath& at) const {
  at.cell = cell;
  at.corners = cell >= 0 ? corners(cell) : 0;
  at.node = cell >= 0 ? &corner_[start_[cell]] : nullptr;
}

void SheetUnder::find(const double place[2], const double* position, int stride, Beneath& from) const {
  int cell = from.cell >= 0 ? from.cell : nearest_cell(place, position, stride);
  double x[4][3];
  from.inside = false;
  for (int step = 0; step < most_steps; ++step) {
    int next = -1;
    take_corners(cell, position, stride, x);
    from.inside = !(worst_edge(cell, place, x, next) < 0.0);
    if (from.inside || next < 0) break;
    cell = next;
  }
  stand_on(cell, from);
  if (from.inside) interpolate(place, x, from);
}

}  // namespace presswork::contact
