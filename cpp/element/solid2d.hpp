// SPDX-License-Identifier: Apache-2.0
// Plane-strain and axisymmetric solids: T3, T6, Q4, Q8, Q9, standard, F-bar or one-point with hourglass control.
//
// Updated Lagrangian: gradients are taken on the configuration at t, F is the increment's, the residual and tangent are
// integrated over the configuration at t+dt. x is the radius and y the axis in axisymmetry; integrals carry 2 pi r, so
// that nodal forces are those of the whole ring; in plane strain they carry the depth.
//
// fbar (de Souza Neto et al. 1996, with the element's volume average in place of the centroid): the stress is that of
// F (Jbar/J)^(1/3), in plane strain of the in-plane part times (Jbar/J)^(1/2); Jbar = v(t+dt)/v(t) of the element.
// one_point (Flanagan & Belytschko 1981): centroid stress, and hourglass forces Q = R Q_n + k gamma.du on the hourglass
// vector gamma, k = 2 fraction * G_now * V * sum |grad N|^2 with G_now = G before first yield, then flow + slope/3 (at
// most G), so that the control stays weak beside plastic flow. In axisymmetry gradients and N/r are the element's
// volume averages.
//
// With settings.small_displacements the points are the undeformed ones, gradients and volumes those at the start, and
// F-bar becomes B-bar (Hughes 1980, with the element's volume average), in the virtual strain too.
//
// Elements are taken pack_width at a time; lane l of pack p is element p*pack_width + l. The last pack repeats the last
// element. Element matrices are written as [pack][row][column][lane], forces as [pack][row][lane]; row = 2 node +
// component.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "element/point_response.hpp"
#include "element/solid2d_forces.hpp"
#include "element/umat_response.hpp"

namespace presswork {

enum class Treatment { standard, fbar, one_point };

template <class Cell, int n_points, Treatment treatment>
struct Solid2d : SolidGeometry<Cell, n_points> {
  using Geometry = SolidGeometry<Cell, n_points>;
  using PointGeometry = typename Geometry::PointGeometry;
  static constexpr int nodes = Geometry::nodes;
  static constexpr int freedoms = 2 * nodes;
  using Forces = SolidForces<nodes>;
  using T = Pack;

  // Where the lanes of point q are, for a law from a shared library.
  static UmatLanes find_lanes(const BlockView& b, const int cells[], int count, const T x[][2], const T du[][2],
                              const PointGeometry* g, int q) {
    UmatLanes lanes;
    lanes.count = count;
    T area(0.0), at[2] = {T(0.0), T(0.0)};
    for (int p = 0; p < n_points; ++p) {
      T thickness(b.depth);
      if (b.axisymmetric) {
        thickness = T(0.0);
        for (int a = 0; a < nodes; ++a) thickness += T(2.0 * std::numbers::pi * Geometry::table().N[p][a]) * x[a][0];
      }
      area += g[p].volume_t / thickness;
    }
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 2; ++i) at[i] += T(Geometry::table().N[q][a]) * (x[a][i] + du[a][i]);
    const std::size_t row = b.n_history;
    for (int lane = 0; lane < count; ++lane) {
      UmatPlace& place = lanes.place[lane] = b.when;
      place.coordinates[0] = at[0][lane], place.coordinates[1] = at[1][lane];
      place.length = std::sqrt(area[lane]);
      place.cell = b.first_cell + cells[lane] + 1;
      place.point = q + 1;
      const std::size_t start = (static_cast<std::size_t>(cells[lane]) * n_points + q) * row;
      lanes.history_n[lane] = b.history_n + start;
      lanes.history[lane] = b.history + start;
    }
    return lanes;
  }

