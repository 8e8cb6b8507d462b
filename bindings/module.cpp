// SPDX-License-Identifier: Apache-2.0
// The compiled module presswork._core. It sees arrays, never files or cases.
#include <omp.h>

#include "arrays.hpp"
#include "tensor/pack.hpp"

namespace presswork::bindings {
void bind_kinematics(nb::module_& m);
void bind_material(nb::module_& m);
void bind_elastic_plastic(nb::module_& m);
void bind_umat(nb::module_& m);
void bind_cells(nb::module_& m);
void bind_element(nb::module_& m);
void bind_shell(nb::module_& m);
void bind_contact(nb::module_& m);
void bind_face_contact(nb::module_& m);
void bind_node_contact(nb::module_& m);
void bind_tool_surface(nb::module_& m);
void bind_sheet_under(nb::module_& m);
void bind_sheet_waves(nb::module_& m);
void bind_assembly(nb::module_& m);
void bind_explicit_space(nb::module_& m);
void bind_one_step(nb::module_& m);
void bind_explicit_plane(nb::module_& m);
void bind_heat(nb::module_& m);
void bind_heat_equation(nb::module_& m);
void bind_heat_surface(nb::module_& m);
void bind_damage(nb::module_& m);
void bind_remesh(nb::module_& m);
void bind_device(nb::module_& m);
}  // namespace presswork::bindings

NB_MODULE(_core, m) {
  using namespace presswork::bindings;
  m.doc() = "Compiled kernels: elements, materials, contact and assembly.";
  m.attr("pack_width") = presswork::pack_width;
  m.attr("architecture") = PRESSWORK_ARCHITECTURE;  // it was compiled for
  m.def("set_threads", [](int n) { omp_set_num_threads(n); }, nb::arg("n"), "Set the number of threads of every loop.");
  m.def("max_threads", [] { return omp_get_max_threads(); }, "Number of threads that loops use.");
  bind_kinematics(m);
  bind_material(m);
  bind_elastic_plastic(m);
  bind_umat(m);
  bind_cells(m);
  bind_element(m);
  bind_shell(m);
  bind_contact(m);
  bind_face_contact(m);
  bind_node_contact(m);
  bind_tool_surface(m);
  bind_sheet_under(m);
  bind_sheet_waves(m);
  bind_assembly(m);
  bind_explicit_space(m);
  bind_one_step(m);
  bind_explicit_plane(m);
  bind_heat(m);
  bind_heat_equation(m);
  bind_heat_surface(m);
  bind_damage(m);
  bind_remesh(m);
  bind_device(m);
}
