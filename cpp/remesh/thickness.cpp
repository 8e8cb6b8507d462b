// SPDX-License-Identifier: Apache-2.0
#include "remesh/thickness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace presswork {

namespace {

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

void measure_thickness(const double* middle, const double* normal, const double* radius, int n, double reach,
                       double opposite, double* thickness) {
  std::fill(thickness, thickness + n, std::numeric_limits<double>::infinity());
  // 1. along the longest axis, so that few faces are in reach
  double extent[3];
  for (int k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int i = 0; i < n; ++i) low = std::min(low, middle[3 * i + k]), high = std::max(high, middle[3 * i + k]);
    extent[k] = high - low;
  }
  const auto axis = std::max_element(extent, extent + 3) - extent;
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const double x = middle[3 * a + axis], y = middle[3 * b + axis];
    return x != y ? x < y : a < b;
  });
  // 2. pairs that look away from each other, both ways
  const auto meet = [&](int own, const double* way, double square, double radii) {
    const double depth = -dot(way, normal + 3 * own);
    const double aside = std::sqrt(std::max(square - depth * depth, 0.0));
    if (depth > 0.0 && aside < radii) thickness[own] = std::min(thickness[own], depth);
  };
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b) {
      const int i = order[a], j = order[b];
      if (middle[3 * j + axis] - middle[3 * i + axis] > reach) break;
      if (dot(normal + 3 * i, normal + 3 * j) >= -opposite) continue;
      double way[3], back[3];
      for (int k = 0; k < 3; ++k) way[k] = middle[3 * j + k] - middle[3 * i + k], back[k] = -way[k];
      const double square = dot(way, way), radii = radius[i] + radius[j];
      if (square > reach * reach) continue;
      meet(i, way, square, radii);
      meet(j, back, square, radii);
    }
}

}  // namespace presswork
