// SPDX-License-Identifier: Apache-2.0
#include "device/host.hpp"

#include <algorithm>

namespace presswork::device {

template <class Real>
void advance_on_host(const Problem<Real>& p, const Cycles& cycles) {
  constexpr int serial_elements = 1000;  // fewer are left to one thread
  int n_elements = 0;
  for (int b = 0; b < p.n_blocks; ++b) n_elements += std::visit([](const auto& of) { return of.n; }, p.block[b]);
  const Tools& tools = p.tools;
  const double* room = tools.n > 0 && tools.ironing ? tools.room : nullptr;
  const int chunks = p.chunks();
#pragma omp parallel if (n_elements >= serial_elements)
  for (int cycle = 0; cycle < cycles.n; ++cycle) {
    const Step step = cycles.step(cycle);
#pragma omp for schedule(static)
    for (int c = 0; c < chunks; ++c) {
      double fastest = 0.0;
      for (int node = c * chunk; node < std::min(p.nodes.n, (c + 1) * chunk); ++node)
        fastest = std::max(fastest, move_node(p.nodes, step, node));
      if (tools.n > 0) tools.fastest[c] = fastest;
    }
#pragma omp single
    if (tools.n > 0) start_tools(tools, step.dt, cycle, *std::max_element(tools.fastest, tools.fastest + chunks));
    for (int b = 0; b < p.n_blocks; ++b)
      std::visit(
          [&](const auto& block) {
#pragma omp for schedule(static)
            for (int i = 0; i < block.n; ++i) block.advance(p.nodes, room, step.dt, i);
          },
          p.block[b]);
#pragma omp for schedule(static)
    for (int node = 0; node < p.nodes.n; ++node) gather_forces(p.nodes, node);
    const Beads& beads = p.beads;
#pragma omp for schedule(static)
    for (int i = 0; i < beads.n; ++i) hold_bead(beads, tools, p.nodes.position, p.nodes.motion, step.dt, cycle, i);
#pragma omp single
    push_sheet(beads, p.nodes.internal_force, 0, 1);
    if (tools.n == 0) continue;
    const Edges& edges = tools.edges;
#pragma omp for schedule(static)
    for (int c = 0; c < edges.chunks(); ++c) {
      ContactSums* of_chunk = edges.sums + std::size_t(c) * edges.n_sharp;
      std::fill_n(of_chunk, edges.n_sharp, ContactSums{});
      for (int edge = c * chunk; edge < std::min(edges.n, (c + 1) * chunk); ++edge)
        touch_edges(p, step.dt, edge, [&](int j, const ContactSums& sums) { of_chunk[j] += sums; });
    }
#pragma omp for schedule(static)
    for (int c = 0; c < chunks; ++c) {
      ContactSums* of_chunk = tools.sums + std::size_t(c) * tools.n;
      std::fill_n(of_chunk, tools.n, ContactSums{});
      for (int node = c * chunk; node < std::min(p.nodes.n, (c + 1) * chunk); ++node)
        touch_tools(p, step.dt, cycle, node, [&](int t, const ContactSums& sums) { of_chunk[t] += sums; });
    }
#pragma omp single
    for (int t = 0; t < tools.n; ++t) {
      ContactSums sum;
      for (int c = 0; c < chunks; ++c) sum += tools.sums[std::size_t(c) * tools.n + t];
      for (int j = 0; j < edges.n_sharp; ++j)
        for (int c = 0; c < edges.chunks() && edges.sharp[j].number == t; ++c)
          sum += edges.sums[std::size_t(c) * edges.n_sharp + j];
      close_tool(tools, t, sum);
    }
  }
}

template void advance_on_host(const Problem<double>&, const Cycles&);
template void advance_on_host(const Problem<float>&, const Cycles&);

}  // namespace presswork::device
