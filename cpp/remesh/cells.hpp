// SPDX-License-Identifier: Apache-2.0
// The cells of a mesh in the plane, and which of them share a node.
#pragma once

#include <span>
#include <vector>

namespace presswork {

struct Cells {
  int n, corners;    // 3 | 4
  const int* nodes;  // (n, corners), counter-clockwise

  const int* of(int cell) const { return nodes + static_cast<std::size_t>(corners) * cell; }
};

// Rows of different lengths, one behind the other.
struct Rows {
  std::vector<int> begin, value;

  std::span<const int> operator[](int row) const {
    return {value.data() + begin[row], static_cast<std::size_t>(begin[row + 1] - begin[row])};
  }
};

// The numbers 0 ... n - 1 that have each key (n,), in their order.
Rows gather_by_key(const int* key, int n, int n_keys);

// The cells that share a node with each, without itself.
Rows find_neighbours(Cells cells);

// Which others (n, n_others) share a node with the cell of their row, home (n,), or with a cell that does.
void mark_near(Cells cells, const int* home, int n, const int* others, int n_others, bool* near);

}  // namespace presswork
