// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "arrays.hpp"
#include "contact/facing.hpp"
#include "contact/interface.hpp"
#include "contact/profile.hpp"
#include "member_arrays.hpp"

namespace presswork::bindings {

namespace {

EdgeList edge_list(const Ints& edges) {
  require(edges.ndim() == 2 && (edges.shape(1) == 2 || edges.shape(1) == 3), "edges must have shape (n, 2 | 3)");
  return {static_cast<int>(edges.shape(0)), static_cast<int>(edges.shape(1)), edges.data()};
}

InterfaceOutput evaluate(Ints slave, Ints master, Ints slots, Ints pairs, Doubles x, Doubles x_n, Doubles slave_depth,
                         Doubles master_depth, Bytes held, Doubles pressure, Doubles shear, Doubles slip,
                         Doubles believed, Doubles least_weight, Doubles stiffness, Doubles shear_limit, double mu,
                         double tangential_part, double reach, double touching, double thickness, bool with_tangent) {
  const std::size_t n_slots = pressure.size();
  require(slave.shape(1) == master.shape(1), "slave and master edges must have as many nodes");
  require(slots.size() == 2 * slave.shape(0), "slots must have shape (n_slave, 2)");
  require(x.size() == x_n.size() && x.ndim() == 2, "x and x_n must have shape (n_points, 2)");
  require(slave_depth.size() == slave.shape(0) && master_depth.size() == master.shape(0), "one depth an edge");
  require(held.size() == n_slots && shear.size() == n_slots && slip.size() == n_slots && stiffness.size() == n_slots &&
              shear_limit.size() == n_slots && believed.size() == n_slots && least_weight.size() == n_slots,
          "one value a slot");
  InterfaceInput in{edge_list(slave),
                    edge_list(master),
                    slots.data(),
                    static_cast<int>(n_slots),
                    static_cast<int>(x.shape(0)),
                    {},
                    x.data(),
                    x_n.data(),
                    slave_depth.data(),
                    master_depth.data(),
                    reach,
                    thickness,
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
  return evaluate_interface(in);
}

void bind_interface(nb::module_& m) {
  nb::class_<InterfaceOutput>(m, "InterfaceResult", "Forces, tangent and slots of an interface between bodies.")
      .def_ro("too_deep", &InterfaceOutput::too_deep, "Pairs that have gone through each other in this increment.")
      .def_prop_ro("force", &field<&InterfaceOutput::force, 2>, "On the nodes (n_points, 2) [N].")
      .def_prop_ro("pairs", &field<&InterfaceOutput::block_pairs, 2>, "Nodes of the blocks (n_blocks, 2).")
      .def_prop_ro("blocks", &field<&InterfaceOutput::blocks, 2, 2>, "d(-force) / d(position) (n_blocks, 2, 2) [N/mm].")
      .def_prop_ro("pressure", &field<&InterfaceOutput::pressure>, "(n_slots,) [MPa].")
      .def_prop_ro("shear", &field<&InterfaceOutput::shear>, "Along the slave edge (n_slots,) [MPa].")
      .def_prop_ro("gap", &field<&InterfaceOutput::gap>, "Weighted mean (n_slots,) [mm]; infinite where none faces.")
      .def_prop_ro("slip", &field<&InterfaceOutput::slip>, "Weighted mean (n_slots,) [mm].")
      .def_prop_ro("slope_places", &field<&InterfaceOutput::slope_places, 2>, "Slots and nodes of the slopes (n, 2).")
      .def_prop_ro("pressure_slopes", &field<&InterfaceOutput::pressure_slopes, 2>,
                   "d pressure / d position of active slots (n, 2) [MPa/mm].")
      .def_prop_ro("status", &field<&InterfaceOutput::status>, "0 apart, 1 sticks, 2 slides (n_slots,).")
      .def_prop_ro("weight", &field<&InterfaceOutput::weight>, "Surface in contact (n_slots,) [mm2].")
      .def_prop_ro("push", &field<&InterfaceOutput::push>, "On the master's nodes (n_points,) [N].")
      .def_prop_ro("drag", &field<&InterfaceOutput::drag>, "On the master's nodes (n_points,) [N].")
      .def_prop_ro("area", &field<&InterfaceOutput::area>, "Share of the master's nodes in the contact [mm2].")
      .def_prop_ro(
          "master_force",
          [](const InterfaceOutput& o) { return std::make_tuple(o.master_force[0], o.master_force[1]); },
          "Of the slave on the master [N].");
  m.def("evaluate_interface", &evaluate, nb::arg("slave"), nb::arg("master"), nb::arg("slots"), nb::arg("pairs"),
        nb::arg("x"), nb::arg("x_n"), nb::kw_only(), nb::arg("slave_depth"), nb::arg("master_depth"), nb::arg("held"),
        nb::arg("pressure"), nb::arg("shear"), nb::arg("slip"), nb::arg("believed"), nb::arg("least_weight"),
        nb::arg("stiffness"), nb::arg("shear_limit"), nb::arg("mu"), nb::arg("tangential_part"), nb::arg("reach"),
        nb::arg("touching"), nb::arg("thickness"), nb::arg("with_tangent"),
        "Mortar contact of slave and master edges at positions x; see interface.hpp.");
  m.def(
      "find_edge_pairs",
      [](Ints slave, Ints master, Doubles x, double margin, bool self) {
        const auto pairs = find_edge_pairs(edge_list(slave), edge_list(master), x.data(), margin, self);
        int* data = new int[2 * pairs.size() + 1];
        nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<int*>(p); });
        for (std::size_t i = 0; i < pairs.size(); ++i) data[2 * i] = pairs[i].slave, data[2 * i + 1] = pairs[i].master;
        return nb::ndarray<nb::numpy, int>(data, {pairs.size(), 2}, owner);
      },
      nb::arg("slave"), nb::arg("master"), nb::arg("x"), nb::arg("margin"), nb::arg("self"),
      "Pairs of half-edges (n, 2) that may touch within the margin [mm], slave and master.");
}

}  // namespace

