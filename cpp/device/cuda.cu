// SPDX-License-Identifier: Apache-2.0
// The CUDA library: a thread a lane. A call takes the arrays to the card, launches its cycles one after the other
// without waiting, and takes back what they have changed.
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "device/cuda_arrays.cuh"
#include "device/cuda_library.hpp"
#include "device/cuda_sums.cuh"

namespace presswork::device {

namespace {

template <class Real>
__global__ void __launch_bounds__(chunk)
    move_nodes(const __grid_constant__ Nodes<Real> nodes, const __grid_constant__ Step step, double* fastest) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  const double speed2 = node < nodes.n ? move_node(nodes, step, node) : 0.0;
  if (!fastest) return;
  const double most = reduce(speed2, [](double a, double b) { return a > b ? a : b; });
  if (threadIdx.x == 0) fastest[blockIdx.x] = most;
}

template <class Kind, class Real>
__global__ void __launch_bounds__(128)
    advance_elements(const __grid_constant__ Nodes<Real> nodes, const __grid_constant__ Kind block, const double* room,
                     double dt) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < block.n) block.advance(nodes, room, dt, i);
}

template <class Real>
__global__ void __launch_bounds__(chunk) gather_nodes(const __grid_constant__ Nodes<Real> nodes) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  if (node < nodes.n) gather_forces(nodes, node);
}

// One block.
__global__ void __launch_bounds__(chunk)
    start_tools_of(const __grid_constant__ Tools tools, int chunks, double dt, int cycle) {
  double most = 0.0;
  for (int c = threadIdx.x; c < chunks; c += chunk) most = tools.fastest[c] > most ? tools.fastest[c] : most;
  most = reduce(most, [](double a, double b) { return a > b ? a : b; });
  if (threadIdx.x == 0) start_tools(tools, dt, cycle, most);
}

template <class Real>
__global__ void __launch_bounds__(chunk)
    hold_beads(const __grid_constant__ Problem<Real> problem, double dt, int cycle) {
  const int i = blockIdx.x * chunk + threadIdx.x;
  const Nodes<Real>& nodes = problem.nodes;
  if (i < problem.beads.n) hold_bead(problem.beads, problem.tools, nodes.position, nodes.motion, dt, cycle, i);
}

// One block.
template <class Real>
__global__ void __launch_bounds__(chunk) push_sheet_of(const __grid_constant__ Beads beads, Real* net) {
  push_sheet(beads, net, threadIdx.x, chunk);
}

template <class Real>
__global__ void __launch_bounds__(chunk)
    touch_nodes(const __grid_constant__ Problem<Real> problem, double dt, int cycle) {
  const int node = blockIdx.x * chunk + threadIdx.x;
  touch_tools(problem, dt, cycle, node, [&](int t, const ContactSums& sums) {
    const ContactSums sum = reduce_sums(sums);
    if (threadIdx.x == 0) problem.tools.sums[std::size_t(blockIdx.x) * problem.tools.n + t] = sum;
  });
}

template <class Real>
__global__ void __launch_bounds__(chunk) press_edges(const __grid_constant__ Problem<Real> problem, double dt) {
  const Edges& edges = problem.tools.edges;
  touch_edges(problem, dt, int(blockIdx.x * chunk + threadIdx.x), [&](int j, const ContactSums& sums) {
    const ContactSums sum = reduce_sums(sums);
    if (threadIdx.x == 0) edges.sums[std::size_t(blockIdx.x) * edges.n_sharp + j] = sum;
  });
}

