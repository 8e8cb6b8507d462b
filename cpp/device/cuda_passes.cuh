// SPDX-License-Identifier: Apache-2.0
// The passes of a cycle as kernels, a thread a lane, and how a cycle is launched.
#pragma once

#include "device/cuda_sums.cuh"
#include "device/resident.hpp"

namespace presswork::device {

template <class Real>
__global__ void __launch_bounds__(chunk) move_nodes(const __grid_constant__ Problem<Real> p) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  const double speed2 = node < p.nodes.n ? move_node(p.nodes, p.step[p.clock->cycle], node) : 0.0;
  if (p.tools.n == 0) return;
  const double most = reduce_largest(speed2);
  if (threadIdx.x == 0) p.tools.fastest[blockIdx.x] = most;
}

static __global__ void __launch_bounds__(chunk) move_nodes_between_walls(const __grid_constant__ Problem<double> p) {
  const double speed2 =
      move_node_between_walls(p, int(blockIdx.x * chunk + threadIdx.x), [&](int i, const WallSums& sums) {
        const WallSums sum = reduce_wall_sums(sums);
        if (threadIdx.x == 0) p.walls.sums[std::size_t(blockIdx.x) * p.walls.n + i] = sum;
      });
  const double most = reduce_largest(speed2);
  if (threadIdx.x == 0) p.fastest()[blockIdx.x] = most;
}

static __global__ void __launch_bounds__(chunk)
    lead_nodes(const __grid_constant__ Ties ties, const __grid_constant__ Nodes<double> nodes) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  const double most = reduce_largest(i < ties.n ? lead_node(ties, nodes, i) : 0.0);
  if (threadIdx.x == 0) ties.fastest[blockIdx.x] = most;
}

static __global__ void __launch_bounds__(chunk)
    give_back_forces(const __grid_constant__ Ties ties, const __grid_constant__ Nodes<double> nodes) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  if (i < ties.n) give_back(ties, nodes, i);
}

// One block; the largest speed squared of nodes in a cycle, for its first thread.
inline __device__ double find_fastest(const double* fastest, int chunks, const Ties& ties) {
  double most = 0.0;
  for (int c = threadIdx.x; c < chunks; c += chunk) most = fastest[c] > most ? fastest[c] : most;
  for (int c = threadIdx.x; c < ties.chunks(); c += chunk) most = ties.fastest[c] > most ? ties.fastest[c] : most;
  return reduce_largest(most);
}

// One block.
static __global__ void __launch_bounds__(chunk) move_walls(const __grid_constant__ Problem<double> p, int chunks) {
  const Walls& walls = p.walls;
  const double most = find_fastest(p.fastest(), chunks, p.ties);
  for (int i = 0; i < walls.n; ++i) {
    WallSums own;
    for (int c = threadIdx.x; c < chunks; c += chunk) own += walls.sums[std::size_t(c) * walls.n + i];
    const WallSums sum = reduce_wall_sums(own);
    if (threadIdx.x == 0) move_wall(walls, p.step[p.clock->cycle], most, i, sum);
  }
}

template <class Kind>
__global__ void __launch_bounds__(chunk)
    measure_cells(const __grid_constant__ Nodes<double> nodes, const __grid_constant__ Kind block) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  if (i < block.n) block.measure_cell(nodes, i);
}

template <class Kind>
__global__ void __launch_bounds__(chunk) measure_nodes(const __grid_constant__ Kind block, int n) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  if (node < n) block.measure_node(node);
}

inline constexpr int threads_of_elements = 128;

template <class Kind, class Real>
__global__ void __launch_bounds__(threads_of_elements)
    advance_elements(const __grid_constant__ Nodes<Real> nodes, const __grid_constant__ Kind block, const double* room,
                     const Step* step, const Clock* clock) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < block.n) block.advance(nodes, room, step[clock->cycle].dt, i);
}

template <class Real>
__global__ void __launch_bounds__(threads_of_elements)
    damage_elements(const __grid_constant__ Elements<Real> block, const Step* step, const Clock* clock) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < block.n) advance_damage(block, step[clock->cycle].dt, i);
}

template <class Real>
__global__ void __launch_bounds__(chunk) gather_nodes(const __grid_constant__ Nodes<Real> nodes) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  if (node < nodes.n) gather_forces(nodes, node);
}

// One block.
template <class Real>
__global__ void __launch_bounds__(chunk) start_tools_of(const __grid_constant__ Problem<Real> p, int chunks) {
  const double most = find_fastest(p.tools.fastest, chunks, p.ties);
  const Moment now = p.now();
  if (threadIdx.x == 0) start_tools(p.tools, now.dt, now.cycle, most);
}

template <class Real>
__global__ void __launch_bounds__(chunk) hold_beads(const __grid_constant__ Problem<Real> p) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  const Moment now = p.now();
  if (i < p.beads.n) hold_bead(p.beads, p.tools, p.nodes.position, p.nodes.motion, now.dt, now.cycle, now.beads, i);
}

// One block.
template <class Real>
__global__ void __launch_bounds__(chunk) push_sheet_of(const __grid_constant__ Beads beads, Real* net) {
  push_sheet(beads, net, threadIdx.x, chunk);
}

template <class Real>
__global__ void __launch_bounds__(chunk) touch_nodes(const __grid_constant__ Problem<Real> p) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  touch_tools(p, node, [&](int t, const ContactSums& sums) {
    const ContactSums sum = reduce_sums(sums);
    if (threadIdx.x == 0) p.tools.sums[std::size_t(blockIdx.x) * p.tools.n + t] = sum;
  });
}

