// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>

#include "arrays.hpp"
#include "element/evaluate_inverse.hpp"

namespace presswork::bindings {

namespace {

// Hardening and yield function of deformation theory.
using Law = Owned<DeformationLaw>;

Law make_law(double young, const std::array<double, 9>& metric, HardeningLaw law, std::vector<double> parameters) {
  require(young > 0.0, "young must be above zero");
  Law made{{{}, young, {}}};
  require(make_hardening(law, std::move(parameters), made.view.hardening, made.data),
          "the parameters are not those of the hardening law");
  for (int i = 0; i < 9; ++i) made.view.strain_metric[i / 3][i % 3] = metric[i];
  return made;
}

// Stress and its slope at total equivalent strains.
std::tuple<NewDoubles, NewDoubles> flow_curve(const Law& law, Doubles strain) {
  double *stress, *slope;
  auto stresses = new_array({strain.size()}, &stress);
  auto slopes = new_array({strain.size()}, &slope);
  for (std::size_t i = 0; i < strain.size(); ++i) law.view.flow(strain.data()[i], 0.0, stress[i], slope[i]);
  return {stresses, slopes};
}

// What layers of strain (n, 3) have gone through, of what they had before (n, 4).
NewDoubles form(const Law& law, Doubles strain, Doubles formed) {
  const std::size_t n = strain.size() / 3;
  require(strain.size() == 3 * n && formed.size() == 4 * n, "strain (n, 3), formed (n, 4)");
  double* out;
  auto made = new_array({n, 4}, &out);
  for (std::size_t i = 0; i < n; ++i) {
    const double* given = formed.data() + 4 * i;
    const double* s = strain.data() + 3 * i;
    const auto layer = form_layer(law.view, Formed<double>{{given[0], given[1], given[2]}, given[3]}, s);
    for (int k = 0; k < 3; ++k) out[4 * i + k] = layer.strain[k];
    out[4 * i + 3] = layer.hardened;
  }
  return made;
}

}  // namespace

void bind_one_step(nb::module_& m) {
  nb::class_<Law>(m, "DeformationLaw", "Deformation theory of a sheet in plane stress.")
      .def(
          "__init__",
          [](Law* self, double young, const std::array<double, 9>& metric, HardeningLaw law,
             std::vector<double> parameters) { new (self) Law(make_law(young, metric, law, std::move(parameters))); },
          nb::arg("young"), nb::arg("strain_metric"), nb::arg("law"), nb::arg("parameters"),
          "strain_metric: rows of Q, e^2 = E' Q E over E = (xx, yy, 2 xy).")
      .def("flow_curve", &flow_curve, nb::arg("strain"), "Stress [MPa] and its slope at total equivalent strains (n).")
      .def("form", &form, nb::arg("strain"), nb::arg("formed"),
           "What layers with logarithmic strains (n, 3: xx, yy, 2 xy) have gone through, and had before (n, 4): the "
           "strain at which they are free of stress, and equivalent plastic strain.");
  m.def(
      "evaluate_inverse",
      [](Ints triangles, Doubles share, Doubles axes, Doubles edges, Doubles curvature, Doubles bases, Doubles blank,
         Doubles formed, double thickness, const Law& law, std::vector<double> height, std::vector<double> weight,
         bool with_stiffness) {
        require(triangles.ndim() == 2 && triangles.shape(1) == 3, "triangles must have shape (n, 3)");
        require(blank.ndim() == 2, "blank must have shape (n_nodes, 2)");
        const std::size_t n = triangles.shape(0), n_nodes = blank.shape(0);
        require(share.size() == n && axes.size() == 6 * n && edges.size() == 4 * n && curvature.size() == 3 * n,
                "share (n), axes (n, 2, 3), edges (n, 2, 2), curvature (n, 3)");
        require(bases.size() == 6 * n_nodes && blank.size() == 2 * n_nodes,
                "bases (n_nodes, 2, 3), blank (n_nodes, 2)");
        require(height.size() == weight.size() && !height.empty() && height.size() <= most_inverse_layers,
                "height and weight must have the same length, 1 to 16");
        for (std::size_t i = 0; i < triangles.size(); ++i)
          require(triangles.data()[i] >= 0 && std::size_t(triangles.data()[i]) < n_nodes,
                  "triangles names a node that is not there");
        require(formed.size() == 4 * n * height.size(), "formed (n, layers, 4)");
        double *force, *stiffness = nullptr;
        auto forces = new_array({n, 3, 3}, &force);
        const std::size_t packs = with_stiffness ? (n + pack_width - 1) / pack_width : 0;
        auto stiffnesses = new_array({packs, 6, 6, std::size_t(pack_width)}, &stiffness);
        const InverseBlock block{static_cast<int>(n), triangles.data(), share.data(),      axes.data(),
                                 edges.data(),        curvature.data(), bases.data(),      blank.data(),
                                 formed.data(),       thickness,        std::move(height), std::move(weight)};
        int failed = -1;
        {
          nb::gil_scoped_release release;
          if (n > 0) failed = evaluate_inverse(block, law.view, force, with_stiffness ? stiffness : nullptr);
        }
        return std::make_tuple(forces, stiffnesses, failed);
      },
      nb::arg("triangles"), nb::arg("share"), nb::arg("axes"), nb::arg("edges"), nb::arg("curvature"), nb::arg("bases"),
      nb::arg("blank"), nb::arg("formed"), nb::arg("thickness"), nb::arg("law"), nb::arg("height"), nb::arg("weight"),
      nb::kw_only(), nb::arg("with_stiffness"),
      "Forces (n, 3, 3) [N] of the triangles of a part whose nodes come from `blank`, after what their layers have "
      "gone through (`formed`, see DeformationLaw.form), their derivatives (n, 6, 6) "
      "along "
      "the nodes' bases, and the index of a triangle turned over in the blank, or -1.");
}

}  // namespace presswork::bindings
