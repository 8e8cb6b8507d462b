// SPDX-License-Identifier: Apache-2.0
// The explicit loop's fast law of sheets: von Mises in plane stress, hardening from a table.
#pragma once

#include <optional>

#include "arrays.hpp"
#include "element/layered_section.hpp"

namespace presswork::bindings {

// Whether the fast law gives what the general one does: von Mises, isotropic hardening alone.
bool is_fast(const SheetLaw& law);
// The fast law there.
std::optional<Owned<FastMises>> find_fast_law(const Owned<SheetLaw>& law);

void bind_tabulated_mises(nb::module_& m);

}  // namespace presswork::bindings
