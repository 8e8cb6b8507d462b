// SPDX-License-Identifier: Apache-2.0
#include "assembly/heat_surface.hpp"

#include "arrays.hpp"
#include "element/heat_column.hpp"
#include "heat_tables.hpp"

namespace presswork::bindings {

namespace {

using Flags = nb::ndarray<const bool, nb::numpy, nb::c_contig, nb::device::cpu>;

template <class T>
auto give(const std::vector<T>& values, std::vector<std::size_t> shape) {
  T* data;
  auto result = new_array(shape, &data);
  std::copy(values.begin(), values.end(), data);
  return result;
}

auto touch(Ints edges, Doubles areas, Flags holds, Doubles push, Doubles gap, Doubles conductance, double width,
           MutableDoubles seen, int corners) {
  const std::size_t n_points = push.size();
  require(edges.ndim() == 2 && edges.shape(1) >= 2, "edges must have shape (n, 2 | 3 | 4)");
  require(corners >= 2 && corners <= 4 && std::size_t(corners) <= edges.shape(1),
          "an edge has 2 corners, a face 3 or 4");
  require(areas.size() == edges.size() && seen.size() == edges.size(), "areas and seen must have the shape of edges");
  require(holds.size() == n_points && gap.size() == n_points, "one value a node");
  for (std::size_t i = 0; i < edges.size(); ++i)
    require(edges.data()[i] >= 0 && std::size_t(edges.data()[i]) < n_points, "edges must be node indices");
  const auto rows = add_slopes(conductance);
  const SurfaceEdges surface{static_cast<int>(edges.shape(0)),
                             static_cast<int>(edges.shape(1)),
                             static_cast<int>(n_points),
                             corners,
                             edges.data(),
                             areas.data()};
  const HeatingTool tool{reinterpret_cast<const std::uint8_t*>(holds.data()),
                         push.data(),
                         gap.data(),
                         {rows.data(), static_cast<int>(conductance.shape(0))},
                         width};
  const auto found = find_touch(surface, tool, seen.data());
  bool* touching;
  auto marks = new_array({found.touching.size()}, &touching);
  std::copy(found.touching.begin(), found.touching.end(), touching);
  const std::size_t n = found.nodes.size();
  return std::make_tuple(marks, give(found.pressure, {n_points}), give(found.nodes, {n}), give(found.area, {n}),
                         give(found.conductance, {n}));
}

auto pairs(Ints own_side, Ints other_side, Doubles own_shape, Doubles other_shape, Ints own, Ints other,
           const std::vector<Doubles>& amounts) {
  const std::size_t n = own_side.size();
  require(
      own.ndim() == 2 && own.shape(1) >= 2 && own.shape(1) <= 4 && other.ndim() == 2 && other.shape(1) == own.shape(1),
      "sides must have shape (n, 2 | 3 | 4)");
  const std::size_t nodes = own.shape(1);
  require(other_side.size() == n && own_shape.size() == nodes * n && other_shape.size() == nodes * n,
          "one value a point");
  for (std::size_t i = 0; i < n; ++i)
    require(own_side.data()[i] >= 0 && std::size_t(own_side.data()[i]) < own.shape(0) && other_side.data()[i] >= 0 &&
                std::size_t(other_side.data()[i]) < other.shape(0),
            "points lie on sides");
  std::vector<const double*> at;
  for (const auto& amount : amounts) {
    require(amount.size() == n, "one amount a point");
    at.push_back(amount.data());
  }
  const auto found = sum_pairs({static_cast<int>(n), static_cast<int>(nodes), own_side.data(), other_side.data(),
                                own_shape.data(), other_shape.data()},
                               own.data(), other.data(), at);
  const std::size_t n_pairs = found.pairs.size() / 2;
  std::vector<NewDoubles> sums;
  for (const auto& each : found.sums) sums.push_back(give(each, {n_pairs}));
  return std::make_tuple(give(found.pairs, {n_pairs, 2}), sums);
}

auto link(Doubles points, Ints pieces, Flags touching, Doubles pressure, Ints profile, Doubles gap, Doubles conductance,
          double width, double chords, double thickness) {
  require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n_points, 2)");
  require(pieces.ndim() == 2 && pieces.shape(1) == 2 && profile.ndim() == 2 && profile.shape(1) == 2,
          "edges must have shape (n, 2)");
  require(touching.size() > 0 && pieces.shape(0) % touching.size() == 0, "touching must have one value an edge");
  for (std::size_t i = 0; i < pieces.size(); ++i)
    require(pieces.data()[i] >= 0 && std::size_t(pieces.data()[i]) < std::min(pressure.size(), gap.size()),
            "edges must be node indices");
  for (std::size_t i = 0; i < profile.size(); ++i)
    require(profile.data()[i] >= 0 && std::size_t(profile.data()[i]) < points.shape(0), "edges must be node indices");
  const auto rows = add_slopes(conductance);
  const MeshedTool tool{{static_cast<int>(profile.shape(0)), profile.data()},
                        gap.data(),
                        {rows.data(), static_cast<int>(conductance.shape(0))},
                        width};
  const auto found = link_tool(points.data(), {static_cast<int>(pieces.shape(0)), pieces.data()}, touching.data(),
                               static_cast<int>(touching.size()), pressure.data(), tool, chords, thickness);
  const std::size_t n = found.pairs.size() / 2;
  return std::make_tuple(give(found.pairs, {n, 2}), give(found.sums[0], {n}), give(found.sums[1], {n}));
}

auto step_column(HeatColumn& column, Doubles temperature, double dt) {
  require(temperature.ndim() == 2 && temperature.shape(1) == column.size(), "temperature must have shape (n, cells)");
  double *still, *answer;
  auto stills = new_array({temperature.shape(0), column.size()}, &still);
  auto answers = new_array({column.size()}, &answer);
  column.set_step(dt);
  for (std::size_t i = 0; i < temperature.shape(0); ++i)
    column.rest(temperature.data() + i * column.size(), still + i * column.size());
  column.answer(answer);
  return std::make_tuple(stills, answers);
}

}  // namespace