// One block.
__global__ void __launch_bounds__(chunk) close_tools(const __grid_constant__ Tools tools, int chunks) {
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

constexpr int threads_of_elements = 128;
int count_blocks(int n, int threads) { return (n + threads - 1) / threads; }

template <class Real>
void advance(Problem<Real> p, const Cycles& cycles) {
  Nodes<Real>& nodes = p.nodes;
  const std::size_t n = nodes.n, slots = nodes.n_slots;
  Arrays arrays;
  arrays.add(nodes.position, 4 * n, true), arrays.add(nodes.motion, 8 * n, true);
  arrays.add(nodes.internal_force, freedoms * n, true), arrays.add(nodes.force, freedoms * n, false);
  arrays.add(nodes.held, n, false), arrays.add(nodes.prescribed, freedoms * n, false);
  arrays.add(nodes.reaction_impulse, freedoms * n, true), arrays.add(nodes.work, 2 * n, true);
  arrays.add(nodes.first_corner, n + 1, false), arrays.add(nodes.corner, slots, false);
  arrays.add(nodes.corner_force, freedoms * slots, false);
  std::vector<Block<Real>> blocks(p.block, p.block + p.n_blocks);
  for (auto& block : blocks) std::visit([&](auto& of) { add_elements(arrays, of); }, block);
  std::vector<Surface> surfaces(p.tools.surface, p.tools.surface + p.tools.n);
  std::vector<SharpTool> sharp(p.tools.edges.sharp, p.tools.edges.sharp + p.tools.edges.n_sharp);
  if (p.tools.n > 0) add_tools(arrays, p, cycles, surfaces);
  if (!sharp.empty()) add_edges(arrays, p, sharp);
  if (p.beads.n > 0) add_beads(arrays, p, cycles);
  arrays.send();
  p.block = blocks.data();
  p.find_sheets();

  const Tools& tools = p.tools;
  const double* room = tools.n > 0 && tools.ironing ? tools.room : nullptr;
  const int chunks = p.chunks();
  for (int cycle = 0; cycle < cycles.n; ++cycle) {
    move_nodes<<<chunks, chunk>>>(nodes, cycles.step(cycle), tools.n > 0 ? tools.fastest : nullptr);
    if (tools.n > 0) start_tools_of<<<1, chunk>>>(tools, chunks, cycles.dt, cycle);
    for (const auto& block : blocks)
      std::visit(
          [&](const auto& of) {
            advance_elements<<<count_blocks(of.n, threads_of_elements), threads_of_elements>>>(nodes, of, room,
                                                                                               cycles.dt);
          },
          block);
    gather_nodes<<<chunks, chunk>>>(nodes);
    if (p.beads.n > 0) {
      hold_beads<<<count_blocks(p.beads.n, chunk), chunk>>>(p, cycles.dt, cycle);
      push_sheet_of<<<1, chunk>>>(p.beads, nodes.internal_force);
    }
    if (tools.n > 0) {
      if (tools.edges.chunks() > 0) press_edges<<<tools.edges.chunks(), chunk>>>(p, cycles.dt);
      touch_nodes<<<chunks, chunk>>>(p, cycles.dt, cycle);
      close_tools<<<1, chunk>>>(tools, chunks);
    }
    check(cudaGetLastError(), "start a cycle");
  }
  check(cudaDeviceSynchronize(), "end its cycles");
  arrays.fetch();
}

template <class Work>
int run(char* message, const Work& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    std::snprintf(message, message_size, "%s", error.what());
    return 1;
  }
}

int count_cards() {
  int n = 0;
  const cudaError_t told = cudaGetDeviceCount(&n);
  if (told == cudaErrorInsufficientDriver)
    throw std::runtime_error("there is no NVIDIA driver, or one older than CUDA 13 needs: install 580 or newer");
  if (told == cudaErrorNoDevice || (told == cudaSuccess && n == 0)) throw std::runtime_error("there is no NVIDIA card");
  check(told, "answer");
  return n;
}

CudaCard describe(int card) {
  cudaDeviceProp properties;
  std::size_t free = 0, all = 0;
  check(cudaGetDeviceProperties(&properties, card), "tell what it is");
  check(cudaSetDevice(card), "be chosen");
  check(cudaMemGetInfo(&free, &all), "tell its memory");
  CudaCard found{};
  std::snprintf(found.name, sizeof found.name, "%s", properties.name);
  found.capability = 10 * properties.major + properties.minor;
  found.memory = double(all), found.free = double(free);
  return found;
}

template <class Real>
void advance_on_first(const Problem<Real>& problem, const Cycles& cycles) {
  count_cards();
  const CudaCard card = describe(0);
  if (card.capability < least_capability)
    throw std::runtime_error(std::string(card.name) + " is too old: compute capability 8.0 or newer is needed");
  advance(problem, cycles);
}

}  // namespace

extern "C" {
int presswork_cuda_count(int* cards, char* message) {
  return run(message, [&] { *cards = count_cards(); });
}
int presswork_cuda_describe(int card, CudaCard* found, char* message) {
  return run(message, [&] { *found = describe(card); });
}
int presswork_cuda_advance_double(const Problem<double>* problem, const Cycles* cycles, char* message) {
  return run(message, [&] { advance_on_first(*problem, *cycles); });
}
int presswork_cuda_advance_single(const Problem<float>* problem, const Cycles* cycles, char* message) {
  return run(message, [&] { advance_on_first(*problem, *cycles); });
}
}

}  // namespace presswork::device
