// SPDX-License-Identifier: Apache-2.0
// Points in space in a grid of cubes: which is the nearest to a place?
#pragma once

#include <cstddef>
#include <vector>

namespace presswork::contact {

class PointGrid {
 public:
  struct Found {
    double away2;    // distance squared [mm2]; only nearer points are looked for
    int point = -1;  // -1: none is that near
  };

  // point (n, 3) [mm], copied. At least one.
  PointGrid(const double* point, int n);

  // Replace what was found by the nearest point, if one is nearer, or as near and of a lower number.
  void find(const double place[3], Found& found) const;
  // The same with one point.
  static void compare(const double point[3], int number, const double place[3], Found& found) {
    const double x = point[0] - place[0], y = point[1] - place[1], z = point[2] - place[2];
    const double away2 = x * x + y * y + z * z;
    if (away2 < found.away2 || (away2 == found.away2 && number < found.point)) found = {away2, number};
  }

 private:
  static constexpr int cubes_a_point = 16;  // about: a sheet fills few of the cubes of its box
  struct Point {
    double x[3];
    int number;
  };
  int cube(double x, int axis) const;  // along an axis, that of the box which is nearest
  std::size_t row(int y, int z) const { return (std::size_t(z) * count_[1] + y) * count_[0]; }
  void compare_all(std::size_t first_cube, std::size_t last_cube, const double place[3], Found& found) const;

  double low_[3], side_;
  int count_[3];            // cubes along each axis
  std::vector<int> start_;  // of each cube, x fastest, in point_
  std::vector<Point> point_;
};

}  // namespace presswork::contact
