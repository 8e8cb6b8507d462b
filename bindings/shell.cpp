// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/variant.h>

#include "arrays.hpp"
#include "element/evaluate_shells.hpp"

namespace presswork::bindings {

namespace {

ShellType shell_named(const std::string& name) {
  auto shell = find_shell(name);
  if (!shell) throw std::invalid_argument("unknown shell " + name);
  return *shell;
}

auto tabulate(const std::string& name) {
  const auto shell = shell_named(name);
  const std::size_t q = shell.points, n = shell.nodes;
  double *N, *dN, *weight, *dN_at_nodes;
  auto values = new_array({q, n}, &N);
  auto slopes = new_array({q, n, 2}, &dN);
  auto weights = new_array({q}, &weight);
  auto node_slopes = new_array({n, n, 2}, &dN_at_nodes);
  shell.tabulate(N, dN, weight, dN_at_nodes);
  return std::make_tuple(values, slopes, weights, node_slopes);
}

auto evaluate(const std::string& name, Ints connectivity, Ints director_of, Doubles undeformed, Doubles points,
              Doubles increment, Doubles director, Doubles layer_position, Doubles layer_weight,
              std::variant<const Owned<SheetLaw>*, const Umat*> given, double dt, double penalty,
              const std::vector<Doubles>& state_n, const std::vector<MutableDoubles>& state, MutableDoubles volume,
              MutableDoubles force, std::optional<MutableDoubles> stiffness, bool symmetric, bool small_displacements,
              std::optional<Doubles> temperature, double young, double poisson, int first_cell,
              std::optional<UmatPlace> when, LawFault* fault) {
  const auto shell = shell_named(name);
  const Umat* const* umat = std::get_if<const Umat*>(&given);
  const SheetUmat user{umat ? *umat : nullptr, young, poisson};
  const ShellLaw law = umat ? ShellLaw(user) : ShellLaw(std::get<const Owned<SheetLaw>*>(given)->view);
  require(law.own || (young > 0.0 && when && fault),
          "a law from a shared library needs young, poisson, when and fault");
  const std::size_t n = connectivity.shape(0), packs = (n + pack_width - 1) / pack_width, freedoms = 6 * shell.nodes;
  const std::size_t q = n * shell.points, k = layer_position.size(), h = law.history_size();
  require(connectivity.ndim() == 2 && connectivity.shape(1) == std::size_t(shell.nodes),
          "connectivity must have shape (n_cells, nodes)");
  require(director_of.size() == connectivity.size(), "director_of must have the shape of connectivity");
  require(increment.size() == 2 * points.size() && points.ndim() == 2 && points.shape(1) == 3,
          "points must have shape (n, 3), increment (n, 6)");
  require(undeformed.size() == points.size(), "undeformed must have the shape of points");
  require(layer_weight.size() == k && k > 0, "layer positions and weights must have the same length");
  require(law.user || h <= std::size_t(most_history), "the law keeps more values than a layer has room for");
  const std::size_t sizes[6] = {q, 3 * q * k, h * q * k, 2 * q * k, 2 * q, n * shell.internal};
  require(state_n.size() == 6 && state.size() == 6, "state: thickness, stress, history, direction, shear, internal");
  for (int i = 0; i < 6; ++i)
    require(state_n[i].size() == sizes[i] && state[i].size() == sizes[i],
            "state must have shapes (n_cells, q), (n_cells, q, k, 3), (.., history_size), (.., 2), (n_cells, q, 2), "
            "(n_cells, internal)");
  require(volume.size() == q * k, "volume must have shape (n_cells, q, k)");
  require(!temperature || temperature->size() == q * k, "temperature must have shape (n_cells, q, k)");
  require(force.size() == packs * freedoms * pack_width, "force must have shape (n_packs, freedoms, pack_width)");
  require(!stiffness || stiffness->size() == packs * freedoms * freedoms * pack_width,
          "stiffness must have shape (n_packs, freedoms, freedoms, pack_width)");
  const ShellView view{static_cast<int>(n),
                       static_cast<int>(k),
                       static_cast<int>(h),
                       connectivity.data(),
                       director_of.data(),
                       undeformed.data(),
                       points.data(),
                       increment.data(),
                       director.data(),
                       layer_position.data(),
                       layer_weight.data(),
                       dt,
                       penalty,
                       state_n[0].data(),
                       state_n[1].data(),
                       state_n[2].data(),
                       state_n[3].data(),
                       state_n[4].data(),
                       state_n[5].data(),
                       state[0].data(),
                       state[1].data(),
                       state[2].data(),
                       state[3].data(),
                       state[4].data(),
                       state[5].data(),
                       volume.data(),
                       force.data(),
                       stiffness ? stiffness->data() : nullptr,
                       symmetric,
                       small_displacements,
                       temperature ? temperature->data() : nullptr,
                       when.value_or(UmatPlace{}),
                       first_cell};
  ShellFailure failure;
  LawFault told;
  {
    nb::gil_scoped_release release;
    if (n > 0) failure = evaluate_shells(shell, view, law, told);
  }
  if (fault) *fault = told;
  return std::make_tuple(failure.cell, failure.fault);
}

}  // namespace

void bind_shell(nb::module_& m) {
  nb::enum_<ShellFault>(m, "ShellFault", "Why a shell could not be evaluated.")
      .value("none", ShellFault::none)
      .value("inside_out", ShellFault::inside_out)
      .value("turned_too_far", ShellFault::turned_too_far)
      .value("law", ShellFault::law)
      .value("bubble", ShellFault::bubble);
  m.def(
      "shell_sizes",
      [](const std::string& name) {
        const auto s = shell_named(name);
        return std::make_tuple(s.nodes, s.points, s.internal);
      },
      nb::arg("element"),
      "Number of nodes of a shell, of integration points in its plane, and of values it keeps besides its points.");
  m.def("shell_shape", &tabulate, nb::arg("element"),
        "Shape functions (q, nodes), their slopes (q, nodes, 2) and weights (q) at a shell's points, and the slopes at "
        "its nodes (nodes, nodes, 2).");
  m.def(
      "evaluate_shells", &evaluate, nb::arg("element"), nb::arg("connectivity"), nb::arg("director_of"),
      nb::arg("undeformed"), nb::arg("points"), nb::arg("increment"), nb::arg("director"), nb::arg("layer_position"),
      nb::arg("layer_weight"), nb::arg("law"), nb::kw_only(), nb::arg("dt"), nb::arg("penalty"), nb::arg("state_n"),
      nb::arg("state"), nb::arg("volume"), nb::arg("force"), nb::arg("stiffness").none(), nb::arg("symmetric"),
      nb::arg("small_displacements") = false, nb::arg("temperature") = nb::none(), nb::arg("young") = 0.0,
      nb::arg("poisson") = 0.0, nb::arg("first_cell") = 0, nb::arg("when") = nb::none(), nb::arg("fault") = nb::none(),
      "Evaluate a block of shells over one increment (n, 6): displacement and rotation vector. state: [thickness "
      "(n_cells, q), stress (n_cells, q, k, 3), history (n_cells, q, k, h), direction (n_cells, q, k, 2), shear "
      "(n_cells, q, 2)]. temperature (n_cells, q, k) [degrees C] is given at the end of the increment, without it that "
      "of the law's start. young and poisson are the elastic constants of a law from a shared library; what it told is "
      "in fault. Fills state, volume, force and stiffness; returns the first cell that failed, or -1, and "
      "why.");
}

}  // namespace presswork::bindings
