// SPDX-License-Identifier: Apache-2.0
// The list of shells, and the threaded loop over a block of them.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "element/element_table.hpp"
#include "element/shell4_stabilized_pack.hpp"

namespace presswork {

struct ShellType : ElementRow {
  int internal;  // values that a cell keeps besides its points
  ShellFailure (*evaluate_pack)(const ShellView&, const ShellLaw&, int pack);
  // N (points, nodes), dN (points, nodes, 2), weights (points) of the rule, and dN at the nodes (nodes, nodes, 2)
  void (*tabulate)(double* N, double* dN, double* weight, double* dN_at_nodes);
};

// Shells of the implicit and of the explicit procedure.
std::span<const ShellType> shell_elements();

// The shell of the implicit procedure of that name, or nothing.
std::optional<ShellType> find_shell(std::string_view name);

// Evaluate every pack of a block. Returns the failure of the lowest cell, if any; what the calls of a law from a shared
// library told goes to `fault`, view.fault need not be set. The result does not depend on the number of threads: each
// pack writes its own slots. Such a law is called by one thread unless it says that several may.
ShellFailure evaluate_shells(const ShellType& shell, ShellView view, const ShellLaw& law, LawFault& fault);

}  // namespace presswork
