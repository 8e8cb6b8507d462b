// SPDX-License-Identifier: Apache-2.0
// A solid's kernel over a block of cells, a pack at a time.
//
// Elements are taken pack_width at a time; lane l of pack p is element p*pack_width + l. The last pack repeats the last
// element. Element matrices are written as [pack][row][column][lane], forces as [pack][row][lane]; row = d node +
// component.
#pragma once

#include <cmath>
#include <numbers>

#include "element/block_view.hpp"
#include "element/solid.hpp"
#include "element/umat_space.hpp"

namespace presswork {

// The points of a pack of cells: their state is read from the block and written to it.
template <class Body, int n_points, class Law>
struct BlockPoints {
  using T = Pack;
  static constexpr int components = Body::components, nodes = Body::nodes, dim = Body::dim;
  static constexpr bool is_umat = std::is_same_v<Law, Umat>;
  const BlockView& b;
  const PointSettings& settings;
  const Law& law;
  const int pack, first = pack * pack_width, count = std::min(pack_width, b.n_cells - first);
  int cells[pack_width];
  T s0[most_point_values<components>], s1[most_point_values<components>];

  BlockPoints(const BlockView& b, const PointSettings& settings, const Law& law, int pack)
      : b(b), settings(settings), law(law), pack(pack) {
    for (int lane = 0; lane < pack_width; ++lane) cells[lane] = std::min(first + lane, b.n_cells - 1);
  }

  template <int width>
  void gather(T x[][width], T du[][width]) const {
    for (int lane = 0; lane < pack_width; ++lane)
      for (int a = 0; a < nodes; ++a) {
        const int node = b.connectivity[cells[lane] * nodes + a];
        for (int i = 0; i < width; ++i) {
          x[a][i].set(lane, b.points[width * node + i]);
          du[a][i].set(lane, b.increment[width * node + i]);
        }
      }
  }

  [[gnu::always_inline]] inline void advance(int q, const T x[][dim], const T du[][dim], const typename Body::Point* g,
                                             const T* F, typename Body::Response& response) {
    load_point<components>(b, law, cells, n_points, q, s0);
    if constexpr (is_umat) {
      respond(settings, law, find_lanes(x, du, g, q), first, F, s0, s1, response, b.fault[pack]);
    } else {
      T mixture[mixture_size];
      const T* given = read_mixture(q, mixture) ? mixture : nullptr;
      note_failed(b, pack, count, respond(settings, law, F, b.dt, temperature_at(q), s0, s1, response, given));
    }
  }
  [[gnu::always_inline]] inline void keep(int q, T volume) {
    save_point<components>(b, law, cells, count, n_points, q, s1, volume);
  }

  // Given to point q.
  T temperature_at(int q) const {
    T given(start_temperature(law));
    if (b.temperature)
      for (int lane = 0; lane < pack_width; ++lane) given.set(lane, b.temperature[cells[lane] * n_points + q]);
    return given;
  }
  bool read_mixture(int q, T mixture[mixture_size]) const {
    if (!b.mixture) return false;
    for (int lane = 0; lane < pack_width; ++lane)
      for (int i = 0; i < mixture_size; ++i)
        mixture[i].set(lane, b.mixture[mixture_size * (cells[lane] * n_points + q) + i]);
    return true;
  }

  void begin_hourglass(T Q[2], T& modulus) const {
    static_assert(!is_umat, "hourglass control needs a flow stress");
    for (int lane = 0; lane < pack_width; ++lane)
      for (int i = 0; i < 2; ++i) Q[i].set(lane, b.hourglass_n[2 * cells[lane] + i]);
    T flow, slope, mixture[mixture_size];
    const T eqps_n = s0[4], modulus_n = T(law.shear_modulus());
    law.flow_at_rest(eqps_n, point_temperature(law, temperature_at(0), s0), flow, slope);
    if (read_mixture(0, mixture)) flow = flow * mixture[mixture_flow], slope = slope * mixture[mixture_flow];
    modulus = Body::Forces::hourglass_modulus(modulus_n, eqps_n, flow, slope);
  }
  void keep_hourglass(const T Q[2]) {
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < 2; ++i) b.hourglass[2 * cells[lane] + i] = Q[i][lane];
  }

