// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "contact/node_on_tool.hpp"

namespace presswork::bindings {

namespace {

using contact::NodeOnTool;

NodeOnTool take_node(std::size_t i, const Doubles& push, const Doubles& slope, const Doubles& normal,
                     const Doubles& rise, const Doubles& bend) {
  return {push.data()[i], slope.data()[i], normal.data() + 3 * i, rise.data() + 3 * i, bend.data() + 9 * i};
}

auto push_nodes(Doubles push, Doubles slope, Doubles normal, Doubles rise, Doubles bend) {
  const std::size_t n = push.size();
  require(slope.size() == n && normal.size() == 3 * n && rise.size() == 3 * n && bend.size() == 9 * n,
          "of each node one push and slope, three of normal and rise, nine of bend");
  double *force, *tangent;
  auto forces = new_array({n, 3}, &force);
  auto tangents = new_array({n, 3, 3}, &tangent);
  for (std::size_t i = 0; i < n; ++i)
    contact::push_node(take_node(i, push, slope, normal, rise, bend), force + 3 * i, tangent + 9 * i);
  return std::make_tuple(forces, tangents);
}

NewDoubles rub_nodes(Doubles push, Doubles slope, Doubles normal, Doubles rise, Doubles bend, Doubles hanging,
                     Doubles pulled, Doubles limit, Doubles by_push, MutableDoubles tangent) {
  const std::size_t n = push.size();
  require(slope.size() == n && normal.size() == 3 * n && rise.size() == 3 * n && bend.size() == 9 * n,
          "of each node one push and slope, three of normal and rise, nine of bend");
  require(hanging.size() == n && pulled.size() == 3 * n && limit.size() == n && by_push.size() == n &&
              tangent.size() == 9 * n,
          "of each node one hanging, limit and by_push, three of pulled, nine of tangent");
  double* friction;
  auto frictions = new_array({n, 3}, &friction);
  for (std::size_t i = 0; i < n; ++i)
    contact::rub_node(take_node(i, push, slope, normal, rise, bend), hanging.data()[i], pulled.data() + 3 * i,
                      limit.data()[i], by_push.data()[i], friction + 3 * i, tangent.data() + 9 * i);
  return frictions;
}

}  // namespace

void bind_node_contact(nb::module_& m) {
  m.def("push_nodes", &push_nodes, nb::arg("push"), nb::arg("slope"), nb::arg("normal"), nb::arg("rise"),
        nb::arg("bend"),
        "Normal forces of a tool on nodes (n, 3) [N] and their tangent (n, 3, 3) [N/mm], as node_on_tool.hpp says. "
        "push (n,) and slope (n,) by the gap; derivatives of gap (n, 3) and normal (n, 3, 3) by the place.");
  m.def("rub_nodes", &rub_nodes, nb::arg("push"), nb::arg("slope"), nb::arg("normal"), nb::arg("rise"), nb::arg("bend"),
        nb::kw_only(), nb::arg("hanging"), nb::arg("pulled"), nb::arg("limit"), nb::arg("by_push"), nb::arg("tangent"),
        "Friction on nodes that a tool pushes (n, 3) [N], as node_on_tool.hpp says; its part is added to the tangent.");
}

}  // namespace presswork::bindings
