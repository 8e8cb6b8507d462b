// SPDX-License-Identifier: Apache-2.0
// The list of elements, and the threaded loop over a block of cells.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "element/element_table.hpp"
#include "element/solid.hpp"

namespace presswork {

struct ElementType : ElementRow {
  int components() const { return dim() == 3 ? 6 : 4; }  // of a stress

  int (*evaluate_pack)(const BlockView&, const PointSettings&, const VonMises&, int pack);
  int (*evaluate_umat)(const BlockView&, const PointSettings&, const Umat&, int pack);  // null if it cannot
};

// Solids in the plane and in space.
std::span<const ElementType> solid_elements();

// The element of that name, or nothing.
std::optional<ElementType> find_element(std::string_view name);

// Evaluate every pack of a block. Returns the lowest index of a cell turned inside out, or -1. The result does not
// depend on the number of threads: each pack writes its own slots.
int evaluate_block(const ElementType& element, const BlockView& block, const PointSettings& settings,
                   const VonMises& law);

// The same with a law from a shared library, by one thread unless it says that several may call it. What its calls told
// goes to `fault`: block.fault need not be set. element.evaluate_umat must not be null.
int evaluate_block(const ElementType& element, BlockView block, const PointSettings& settings, const Umat& law,
                   UmatFault& fault);

}  // namespace presswork
