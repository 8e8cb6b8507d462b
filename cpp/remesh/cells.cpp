// SPDX-License-Identifier: Apache-2.0
#include "remesh/cells.hpp"

#include <algorithm>

namespace presswork {

Rows gather_by_key(const int* key, int n, int n_keys) {
  Rows rows{std::vector<int>(n_keys + 1, 0), std::vector<int>(n)};
  for (int i = 0; i < n; ++i) ++rows.begin[key[i] + 1];
  for (int k = 0; k < n_keys; ++k) rows.begin[k + 1] += rows.begin[k];
  std::vector<int> next(rows.begin.begin(), rows.begin.end() - 1);
  for (int i = 0; i < n; ++i) rows.value[next[key[i]]++] = i;
  return rows;
}

Rows find_neighbours(Cells cells) {
  const int n_corners = cells.n * cells.corners;
  const int n_nodes = n_corners > 0 ? *std::max_element(cells.nodes, cells.nodes + n_corners) + 1 : 0;
  const Rows at_node = gather_by_key(cells.nodes, n_corners, n_nodes);
  Rows beside;
  beside.begin.reserve(cells.n + 1);
  beside.value.reserve(8 * static_cast<std::size_t>(cells.n));
  beside.begin.push_back(0);
  std::vector<int> seen(cells.n, -1);
  for (int cell = 0; cell < cells.n; ++cell) {
    seen[cell] = cell;
    for (int a = 0; a < cells.corners; ++a)
      for (int corner : at_node[cells.of(cell)[a]]) {
        const int other = corner / cells.corners;
        if (seen[other] == cell) continue;
        seen[other] = cell;
        beside.value.push_back(other);
      }
    beside.begin.push_back(static_cast<int>(beside.value.size()));
  }
  return beside;
}

void mark_near(Cells cells, const int* home, int n, const int* others, int n_others, bool* near) {
  const Rows beside = find_neighbours(cells);
  const int n_corners = cells.n * cells.corners;
  // the row for which a node belongs to a cell beside home: another cell near home has such a node
  std::vector<int> seen(n_corners > 0 ? *std::max_element(cells.nodes, cells.nodes + n_corners) + 1 : 0, -1);
  int row = -1;
  for (int i = 0; i < n; ++i) {
    if (i == 0 || home[i] != home[i - 1]) {
      row = i;
      for (int other : beside[home[i]])
        for (int a = 0; a < cells.corners; ++a) seen[cells.of(other)[a]] = row;
      for (int a = 0; a < cells.corners; ++a) seen[cells.of(home[i])[a]] = row;
    }
    for (int k = 0; k < n_others; ++k) {
      const std::size_t place = static_cast<std::size_t>(n_others) * i + k;
      const int* nodes = cells.of(others[place]);
      near[place] = std::any_of(nodes, nodes + cells.corners, [&](int node) { return seen[node] == row; });
    }
  }
}

}  // namespace presswork