  // Of the law without stress, in this increment.
  T dilatation() const {
    T linear(0.0);
    if constexpr (std::is_same_v<Law, SolidLaw>) {
      if (!law.thermoelastic.active() && !law.phases) return linear;
      T kept[most_point_values<components>], mixture[mixture_size];
      load_point<components>(b, law, cells, n_points, 0, kept);
      const T now = law.temperature_now(temperature_at(0), kept);
      if (law.thermoelastic.active()) linear = law.thermoelastic.strain(law.temperature_before(kept), now);
      if (law.phases && read_mixture(0, mixture)) linear += mixture[mixture_strain] - kept[law.mixture_at()];
    }
    return T(3.0) * linear;
  }
  void begin_bubble(T& relaxed) const {
    for (int lane = 0; lane < pack_width; ++lane) relaxed.set(lane, 1.0 + b.dt * b.hourglass_n[2 * cells[lane]]);
  }
  void keep_bubble(double shear_modulus) {
    const T relaxed = relaxed_by_flow(shear_modulus, s1, s1[components] - s0[components]);
    for (int lane = 0; lane < count; ++lane) {
      const int place = 2 * cells[lane];
      b.hourglass[place] = b.dt > 0.0 ? relaxed[lane] / b.dt : b.hourglass_n[place];
    }
  }

  // Where the lanes of point q are, for a law from a shared library.
  UmatLanes find_lanes(const T x[][dim], const T du[][dim], const typename Body::Point* g, int q) const {
    UmatLanes lanes;
    lanes.count = count;
    T size(0.0), at[dim];  // area, in space volume
    for (int p = 0; p < n_points; ++p) {
      T thickness(dim == 2 ? b.section.depth : 1.0);
      if (dim == 2 && b.section.axisymmetric) {
        thickness = T(0.0);
        for (int a = 0; a < nodes; ++a) thickness += T(2.0 * std::numbers::pi * Body::table().N[p][a]) * x[a][0];
      }
      size += g[p].volume_t / thickness;
    }
    for (int i = 0; i < dim; ++i) {
      at[i] = T(0.0);
      for (int a = 0; a < nodes; ++a) at[i] += T(Body::table().N[q][a]) * (x[a][i] + du[a][i]);
    }
    const std::size_t row = b.n_history;
    for (int lane = 0; lane < count; ++lane) {
      UmatPlace& place = lanes.place[lane] = b.when;
      for (int i = 0; i < dim; ++i) place.coordinates[i] = at[i][lane];
      place.length = dim == 2 ? std::sqrt(size[lane]) : std::cbrt(size[lane]);
      place.cell = b.first_cell + cells[lane] + 1;
      place.point = q + 1;
      if (b.temperature && b.temperature_n) {
        const std::size_t point = static_cast<std::size_t>(cells[lane]) * n_points + q;
        place.temperature[0] = b.temperature_n[point];
        place.temperature[1] = b.temperature[point] - b.temperature_n[point];
      }
      const std::size_t start = (static_cast<std::size_t>(cells[lane]) * n_points + q) * row;
      lanes.history_n[lane] = b.history_n + start;
      lanes.history[lane] = b.history + start;
    }
    return lanes;
  }
};

// Evaluate a pack of a block. Returns the index of a cell turned inside out, or -1.
template <int dim, class Cell, int n_points, Treatment treatment, class Law>
int evaluate_pack(const BlockView& b, const PointSettings& settings, const Law& law, int pack) {
  using Kernel = SolidKernel<dim, Cell, n_points, treatment, Pack>;
  using Points = BlockPoints<typename Kernel::Body, n_points, Law>;
  constexpr int nodes = Cell::nodes, freedoms = Kernel::freedoms;
  Points points(b, settings, law, pack);
  Pack x[nodes][Kernel::node_freedoms], du[nodes][Kernel::node_freedoms], force[freedoms];
  alignas(64) Pack K[freedoms * freedoms];
  points.gather(x, du);
  const Pack::Mask bad = Kernel::evaluate(b.section, settings, x, du, points, force, b.stiffness ? K : nullptr);
  for (int lane = 0; lane < pack_width; ++lane)
    if (bad[lane]) return points.cells[lane];

  auto store = [](double* array, std::size_t index, Pack value) {
    for (int lane = 0; lane < pack_width; ++lane) array[index * pack_width + lane] = value[lane];
  };
  for (int i = 0; i < freedoms; ++i) store(b.force, static_cast<std::size_t>(pack) * freedoms + i, force[i]);
  if (!b.stiffness) return -1;
  const std::size_t base = static_cast<std::size_t>(pack) * freedoms * freedoms;
  for (int i = 0; i < freedoms; ++i)
    for (int j = 0; j < freedoms; ++j) {
      Pack k = b.symmetric ? Pack(0.5) * (K[i * freedoms + j] + K[j * freedoms + i]) : K[i * freedoms + j];
      store(b.stiffness, base + i * freedoms + j, k);
    }
  return -1;
}

}  // namespace presswork