void bind_contact(nb::module_& m) {
  m.def(
      "find_facing",
      [](Doubles points, Ints own, Ints other, Doubles reach, double thickness) {
        require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n_points, 2)");
        require(own.ndim() == 2 && own.shape(1) == 2 && other.ndim() == 2 && other.shape(1) == 2,
                "edges must have shape (n, 2)");
        require(reach.size() == own.shape(0), "reach must have shape (n_own,)");
        for (const Ints& edges : {own, other})
          for (std::size_t i = 0; i < edges.size(); ++i)
            require(edges.data()[i] >= 0 && std::size_t(edges.data()[i]) < points.shape(0),
                    "edges must be node indices");
        const auto found = find_facing(points.data(), {static_cast<int>(own.shape(0)), own.data()},
                                       {static_cast<int>(other.shape(0)), other.data()}, reach.data(), thickness);
        const std::size_t n = found.size();
        int *own_edge, *other_edge;
        double *own_shape, *other_shape, *gap, *area;
        auto result =
            std::make_tuple(new_array({n}, &own_edge), new_array({n}, &other_edge), new_array({n, 2}, &own_shape),
                            new_array({n, 2}, &other_shape), new_array({n}, &gap), new_array({n}, &area));
        for (std::size_t i = 0; i < n; ++i) {
          own_edge[i] = found[i].own, other_edge[i] = found[i].other;
          for (int k = 0; k < 2; ++k)
            own_shape[2 * i + k] = found[i].own_shape[k], other_shape[2 * i + k] = found[i].other_shape[k];
          gap[i] = found[i].gap, area[i] = found[i].area;
        }
        return result;
      },
      nb::arg("points"), nb::arg("own"), nb::arg("other"), nb::arg("reach"), nb::arg("thickness"),
      "Points of a rule on edges own (n, 2) that edges other (m, 2) face within reach (n,): the two edges of each, the "
      "shape functions there, gap [mm] and area [mm2]; thickness 0: rings.");
  m.def(
      "touch_profile",
      [](Doubles segments, Doubles points) {
        require(segments.ndim() == 2 && segments.shape(1) == 7, "segments must have shape (n_segments, 7)");
        require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n, 2)");
        const std::size_t n = points.shape(0);
        require(segments.shape(0) > 0, "a profile needs a segment");
        double *gap, *normal, *second_gap, *second_normal;
        int *segment, *second_segment;
        auto gaps = new_array({n}, &gap);
        auto normals = new_array({n, 2}, &normal);
        auto second_gaps = new_array({n}, &second_gap);
        auto second_normals = new_array({n, 2}, &second_normal);
        auto of_gap = new_array({n}, &segment);
        auto of_second_gap = new_array({n}, &second_segment);
        const int n_segments = static_cast<int>(segments.shape(0));
        std::vector<profile::Prepared> prepared(n_segments);
        std::vector<profile::Box> boxes(2 * ProfileSearch::count_leaves(n_segments));
        const ProfileSearch search(n_segments, segments.data(), prepared.data(), boxes.data());
#pragma omp parallel for schedule(static) if (n > 2000)  // waking a thread takes longer than a short loop
        for (std::size_t i = 0; i < n; ++i) {
          const Touch t = search.touch(points.data()[2 * i], points.data()[2 * i + 1]);
          gap[i] = t.gap, second_gap[i] = t.second_gap;
          segment[i] = t.segment, second_segment[i] = t.second_segment;
          for (int k = 0; k < 2; ++k) normal[2 * i + k] = t.normal[k], second_normal[2 * i + k] = t.second_normal[k];
        }
        return std::make_tuple(gaps, normals, second_gaps, second_normals, of_gap, of_second_gap);
      },
      nb::arg("segments"), nb::arg("points"),
      "Gap (n) and normal (n, 2) of points to a tool profile, those of the second face where a point lies in an inner "
      "corner (infinite elsewhere), and the indices of the segments touched by the first and the second (-1: none).");
  bind_interface(m);
}

}  // namespace presswork::bindings
