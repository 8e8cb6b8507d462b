// SPDX-License-Identifier: Apache-2.0
#include "device/space.hpp"

#include <omp.h>

#include "device/cuda_library.hpp"
#include "device/host.hpp"
#include "explicit/space/shell_section.hpp"

namespace presswork::device {

using explicit_dynamics::SheetBlock;
using explicit_dynamics::ShellTreatment;
using explicit_dynamics::SpaceLoop;

namespace {

// The shells round each node, in the order of their numbers.
void list_corners(const std::vector<int>& connectivity, int n_nodes, std::vector<int>& first, std::vector<int>& list) {
  const int n = static_cast<int>(connectivity.size()) / corners;
  first.assign(n_nodes + 1, 0), list.resize(connectivity.size());
  for (int node : connectivity) ++first[node + 1];
  for (int node = 0; node < n_nodes; ++node) first[node + 1] += first[node];
  std::vector<int> next(first.begin(), first.end() - 1);
  for (int shell = 0; shell < n; ++shell)
    for (int a = 0; a < corners; ++a) list[next[connectivity[corners * std::size_t(shell) + a]]++] = shell + a * n;
}

}  // namespace

template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop) {
  const auto& nodes = loop.nodes;
  if (loop.contact) return "rigid tools";
  if (loop.beads) return "drawbeads";
  if (!loop.hanging.all().empty()) return "refined sheets";
  for (std::size_t b = 0; b < loop.blocks.size(); ++b)
    if (!loop.is_sheet(static_cast<int>(b))) return "solids";
  if (loop.blocks.size() != 1 || loop.blocks[0]->nodes_each() != corners) return "triangles";
  const auto& section = loop.sheet(0).section();
  if (section.treatment != ShellTreatment::stabilized) return "shells other than shell4_1pt with physical hourglass";
  if (!std::holds_alternative<FastMises>(section.law))
    return "laws other than von Mises with isotropic hardening from a table, without rate and heat";
  if (!loop.blocks[0]->damage.empty()) return "damage";
  if (!nodes.walls.empty() || !nodes.follows.empty()) return "walls and sectors";
  for (auto held : nodes.held())
    if (held >> nodes.askew & 1) return "nodes held along a direction";
  return "";
}

template <class Real>
void advance(SpaceLoop<Real>& loop, Target target, const Cycles& cycles) {
  const double start = omp_get_wtime();
  auto& nodes = loop.nodes;
  auto& block = *loop.blocks[0];
  const auto& section = loop.sheet(0).section();
  const std::size_t n = block.n(), rows = block.n_rows(), n_nodes = nodes.n;
  // 1. what is kept otherwise in the loop
  std::vector<int> first, corner, node(corners * n);
  list_corners(block.connectivity(), nodes.n, first, corner);
  std::vector<Real> state(rows * n), force(freedoms * corners * n);
  for (std::size_t e = 0; e < n; ++e) {
    for (std::size_t a = 0; a < corners; ++a) node[a * n + e] = block.connectivity()[corners * e + a];
    for (std::size_t r = 0; r < rows; ++r) state[r * n + e] = static_cast<Real>(block.value(int(e), int(r)));
  }
  std::vector<double> work(2 * n_nodes, 0.0);
  const Problem<Real> problem{
      {nodes.n, nodes.position.data(), nodes.motion.data(), nodes.internal_force.data(), nodes.force.data(),
       nodes.held().data(), nodes.prescribed().data(), nodes.reaction_impulse.data(), work.data(), first.data(),
       corner.data()},
      {block.n(), node.data(), state.data(), force.data(), std::get<FastMises>(section.law), section.rule},
      static_cast<int>(rows)};
  // 2. the cycles
  if (target == Target::host)
    advance_on_host(problem, cycles);
  else
    advance_on_cuda(problem, cycles);
  // 3. back into the loop
  for (std::size_t e = 0; e < n; ++e)
    for (std::size_t r = 0; r < rows; ++r) block.set_value(int(e), int(r), double(state[r * n + e]));
  for (std::size_t i = 0; i < n_nodes; ++i) loop.work.external += work[2 * i], loop.work.damping += work[2 * i + 1];
  loop.seconds[static_cast<int>(explicit_dynamics::Phase::elements)] += omp_get_wtime() - start;
}

template std::string find_lack(const SpaceLoop<double>&);
template std::string find_lack(const SpaceLoop<float>&);
template void advance(SpaceLoop<double>&, Target, const Cycles&);
template void advance(SpaceLoop<float>&, Target, const Cycles&);

}  // namespace presswork::device
