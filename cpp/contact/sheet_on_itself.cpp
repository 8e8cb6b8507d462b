// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_on_itself.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tensor/dual.hpp"

namespace presswork {

template <int N>
bool operator<=(const Dual<double, N>& a, const Dual<double, N>& b) {
  return a.value <= b.value;
}
template <int N>
bool operator>=(const Dual<double, N>& a, const Dual<double, N>& b) {
  return a.value >= b.value;
}
template <int N>
bool operator<=(const Dual<double, N>& a, double b) {
  return a.value <= b;
}
template <int N>
bool operator>=(const Dual<double, N>& a, double b) {
  return a.value >= b;
}

}  // namespace presswork

namespace presswork::contact {

namespace {

constexpr double through = 2.0;  // distances at which a node may touch: farther off it has not come through

void take_corners(const double* position, int n, const int* nodes, double corner[4][3]) {
  for (int a = 0; a < n; ++a) std::copy_n(position + 3 * std::size_t(nodes[a]), 3, corner[a]);
}

}  // namespace

void SheetOnItself::list_nodes(int node, int cell, int nodes[5]) const {
  nodes[0] = node;
  for (int a = 0; a < 4; ++a) nodes[1 + a] = cell_node_[cell_start_[cell] + std::min(a, corners(cell) - 1)];
}

// Of any length.
void SheetOnItself::find_normal(int node, const double* position, double normal[3]) const {
  std::fill_n(normal, 3, 0.0);
  for (int s = node_start_[node]; s < node_start_[node + 1]; ++s) {
    const int cell = node_cell_[s], n = corners(cell);
    double corner[4][3], d[3], e[3], own[3];
    take_corners(position, n, &cell_node_[cell_start_[cell]], corner);
    for (int i = 0; i < 3; ++i) d[i] = corner[2][i] - corner[0][i], e[i] = corner[n - 1][i] - corner[1][i];
    cross(d, e, own);
    for (int i = 0; i < 3; ++i) normal[i] += own[i];
  }
}

std::vector<std::pair<int, int>> SheetOnItself::search(const double* position, const std::vector<double>& half_node,
                                                       const std::vector<double>& half_cell, double margin) {
  list_near(position, 3, half_node, half_cell, margin, entries_);
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t e = 0; e < entries_.cell.size(); ++e)
    for (int s = cell_start_[entries_.cell[e]]; s < cell_start_[entries_.cell[e] + 1]; ++s)
      pairs.push_back(std::minmax(entries_.node[e], cell_node_[s]));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

int SheetOnItself::look(const SheetPlace& sheet, double reach, int* cell, double* gap, double* normal) const {
  std::fill_n(cell, 2 * n_nodes_, -1);
  std::fill_n(gap, 2 * n_nodes_, std::numeric_limits<double>::infinity());
  int gone = -1;
  for (int node = 0; node + 1 < static_cast<int>(entries_.start.size()); ++node) {
    const double* x = sheet.now + 3 * std::size_t(node);
    bool has_normal = false;
    double out[3];
    for (int e = entries_.start[node]; e < entries_.start[node + 1]; ++e) {
      const int at = entries_.cell[e], n = corners(at);
      double corner[4][3], before[4][3];
      take_corners(sheet.now, n, &cell_node_[cell_start_[at]], corner);
      const OnCell now = find_closest_on_cell(x, n, corner);
      const double distance = std::sqrt(now.squared), touching = sheet.half_node[node] + sheet.half_cell[at];
      if (distance > through * touching) continue;
      take_corners(sheet.before, n, &cell_node_[cell_start_[at]], before);
      const OnCell was = find_closest_on_cell(sheet.before + 3 * std::size_t(node), n, before);
      if (!(dot(now.away, was.away) > 0.0)) gone = gone < 0 ? node : gone;
      if (distance - touching >= reach) continue;
      if (!has_normal) find_normal(node, sheet.before, out), has_normal = true;
      const std::size_t slot = 2 * std::size_t(node) + (dot(now.away, out) < 0.0);
      if (distance - touching >= gap[slot]) continue;
      cell[slot] = at, gap[slot] = distance - touching;
      for (int i = 0; i < 3; ++i) normal[3 * slot + i] = now.away[i] / distance;
    }
  }
  return gone;
}

void SheetOnItself::touch(const SheetPlace& sheet, const SlotTouch& at, double mu, int nodes[5],
                          SlotForce& found) const {
  using Number = Dual<double, 15>;
  const int n = corners(at.cell);
  list_nodes(at.slot / 2, at.cell, nodes);
  // 1. places and ways of the node and the corners, as variables
  Number x[5][3], way[5][3];
  for (int a = 0; a <= n; ++a)
    for (int i = 0; i < 3; ++i) {
      const double now = sheet.now[3 * std::size_t(nodes[a]) + i];
      x[a][i] = Number::variable(now, 3 * a + i);
      way[a][i] = Number::variable(now - sheet.before[3 * std::size_t(nodes[a]) + i], 3 * a + i);
    }
  const PlaceOnCell<Number> place = find_closest_on_cell<Number>(x[0], n, x + 1);
  // 2. normal force
  const Number distance = square_root(place.squared), push = Number(at.push) + at.slope * (distance - distance.value);
  Number normal[3], slip[3];
  for (int i = 0; i < 3; ++i) {
    normal[i] = place.away[i] / distance, slip[i] = way[0][i];
    for (int a = 0; a < n; ++a) slip[i] -= place.weight[a] * way[1 + a][i];
  }
  // 3. friction: elastic trial in the tangent plane, shortened to mu N
  Number trial[3];
  for (int i = 0; i < 3; ++i) trial[i] = Number(at.shear_n[i]) - at.hanging * slip[i];
  const Number out = dot(normal, trial);
  for (int i = 0; i < 3; ++i) trial[i] -= out * normal[i];
  const Number size = square_root(dot(trial, trial)), limit = mu * push;
  if (mu == 0.0)
    std::fill_n(trial, 3, Number(0.0));
  else if (size > limit)
    for (Number& each : trial) each *= limit / size;
  // 4. on the node, and the opposite on the corners
  for (int a = 0; a < 5; ++a)
    for (int i = 0; i < 3; ++i) {
      const Number own = push * normal[i] + trial[i];
      const Number force = a == 0 ? own : a <= n ? -(place.weight[a - 1] * own) : Number(0.0);
      found.force[a][i] = force.value;
      for (int b = 0; b < 5; ++b)
        for (int j = 0; j < 3; ++j) found.tangent[a][b][i][j] = b <= n ? -force.slope[3 * b + j] : 0.0;
    }
  for (int i = 0; i < 3; ++i) found.shear[i] = trial[i].value, found.slip[i] = slip[i].value;
}

}  // namespace presswork::contact
