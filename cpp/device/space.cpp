// SPDX-License-Identifier: Apache-2.0
#include "device/space.hpp"

#include <omp.h>

#include "device/cuda_library.hpp"
#include "device/host.hpp"
#include "explicit/space/shell_section.hpp"

namespace presswork::device {

using explicit_dynamics::ElementBlock;
using explicit_dynamics::ShellSection;
using explicit_dynamics::ShellTreatment;
using explicit_dynamics::SpaceLoop;
using explicit_dynamics::SpaceNodes;

namespace {

// Shells of a block as a device takes them, and what it does not change.
template <class Real>
struct Borrowed {
  ElementBlock<SpaceNodes<Real>>* block = nullptr;  // none: no shells of this kind
  std::vector<int> node;
  std::vector<Real> state;
  Shells<Real> view{};

  void take(ElementBlock<SpaceNodes<Real>>& from, const ShellSection& section, int first_slot) {
    block = &from;
    const std::size_t n = from.n(), corners = from.nodes_each(), rows = from.n_rows();
    node.resize(corners * n), state.resize(rows * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t a = 0; a < corners; ++a) node[a * n + e] = from.connectivity()[corners * e + a];
      for (std::size_t r = 0; r < rows; ++r) state[r * n + e] = static_cast<Real>(from.value(int(e), int(r)));
    }
    view = {from.n(), first_slot, node.data(), state.data(), std::get<FastMises>(section.law), section.rule};
  }
  void give_back() const {
    if (!block) return;
    const std::size_t n = block->n(), rows = block->n_rows();
    for (std::size_t e = 0; e < n; ++e)
      for (std::size_t r = 0; r < rows; ++r) block->set_value(int(e), int(r), double(state[r * n + e]));
  }
};

// The slots of the corners round each node, the shells in turn.
template <class Real>
void list_corners(const Borrowed<Real> (&kinds)[2], int n_nodes, std::vector<int>& first, std::vector<int>& list) {
  first.assign(n_nodes + 1, 0);
  for (const auto& kind : kinds)
    for (int node : kind.node) ++first[node + 1];
  for (int node = 0; node < n_nodes; ++node) first[node + 1] += first[node];
  list.resize(first[n_nodes]);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (const auto& kind : kinds)
    for (int e = 0; e < kind.view.n; ++e)
      for (std::size_t slot = e; slot < kind.node.size(); slot += kind.view.n)
        list[next[kind.node[slot]]++] = kind.view.first_slot + static_cast<int>(slot);
}

}  // namespace

template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop) {
  const auto& nodes = loop.nodes;
  if (loop.contact) return "rigid tools";
  if (loop.beads) return "drawbeads";
  if (loop.shell_contact) return "shells that touch shells";
  if (!loop.hanging.all().empty()) return "refined sheets";
  for (std::size_t b = 0; b < loop.blocks.size(); ++b)
    if (!loop.is_sheet(static_cast<int>(b))) return "solids";
  int like[2] = {};
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    const auto& block = loop.sheet(static_cast<int>(b));
    if (block.nodes_each() == 4 && block.section().treatment != ShellTreatment::stabilized)
      return "shells other than shell4_1pt with physical hourglass";
    if (!std::holds_alternative<FastMises>(block.section().law))
      return "laws other than von Mises with isotropic hardening from a table, without rate and heat";
    if (!block.damage.empty()) return "damage";
    if (like[block.nodes_each() - 3]++ > 0) return "two blocks of like shells";
  }
  if (loop.blocks.empty()) return "nodes without shells";
  if (!nodes.walls.empty() || !nodes.follows.empty()) return "walls and sectors";
  for (auto held : nodes.held())
    if (held >> nodes.askew & 1) return "nodes held along a direction";
  return "";
}

template <class Real>
void advance(SpaceLoop<Real>& loop, Target target, const Cycles& cycles) {
  const double start = omp_get_wtime();
  auto& nodes = loop.nodes;
  const std::size_t n_nodes = nodes.n;
  // 1. what is kept otherwise in the loop
  Borrowed<Real> kinds[2];  // of four nodes, of three
  int n_slots = 0;
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    auto& block = *loop.blocks[b];
    kinds[block.nodes_each() == 4 ? 0 : 1].take(block, loop.sheet(static_cast<int>(b)).section(), n_slots);
    n_slots += block.n() * block.nodes_each();
  }
  std::vector<int> first, corner;
  list_corners(kinds, nodes.n, first, corner);
  std::vector<Real> corner_force(std::size_t(freedoms) * n_slots);
  std::vector<double> work(2 * n_nodes, 0.0);
  const Problem<Real> problem{
      {nodes.n, nodes.position.data(), nodes.motion.data(), nodes.internal_force.data(), nodes.force.data(),
       nodes.held().data(), nodes.prescribed().data(), nodes.reaction_impulse.data(), work.data(), first.data(),
       corner.data(), n_slots, corner_force.data()},
      kinds[0].view,
      kinds[1].view,
      loop.blocks[0]->n_rows()};
  // 2. the cycles
  if (target == Target::host)
    advance_on_host(problem, cycles);
  else
    advance_on_cuda(problem, cycles);
  // 3. back into the loop
  for (const auto& kind : kinds) kind.give_back();
  for (std::size_t i = 0; i < n_nodes; ++i) loop.work.external += work[2 * i], loop.work.damping += work[2 * i + 1];
  loop.seconds[static_cast<int>(explicit_dynamics::Phase::elements)] += omp_get_wtime() - start;
}

template std::string find_lack(const SpaceLoop<double>&);
template std::string find_lack(const SpaceLoop<float>&);
template void advance(SpaceLoop<double>&, Target, const Cycles&);
template void advance(SpaceLoop<float>&, Target, const Cycles&);

}  // namespace presswork::device
