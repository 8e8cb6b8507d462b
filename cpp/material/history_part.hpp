// SPDX-License-Identifier: Apache-2.0
// A part of what a law keeps at a point behind its stress, by name (history.hpp).
#pragma once

#include <string>
#include <vector>

namespace presswork {

struct HistoryPart {
  std::string name;
  int size;              // values
  bool is_axes = false;  // directions of the law's axes: x in the plane (2), x and y in space (6); else plain numbers
};
using History = std::vector<HistoryPart>;

}  // namespace presswork
