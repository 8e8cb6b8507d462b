// SPDX-License-Identifier: Apache-2.0
#include "device/space.hpp"

#include <omp.h>

#include <cmath>
#include <stdexcept>

#include "device/borrowed_blocks.hpp"
#include "device/borrowed_tools.hpp"
#include "device/cuda_library.hpp"
#include "device/host.hpp"

namespace presswork::device {

template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop) {
  const auto& nodes = loop.nodes;
  if (loop.contact)
    for (const Tool& tool : loop.contact->tools)
      if (tool.surface->is_smooth()) return "tools of triangles that are rounded off";
  if (loop.shell_contact) return "shells that touch each other";
  if (!loop.hanging.all().empty()) return "refined sheets";
  int sheets = 0;
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    if (!loop.is_sheet(static_cast<int>(b))) return "solids";
    const auto& block = loop.sheet(static_cast<int>(b));
    const std::string lack = find_lack_of_shells(block.section(), block.nodes_each());
    if (!lack.empty()) return lack;
    if (!block.damage.empty()) return "damage";
    if (++sheets > most_sheets) return "more than two blocks of shells";
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
  std::vector<std::unique_ptr<BorrowedBlock<Real>>> blocks;
  std::vector<Block<Real>> seen;
  int n_slots = 0;
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    blocks.push_back(std::make_unique<BorrowedBlock<Real>>(loop, static_cast<int>(b), n_slots));
    seen.push_back(blocks.back()->view());
    n_slots += static_cast<int>(blocks.back()->node.size());
  }
  BorrowedTools tools;
  if (loop.contact) tools.take(*loop.contact, nodes.n, cycles.n);
  BorrowedBeads beads;
  if (loop.beads) beads.take(*loop.beads, cycles.n);
  std::vector<int> first, corner;
  list_corners(blocks, nodes.n, first, corner);
  std::vector<Real> corner_force(std::size_t(freedoms) * n_slots);
  std::vector<double> work(2 * n_nodes, 0.0);
  Problem<Real> problem{
      {nodes.n, nodes.position.data(), nodes.motion.data(), nodes.internal_force.data(), nodes.force.data(),
       nodes.held().data(), nodes.prescribed().data(), nodes.reaction_impulse.data(), work.data(), first.data(),
       corner.data(), n_slots, corner_force.data()},
      seen.data(),
      static_cast<int>(seen.size()),
      {},
      tools.view,
      beads.view};
  problem.find_sheets();
  // 2. the cycles
  if (target == Target::host)
    advance_on_host(problem, cycles);
  else
    advance_on_cuda(problem, cycles);
  for (std::size_t i = 0; i < freedoms * n_nodes; ++i)
    if (std::isnan(nodes.internal_force.data()[i]))
      throw std::runtime_error(
          "a force is no number any more: a material law has found no stress for the strain of a step, the step is too "
          "long, or a shell has collapsed");
  // 3. back into the loop
  for (const auto& block : blocks) block->give_back();
  tools.give_back(nodes.n, cycles.n);
  beads.give_back(cycles.n);
  for (std::size_t i = 0; i < n_nodes; ++i) loop.work.external += work[2 * i], loop.work.damping += work[2 * i + 1];
  loop.seconds[static_cast<int>(explicit_dynamics::Phase::elements)] += omp_get_wtime() - start;
}

template std::string find_lack(const SpaceLoop<double>&);
template std::string find_lack(const SpaceLoop<float>&);
template void advance(SpaceLoop<double>&, Target, const Cycles&);
template void advance(SpaceLoop<float>&, Target, const Cycles&);

}  // namespace presswork::device
