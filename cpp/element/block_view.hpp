// SPDX-License-Identifier: Apache-2.0
// What a kernel of solids sees of one block of cells.
#pragma once

#include "element/solid2d_geometry.hpp"
#include "element/umat_response.hpp"

namespace presswork {

// Views of one block of cells; arrays are C-contiguous. q is the rule's number of points, d the dimension, c the number
// of stress components: 4 in the plane (xx, yy, zz, xy), 6 in space (xx, yy, zz, xy, yz, zx).
struct BlockView {
  int n_cells;
  const int* connectivity;  // (n_cells, nodes)
  const double* points;     // (n_points, f) at t [mm]; f is d, and one more for a pressure over its scale
  const double* increment;  // (n_points, f) change since t [mm]
  SolidSection section;
  const double* stress_n;     // (n_cells, q, c) [MPa]
  const double* eqps_n;       // (n_cells, q)
  const double* hourglass_n;  // (n_cells, 2) one_point: forces [N]; mixed: how fast flow relaxes the bubble [1/s], 0
  double* stress;
  double* eqps;
  double* hourglass;
  double* volume;     // (n_cells, q) [mm3] at t+dt
  double* force;      // (n_packs, f nodes, pack_width) [N]
  double* stiffness;  // (n_packs, f nodes, f nodes, pack_width) [N/mm], or null
  bool symmetric;     // keep the symmetric part of the stiffness
  // what a law keeps besides: kept_values, or, of one from a shared library, n_state + UmatHistory<c>::size
  const double* history_n = nullptr;  // (n_cells, q, n_history)
  double* history = nullptr;
  int n_history = 0;
  double dt = 0.0;                        // of the increment [s]
  const double* temperature = nullptr;    // (n_cells, q) given to the points [degrees C]; null: that of the law's start
  const double* temperature_n = nullptr;  // the same when the increment began, for laws from shared libraries
  const double* mixture = nullptr;        // (n_cells, q, mixture_size) given to laws with phases, or null
  int first_cell = 0;                     // of the block in the mesh
  UmatPlace when = {};                    // stage, increment and times
  LawFault* fault = nullptr;              // (n_packs)
};

// Values of point q, of n_points, in N components, and back. Those that a law from a shared library keeps it reads and
// writes itself.
template <int N, class Law>
void load_point(const BlockView& b, const Law& law, const int cells[], int n_points, int q, Pack* s0) {
  for (int lane = 0; lane < pack_width; ++lane) {
    const std::size_t at = static_cast<std::size_t>(cells[lane]) * n_points + q;
    for (int i = 0; i < N; ++i) s0[i].set(lane, b.stress_n[N * at + i]);
    s0[N].set(lane, b.eqps_n[at]);
    if constexpr (!std::is_same_v<Law, Umat>)
      for (int i = 0; i < kept_values(law); ++i) s0[N + 1 + i].set(lane, b.history_n[b.n_history * at + i]);
  }
}
template <int N, class Law>
void save_point(const BlockView& b, const Law& law, const int cells[], int count, int n_points, int q, const Pack* s1,
                Pack volume) {
  for (int lane = 0; lane < count; ++lane) {
    const std::size_t at = static_cast<std::size_t>(cells[lane]) * n_points + q;
    for (int i = 0; i < N; ++i) b.stress[N * at + i] = s1[i][lane];
    b.eqps[at] = s1[N][lane];
    b.volume[at] = volume[lane];
    if constexpr (!std::is_same_v<Law, Umat>)
      for (int i = 0; i < kept_values(law); ++i) b.history[b.n_history * at + i] = s1[N + 1 + i][lane];
  }
}
// Notes the lanes in which a law of our own found no stress.
inline void note_failed(const BlockView& b, int pack, int count, Pack::Mask failed) {
  for (int lane = 0; any(failed) && lane < count; ++lane)
    if (failed[lane]) b.fault[pack].note(LawStatus::no_stress, pack * pack_width + lane, 0.5);
}

}  // namespace presswork
