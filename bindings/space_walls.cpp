// SPDX-License-Identifier: Apache-2.0
#include "space_walls.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>

#include "arrays.hpp"
#include "explicit_walls.hpp"

namespace presswork::bindings {

namespace {

using namespace explicit_dynamics;
using Loop = SpaceLoop<double>;

using Vector3 = std::array<double, 3>;
Vector3 copy_vector(const double v[3]) { return {v[0], v[1], v[2]}; }
void set_vector(const Vector3& from, double to[3]) { std::copy(from.begin(), from.end(), to); }

void add_wall(Loop& self, std::shared_ptr<const contact::ToolSurface> surface, Bytes touching, Vector3 position,
              std::array<Vector3, 3> rotation, Vector3 centre, Vector3 axis, bool turns, double mu, double reach) {
  require(touching.size() == std::size_t(self.nodes.n), "touching must have shape (n_nodes)");
  WallMotion motion;
  set_vector(position, motion.origin), set_vector(centre, motion.centre), set_vector(axis, motion.axis);
  for (int i = 0; i < 3; ++i) set_vector(rotation[i], motion.drawn[i]);
  motion.turns = turns;
  self.add_wall(std::move(surface), touching.data(), mu, reach, motion);
}

void float_wall(Loop& self, int wall, Vector3 direction, double mass, double drag, double stiffness, bool rests) {
  require(mass > 0.0, "a wall that floats needs a mass");
  Floating& of = wall_of(self, wall).motion.floating;
  set_vector(direction, of.direction);
  of.mass = mass, of.drag = drag, of.stiffness = stiffness, of.rests = rests, of.push = 0.0;
}

void hold_along(Loop& self, Ints node, Doubles along, Doubles velocity) {
  const std::size_t k = node.size();
  require(along.size() == 3 * k && velocity.size() == k, "along must have shape (k, 3), velocity (k)");
  std::vector<int> nodes(node.data(), node.data() + k);
  std::vector<HeldAlong> held(k);
  for (std::size_t i = 0; i < k; ++i) {
    require(nodes[i] >= (i > 0 ? nodes[i - 1] : 0) && nodes[i] < self.nodes.n, "node must rise, and name nodes");
    std::copy_n(along.data() + 3 * i, 3, held[i].along);
    held[i].velocity = velocity.data()[i];
  }
  self.nodes.hold_along(nodes, std::move(held));
}

void tie_nodes(Loop& self, Ints pairs, double angle) {
  require(pairs.ndim() == 2 && pairs.shape(1) == 2, "pairs must have shape (n, 2)");
  std::vector<std::pair<int, int>> list;
  for (std::size_t i = 0; i < pairs.size(); i += 2) list.emplace_back(pairs.data()[i], pairs.data()[i + 1]);
  for (const auto& [first, last] : list)
    require(std::min(first, last) >= 0 && std::max(first, last) < self.nodes.n,
            "a pair names a node that is not there");
  self.tie(std::move(list), angle);
}

NewDoubles copy_rows(const std::vector<double>& rows, std::size_t n, std::size_t width) {
  double* to;
  auto array = width > 1 ? new_array({n, width}, &to) : new_array({n}, &to);
  std::copy(rows.begin(), rows.end(), to);
  return array;
}

// What is asked of a wall.
void bind_wall_results(nb::class_<Loop>& loop) {
  bind_wall_sums(loop);
  loop.def(
          "wall_force",
          [](const Loop& self, int wall) { return copy_rows(wall_of(self, wall).force, self.nodes.n, 3); },
          nb::arg("wall"), "Forces of a wall on the nodes (n_nodes, 3) in the last cycle.")
      .def(
          "wall_offset", [](const Loop& self, int wall) { return copy_vector(wall_of(self, wall).motion.offset); },
          nb::arg("wall"), "Displacement of a wall since the start [mm].")
      .def(
          "wall_angle", [](const Loop& self, int wall) { return wall_of(self, wall).motion.angle; }, nb::arg("wall"),
          "By how much a wall has turned since the start [rad].")
      .def(
          "wall_travel", [](const Loop& self, int wall) { return wall_of(self, wall).motion.travel; }, nb::arg("wall"),
          "How far forces and springs have moved a wall since the start [mm].")
      .def(
          "wall_radius", [](const Loop& self, int wall) { return wall_of(self, wall).measure_radius(self.nodes); },
          nb::arg("wall"),
          "How far the farthest node is from the centre of a wall that turns [mm]; negative: it does not turn.")
      .def(
          "set_wall_radius", [](Loop& self, int wall, double radius) { wall_of(self, wall).radius_of_others = radius; },
          nb::arg("wall"), nb::arg("radius"), "Say how far nodes of other parts of the mesh are from that centre.")
      .def(
          "wall_impulse",
          [](const Loop& self, int wall) {
            const double* sum = wall_of(self, wall).impulse;
            return std::array<double, 4>{sum[0], sum[1], sum[2], sum[3]};
          },
          nb::arg("wall"),
          "Impulse that a wall has given to the nodes since the start [N s], and that of its moment about the wall's "
          "axis [N mm s].")
      .def(
          "wall_pressed",
          [](const Loop& self, int wall) { return copy_rows(wall_of(self, wall).pressed, self.nodes.n, 1); },
          nb::arg("wall"), "Impulse of a wall's pressure on the nodes since begin_wall_sums (n_nodes) [N s].")
      .def(
          "wall_rubbed",
          [](const Loop& self, int wall) { return copy_rows(wall_of(self, wall).rubbed, self.nodes.n, 1); },
          nb::arg("wall"), "Work that friction on a wall has taken at the nodes since then (n_nodes) [N mm].");
}

}  // namespace

void bind_space_walls(nb::class_<Loop>& loop) {
  loop.def("add_wall", &add_wall, nb::arg("surface"), nb::arg("touching"), nb::kw_only(), nb::arg("position"),
           nb::arg("rotation"), nb::arg("centre"), nb::arg("axis"), nb::arg("turns"), nb::arg("mu"), nb::arg("reach"),
           "Let a rigid tool hold the nodes marked (n_nodes) off its surface; position: of the tool's frame [mm], "
           "rotation: from it to space (3, 3); centre [mm] and axis, in space: about which it turns; turns: whether it "
           "is turned now or later; reach: how far off it is looked for [mm].")
      .def(
          "limit_wall_friction",
          [](const Loop& self, int wall, Doubles limit) {
            require(limit.size() == std::size_t(self.nodes.n), "limit must have shape (n_nodes)");
            wall_of(self, wall).friction_limit.assign(limit.data(), limit.data() + limit.size());
          },
          nb::arg("wall"), nb::arg("limit"), "Largest friction on each node (n_nodes) [N] from now on.")
      .def(
          "move_wall",
          [](Loop& self, int wall, Vector3 velocity, double spin) {
            WallMotion& of = wall_of(self, wall).motion;
            set_vector(velocity, of.velocity);
            of.spin = spin;
          },
          nb::arg("wall"), nb::arg("velocity"), nb::arg("spin") = 0.0,
          "Let a wall move [mm/s] and turn [1/s] from now on.")
      .def(
          "place_wall", [](Loop& self, int wall, Vector3 offset) { wall_of(self, wall).place(offset.data()); },
          nb::arg("wall"), nb::arg("offset"), "Put a wall elsewhere, by a displacement since the start [mm].")
      .def(
          "float_wall", &float_wall, nb::arg("wall"), nb::arg("direction"), nb::kw_only(), nb::arg("mass"),
          nb::arg("drag"), nb::arg("stiffness"), nb::arg("rests"),
          "Let forces move a wall of a mass [t] along a direction, besides. drag [1/s]; stiffness: of a spring [N/mm]; "
          "rests: whether it goes no further back than to where it starts.")
      .def(
          "push_wall", [](Loop& self, int wall, double force) { wall_of(self, wall).motion.floating.push = force; },
          nb::arg("wall"), nb::arg("force"), "Push a wall that floats along its direction from now on [N].")
      .def(
          "hold_wall",
          [](Loop& self, int wall) {
            WallMotion& of = wall_of(self, wall).motion;
            of.floating = {}, of.rate = 0.0;
          },
          nb::arg("wall"), "Let no force move a wall any more.")
      .def(
          "hold_along", &hold_along, nb::arg("node"), nb::arg("along"), nb::arg("velocity"),
          "Prescribe velocities (k) [mm/s] of nodes (k), rising, along unit vectors (k, 3) besides those of prescribe, "
          "to which they are normal, and to each other.")
      .def("tie", &tie_nodes, nb::arg("pairs"), nb::arg("angle"),
           "Let the second node of each pair (n, 2) follow the first, turned about z by an angle [rad].");
  bind_wall_results(loop);
}

}  // namespace presswork::bindings
