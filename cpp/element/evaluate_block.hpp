// SPDX-License-Identifier: Apache-2.0
// The list of elements, and the threaded loop over a block of cells.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "element/element_table.hpp"
#include "element/solid_block.hpp"
#include "element/solid_derivative.hpp"

namespace presswork {

struct ElementType : ElementRow {
  // null where the element does not take the law
  template <class Law>
  using Kernel = int (*)(const BlockView&, const PointSettings&, const Law&, int pack);
  Kernel<VonMises> evaluate_mises = nullptr;
  Kernel<PlaneLaw> evaluate_plane = nullptr;
  Kernel<SolidLaw> evaluate_space = nullptr;
  Kernel<Umat> evaluate_umat = nullptr;
  bool (*differentiate)(const SolidSection&, PointSettings, const VonMises&, const CellState&, const double* x,
                        const double* du, const double* along, double* force, double* derivative) = nullptr;

  int components() const { return dim() == 3 ? 6 : 4; }  // of a stress
};

// The laws that a solid's points can have.
using BulkLaw = std::variant<const VonMises*, const PlaneLaw*, const SolidLaw*, const Umat*>;

// Solids in the plane and in space.
std::span<const ElementType> solid_elements();

// The element of that name, or nothing.
std::optional<ElementType> find_element(std::string_view name);

// Evaluate every pack of a block. Returns the lowest index of a cell turned inside out, or -1; what the law's calls
// told goes to `fault`, block.fault need not be set. The result does not depend on the number of threads: each pack
// writes its own slots. A law from a shared library is called by one thread unless it says that several may; the
// element's evaluate_umat must then not be null.
int evaluate_block(const ElementType& element, BlockView block, const PointSettings& settings, const BulkLaw& law,
                   LawFault& fault);

}  // namespace presswork
