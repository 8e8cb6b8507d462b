// SPDX-License-Identifier: Apache-2.0
// Solids in space: standard or F-bar. The formulation is that of solid2d.hpp, its equations those of
// space_response.hpp.
//
// Updated Lagrangian: gradients are taken on the configuration at t, F is the increment's, the residual and tangent are
// integrated over the configuration at t+dt. fbar (de Souza Neto et al. 1996, with the element's volume average in
// place of the centroid): the stress is that of F (Jbar/J)^(1/3), Jbar = v(t+dt)/v(t) of the element. With
// settings.small_displacements it becomes B-bar (Hughes 1980, with the element's volume average).
//
// Elements are taken pack_width at a time; lane l of pack p is element p*pack_width + l. The last pack repeats the last
// element. Element matrices are written as [pack][row][column][lane], forces as [pack][row][lane]; row = 3 node +
// component.
#pragma once

#include <algorithm>

#include "element/solid2d.hpp"
#include "element/solid_space.hpp"

namespace presswork {

template <class Cell, int n_points, Treatment treatment>
struct SpaceSolid : SolidSpace<Cell, n_points, Pack> {
  using T = Pack;
  using Base = SolidSpace<Cell, n_points, T>;
  using Point = typename Base::Point;
  static constexpr int dim = 3, nodes = Base::nodes, freedoms = Base::freedoms;
  static_assert(treatment != Treatment::one_point);

  // Evaluate the pack whose first cell is pack * pack_width. Returns the index of a cell turned inside out, or -1.
  template <class Law>
  static int evaluate(const BlockView& b, const PointSettings& settings, const Law& law, int pack) {
    const int first = pack * pack_width;
    int cells[pack_width];
    T x[nodes][3], du[nodes][3];
    for (int lane = 0; lane < pack_width; ++lane) {
      cells[lane] = std::min(first + lane, b.n_cells - 1);
      for (int a = 0; a < nodes; ++a) {
        const int node = b.connectivity[cells[lane] * nodes + a];
        for (int i = 0; i < 3; ++i) {
          x[a][i].set(lane, b.points[3 * node + i]);
          du[a][i].set(lane, b.increment[3 * node + i]);
        }
      }
    }

    // 1. kinematics of every point, before anything is computed from it
    Point g[n_points];
    const bool small = settings.small_displacements;
    Mask<T> bad{};
    for (int q = 0; q < n_points; ++q) {
      bad = either(bad, Base::measure_reference(x, q, g[q]));
      bad = either(bad, Base::deform(du, small, g[q]));
    }
    for (int lane = 0; lane < pack_width; ++lane)
      if (bad[lane]) return cells[lane];

    T force[freedoms];
    alignas(64) T K[freedoms * freedoms];
    const bool with_K = b.stiffness != nullptr;
    for (auto& f : force) f = T(0.0);
    if (with_K)
      for (auto& k : K) k = T(0.0);
    T mean_div[freedoms], mean(1.0);
    if constexpr (treatment == Treatment::fbar) mean = Base::mean_dilatation(g, with_K, small, mean_div);

    // 2. stress, internal force and tangent point by point
    for (int q = 0; q < n_points; ++q) {
      T s0[most_point_values<6>], s1[most_point_values<6>];
      load_point<6>(b, law, cells, n_points, q, s0);
      T F[9];
      std::copy_n(g[q].F, 9, F);
      if constexpr (treatment == Treatment::fbar) Base::use_mean_dilatation(mean, g[q], small, F);
      typename Base::Response response;
      const int count = std::min(pack_width, b.n_cells - first);
      note_failed(b, pack, count, respond(settings, law, F, b.dt, s0, s1, response));

      T dv = g[q].volume_t * g[q].jacobian;
      typename Base::Gradients now;
      Base::push_forward(g[q], small, now);
      Base::add_force(now, response.stress, dv, force);
      if (with_K) Base::add_stiffness(now, response, dv, K);
      if constexpr (treatment == Treatment::fbar) {
        if (small)
          Base::add_bbar(now, response, dv, mean_div, force, with_K ? K : nullptr);
        else if (with_K)
          Base::add_fbar(now, response, dv, mean_div, K);
      }
      save_point<6>(b, law, cells, count, n_points, q, s1, dv);
    }

    // 3. out
    for (int i = 0; i < freedoms; ++i) store(b.force, static_cast<std::size_t>(pack) * freedoms + i, force[i]);
    if (!with_K) return -1;
    const std::size_t base = static_cast<std::size_t>(pack) * freedoms * freedoms;
    for (int i = 0; i < freedoms; ++i)
      for (int j = 0; j < freedoms; ++j) {
        T k = b.symmetric ? T(0.5) * (K[i * freedoms + j] + K[j * freedoms + i]) : K[i * freedoms + j];
        store(b.stiffness, base + i * freedoms + j, k);
      }
    return -1;
  }

  static void store(double* array, std::size_t index, T value) {
    for (int lane = 0; lane < pack_width; ++lane) array[index * pack_width + lane] = value[lane];
  }
};

}  // namespace presswork
