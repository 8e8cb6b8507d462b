// SPDX-License-Identifier: Apache-2.0
// Internal force of the one-point shell alone, microseconds per shell and evaluation: one lane at a time and in SIMD
// packs, on 1 and 2 threads. benchmarks/shells.py builds and runs it; by hand:
//
//   c++ -std=c++20 -O3 -march=native -fopenmp -fno-math-errno -fno-trapping-math -Icpp benchmarks/shell_kernel.cpp
//
// 10,000 squares of 1 mm, 0.8 mm thick, stretched equally in both directions by 3e-5 an evaluation, five Gauss points,
// von Mises with Swift's hardening, warping terms. Nodal values lie ready beside the shell; gathering them, assembly
// and the step of the nodes are what explicit_shells.py counts besides. The least of the repeats, on one thread of CPU
// time; that every point flows in every evaluation is checked.
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "element/shell4_one_point.hpp"

using namespace presswork;

namespace {

constexpr int n_shells = 10'000, evaluations = 60, repeats = 9, points = 5;
constexpr double step = 3e-5;  // strain of an evaluation

template <class T>
struct Shell {
  T x[4][3], v[4][3], w[4][3], state[shell4::head_rows + points * FastMises::rows()], force[24];
};

double lane_of(double value, int) { return value; }
double lane_of(const Pack& value, int lane) { return value[lane]; }

// One thread: CPU time, which other processes disturb least; more: wall time [s].
double now(int threads) {
  timespec t;
  clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

template <class T>
Shell<T> unit_square() {
  constexpr double corner[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  Shell<T> shell;
  for (auto& s : shell.state) s = T(0.0);
  shell.state[shell4::thickness] = T(0.8);
  for (int a = 0; a < 4; ++a)
    for (int i = 0; i < 3; ++i) {
      shell.x[a][i] = T(i < 2 ? corner[a][i] : 0.0);
      shell.v[a][i] = shell.x[a][i];
      shell.w[a][i] = T(0.0);
    }
  shell.state[shell4::reference] = shell.state[shell4::reference + 3] = T(1.0);  // sides along x and y
  return shell;
}

template <class T>
double microseconds(const FastMises& law, const LayerRule& rule, int threads) {
  constexpr int width = sizeof(T) / sizeof(double);
  const ShellControl control;
  const LayerConditions<T> conditions{step};
  std::vector<Shell<T>> shells(n_shells / width, unit_square<T>());
  const int count = static_cast<int>(shells.size());
  auto evaluate = [&] {
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int i = 0; i < count; ++i) {
      auto& s = shells[i];
      for (int a = 0; a < 4; ++a)
        for (int j = 0; j < 2; ++j) s.x[a][j] += T(step) * s.v[a][j];
      shell4::advance<true>(law, rule, control, conditions, s.x, s.v, s.w, static_cast<const T*>(nullptr), s.state,
                            s.force);
    }
  };
  for (int k = 0; k < 200; ++k) evaluate();  // into the plastic range
  double best = 1e300;
  for (int r = 0; r < repeats; ++r) {
    std::vector<double> before(points);
    auto strain = [&](int k) { return lane_of(shells.back().state[shell4::head_rows + k * FastMises::rows() + 3], 0); };
    for (int k = 0; k < points; ++k) before[k] = strain(k);
    const double started = now(threads);
    for (int k = 0; k < evaluations; ++k) evaluate();
    best = std::min(best, 1e6 * (now(threads) - started) / evaluations / (count * width));
    for (int k = 0; k < points; ++k)
      if (!(strain(k) - before[k] > 0.9 * 2 * step * evaluations / (1 + step * (200 + repeats * evaluations)))) {
        std::fprintf(stderr, "point %d flows by %g only\n", k, strain(k) - before[k]);
        std::exit(1);
      }
  }
  return best;
}

}  // namespace

int main() {
  const HardeningTable table(Hardening{hardening::Swift{565.0, 0.007, 0.26}});
  const FastMises law{{207e3, 0.3, table.view()}};
  const LayerRule rule{
      5,
      {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640},
      {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, 0.1184634425280945}};
  for (int threads : {1, 2})
    std::printf("one-point shell, internal force, %d thread%s: one lane %.3f, packs of %d %.3f us per shell\n", threads,
                threads > 1 ? "s" : "", microseconds<double>(law, rule, threads), pack_width,
                microseconds<Pack>(law, rule, threads));
}
