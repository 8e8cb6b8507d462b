// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <type_traits>
#include <vector>

#include "contact/face_interface.hpp"
#include "contact/facing_faces.hpp"
#include "member_arrays.hpp"

namespace presswork::bindings {

namespace {

FaceList face_list(const Ints& faces) {
  require(faces.ndim() == 2 && (faces.shape(1) == 3 || faces.shape(1) == 4), "faces must have shape (n, 3 | 4)");
  return {static_cast<int>(faces.shape(0)), static_cast<int>(faces.shape(1)), faces.data()};
}

FaceInterfaceOutput evaluate(Ints slave, Ints master, Ints slots, Ints pairs, Doubles x, Doubles x_n,
                             Doubles slave_depth, Doubles master_depth, Bytes held, Doubles pressure, Doubles shear,
                             Doubles slip, Doubles believed, Doubles least_weight, Doubles stiffness,
                             Doubles shear_limit, double mu, double tangential_part, double reach, double touching,
                             bool with_tangent) {
  const std::size_t n_slots = pressure.size();
  const FaceList own = face_list(slave), other = face_list(master);
  require(own.nodes == other.nodes, "slave and master faces must have as many nodes");
  require(slots.size() == slave.size(), "slots must have shape (n_slave, 3 | 4)");
  require(x.size() == x_n.size() && x.ndim() == 2 && x.shape(1) == 3, "x and x_n must have shape (n_points, 3)");
  require(slave_depth.size() == slave.shape(0) && master_depth.size() == master.shape(0), "one depth a face");
  require(held.size() == n_slots && stiffness.size() == n_slots && shear_limit.size() == n_slots &&
              believed.size() == n_slots && least_weight.size() == n_slots,
          "one value a slot");
  require(shear.size() == 3 * n_slots && slip.size() == 3 * n_slots, "shear and slip must have shape (n_slots, 3)");
  FaceInterfaceInput in{own,
                        other,
                        slots.data(),
                        static_cast<int>(n_slots),
                        static_cast<int>(x.shape(0)),
                        {},
                        x.data(),
                        x_n.data(),
                        slave_depth.data(),
                        master_depth.data(),
                        reach,
                        held.data(),
                        pressure.data(),
                        shear.data(),
                        slip.data(),
                        believed.data(),
                        least_weight.data(),
                        stiffness.data(),
                        tangential_part,
                        shear_limit.data(),
                        mu,
                        touching,
                        with_tangent};
  for (std::size_t i = 0; i < pairs.shape(0); ++i) in.pairs.push_back({pairs.data()[2 * i], pairs.data()[2 * i + 1]});
  return evaluate_face_interface(in);
}

}  // namespace

void bind_face_contact(nb::module_& m) {
  using Output = FaceInterfaceOutput;
  nb::class_<Output>(m, "FaceInterfaceResult", "Forces, tangent and slots of an interface between bodies in space.")
      .def_ro("too_deep", &Output::too_deep, "Pairs that have gone through each other in this increment.")
      .def_prop_ro("force", &field<&Output::force, 3>, "On the nodes (n_points, 3) [N].")
      .def_prop_ro("pairs", &field<&Output::block_pairs, 2>, "Nodes of the blocks (n_blocks, 2).")
      .def_prop_ro("blocks", &field<&Output::blocks, 3, 3>, "d(-force) / d(position) (n_blocks, 3, 3) [N/mm].")
      .def_prop_ro("pressure", &field<&Output::pressure>, "(n_slots,) [MPa].")
      .def_prop_ro("shear", &field<&Output::shear, 3>, "On the slave (n_slots, 3) [MPa].")
      .def_prop_ro("gap", &field<&Output::gap>, "Weighted mean (n_slots,) [mm]; infinite where none faces.")
      .def_prop_ro("slip", &field<&Output::slip, 3>, "Weighted mean (n_slots, 3) [mm].")
      .def_prop_ro("normal", &field<&Output::normal, 3>, "Out of the slave (n_slots, 3); zero where none faces.")
      .def_prop_ro("slope_places", &field<&Output::slope_places, 2>, "Slots and nodes of the slopes (n, 2).")
      .def_prop_ro("pressure_slopes", &field<&Output::pressure_slopes, 3>,
                   "d pressure / d position of active slots (n, 3) [MPa/mm].")
      .def_prop_ro("status", &field<&Output::status>, "0 apart, 1 sticks, 2 slides (n_slots,).")
      .def_prop_ro("weight", &field<&Output::weight>, "Surface in contact (n_slots,) [mm2].")
      .def_prop_ro("push", &field<&Output::push>, "On the master's nodes (n_points,) [N].")
      .def_prop_ro("drag", &field<&Output::drag, 3>, "On the master's nodes (n_points, 3) [N].")
      .def_prop_ro("area", &field<&Output::area>, "Share of the master's nodes in the contact [mm2].")
      .def_prop_ro(
          "master_force",
          [](const Output& o) { return std::make_tuple(o.master_force[0], o.master_force[1], o.master_force[2]); },
          "Of the slave on the master [N].");
  m.def("evaluate_face_interface", &evaluate, nb::arg("slave"), nb::arg("master"), nb::arg("slots"), nb::arg("pairs"),
        nb::arg("x"), nb::arg("x_n"), nb::kw_only(), nb::arg("slave_depth"), nb::arg("master_depth"), nb::arg("held"),
        nb::arg("pressure"), nb::arg("shear"), nb::arg("slip"), nb::arg("believed"), nb::arg("least_weight"),
        nb::arg("stiffness"), nb::arg("shear_limit"), nb::arg("mu"), nb::arg("tangential_part"), nb::arg("reach"),
        nb::arg("touching"), nb::arg("with_tangent"),
        "Mortar contact of slave and master faces at positions x; see face_interface.hpp.");
  m.def(
      "find_face_pairs",
      [](Ints slave, Ints master, Doubles x, double margin, bool self) {
        const auto pairs = find_face_pairs(face_list(slave), face_list(master), x.data(), margin, self);
        int* data;
        auto result = new_array({pairs.size(), 2}, &data);
        for (std::size_t i = 0; i < pairs.size(); ++i) data[2 * i] = pairs[i].slave, data[2 * i + 1] = pairs[i].master;
        return result;
      },
      nb::arg("slave"), nb::arg("master"), nb::arg("x"), nb::arg("margin"), nb::arg("self"),
      "Pairs of faces (n, 2) that may touch within the margin [mm], slave and master.");
  m.def(
      "find_facing_faces",
      [](Doubles points, Ints own, Ints other, Doubles reach) {
        require(points.ndim() == 2 && points.shape(1) == 3, "points must have shape (n_points, 3)");
        const FaceList faces = face_list(own), others = face_list(other);
        require(faces.nodes == others.nodes, "own and other faces must have as many nodes");
        require(reach.size() == own.shape(0), "reach must have shape (n_own,)");
        for (const Ints& sides : {own, other})
          for (std::size_t i = 0; i < sides.size(); ++i)
            require(sides.data()[i] >= 0 && std::size_t(sides.data()[i]) < points.shape(0),
                    "faces must be node indices");
        const auto found = find_facing_faces(points.data(), faces, others, reach.data());
        const std::size_t n = found.own.size(), nodes = own.shape(1);
        const auto give = [](const auto& values, std::vector<std::size_t> shape) {
          typename std::decay_t<decltype(values)>::value_type* data;
          auto result = new_array(shape, &data);
          std::copy(values.begin(), values.end(), data);
          return result;
        };
        return std::make_tuple(give(found.own, {n}), give(found.other, {n}), give(found.own_shape, {n, nodes}),
                               give(found.other_shape, {n, nodes}), give(found.gap, {n}), give(found.area, {n}));
      },
      nb::arg("points"), nb::arg("own"), nb::arg("other"), nb::arg("reach"),
      "Points of a rule on faces own (n, 3 | 4) that faces other (m, 3 | 4) face within reach (n,): the two faces of "
      "each, the shape functions there, gap [mm] and area [mm2].");
}

}  // namespace presswork::bindings
