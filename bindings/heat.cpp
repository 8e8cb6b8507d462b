// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "element/heat_block.hpp"
#include "element/heat_storage.hpp"
#include "heat_tables.hpp"

namespace presswork::bindings {

namespace {

HeatBlock view_block(const HeatCellType& type, Ints connectivity, Doubles points, bool axisymmetric, double depth) {
  require(connectivity.ndim() == 2 && connectivity.shape(1) == std::size_t(type.nodes),
          "connectivity must have shape (n_cells, nodes)");
  require(points.ndim() == 2 && points.shape(1) == std::size_t(type.dim), "points must have shape (n_points, d)");
  const int n = static_cast<int>(points.shape(0));
  for (std::size_t i = 0; i < connectivity.size(); ++i)
    require(connectivity.data()[i] >= 0 && connectivity.data()[i] < n, "connectivity must be node indices");
  return {static_cast<int>(connectivity.shape(0)), connectivity.data(), points.data(), {axisymmetric, depth, 0.0}};
}

}  // namespace

void bind_heat(nb::module_& m) {
  m.def(
      "conduct_heat",
      [](const std::string& cell, Ints connectivity, Doubles points, Doubles temperature, Doubles conductivity,
         bool axisymmetric, double depth, MutableDoubles flow, std::optional<MutableDoubles> conduction) {
        const auto& type = heat_cell_named(cell);
        const auto block = view_block(type, connectivity, points, axisymmetric, depth);
        const std::size_t packs = (block.n_cells + pack_width - 1) / pack_width, n = type.nodes;
        require(temperature.size() == points.shape(0), "temperature must have shape (n_points,)");
        require(flow.size() == packs * n * pack_width, "flow must have shape (n_packs, nodes, pack_width)");
        require(!conduction || conduction->size() == packs * n * n * pack_width,
                "conduction must have shape (n_packs, nodes, nodes, pack_width)");
        const auto rows = add_slopes(conductivity);
        const TemperatureTable table{rows.data(), static_cast<int>(conductivity.shape(0))};
        nb::gil_scoped_release release;
        return conduct_heat(type, block, table, temperature.data(), flow.data(),
                            conduction ? conduction->data() : nullptr);
      },
      nb::arg("cell"), nb::arg("connectivity"), nb::arg("points"), nb::arg("temperature"), nb::arg("conductivity"),
      nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth"), nb::arg("flow"), nb::arg("conduction").none(),
      "Fill flow, the heat that leaves the nodes of each cell [N mm/s], and its derivative by their temperatures.\n\n"
      "conductivity: rows of temperature and value (n, 2). Returns the number of a cell "
      "turned inside out, or -1.");
  m.def(
      "find_heat_content",
      [](Doubles pieces, double latent, double start, double end, Doubles temperature) {
        require(pieces.ndim() == 2 && pieces.shape(0) > 0 && pieces.shape(1) == HeatContent::columns,
                "pieces must have shape (n, 4)");
        const HeatContent table{pieces.data(), static_cast<int>(pieces.shape(0)), latent, start, end};
        double *content, *specific;
        const std::vector<std::size_t> shape(temperature.shape_ptr(), temperature.shape_ptr() + temperature.ndim());
        auto contents = new_array(shape, &content);
        auto specifics = new_array(shape, &specific);
        for (std::size_t i = 0; i < temperature.size(); ++i) table.find(temperature.data()[i], content[i], specific[i]);
        return std::make_tuple(contents, specifics);
      },
      nb::arg("pieces"), nb::arg("latent"), nb::arg("start"), nb::arg("end"), nb::arg("temperature"),
      "Heat content [mm2/s2] and specific heat [mm2/(s2 K)] at temperatures of any shape [degrees C].\n\n"
      "pieces (n, 4): temperature from where on, specific heat, its slope and heat content there; latent [mm2/s2] from "
      "start to end [degrees C].");
  m.def(
      "lump_volumes",
      [](const std::string& cell, Ints connectivity, Doubles points, bool axisymmetric, double depth) {
        const auto& type = heat_cell_named(cell);
        const auto block = view_block(type, connectivity, points, axisymmetric, depth);
        double* volume;
        auto result = new_array({connectivity.shape(0), connectivity.shape(1)}, &volume);
        type.lump(block, volume);
        return result;
      },
      nb::arg("cell"), nb::arg("connectivity"), nb::arg("points"), nb::kw_only(), nb::arg("axisymmetric"),
      nb::arg("depth"), "Volume that each node of each cell stands for (n_cells, nodes) [mm3].");
}

}  // namespace presswork::bindings
