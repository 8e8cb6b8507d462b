// SPDX-License-Identifier: Apache-2.0
// Lines from -1 to 1, the sides of cells in the plane. Node order: first end, last end, then the middle. No kernel
// evaluates them by themselves, so they have neither shape functions nor rules.
#pragma once

#include <string_view>

namespace presswork {

struct Line {
  static constexpr std::string_view plural = "lines";
  static constexpr int dim = 1, corners = 2;
  static constexpr double places[3][1] = {{-1}, {1}, {0}};
  static constexpr int simplices[1][2] = {{0, 1}};
};

struct Line2 : Line {
  static constexpr std::string_view name = "line2";
  static constexpr int nodes = 2, edges[1][2] = {{0, 1}}, pieces[1][2] = {{0, 1}}, reversed[2] = {1, 0};
};

struct Line3 : Line {
  static constexpr std::string_view name = "line3";
  static constexpr int nodes = 3, edges[1][3] = {{0, 1, 2}}, pieces[2][2] = {{0, 2}, {2, 1}}, reversed[3] = {1, 0, 2};
};

}  // namespace presswork
