// SPDX-License-Identifier: Apache-2.0
// Which edges may touch a tool.
#include <algorithm>

#include "explicit/contact/edge_contact.hpp"

namespace presswork::explicit_dynamics {

int EdgeContact::find_awake(int c, Pairs& of, double travel, int found[chunk + 1]) const {
  int n = 0;
  const int groups = static_cast<int>(of.wake_group.size()), first = c * (chunk / group);
  for (int g = first; g < std::min(groups, first + chunk / group); ++g) {
    if (of.wake_group[g] > travel) continue;
    const double* wake = &of.wake[g * std::size_t(group)];
    const int before = n;
    for (int i = 0; i < group; ++i) found[n] = g * group + i, n += wake[i] <= travel ? 1 : 0;
    if (n == before) of.wake_group[g] = *std::min_element(wake, wake + group);
  }
  for (int i = 0; i < n; ++i) {
    const auto* record = reinterpret_cast<const char*>(&of.at[found[i]]);
    for (std::size_t line = 0; line < sizeof(Touching); line += 64) __builtin_prefetch(record + line, 1);
  }
  return n;
}

// Ask the surface about one edge.
void EdgeContact::ask(const Tool& tool, Pairs& of, int edge, const Segment& seen, const double* half, int& lost) const {
  const double at_ends[2] = {half_at(tool.grip, half, edge, 0.0), half_at(tool.grip, half, edge, 1.0)};
  if (!ask_edge(*tool.surface, *of.sharp, {memory_, reach_}, tool.travel, seen, at_ends, of.at[edge], of.wake[edge]))
    lost = std::min(lost, n_nodes_ + edge);
}

}  // namespace presswork::explicit_dynamics
