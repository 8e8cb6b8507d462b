// SPDX-License-Identifier: Apache-2.0
#include "device/host.hpp"

#include <algorithm>

namespace presswork::device {

namespace {

constexpr int serial_elements = 1000;  // fewer are left to one thread

// The passes of a cycle that tools make, by all threads.
template <class Real>
void touch(const Problem<Real>& p) {
  const Tools& tools = p.tools;
  const Edges& edges = tools.edges;
  const int chunks = p.chunks();
#pragma omp for schedule(static)
  for (int c = 0; c < edges.chunks(); ++c) {
    ContactSums* of_chunk = edges.sums + std::size_t(c) * edges.n_sharp;
    std::fill_n(of_chunk, edges.n_sharp, ContactSums{});
    for (int edge = c * chunk; edge < std::min(edges.n, (c + 1) * chunk); ++edge)
      touch_edges(p, edge, [&](int j, const ContactSums& sums) { of_chunk[j] += sums; });
  }
#pragma omp for schedule(static)
  for (int c = 0; c < chunks; ++c) {
    ContactSums* of_chunk = tools.sums + std::size_t(c) * tools.n;
    std::fill_n(of_chunk, tools.n, ContactSums{});
    for (int node = c * chunk; node < std::min(p.nodes.n, (c + 1) * chunk); ++node)
      touch_tools(p, node, [&](int t, const ContactSums& sums) { of_chunk[t] += sums; });
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

// Nodes, those that follow them, tools and walls, by all threads.
template <class Real>
void move(const Problem<Real>& p) {
  const int chunks = p.chunks();
  double* fastest_of = p.fastest();
  const Walls& walls = p.walls;
  const Step& step = p.step[p.clock->cycle];
#pragma omp for schedule(static)
  for (int c = 0; c < chunks; ++c) {
    double fastest = 0.0;
    WallSums* of_chunk = walls.sums + std::size_t(c) * walls.n;
    std::fill_n(of_chunk, walls.n, WallSums{});
    for (int node = c * chunk; node < std::min(p.nodes.n, (c + 1) * chunk); ++node)
      if constexpr (std::is_same_v<Real, double>)
        fastest = std::max(fastest,
                           move_node_between_walls(p, node, [&](int i, const WallSums& sums) { of_chunk[i] += sums; }));
      else
        fastest = std::max(fastest, move_node(p.nodes, step, node));
    if (fastest_of) fastest_of[c] = fastest;
  }
  const Ties& ties = p.ties;
  if constexpr (std::is_same_v<Real, double>)
#pragma omp for schedule(static)
    for (int c = 0; c < ties.chunks(); ++c) {
      ties.fastest[c] = 0.0;
      for (int i = c * chunk; i < std::min(ties.n, (c + 1) * chunk); ++i)
        ties.fastest[c] = std::max(ties.fastest[c], lead_node(ties, p.nodes, i));
    }
#pragma omp single
  if (fastest_of) {
    double fastest = *std::max_element(fastest_of, fastest_of + chunks);
    for (int c = 0; c < ties.chunks(); ++c) fastest = std::max(fastest, ties.fastest[c]);
    if (p.tools.n > 0) start_tools(p.tools, step.dt, p.clock->cycle, fastest);
    for (int i = 0; i < walls.n; ++i) {
      WallSums sum;
      for (int c = 0; c < chunks; ++c) sum += walls.sums[std::size_t(c) * walls.n + i];
      move_wall(walls, step, fastest, i, sum);
    }
  }
}

// Of cells and nodes, where a kind of elements asks for them; by all threads.
template <class Real, class Kind>
void measure_volumes([[maybe_unused]] const Problem<Real>& p, [[maybe_unused]] const Kind& block) {
  if constexpr (requires { block.volumes; }) {
#pragma omp for schedule(static)
    for (int i = 0; i < block.n; ++i) block.measure_cell(p.nodes, i);
#pragma omp for schedule(static)
    for (int node = 0; node < p.nodes.n; ++node) block.measure_node(node);
  }
}

// One cycle, by all threads.
template <class Real>
void compute_cycle(const Problem<Real>& p) {
  const Tools& tools = p.tools;
  const Beads& beads = p.beads;
  const double* room = tools.n > 0 && tools.ironing ? tools.room : nullptr;
  const Moment now = p.now();
  move(p);
  for (int b = 0; b < p.n_blocks; ++b)
    std::visit(
        [&](const auto& block) {
          measure_volumes(p, block);
#pragma omp for schedule(static)
          for (int i = 0; i < block.n; ++i) {
            block.advance(p.nodes, room, now.dt, i);
            if (block.damage.n_criteria > 0) advance_damage(block, now.dt, i);
          }
        },
        p.block[b]);
#pragma omp for schedule(static)
  for (int node = 0; node < p.nodes.n; ++node) gather_forces(p.nodes, node);
  if constexpr (std::is_same_v<Real, double>)
#pragma omp for schedule(static)
    for (int i = 0; i < p.ties.n; ++i) give_back(p.ties, p.nodes, i);
#pragma omp for schedule(static)
  for (int i = 0; i < beads.n; ++i)
    hold_bead(beads, tools, p.nodes.position, p.nodes.motion, now.dt, now.cycle, now.beads, i);
#pragma omp single
  push_sheet(beads, p.nodes.internal_force, 0, 1);
  if (tools.n > 0) touch(p);
#pragma omp single
  ++p.clock->cycle;
}

template <class Real>
class HostResident final : public Resident<Real> {
 public:
  using Resident<Real>::Resident;

  Found sum_up(const Pass<Real>& pass) override {
    return std::visit(
        [&](const auto& own) {
          const int chunks = (own.n + chunk - 1) / chunk;
#pragma omp parallel for schedule(static) if (own.n >= serial_elements)
          for (int c = 0; c < chunks; ++c) {
            this->found_[c] = Found{};
            for (int i = c * chunk; i < std::min(own.n, (c + 1) * chunk); ++i) this->found_[c] += own(i);
          }
          Found all;
          for (int c = 0; c < chunks; ++c) all += this->found_[c];
          return all;
        },
        pass);
  }

 protected:
  void begin() override {
    const Problem<Real>& p = this->problem;
    for (int b = 0; b < p.n_blocks; ++b) std::visit([&](const auto& block) { measure_volumes(p, block); }, p.block[b]);
  }
  void compute(int n_cycles) override {
    int n_elements = 0;
    const Problem<Real>& p = this->problem;
    for (int b = 0; b < p.n_blocks; ++b) n_elements += std::visit([](const auto& of) { return of.n; }, p.block[b]);
#pragma omp parallel if (n_elements >= serial_elements)
    for (int cycle = 0; cycle < n_cycles; ++cycle) compute_cycle(p);
  }
};

}  // namespace

template <class Real>
std::unique_ptr<Resident<Real>> make_on_host(const Problem<Real>& problem, double memory) {
  return std::make_unique<HostResident<Real>>(problem, std::make_unique<HostMemory>(memory));
}

template std::unique_ptr<Resident<double>> make_on_host(const Problem<double>&, double);
template std::unique_ptr<Resident<float>> make_on_host(const Problem<float>&, double);

}  // namespace presswork::device
