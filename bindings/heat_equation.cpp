// SPDX-License-Identifier: Apache-2.0
#include "assembly/heat_equation.hpp"

#include <nanobind/stl/function.h>

#include "arrays.hpp"
#include "heat_tables.hpp"

namespace presswork::bindings {

namespace {

using Values = std::vector<double>;

Values copy(const Doubles& a) { return Values(a.data(), a.data() + a.size()); }

std::vector<int> copy_nodes(const Ints& a) {
  std::vector<int> nodes(a.data(), a.data() + a.size());
  for (const int node : nodes) require(node >= 0, "nodes must be indices");
  return nodes;
}

int count_nodes(const HeatFilm& film) {
  return std::visit([](const auto& f) { return f.n_nodes(); }, film);
}

NewDoubles give(const Values& values) {
  double* data;
  auto result = new_array({values.size()}, &data);
  std::copy(values.begin(), values.end(), data);
  return result;
}

std::tuple<NewDoubles, NewDoubles> evaluate(const HeatFilm& film, Doubles temperature) {
  require(count_nodes(film) <= static_cast<int>(temperature.size()), "the film has more nodes than temperatures");
  double *power, *slope;
  auto powers = new_array({temperature.size()}, &power);
  auto slopes = new_array({temperature.size()}, &slope);
  std::visit([&](const auto& f) { f.add(temperature.data(), power, slope); }, film);
  return {powers, slopes};
}

void bind_films(nb::module_& m) {
  nb::class_<HeatFilm>(m, "HeatFilm", "What heats and cools the surface of bodies, lumped at its nodes.")
      .def_static(
          "at_nodes",
          [](Ints nodes, Doubles factor, Doubles other) {
            require(factor.size() == nodes.size() && other.size() == nodes.size(), "one factor and other a node");
            return HeatFilm{NodeFilm{copy_nodes(nodes), copy(factor), copy(other)}};
          },
          nb::arg("nodes"), nb::arg("factor"), nb::arg("other"),
          "Nodes (n,) that exchange heat with temperatures (n,) [degrees C] by factors (n,) [N mm/(s K)].")
      .def_static(
          "convection",
          [](Doubles area, Doubles coefficient, double ambient) {
            return HeatFilm{ConvectionFilm{copy(area), add_slopes(coefficient), ambient}};
          },
          nb::arg("area"), nb::arg("coefficient"), nb::arg("ambient"),
          "Newton's law of cooling: areas of the nodes (n_points,) [mm2], rows of temperature and coefficient (n, 2).")
      .def_static(
          "radiation", [](Doubles factor, double ambient) { return HeatFilm{RadiationFilm{copy(factor), ambient}}; },
          nb::arg("factor"), nb::arg("ambient"),
          "To large surroundings: area, emissivity and Stefan and Boltzmann's constant (n_points,) [N mm/(s K4)].")
      .def_static(
          "flux", [](Doubles power) { return HeatFilm{FluxFilm{copy(power)}}; }, nb::arg("power"),
          "Heat that does not depend on temperature (n_points,) [N mm/s].")
      .def_static(
          "between",
          [](Ints pairs, Doubles factor) {
            require(pairs.size() == 2 * factor.size(), "pairs (n, 2) and a factor for each");
            return HeatFilm{PairFilm{copy_nodes(pairs), copy(factor)}};
          },
          nb::arg("pairs"), nb::arg("factor"), "Pairs of nodes (n, 2) and their conductances (n,) [N mm/(s K)].")
      .def_static(
          "martensite",
          [](Ints nodes, Doubles heat, Doubles free, Doubles before, double start, double rate) {
            require(heat.size() == nodes.size() && free.size() == nodes.size() && before.size() == nodes.size(),
                    "one value a node");
            return HeatFilm{MartensiteFilm{copy_nodes(nodes), copy(heat), copy(free), copy(before), start, rate}};
          },
          nb::arg("nodes"), nb::arg("heat"), nb::arg("free"), nb::arg("before"), nb::kw_only(), nb::arg("start"),
          nb::arg("rate"),
          "Heat of the martensite that forms at nodes (n,) in a step: heat [N mm/s] of all of each, fractions of what "
          "may "
          "form and has formed (n,), start [degrees C], rate [1/K].")
      .def("evaluate", &evaluate, nb::arg("temperature"),
           "Heat given to the nodes [N mm/s] and minus its derivative by their own temperatures [N mm/(s K)].");
}

HeatBody make_body(const std::string& cell, Ints connectivity, Doubles conductivity, Doubles pieces,
                   std::tuple<double, double, double> latent, Doubles mass) {
  const auto& type = heat_cell_named(cell);
  require(connectivity.ndim() == 2 && connectivity.shape(1) == std::size_t(type.nodes),
          "connectivity must have shape (n_cells, nodes)");
  require(pieces.ndim() == 2 && pieces.shape(0) > 0 && pieces.shape(1) == HeatContent::columns,
          "pieces must have shape (n, 4)");
  auto nodes = copy_nodes(connectivity);
  for (const int node : nodes) require(node < static_cast<int>(mass.size()), "connectivity must be node indices");
  const auto [heat, start, end] = latent;
  return {&type, std::move(nodes), add_slopes(conductivity), copy(pieces), heat, start, end, copy(mass)};
}

using PythonSolver = std::function<std::optional<Doubles>(bool, nb::ndarray<nb::numpy, const double>,
                                                          nb::ndarray<nb::numpy, const double>)>;

DirectSolver call(const PythonSolver& solver) {
  const auto view = [](const Values& v) { return nb::ndarray<nb::numpy, const double>(v.data(), {v.size()}); };
  return [solver, view](bool fresh, const Values& data, const Values& rhs, Values& change) {
    const nb::gil_scoped_acquire acquire;
    const auto found = solver(fresh, view(data), view(rhs));
    if (!found) return false;
    require(found->size() == change.size(), "the solution must have the length of rhs");
    std::copy_n(found->data(), change.size(), change.begin());
    return true;
  };
}

HeatStepResult solve(HeatEquation& equation, const Assembler<1>& assembler, Doubles points, Doubles temperature_n,
                     double dt, const std::vector<const HeatFilm*>& films, Bytes mask, Doubles prescribed,
                     std::optional<Doubles> source, int counted, Doubles guess, bool iterative,
                     const PythonSolver& direct) {
  const std::size_t n = equation.n_points();
  require(assembler.n_nodes() == equation.n_points(), "the assembler has other nodes");
  require(points.size() == n * equation.dimension(), "points must have shape (n_points, d)");
  require(temperature_n.size() == n && mask.size() == n && prescribed.size() == n && guess.size() == n &&
              (!source || source->size() == n),
          "one value a node");
  for (const auto* film : films) require(film && count_nodes(*film) <= static_cast<int>(n), "nodes of a film");
  const HeatStepInput input{points.data(),
                            temperature_n.data(),
                            dt,
                            films,
                            mask.data(),
                            prescribed.data(),
                            source ? source->data() : nullptr,
                            counted,
                            iterative};
  const auto solver = call(direct);
  const nb::gil_scoped_release release;
  return equation.solve(assembler, input, guess.data(), solver);
}

void bind_result(nb::module_& m) {
  nb::class_<HeatStepResult>(m, "HeatStepResult", "A time step of the heat equation.")
      .def_prop_ro(
          "outcome",
          [](const HeatStepResult& r) {
            constexpr const char* names[] = {"converged", "unbounded", "singular", "no balance", "turned cell"};
            return names[static_cast<int>(r.outcome)];
          },
          "converged, unbounded, singular, no balance, or turned cell.")
      .def_prop_ro(
          "temperature", [](const HeatStepResult& r) { return give(r.temperature); }, nb::rv_policy::move,
          "(n_points,) [degrees C].")
      .def_prop_ro(
          "power",
          [](const HeatStepResult& r) {
            double* data;
            auto result = new_array({r.power.size(), 2}, &data);
            for (const auto& each : r.power) data = std::copy(each.begin(), each.end(), data);
            return result;
          },
          nb::rv_policy::move,
          "Heat that flowed in by each film and, last, by prescribed temperatures, into the nodes counted first and "
          "into the others (n_films + 1, 2) [N mm/s].")
      .def_ro("residual", &HeatStepResult::residual, "Of every iteration, over the sum of all flows.")
      .def_ro("correction", &HeatStepResult::correction, "Largest of every iteration [K].")
      .def_ro("assembly_seconds", &HeatStepResult::assembly_seconds)
      .def_ro("solve_seconds", &HeatStepResult::solve_seconds)
      .def_ro("block", &HeatStepResult::block, "Of the cell that is turned inside out.")
      .def_ro("cell", &HeatStepResult::cell, "That is turned inside out.");
}

}  // namespace

void bind_heat_equation(nb::module_& m) {
  bind_films(m);
  bind_result(m);
  nb::class_<HeatBody>(m, "HeatBody", "Cells of one kind and material that conduct and store heat.")
      .def(
          "__init__",
          [](HeatBody* self, const std::string& cell, Ints connectivity, Doubles conductivity, Doubles pieces,
             std::tuple<double, double, double> latent,
             Doubles mass) { new (self) HeatBody(make_body(cell, connectivity, conductivity, pieces, latent, mass)); },
          nb::arg("cell"), nb::arg("connectivity"), nb::arg("conductivity"), nb::arg("pieces"), nb::arg("latent"),
          nb::arg("mass"),
          "conductivity (n, 2); pieces and latent as in find_heat_content; mass at the nodes (n_points,) [t].");
  nb::class_<HeatEquation>(m, "HeatEquation", "Time steps of the heat equation by backward Euler.")
      .def(
          "__init__",
          [](HeatEquation* self, const std::vector<HeatBody>& bodies, bool axisymmetric, double depth) {
            require(!bodies.empty(), "no bodies");
            for (const auto& body : bodies)
              require(body.mass.size() == bodies.front().mass.size() && body.type->dim == bodies.front().type->dim,
                      "bodies share their nodes");
            new (self) HeatEquation(static_cast<int>(bodies.front().mass.size()), bodies, {axisymmetric, depth, 0.0});
          },
          nb::arg("bodies"), nb::kw_only(), nb::arg("axisymmetric"), nb::arg("depth"))
      .def(
          "find_content",
          [](const HeatEquation& equation, Doubles temperature) {
            require(temperature.size() == std::size_t(equation.n_points()), "one value a node");
            double *content, *slope;
            auto contents = new_array({temperature.size()}, &content);
            auto slopes = new_array({temperature.size()}, &slope);
            equation.find_content(temperature.data(), content, slope);
            return std::make_tuple(contents, slopes);
          },
          nb::arg("temperature"), "Heat stored at the nodes (n_points,) [N mm] and its derivative [N mm/K].")
      .def("solve", &solve, nb::arg("assembler"), nb::kw_only(), nb::arg("points"), nb::arg("temperature_n"),
           nb::arg("dt"), nb::arg("films"), nb::arg("mask"), nb::arg("prescribed"), nb::arg("source").none(),
           nb::arg("counted"), nb::arg("guess"), nb::arg("iterative"), nb::arg("direct"),
           "Temperatures at the end of a step from a guess at them.\n\ndirect: called with whether the matrix is new, "
           "its values and the right-hand side where iterations do not find a correction; None for a singular matrix.");
}

}  // namespace presswork::bindings