template <class Real>
__global__ void __launch_bounds__(chunk) press_edges(const __grid_constant__ Problem<Real> p) {
  const Edges& edges = p.tools.edges;
  touch_edges(p, int(blockIdx.x * chunk + threadIdx.x), [&](int j, const ContactSums& sums) {
    const ContactSums sum = reduce_sums(sums);
    if (threadIdx.x == 0) edges.sums[std::size_t(blockIdx.x) * edges.n_sharp + j] = sum;
  });
}

// One block.
static __global__ void __launch_bounds__(chunk) close_tools(const __grid_constant__ Tools tools, int chunks) {
  for (int t = 0; t < tools.n; ++t) {
    ContactSums own;
    for (int c = threadIdx.x; c < chunks; c += chunk) own += tools.sums[std::size_t(c) * tools.n + t];
    const Edges& edges = tools.edges;
    for (int j = 0; j < edges.n_sharp; ++j)
      for (int c = threadIdx.x; c < edges.chunks() && edges.sharp[j].number == t; c += chunk)
        own += edges.sums[std::size_t(c) * edges.n_sharp + j];
    const ContactSums sum = reduce_sums(own);
    if (threadIdx.x == 0) close_tool(tools, t, sum);
  }
}

// One thread.
static __global__ void end_cycle(Clock* clock) { ++clock->cycle; }

// A pass that measures: by chunks, then of all.
template <class Own>
__global__ void __launch_bounds__(chunk) measure_chunks(const __grid_constant__ Own own, Found* of_chunk) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  const Found found = reduce_found(i < own.n ? own(i) : Found{});
  if (threadIdx.x == 0) of_chunk[blockIdx.x] = found;
}
// One block.
static __global__ void __launch_bounds__(chunk) join_chunks(Found* of_chunk, int chunks) {
  Found own;
  for (int c = threadIdx.x; c < chunks; c += chunk) own += of_chunk[c];
  const Found found = reduce_found(own);
  if (threadIdx.x == 0) of_chunk[chunks] = found;
}

inline int count_blocks(int n, int threads) { return (n + threads - 1) / threads; }

// The pass that moves nodes, and what follows them, into a stream.
template <class Real>
void launch_move(const Problem<Real>& p, cudaStream_t stream) {
  const int chunks = p.chunks();
  if constexpr (std::is_same_v<Real, double>) {
    if (p.walls.n > 0)
      move_nodes_between_walls<<<chunks, chunk, 0, stream>>>(p);
    else
      move_nodes<<<chunks, chunk, 0, stream>>>(p);
    if (p.ties.n > 0) lead_nodes<<<p.ties.chunks(), chunk, 0, stream>>>(p.ties, p.nodes);
    if (p.walls.n > 0) move_walls<<<1, chunk, 0, stream>>>(p, chunks);
  } else {
    move_nodes<<<chunks, chunk, 0, stream>>>(p);
  }
}

// Volumes of cells and nodes, where a kind of elements asks for them.
template <class Real, class Kind>
void launch_volumes(const Nodes<Real>& nodes, const Kind& block, cudaStream_t stream) {
  if constexpr (requires { block.volumes; }) {
    measure_cells<<<count_blocks(block.n, chunk), chunk, 0, stream>>>(nodes, block);
    measure_nodes<<<count_blocks(nodes.n, chunk), chunk, 0, stream>>>(block, nodes.n);
  }
}

// One cycle into a stream.
template <class Real>
void launch_cycle(const Problem<Real>& p, cudaStream_t stream) {
  const Nodes<Real>& nodes = p.nodes;
  const Tools& tools = p.tools;
  const double* room = tools.n > 0 && tools.ironing ? tools.room : nullptr;
  const int chunks = p.chunks();
  launch_move(p, stream);
  if (tools.n > 0) start_tools_of<<<1, chunk, 0, stream>>>(p, chunks);
  for (int b = 0; b < p.n_blocks; ++b)
    std::visit(
        [&](const auto& of) {
          const int blocks = count_blocks(of.n, threads_of_elements);
          launch_volumes(nodes, of, stream);
          advance_elements<<<blocks, threads_of_elements, 0, stream>>>(nodes, of, room, p.step, p.clock);
          if (of.damage.n_criteria > 0)
            damage_elements<Real><<<blocks, threads_of_elements, 0, stream>>>(of, p.step, p.clock);
        },
        p.block[b]);
  gather_nodes<<<chunks, chunk, 0, stream>>>(nodes);
  if constexpr (std::is_same_v<Real, double>)
    if (p.ties.n > 0) give_back_forces<<<p.ties.chunks(), chunk, 0, stream>>>(p.ties, nodes);
  if (p.beads.n > 0) {
    hold_beads<<<count_blocks(p.beads.n, chunk), chunk, 0, stream>>>(p);
    push_sheet_of<<<1, chunk, 0, stream>>>(p.beads, nodes.internal_force);
  }
  if (tools.n > 0) {
    if (tools.edges.chunks() > 0) press_edges<<<tools.edges.chunks(), chunk, 0, stream>>>(p);
    touch_nodes<<<chunks, chunk, 0, stream>>>(p);
    close_tools<<<1, chunk, 0, stream>>>(tools, chunks);
  }
  end_cycle<<<1, 1, 0, stream>>>(p.clock);
}

}  // namespace presswork::device
