// SPDX-License-Identifier: Apache-2.0
// The threaded loop of heat conduction over the cells of a block.
#pragma once

#include <string_view>

#include "element/heat_conduction.hpp"

namespace presswork {

// Arrays are C-contiguous; d is the dimension.
struct HeatBlock {
  int n_cells;
  const int* connectivity;  // (n_cells, nodes)
  const double* points;     // (n_points, d) [mm]
  SolidSection section;
};

struct HeatCellType {
  std::string_view cell;
  int dim, nodes;
  int (*conduct)(const HeatBlock&, const TemperatureTable& conductivity, const double* temperature, double* flow,
                 double* conduction);
  void (*lump)(const HeatBlock&, double* volume);
};

// By the cell's name, as ElementRow::cell has it; null if there is none.
const HeatCellType* find_heat_cell(std::string_view cell);

// Fill flow (n_packs, nodes, pack_width) [N mm/s] at nodal temperatures (n_points) and, unless null, conduction
// (n_packs, nodes, nodes, pack_width) [N mm/(s K)]. Returns the lowest number of a cell turned inside out, or -1.
inline int conduct_heat(const HeatCellType& type, const HeatBlock& block, const TemperatureTable& conductivity,
                        const double* temperature, double* flow, double* conduction) {
  return type.conduct(block, conductivity, temperature, flow, conduction);
}

}  // namespace presswork