void bind_heat_surface(nb::module_& m) {
  m.def("find_touch", &touch, nb::arg("edges"), nb::arg("areas"), nb::kw_only(), nb::arg("holds"), nb::arg("push"),
        nb::arg("gap"), nb::arg("conductance"), nb::arg("width"), nb::arg("seen"), nb::arg("corners") = 2,
        "Where a tool touches edges (n, nodes), in space faces, or is near them; corners: of each, its first "
        "nodes.\n\nholds, push [N], gap [mm]: at nodes (n_points,); "
        "conductance: rows of pressure [MPa] and value (n, 2); width [mm]: across which heat passes; seen (n, nodes) "
        "loses what touches and what passes. Returns edges that touch (n,), the pressure at their nodes (n_points,), "
        "and the nodes that touch or are near with their areas and conductances.");
  m.def("sum_pairs", &pairs, nb::arg("own_side"), nb::arg("other_side"), nb::arg("own_shape"), nb::arg("other_shape"),
        nb::arg("own"), nb::arg("other"), nb::arg("amounts"),
        "Pairs of nodes (n, 2), each once, and sums over them of amounts at points of sides own that face sides other, "
        "as find_facing returns them.");
  m.def("link_tool", &link, nb::arg("points"), nb::arg("pieces"), nb::kw_only(), nb::arg("touching"),
        nb::arg("pressure"), nb::arg("profile"), nb::arg("gap"), nb::arg("conductance"), nb::arg("width"),
        nb::arg("chords"), nb::arg("thickness"),
        "What passes between pieces (m, 2) of a surface and the profile (k, 2) of a tool with a mesh: pairs of nodes "
        "(n, 2), conductance times shared area [N mm/(s K)] and shared area [mm2].\n\ntouching: of the edges "
        "(n_edges,), whose pieces follow each other edge by edge, once or twice; pressure [MPa], gap [mm]: at nodes; "
        "conductance, width as find_touch has them; chords: of a piece, how far the mesh of the tool may lie off; "
        "thickness as find_facing has it.");
  nb::class_<HeatColumn>(m, "HeatColumn", "A row of finite volumes behind a surface.")
      .def(
          "__init__",
          [](HeatColumn* self, Doubles capacity, Doubles between) {
            require(capacity.size() > 0 && between.size() + 1 == capacity.size(), "one conductance between two");
            new (self) HeatColumn({capacity.data(), capacity.data() + capacity.size()},
                                  {between.data(), between.data() + between.size()});
          },
          nb::arg("capacity"), nb::arg("between"))
      .def("step", &step_column, nb::arg("temperature"), nb::arg("dt"),
           "Temperatures (n, cells) after dt [s] without a flux, and what a flux of 1 adds (cells,).");
}

}  // namespace presswork::bindings
