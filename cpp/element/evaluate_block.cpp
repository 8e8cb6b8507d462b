// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_block.hpp"

#include <algorithm>
#include <climits>
#include <vector>

namespace presswork {

namespace {

template <int dim, class Cell, int n_points, Treatment treatment = Treatment::standard>
constexpr ElementType element(std::string_view name, std::string_view description, bool in_explicit = false) {
  const Family family = dim == 2 ? Family::plane : Family::space;
  const ElementRow row{
      name, Cell::name, Cell::nodes, n_points, family, description, true, in_explicit, treatment == Treatment::mixed};
  ElementType type{row, &evaluate_pack<dim, Cell, n_points, treatment, VonMises>};
  type.differentiate = &differentiate_cell<dim, Cell, n_points, treatment>;
  if constexpr (dim == 3)
    type.evaluate_space = &evaluate_pack<dim, Cell, n_points, treatment, SolidLaw>;
  else
    type.evaluate_plane = &evaluate_pack<dim, Cell, n_points, treatment, PlaneLaw>;
  if constexpr (treatment != Treatment::one_point)
    type.evaluate_umat = &evaluate_pack<dim, Cell, n_points, treatment, Umat>;
  return type;
}

constexpr ElementType elements[] = {
    element<2, Tri3, 1>("tri3", "3-node triangles, constant strain", true),
    element<2, Tri6, 6>("tri6_6pt", "6-node triangles, 6-point rule"),
    element<2, Tri6, 7>("tri6_7pt", "6-node triangles, 7-point rule"),
    element<2, Quad4, 4>("quad4", "4-node quadrilaterals, full integration"),
    element<2, Quad4, 4, Treatment::fbar>("quad4_fbar", "4-node quadrilaterals, F-bar"),
    element<2, Quad4, 1, Treatment::one_point>("quad4_1pt", "4-node quadrilaterals, one point with hourglass control",
                                               true),
    element<2, Quad8, 9>("quad8", "8-node quadrilaterals, 3 x 3 points"),
    element<2, Quad8, 4>("quad8_2x2", "8-node quadrilaterals, 2 x 2 points"),
    element<2, Quad9, 9>("quad9", "9-node quadrilaterals, 3 x 3 points"),
    element<2, Quad9, 4>("quad9_2x2", "9-node quadrilaterals, 2 x 2 points"),
    element<3, Hex8, 8>("hex8", "8-node hexahedra, full integration", true),
    element<3, Hex8, 8, Treatment::fbar>("hex8_fbar", "8-node hexahedra, F-bar", true),
    element<3, Tet4, 1, Treatment::mixed>("tet4_mini", "4-node tetrahedra, pressure at the nodes and a bubble"),
    element<3, Tet10, 4, Treatment::fbar>("tet10", "10-node tetrahedra, mean of J over each"),
};

}  // namespace

std::span<const ElementType> solid_elements() { return elements; }

std::optional<ElementType> find_element(std::string_view name) {
  for (const auto& e : elements)
    if (e.name == name) return e;
  return std::nullopt;
}

namespace {

template <class Law>
int evaluate_packs(int (*evaluate)(const BlockView&, const PointSettings&, const Law&, int), const BlockView& block,
                   const PointSettings& settings, const Law& law, int n_packs, bool shared) {
  int failed = INT_MAX;
#pragma omp parallel for schedule(static) reduction(min : failed) if (shared)
  for (int pack = 0; pack < n_packs; ++pack) {
    const int cell = evaluate(block, settings, law, pack);
    if (cell >= 0) failed = std::min(failed, cell);
  }
  return failed == INT_MAX ? -1 : failed;
}

}  // namespace

int evaluate_block(const ElementType& element, BlockView block, const PointSettings& settings, const BulkLaw& law,
                   LawFault& fault) {
  const int n_packs = (block.n_cells + pack_width - 1) / pack_width;
  std::vector<LawFault> faults(n_packs);
  block.fault = faults.data();
  const auto evaluate = [&](auto kernel, const auto& chosen, bool shared) {
    return evaluate_packs(kernel, block, settings, chosen, n_packs, shared);
  };
  int failed;
  if (const auto* mises = std::get_if<const VonMises*>(&law))
    failed = evaluate(element.evaluate_mises, **mises, true);
  else if (const auto* plane = std::get_if<const PlaneLaw*>(&law))
    failed = evaluate(element.evaluate_plane, **plane, true);
  else if (const auto* space = std::get_if<const SolidLaw*>(&law))
    failed = evaluate(element.evaluate_space, **space, true);
  else
    failed = evaluate(element.evaluate_umat, *std::get<const Umat*>(law), std::get<const Umat*>(law)->thread_safe);
  for (const auto& f : faults) fault.note(f.status, f.cell, f.step_factor);
  return failed;
}

}  // namespace presswork
