// SPDX-License-Identifier: Apache-2.0
#include "element/heat_block.hpp"

#include <climits>
#include <cstddef>

namespace presswork {

namespace {

template <int dim, int nodes>
void gather(const HeatBlock& b, int pack, int cells[], Pack x[][dim]) {
  for (int lane = 0; lane < pack_width; ++lane) {
    cells[lane] = std::min(pack * pack_width + lane, b.n_cells - 1);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < dim; ++i)
        x[a][i].set(lane, b.points[static_cast<std::size_t>(dim) * b.connectivity[cells[lane] * nodes + a] + i]);
  }
}

void store(double* array, std::size_t index, Pack value) {
  for (int lane = 0; lane < pack_width; ++lane) array[index * pack_width + lane] = value[lane];
}

template <int dim, class Cell, int n_points>
int conduct_pack(const HeatBlock& b, const TemperatureTable& conductivity, const double* temperature, double* flow,
                 double* conduction, int pack) {
  using Kernel = HeatCell<dim, Cell, n_points, Pack>;
  constexpr int nodes = Cell::nodes;
  int cells[pack_width];
  Pack x[nodes][dim], theta[nodes], out[nodes], K[nodes * nodes];
  gather<dim, nodes>(b, pack, cells, x);
  for (int lane = 0; lane < pack_width; ++lane)
    for (int a = 0; a < nodes; ++a) theta[a].set(lane, temperature[b.connectivity[cells[lane] * nodes + a]]);
  const Pack::Mask bad = Kernel::conduct(b.section, conductivity, x, theta, out, conduction ? K : nullptr);
  for (int lane = 0; lane < pack_width; ++lane)
    if (bad[lane]) return cells[lane];
  const std::size_t first = static_cast<std::size_t>(pack) * nodes;
  for (int a = 0; a < nodes; ++a) store(flow, first + a, out[a]);
  if (conduction)
    for (int i = 0; i < nodes * nodes; ++i) store(conduction, first * nodes + i, K[i]);
  return -1;
}

template <int dim, class Cell, int n_points>
int conduct(const HeatBlock& b, const TemperatureTable& conductivity, const double* temperature, double* flow,
            double* conduction) {
  const int n_packs = (b.n_cells + pack_width - 1) / pack_width;
  int failed = INT_MAX;
#pragma omp parallel for schedule(static) reduction(min : failed)
  for (int pack = 0; pack < n_packs; ++pack) {
    const int cell = conduct_pack<dim, Cell, n_points>(b, conductivity, temperature, flow, conduction, pack);
    if (cell >= 0) failed = std::min(failed, cell);
  }
  return failed == INT_MAX ? -1 : failed;
}

template <int dim, class Cell, int n_points>
void lump(const HeatBlock& b, double* volume) {
  constexpr int nodes = Cell::nodes;
  const int n_packs = (b.n_cells + pack_width - 1) / pack_width;
  for (int pack = 0; pack < n_packs; ++pack) {
    int cells[pack_width];
    Pack x[nodes][dim], part[nodes];
    gather<dim, nodes>(b, pack, cells, x);
    HeatCell<dim, Cell, n_points, Pack>::lump(b.section, x, part);
    for (int lane = 0; lane < pack_width; ++lane)
      for (int a = 0; a < nodes; ++a) volume[static_cast<std::size_t>(cells[lane]) * nodes + a] = part[a][lane];
  }
}

template <int dim, class Cell, int n_points>
constexpr HeatCellType heat_cell() {
  return {Cell::name, dim, Cell::nodes, &conduct<dim, Cell, n_points>, &lump<dim, Cell, n_points>};
}

constexpr HeatCellType heat_cells[] = {
    heat_cell<2, Tri3, 3>(),  heat_cell<2, Tri6, 6>(), heat_cell<2, Quad4, 4>(), heat_cell<2, Quad8, 9>(),
    heat_cell<2, Quad9, 9>(), heat_cell<3, Hex8, 8>(), heat_cell<3, Tet4, 4>(),
};

}  // namespace

const HeatCellType* find_heat_cell(std::string_view name) {
  for (const auto& type : heat_cells)
    if (type.cell == name) return &type;
  return nullptr;
}

}  // namespace presswork
