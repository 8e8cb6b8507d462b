// SPDX-License-Identifier: Apache-2.0
#include "remesh/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace presswork {

namespace {

constexpr double flat = 1e-12;       // area of a triangle, of the largest
constexpr double on_circle = 1e-11;  // determinant of a point on the circle, over the square of the squared sides
constexpr int most_flips = 20;       // of a side, on average

double twice_area(const double* a, const double* b, const double* c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool is_in_circle(const double* a, const double* b, const double* c, const double* d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1], cx = c[0] - d[0],
               cy = c[1] - d[1];
  const double aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy, sum = aa + bb + cc;
  return ax * (by * cc - cy * bb) - ay * (bx * cc - cx * bb) + aa * (bx * cy - cx * by) > on_circle * sum * sum;
}

}  // namespace

bool restore_delaunay(const double* points, int n, int* corners, int* beside) {
  const auto at = [&](int node) { return points + 2 * static_cast<std::size_t>(node); };
  double largest = 0.0, least = 0.0;
  for (int t = 0; t < n; ++t) {
    const double area = twice_area(at(corners[3 * t]), at(corners[3 * t + 1]), at(corners[3 * t + 2]));
    largest = std::max(largest, area), least = std::min(least, area);
  }
  if (least < -flat * largest) return false;
  std::vector<std::pair<int, int>> open;  // triangle and corner opposite to a side that is to be looked at
  for (int t = n - 1; t >= 0; --t)
    for (int k = 0; k < 3; ++k)
      if (beside[3 * t + k] > t) open.push_back({t, k});
  const auto replace = [&](int triangle, int before, int after) {
    if (triangle < 0) return;
    for (int k = 0; k < 3; ++k)
      if (beside[3 * triangle + k] == before) {
        beside[3 * triangle + k] = after;
        return;
      }
  };
  long left = static_cast<long>(most_flips) * 3 * n;
  while (!open.empty()) {
    const auto [t, k] = open.back();
    open.pop_back();
    const int other = beside[3 * t + k];
    if (other < 0) continue;
    int j = 0;
    while (j < 3 && beside[3 * other + j] != t) ++j;
    if (j == 3) return false;
    const int a = corners[3 * t + k], b = corners[3 * t + (k + 1) % 3], c = corners[3 * t + (k + 2) % 3];
    const int d = corners[3 * other + j];
    if (!is_in_circle(at(a), at(b), at(c), at(d))) continue;
    if (twice_area(at(a), at(b), at(d)) <= 0.0 || twice_area(at(a), at(d), at(c)) <= 0.0) continue;
    if (--left < 0) return false;
    const int of_b = beside[3 * t + (k + 1) % 3], of_c = beside[3 * t + (k + 2) % 3];
    // in the other triangle the side runs from c to b
    const int other_of_c = beside[3 * other + (j + 1) % 3], other_of_b = beside[3 * other + (j + 2) % 3];
    const int first[3] = {a, b, d}, second[3] = {a, d, c};
    const int first_beside[3] = {other_of_c, other, of_c}, second_beside[3] = {other_of_b, of_b, t};
    std::copy(first, first + 3, corners + 3 * t), std::copy(second, second + 3, corners + 3 * other);
    std::copy(first_beside, first_beside + 3, beside + 3 * t);
    std::copy(second_beside, second_beside + 3, beside + 3 * other);
    replace(other_of_c, other, t), replace(of_b, t, other);
    open.insert(open.end(), {{t, 0}, {t, 2}, {other, 0}, {other, 1}});
  }
  return true;
}

}  // namespace presswork
