// SPDX-License-Identifier: Apache-2.0
// What the bindings of heat share.
#pragma once

#include "arrays.hpp"
#include "element/heat_block.hpp"

namespace presswork::bindings {

inline const HeatCellType& heat_cell_named(const std::string& name) {
  const auto* type = find_heat_cell(name);
  if (!type) throw std::invalid_argument("no heat conduction in cells of kind " + name);
  return *type;
}

// Rows of a TemperatureTable from temperatures and values (n, 2).
inline std::vector<double> add_slopes(const Doubles& table) {
  require(table.ndim() == 2 && table.shape(0) > 0 && table.shape(1) == 2, "a table must have shape (n, 2)");
  std::vector<double> rows;
  const double* row = table.data();
  for (std::size_t i = 0; i < table.shape(0); ++i, row += 2) {
    const bool last = i + 1 == table.shape(0);
    rows.insert(rows.end(), {row[0], row[1], last ? 0.0 : (row[3] - row[1]) / (row[2] - row[0])});
  }
  return rows;
}

}  // namespace presswork::bindings
