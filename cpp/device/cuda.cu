// SPDX-License-Identifier: Apache-2.0
// The CUDA library: a thread a lane. A call takes the arrays to the card, launches its cycles one after the other
// without waiting, and takes back what they have changed.
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "device/cuda_library.hpp"

namespace presswork::device {

namespace {

template <class Real>
__global__ void __launch_bounds__(256)
    move_nodes(const __grid_constant__ Nodes<Real> nodes, const __grid_constant__ Step step) {
  const int node = blockIdx.x * blockDim.x + threadIdx.x;
  if (node < nodes.n) move_node(nodes, step, node);
}

template <int corners, class Real>
__global__ void __launch_bounds__(128)
    advance_shells(const __grid_constant__ Nodes<Real> nodes, const __grid_constant__ Shells<Real> shells, double dt) {
  const int shell = blockIdx.x * blockDim.x + threadIdx.x;
  if (shell < shells.n) advance_shell<corners>(nodes, shells, dt, shell);
}

template <class Real>
__global__ void __launch_bounds__(256) gather_nodes(const __grid_constant__ Nodes<Real> nodes) {
  const int node = blockIdx.x * blockDim.x + threadIdx.x;
  if (node < nodes.n) gather_forces(nodes, node);
}

void check(cudaError_t told, const char* what) {
  if (told == cudaSuccess) return;
  throw std::runtime_error(std::string("the card failed to ") + what + ": " + cudaGetErrorString(told));
}

// An array of the host and its copy on the card.
struct Copy {
  void *host, *card;
  std::size_t bytes;
  bool changes;
};

// All arrays of a call. They are listed first, so that their size is known before anything is computed.
class Arrays {
 public:
  ~Arrays() {
    for (const Copy& each : copies_) cudaFree(each.card);
  }
  template <class Number>
  void add(Number*& array, std::size_t n, bool changes) {
    pointers_.push_back(reinterpret_cast<void**>(const_cast<std::remove_const_t<Number>**>(&array)));
    copies_.push_back({const_cast<std::remove_const_t<Number>*>(array), nullptr, n * sizeof(Number), changes});
  }
  void send() {
    std::size_t needed = 0, free = 0, all = 0;
    for (const Copy& each : copies_) needed += each.bytes;
    check(cudaMemGetInfo(&free, &all), "tell its memory");
    if (needed > free) {
      char told[200];
      std::snprintf(told, sizeof told,
                    "the run needs %.2f GB on the card, which has %.2f GB free of %.2f: take precision = \"single\", "
                    "fewer shells or device = \"cpu\"",
                    needed * 1e-9, free * 1e-9, all * 1e-9);
      throw std::runtime_error(told);
    }
    for (std::size_t i = 0; i < copies_.size(); ++i) {
      Copy& each = copies_[i];
      check(cudaMalloc(&each.card, each.bytes > 0 ? each.bytes : 1), "give memory");
      check(cudaMemcpy(each.card, each.host, each.bytes, cudaMemcpyHostToDevice), "take an array");
      *pointers_[i] = each.card;
    }
  }
  void fetch() const {
    for (const Copy& each : copies_)
      if (each.changes) check(cudaMemcpy(each.host, each.card, each.bytes, cudaMemcpyDeviceToHost), "give an array");
  }

 private:
  std::vector<Copy> copies_;
  std::vector<void**> pointers_;
};

constexpr int threads_of_shells = 128, threads_of_nodes = 256;
int blocks(int n, int threads) { return (n + threads - 1) / threads; }

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
  const auto add_shells = [&](Shells<Real>& shells, std::size_t corners) {
    if (shells.n == 0) return;
    arrays.add(shells.node, corners * shells.n, false), arrays.add(shells.state, std::size_t(p.rows) * shells.n, true);
    TabulatedHardening& table = shells.law.hardening;
    const std::size_t pieces = 4 * static_cast<std::size_t>(table.last + 1);
    arrays.add(table.rows, pieces, false), arrays.add(table.float_rows, pieces, false);
  };
  add_shells(p.quadrilaterals, 4), add_shells(p.triangles, 3);
  arrays.send();
  const auto launch = [&]<int corners>(const Shells<Real>& shells) {
    if (shells.n > 0)
      advance_shells<corners><<<blocks(shells.n, threads_of_shells), threads_of_shells>>>(nodes, shells, cycles.dt);
  };
  for (int cycle = 0; cycle < cycles.n; ++cycle) {
    move_nodes<<<blocks(nodes.n, threads_of_nodes), threads_of_nodes>>>(nodes, cycles.step(cycle));
    launch.template operator()<4>(p.quadrilaterals);
    launch.template operator()<3>(p.triangles);
    gather_nodes<<<blocks(nodes.n, threads_of_nodes), threads_of_nodes>>>(nodes);
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
