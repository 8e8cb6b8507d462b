// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "element/evaluate_block.hpp"
#include "element/point_history.hpp"

namespace presswork::bindings {

namespace {

ElementType element_named(const std::string& name) {
  auto element = find_element(name);
  if (!element) throw std::invalid_argument("unknown element " + name);
  return *element;
}

// Of solids with a pressure at the nodes: bulk and shear modulus [MPa], and the pressure that counts as a length.
using PressureFreedom = std::tuple<double, double, double>;

SolidSection make_section(bool axisymmetric, double depth, double hourglass_fraction,
                          const std::optional<PressureFreedom>& pressure) {
  SolidSection section{axisymmetric, depth, hourglass_fraction};
  if (pressure) std::tie(section.bulk_modulus, section.shear_modulus, section.pressure_scale) = *pressure;
  return section;
}

template <class Law>
History list_parts(const Owned<Law>& law, int) {
  return list_point_history(law.view);
}
History list_parts(const Umat& law, int components) {
  return components == 3   ? list_point_history<3>(law)
         : components == 4 ? list_point_history<4>(law)
                           : list_point_history<6>(law);
}

}  // namespace

void bind_element(nb::module_& m) {
  nb::enum_<TangentKind>(m, "TangentKind", "Which tangent an element builds.")
      .value("none", TangentKind::none)
      .value("consistent", TangentKind::consistent)
      .value("thesis", TangentKind::thesis);
  nb::class_<PointSettings>(m, "PointSettings", "Kinematics and tangent of an integration point.")
      .def(
          "__init__",
          [](PointSettings* self, StrainMeasure measure, TangentKind tangent, bool green_lagrange_matrix, bool k_e,
             bool k_u, bool k_v, bool small_displacements) {
            new (self) PointSettings{measure, tangent, green_lagrange_matrix, k_e, k_u, k_v, small_displacements};
          },
          nb::kw_only(), nb::arg("measure") = StrainMeasure::log, nb::arg("tangent") = TangentKind::consistent,
          nb::arg("green_lagrange_matrix") = false, nb::arg("k_e") = true, nb::arg("k_u") = true,
          nb::arg("k_v") = false, nb::arg("small_displacements") = false);

  nb::enum_<Family>(m, "Family", "Where an element serves.")
      .value("plane", Family::plane, "Solids in plane strain and in axisymmetry.")
      .value("space", Family::space, "Solids in space.")
      .value("shell", Family::shell, "Shells.");
  nb::class_<ElementRow>(m, "Element", "A row of the table of elements.")
      .def_prop_ro("name", [](const ElementRow& e) { return std::string(e.name); })
      .def_prop_ro(
          "cell", [](const ElementRow& e) { return std::string(e.cell); }, "Kind of cell of the mesh.")
      .def_ro("nodes", &ElementRow::nodes)
      .def_ro("points", &ElementRow::points, "Integration points of a cell; of a shell those in its plane.")
      .def_ro("family", &ElementRow::family)
      .def_prop_ro("description", [](const ElementRow& e) { return std::string(e.description); })
      .def_ro("in_implicit", &ElementRow::in_implicit, "Whether the implicit procedure has it.")
      .def_ro("in_explicit", &ElementRow::in_explicit, "Whether the explicit procedure has it.")
      .def_prop_ro("freedoms", &ElementRow::freedoms, "Of a node: displacements, then a pressure or rotations.");
  m.def(
      "element_sizes",
      [](const std::string& name) {
        const auto e = element_named(name);
        return std::make_tuple(e.nodes, e.points);
      },
      nb::arg("element"), "Number of nodes and of integration points of a solid.");
  m.def("elements", &list_elements, "The table of elements, a row each.");

  using AnyLaw = std::variant<const Owned<VonMises>*, const Owned<AdiabaticMises>*, const Owned<SheetLaw>*,
                              const Owned<PlaneLaw>*, const Owned<SolidLaw>*, const Umat*>;
  m.def(
      "list_history",
      [](AnyLaw law, int components) {
        require(components == 3 || components == 4 || components == 6, "a stress has 3, 4 or 6 components");
        std::vector<std::tuple<std::string, int, bool>> parts;
        for (const HistoryPart& part :
             std::visit([=](const auto* chosen) { return list_parts(*chosen, components); }, law))
          parts.emplace_back(part.name, part.size, part.is_axes);
        return parts;
      },
      nb::arg("law"), nb::arg("components"),
      "What a point keeps for a law behind its stress of so many components: name, number of values, and whether these "
      "are the directions of its axes (x in the plane, x and y in space), in their order.");
  m.def(
      "evaluate_block",
      [](const std::string& name, Ints connectivity, Doubles points, Doubles increment,
         std::variant<const Owned<VonMises>*, const Owned<PlaneLaw>*, const Owned<SolidLaw>*, const Umat*> law,
         const PointSettings& settings, bool axisymmetric, double depth, double hourglass_fraction,
         const std::optional<PressureFreedom>& pressure, Doubles stress_n, Doubles eqps_n, Doubles hourglass_n,
         MutableDoubles stress, MutableDoubles eqps, MutableDoubles hourglass, MutableDoubles volume,
         MutableDoubles force, std::optional<MutableDoubles> stiffness, bool symmetric,
         std::optional<Doubles> history_n, std::optional<MutableDoubles> history, double dt, int first_cell,
         std::optional<Doubles> temperature, std::optional<Doubles> temperature_n, std::optional<UmatPlace> when,
         LawFault* fault, std::optional<Doubles> mixture) {
        const auto element = element_named(name);
        const std::size_t n = connectivity.shape(0), packs = (n + pack_width - 1) / pack_width;
        const std::size_t freedoms = element.freedoms() * element.nodes, q = n * element.points;
        const std::size_t components = element.components();
        require(connectivity.ndim() == 2 && connectivity.shape(1) == std::size_t(element.nodes),
                "connectivity must have shape (n_cells, nodes)");
        require(points.size() == increment.size() && points.shape(1) == std::size_t(element.freedoms()),
                "points and increment must have shape (n, freedoms)");
        require(stress_n.size() == components * q && stress.size() == components * q,
                "stress must have shape (n_cells, points, 4), of a solid in space 6");
        require(eqps_n.size() == q && eqps.size() == q && volume.size() == q, "eqps, volume: shape (n_cells, points)");
        require(hourglass_n.size() == 2 * n && hourglass.size() == 2 * n, "hourglass must have shape (n_cells, 2)");
        require(force.size() == packs * freedoms * pack_width, "force must have shape (n_packs, freedoms, pack_width)");
        require(!stiffness || stiffness->size() == packs * freedoms * freedoms * pack_width,
                "stiffness must have shape (n_packs, freedoms, freedoms, pack_width)");
        require(!temperature || temperature->size() == q, "temperature must have shape (n_cells, points)");
        require(!temperature_n || temperature_n->size() == q, "temperature_n must have shape (n_cells, points)");
        require(!mixture || mixture->size() == q * mixture_size, "mixture must have shape (n_cells, points, 3)");
        BlockView block{static_cast<int>(n),
                        connectivity.data(),
                        points.data(),
                        increment.data(),
                        make_section(axisymmetric, depth, hourglass_fraction, pressure),
                        stress_n.data(),
                        eqps_n.data(),
                        hourglass_n.data(),
                        stress.data(),
                        eqps.data(),
                        hourglass.data(),
                        volume.data(),
                        force.data(),
                        nullptr,
                        symmetric};
        BulkLaw used_law;
        if (const auto* mises = std::get_if<const Owned<VonMises>*>(&law)) {
          used_law = &(*mises)->view;
        } else if (const auto* plane = std::get_if<const Owned<PlaneLaw>*>(&law)) {
          require(element.evaluate_plane, "this element takes a law of another dimension");
          used_law = &(*plane)->view, block.n_history = kept_values((*plane)->view);
        } else if (const auto* space = std::get_if<const Owned<SolidLaw>*>(&law)) {
          require(element.evaluate_space, "this element takes a law of another dimension");
          used_law = &(*space)->view, block.n_history = kept_values((*space)->view);
        } else {
          const Umat* umat = std::get<const Umat*>(law);
          require(element.evaluate_umat, "this element does not take a law from a shared library");
          used_law = umat,
          block.n_history = umat->n_state + (element.dim() == 3 ? UmatHistory<6>::size : UmatHistory<4>::size);
        }
        if (block.n_history > 0) {
          const std::size_t rows = q * block.n_history;
          require(history_n && history && history_n->size() == rows && history->size() == rows && when && fault,
                  "this law needs history_n, history (n_cells, points, n_history), when and fault");
          block.history_n = history_n->data(), block.history = history->data();
        }
        if (when) block.when = *when;
        if (temperature) block.temperature = temperature->data();
        if (temperature_n) block.temperature_n = temperature_n->data();
        if (mixture) block.mixture = mixture->data();
        block.first_cell = first_cell, block.dt = dt;
        LawFault unheard;
        LawFault& told = fault ? *fault : unheard;
        told = {};
        PointSettings used = settings;
        if (stiffness)
          block.stiffness = stiffness->data();
        else
          used.tangent = TangentKind::none;
        nb::gil_scoped_release release;
        if (n == 0) return -1;
        return evaluate_block(element, block, used, used_law, told);
      },
      nb::arg("element"), nb::arg("connectivity"), nb::arg("points"), nb::arg("increment"), nb::arg("law"),
      nb::arg("settings"), nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth"), nb::arg("hourglass_fraction"),
      nb::arg("pressure") = nb::none(), nb::arg("stress_n"), nb::arg("eqps_n"), nb::arg("hourglass_n"),
      nb::arg("stress"), nb::arg("eqps"), nb::arg("hourglass"), nb::arg("volume"), nb::arg("force"),
      nb::arg("stiffness").none(), nb::arg("symmetric") = false, nb::arg("history_n") = nb::none(),
      nb::arg("history") = nb::none(), nb::arg("dt") = 0.0, nb::arg("first_cell") = 0,
      nb::arg("temperature") = nb::none(), nb::arg("temperature_n") = nb::none(), nb::arg("when") = nb::none(),
      nb::arg("fault") = nb::none(), nb::arg("mixture") = nb::none(),
      "Evaluate a block of cells over one increment; fills stress, eqps, hourglass, volume, force and stiffness. "
      "history (n_cells, points, n_history) is what the law keeps besides stress and eqps; temperature (n_cells, "
      "points) [degrees C] is given at the end of the increment, without it that of the law's start; mixture (n_cells, "
      "points, 3) what phases make of a point: strain, K phi [1/MPa], factor on the flow stress. Returns the index "
      "of a cell "
      "turned inside out, or -1; what the law told is in fault.");

  m.def(
      "differentiate_cell",
      [](const std::string& name, Doubles points, Doubles increment, Doubles along, const Owned<VonMises>& law,
         const PointSettings& settings, bool axisymmetric, double depth, double hourglass_fraction,
         const std::optional<PressureFreedom>& pressure, Doubles stress_n, Doubles eqps_n, Doubles hourglass_n) {
        const auto element = element_named(name);
        const std::size_t nodes = element.nodes, d = element.freedoms(), q = element.points;
        require(points.size() == nodes * d && increment.size() == nodes * d && along.size() == nodes * d,
                "points, increment and along must have shape (nodes, d)");
        require(stress_n.size() == q * element.components() && eqps_n.size() == q && hourglass_n.size() == 2,
                "stress_n, eqps_n and hourglass_n must have shapes (points, c), (points) and (2)");
        double *force, *derivative;
        auto forces = new_array({nodes, d}, &force);
        auto derivatives = new_array({nodes, d}, &derivative);
        const CellState state{stress_n.data(), eqps_n.data(), hourglass_n.data()};
        require(
            element.differentiate(make_section(axisymmetric, depth, hourglass_fraction, pressure), settings, law.view,
                                  state, points.data(), increment.data(), along.data(), force, derivative),
            "the cell is turned inside out");
        return std::make_tuple(forces, derivatives);
      },
      nb::arg("element"), nb::arg("points"), nb::arg("increment"), nb::arg("along"), nb::arg("law"),
      nb::arg("settings"), nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth"), nb::arg("hourglass_fraction"),
      nb::arg("pressure") = nb::none(), nb::arg("stress_n"), nb::arg("eqps_n"), nb::arg("hourglass_n"),
      "Forces (nodes, d) of one solid cell and their exact derivative along a move of its nodes, by dual numbers.");
}

}  // namespace presswork::bindings
