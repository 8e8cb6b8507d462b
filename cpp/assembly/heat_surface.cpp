// SPDX-License-Identifier: Apache-2.0
#include "assembly/heat_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace presswork {

namespace {

constexpr double far = 1e3;  // gaps, in widths across which heat passes, beyond which all are one
const double root = std::sqrt(0.6);
const double gauss[3][2] = {{-root, 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {root, 5.0 / 9.0}};

// Part of heat that passes an edge across the gaps at its ends.
double find_part(double first, double last, double width) {
  first = std::min(first, far * width + 1.0), last = std::min(last, far * width + 1.0);
  double part = 0.0;
  for (const auto& [s, weight] : gauss) {
    const double between = 0.5 * (1 - s) * first + 0.5 * (1 + s) * last;
    part += 0.5 * weight * std::clamp(1.0 - std::max(between, 0.0) / width, 0.0, 1.0);
  }
  return part;
}

// The same of a face of three or four corners.
double find_part(const double* gaps, int corners, double width) {
  if (corners == 2) return find_part(gaps[0], gaps[1], width);
  double part = 0.0, held[4];
  for (int k = 0; k < corners; ++k) held[k] = std::min(gaps[k], far * width + 1.0);
  const auto pass = [width](double between) { return std::clamp(1.0 - std::max(between, 0.0) / width, 0.0, 1.0); };
  if (corners == 3) {
    for (int k = 0; k < 3; ++k) part += pass((4.0 * held[k] + held[(k + 1) % 3] + held[(k + 2) % 3]) / 6.0) / 3.0;
    return part;
  }
  for (const auto& [r, one] : gauss)
    for (const auto& [s, other] : gauss) {
      const double low = 0.5 * (1 - r) * held[0] + 0.5 * (1 + r) * held[1];
      const double high = 0.5 * (1 - r) * held[3] + 0.5 * (1 + r) * held[2];
      part += 0.25 * one * other * pass(0.5 * (1 - s) * low + 0.5 * (1 + s) * high);
    }
  return part;
}

}  // namespace

Touch find_touch(const SurfaceEdges& surface, const HeatingTool& tool, double* seen) {
  Touch touch;
  std::vector<double> area(surface.n_points, 0.0), beside(surface.n_points, 0.0);
  touch.touching.resize(surface.n), touch.pressure.assign(surface.n_points, 0.0);
  for (int e = 0; e < surface.n; ++e) {
    const std::size_t first = std::size_t(e) * surface.nodes;
    const int* nodes = surface.edges + first;
    bool held = true;
    double gaps[4];
    for (int k = 0; k < surface.corners; ++k) held = held && tool.holds[nodes[k]], gaps[k] = tool.gap[nodes[k]];
    touch.touching[e] = held;
    const double part = held || tool.width == 0.0 ? 0.0 : find_part(gaps, surface.corners, tool.width);
    for (int k = 0; k < surface.nodes; ++k) {
      const double own = surface.areas[first + k];
      if (touch.touching[e]) area[nodes[k]] += own, seen[first + k] = 0.0;
      if (part > 0.0) beside[nodes[k]] += own * part, seen[first + k] -= own * part;
    }
  }
  double loose, at_pressure, slope;
  tool.conductance.find(0.0, loose, slope);
  for (int a = 0; a < surface.n_points; ++a) {
    if (area[a] > 0.0) touch.pressure[a] = tool.push[a] / area[a];
    const double whole = area[a] + beside[a];
    if (whole == 0.0) continue;
    tool.conductance.find(touch.pressure[a], at_pressure, slope);
    touch.nodes.push_back(a);
    touch.area.push_back(whole);
    touch.conductance.push_back(beside[a] > 0.0 ? (area[a] * at_pressure + beside[a] * loose) / whole : at_pressure);
  }
  return touch;
}

PairSums sum_pairs(const FacingPoints& found, const int* own, const int* other,
                   const std::vector<const double*>& amounts) {
  const int nodes = found.nodes, each = nodes * nodes;
  std::vector<std::pair<std::pair<int, int>, int>> places;  // nodes, and the places of each point
  places.reserve(each * std::size_t(found.n));
  for (int i = 0; i < found.n; ++i)
    for (int k = 0; k < each; ++k)
      places.push_back(
          {{own[nodes * found.own[i] + k / nodes], other[nodes * found.other[i] + k % nodes]}, each * i + k});
  std::sort(places.begin(), places.end());
  PairSums result;
  result.sums.resize(amounts.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    const auto& [pair, place] = places[p];
    if (p == 0 || pair != places[p - 1].first) {
      result.pairs.insert(result.pairs.end(), {pair.first, pair.second});
      for (auto& sums : result.sums) sums.push_back(0.0);
    }
    const int i = place / each, k = place % each;
    const double shape = found.own_shape[nodes * i + k / nodes], across = found.other_shape[nodes * i + k % nodes];
    for (std::size_t m = 0; m < amounts.size(); ++m) result.sums[m].back() += amounts[m][i] * shape * across;
  }
  return result;
}

PairSums link_tool(const double* points, Edges pieces, const bool* touching, int n_edges, const double* pressure,
                   const MeshedTool& tool, double chords, double thickness) {
  // 1. pieces that touch or are near
  std::vector<int> own;
  std::vector<double> reach;
  std::vector<std::uint8_t> holds;
  for (int i = 0; i < pieces.n; ++i) {
    const int *ends = pieces.nodes + 2 * i, a = ends[0], b = ends[1];
    const bool held = touching[i % n_edges];
    if (!held && !(std::min(tool.gap[a], tool.gap[b]) < tool.width)) continue;
    const double x = points[2 * b] - points[2 * a], y = points[2 * b + 1] - points[2 * a + 1];
    own.insert(own.end(), {a, b});
    holds.push_back(held);
    reach.push_back((held ? 0.0 : tool.width) + chords * std::sqrt(x * x + y * y));
  }
  // 2. what passes at the points where they face the profile
  const auto found =
      find_facing(points, {static_cast<int>(holds.size()), own.data()}, tool.profile, reach.data(), thickness);
  const int n = static_cast<int>(found.size());
  std::vector<int> edge(n), across(n);
  std::vector<double> shape(2 * std::size_t(n)), opposite(2 * std::size_t(n)), conducted(n), area(n);
  for (int i = 0; i < n; ++i) {
    const Facing& at = found[i];
    const int* ends = own.data() + 2 * at.own;
    double part = 1.0, pushed = 0.0, conductance, slope;
    if (holds[at.own]) {
      pushed = at.own_shape[0] * pressure[ends[0]] + at.own_shape[1] * pressure[ends[1]];
    } else {
      double between = 0.0;
      for (int k = 0; k < 2; ++k) between += at.own_shape[k] * std::min(tool.gap[ends[k]], far * tool.width + 1.0);
      part = std::clamp(1.0 - std::max(between, 0.0) / std::max(tool.width, 1e-300), 0.0, 1.0);
    }
    tool.conductance.find(pushed, conductance, slope);
    area[i] = part * at.area, conducted[i] = conductance * area[i];
    edge[i] = at.own, across[i] = at.other;
    for (int k = 0; k < 2; ++k) shape[2 * i + k] = at.own_shape[k], opposite[2 * i + k] = at.other_shape[k];
  }
  return sum_pairs({n, 2, edge.data(), across.data(), shape.data(), opposite.data()}, own.data(), tool.profile.nodes,
                   {conducted.data(), area.data()});
}

}  // namespace presswork
