// SPDX-License-Identifier: Apache-2.0
// The CUDA library: a loop that lives in the memory of a card. Its cycles are graphs of kernels, of one cycle and of
// many, which are made at the first call and launched at once: nothing waits but the end of a call.
#include <cstdio>
#include <stdexcept>
#include <string>

#include "device/cuda_library.hpp"
#include "device/cuda_passes.cuh"

namespace presswork::device {

namespace {

void check(cudaError_t told, const char* what) {
  if (told == cudaSuccess) return;
  throw std::runtime_error(std::string("the card failed to ") + what + ": " + cudaGetErrorString(told));
}

class CardMemory final : public Memory {
 public:
  void* give(std::size_t bytes) override {
    void* made = nullptr;
    check(cudaMalloc(&made, bytes), "give memory");
    return made;
  }
  void release(void* at) override { cudaFree(at); }
  void send(void* to, const void* from, std::size_t bytes) override {
    check(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "take an array");
  }
  void fetch(void* to, const void* from, std::size_t bytes) override {
    check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost), "give an array");
  }
  void copy(void* to, const void* from, std::size_t bytes) override {
    check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToDevice), "copy an array");
  }
  void clear(void* at, std::size_t bytes) override { check(cudaMemset(at, 0, bytes), "clear an array"); }
  void measure(double& free, double& all) override {
    std::size_t left = 0, whole = 0;
    check(cudaMemGetInfo(&left, &whole), "tell its memory");
    free = static_cast<double>(left), all = static_cast<double>(whole);
  }
};

template <class Real>
class CardResident final : public Resident<Real> {
 public:
  explicit CardResident(const Problem<Real>& problem) : Resident<Real>(problem, std::make_unique<CardMemory>()) {
    check(cudaStreamCreate(&stream_), "make a stream");
  }
  ~CardResident() override {
    for (cudaGraphExec_t graph : {one_, many_})
      if (graph) cudaGraphExecDestroy(graph);
    cudaStreamDestroy(stream_);
  }

  Found sum_up(const Pass<Real>& pass) override {
    const int chunks = std::visit(
        [&](const auto& own) {
          const int blocks = count_blocks(own.n, chunk);
          measure_chunks<<<blocks, chunk, 0, stream_>>>(own, this->found_);
          return blocks;
        },
        pass);
    join_chunks<<<1, chunk, 0, stream_>>>(this->found_, chunks);
    check(cudaGetLastError(), "start a measurement");
    check(cudaStreamSynchronize(stream_), "end a measurement");
    Found all;
    this->arrays.fetch(&all, this->found_ + chunks, sizeof all);
    return all;
  }

 protected:
  void begin() override {
    const Problem<Real>& p = this->problem;
    for (int b = 0; b < p.n_blocks; ++b)
      std::visit([&](const auto& of) { launch_volumes(p.nodes, of, stream_); }, p.block[b]);
    check(cudaStreamSynchronize(stream_), "measure volumes");
  }
  void compute(int n_cycles) override {
    if (!one_) one_ = make_graph(1), many_ = make_graph(in_graph);
    for (; n_cycles >= in_graph; n_cycles -= in_graph) check(cudaGraphLaunch(many_, stream_), "start cycles");
    for (; n_cycles > 0; --n_cycles) check(cudaGraphLaunch(one_, stream_), "start a cycle");
    check(cudaStreamSynchronize(stream_), "end its cycles");
  }

 private:
  static constexpr int in_graph = 32;

  cudaGraphExec_t make_graph(int n_cycles) {
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t made = nullptr;
    check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "begin a graph of cycles");
    for (int cycle = 0; cycle < n_cycles; ++cycle) launch_cycle(this->problem, stream_);
    check(cudaStreamEndCapture(stream_, &graph), "end a graph of cycles");
    check(cudaGraphInstantiate(&made, graph, 0), "make a graph of cycles");
    cudaGraphDestroy(graph);
    return made;
  }

  cudaStream_t stream_ = nullptr;
  cudaGraphExec_t one_ = nullptr, many_ = nullptr;
};

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
Resident<Real>* make_on_first(const Problem<Real>& problem) {
  count_cards();
  const CudaCard card = describe(0);
  if (card.capability < least_capability)
    throw std::runtime_error(std::string(card.name) + " is too old: compute capability 8.0 or newer is needed");
  return new CardResident<Real>(problem);
}

}  // namespace

extern "C" {
int presswork_cuda_count(int* cards, char* message) {
  return run(message, [&] { *cards = count_cards(); });
}
int presswork_cuda_describe(int card, CudaCard* found, char* message) {
  return run(message, [&] { *found = describe(card); });
}
int presswork_cuda_make_double(const Problem<double>* problem, Resident<double>** made, char* message) {
  return run(message, [&] { *made = make_on_first(*problem); });
}
int presswork_cuda_make_single(const Problem<float>* problem, Resident<float>** made, char* message) {
  return run(message, [&] { *made = make_on_first(*problem); });
}
}

}  // namespace presswork::device
