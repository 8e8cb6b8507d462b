// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_block.hpp"

#include <algorithm>
#include <climits>
#include <vector>

namespace presswork {

namespace {

template <class Cell, int n_points, Treatment treatment = Treatment::standard>
constexpr ElementType element(std::string_view name) {
  using Kernel = Solid2d<Cell, n_points, treatment>;
  ElementType type{name, 2, Kernel::nodes, n_points, &Kernel::template evaluate<VonMises>, nullptr};
  if constexpr (treatment != Treatment::one_point) type.evaluate_umat = &Kernel::template evaluate<Umat>;
  return type;
}

template <class Cell, int n_points, Treatment treatment = Treatment::standard>
constexpr ElementType space_element(std::string_view name) {
  return {name, 3, Cell::nodes, n_points, &SpaceSolid<Cell, n_points, treatment>::evaluate, nullptr};
}

const ElementType elements[] = {
    element<Tri3, 1>("tri3"),
    element<Tri6, 6>("tri6_6pt"),
    element<Tri6, 7>("tri6_7pt"),
    element<Quad4, 4>("quad4"),
    element<Quad4, 4, Treatment::fbar>("quad4_fbar"),
    element<Quad4, 1, Treatment::one_point>("quad4_1pt"),
    element<Quad8, 9>("quad8"),
    element<Quad8, 4>("quad8_2x2"),
    element<Quad9, 9>("quad9"),
    element<Quad9, 4>("quad9_2x2"),
    space_element<Hex8, 8>("hex8"),
    space_element<Hex8, 8, Treatment::fbar>("hex8_fbar"),
};

}  // namespace

std::optional<ElementType> find_element(std::string_view name) {
  for (const auto& e : elements)
    if (e.name == name) return e;
  return std::nullopt;
}

int evaluate_block(const ElementType& element, const BlockView& block, const PointSettings& settings,
                   const VonMises& law) {
  const int n_packs = (block.n_cells + pack_width - 1) / pack_width;
  int failed = INT_MAX;
#pragma omp parallel for schedule(static) reduction(min : failed)
  for (int pack = 0; pack < n_packs; ++pack) {
    const int cell = element.evaluate_pack(block, settings, law, pack);
    if (cell >= 0) failed = std::min(failed, cell);
  }
  return failed == INT_MAX ? -1 : failed;
}

int evaluate_block(const ElementType& element, BlockView block, const PointSettings& settings, const Umat& law,
                   UmatFault& fault) {
  const int n_packs = (block.n_cells + pack_width - 1) / pack_width;
  std::vector<UmatFault> faults(n_packs);
  block.fault = faults.data();
  int failed = INT_MAX;
#pragma omp parallel for schedule(static) reduction(min : failed) if (law.thread_safe)
  for (int pack = 0; pack < n_packs; ++pack) {
    const int cell = element.evaluate_umat(block, settings, law, pack);
    if (cell >= 0) failed = std::min(failed, cell);
  }
  for (const auto& f : faults) fault.note(f.status, f.cell, f.step_factor);
  return failed == INT_MAX ? -1 : failed;
}

}  // namespace presswork