  // Evaluate the pack whose first cell is `first`. Returns the index of a cell turned inside out, or -1.
  template <class Law>
  static int evaluate(const BlockView& b, const PointSettings& settings, const Law& law, int pack) {
    constexpr bool is_umat = std::is_same_v<Law, Umat>;
    static_assert(!(is_umat && treatment == Treatment::one_point), "hourglass control needs a flow stress");
    const int first = pack * pack_width;
    int cells[pack_width];
    T x[nodes][2], du[nodes][2];
    for (int lane = 0; lane < pack_width; ++lane) {
      cells[lane] = first + lane < b.n_cells ? first + lane : b.n_cells - 1;
      for (int a = 0; a < nodes; ++a) {
        const int node = b.connectivity[cells[lane] * nodes + a];
        for (int i = 0; i < 2; ++i) {
          x[a][i].set(lane, b.points[2 * node + i]);
          du[a][i].set(lane, b.increment[2 * node + i]);
        }
      }
    }

    // 1. kinematics of every point, before anything is computed from it
    PointGeometry g[n_points];
    Pack::Mask bad{};
    const bool small = settings.small_displacements;
    for (int q = 0; q < n_points; ++q) {
      bool measured = false;
      if constexpr (treatment == Treatment::one_point)
        if ((measured = b.axisymmetric)) bad |= Geometry::measure_mean(x, g[q]);
      if (!measured) bad |= Geometry::measure_reference(b, x, q, g[q]);
      bad |= Geometry::deform(du, g[q], small);
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
    if constexpr (treatment == Treatment::fbar) mean = Geometry::mean_dilatation(g, with_K, small, mean_div);

    // 2. stress, internal force and tangent point by point
    for (int q = 0; q < n_points; ++q) {
      T s0[most_point_values<4>], s1[most_point_values<4>];
      load_point<4>(b, law, cells, n_points, q, s0);
      T F[5] = {g[q].F[0], g[q].F[1], g[q].F[2], g[q].F[3], g[q].F[4]};
      if constexpr (treatment == Treatment::fbar) Geometry::use_mean_dilatation(b, mean, g[q], small, F);
      PointResponse<T> response;
      const int count = std::min(pack_width, b.n_cells - first);
      if constexpr (is_umat) {
        respond(settings, law, find_lanes(b, cells, count, x, du, g, q), first, F, s0, s1, response, b.fault[pack]);
      } else {
        note_failed(b, pack, count, respond(settings, law, F, b.dt, s0, s1, response));
      }

      T now[nodes][3], dv = g[q].volume_t * g[q].jacobian;
      Geometry::push_forward(g[q], now, small);
      Forces::add_force(now, response.stress, dv, force);
      if (with_K) {
        Forces::add_stiffness(now, response.modulus, dv, K);
        if constexpr (treatment == Treatment::fbar)
          if (!small) Forces::add_fbar(b, now, response.modulus, response.stress, dv, mean_div, K);
      }
      if constexpr (treatment == Treatment::fbar)
        if (small)
          Forces::add_bbar(b, now, response.modulus, response.stress, dv, mean_div, force, with_K ? K : nullptr);
      if constexpr (treatment == Treatment::one_point) {
        T Q[2];
        for (int lane = 0; lane < pack_width; ++lane)
          for (int i = 0; i < 2; ++i) Q[i].set(lane, b.hourglass_n[2 * cells[lane] + i]);
        T flow, slope;
        const T eqps_n = s0[4], modulus_n = T(law.shear_modulus());
        law.flow_at_rest(eqps_n, point_temperature(law, s0), flow, slope);
        Forces::add_hourglass(Forces::hourglass_modulus(modulus_n, eqps_n, flow, slope), b.hourglass_fraction, x, du,
                              g[q], now, Q, force, with_K ? K : nullptr, small);
        for (int lane = 0; lane < pack_width && first + lane < b.n_cells; ++lane)
          for (int i = 0; i < 2; ++i) b.hourglass[2 * cells[lane] + i] = Q[i][lane];
      }
      save_point<4>(b, law, cells, count, n_points, q, s1, dv);
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
