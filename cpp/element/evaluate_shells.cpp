// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_shells.hpp"

#include <climits>
#include <cstring>

namespace presswork {

namespace {

template <Cell cell, int n_points>
void tabulate(double* N, double* dN, double* weight, double* dN_at_nodes) {
  static const ShapeTable<cell, n_points> table;
  std::memcpy(N, table.N, sizeof table.N);
  std::memcpy(dN, table.dN, sizeof table.dN);
  std::memcpy(weight, table.weight, sizeof table.weight);
  constexpr int nodes = node_count(cell);
  constexpr double square[9][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
  constexpr double corner[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  for (int a = 0; a < nodes; ++a) {
    const double* at = is_triangle(cell) ? corner[a] : square[a];
    double values[nodes];
    shape_functions<cell>(at[0], at[1], values, reinterpret_cast<double (*)[2]>(dN_at_nodes + 2 * nodes * a));
  }
}

template <Cell cell, int n_points, Tying tying = Tying::none>
constexpr ShellType shell(std::string_view name) {
  using Evaluator = ShellPack<cell, n_points, tying, Pack>;
  constexpr Cell mesh_cell = cell == Cell::tri3_bubble ? Cell::tri3 : cell;
  return {name,
          Evaluator::mesh_nodes,
          n_points,
          Evaluator::internal_values,
          &Evaluator::evaluate_pack,
          &tabulate<mesh_cell, n_points>};
}

constexpr ShellType stabilized(std::string_view name) {
  using Evaluator = StabilizedPack<Pack>;
  return {name, 4, 1, Evaluator::internal_values, &Evaluator::evaluate_pack, &tabulate<Cell::quad4, 1>};
}

const ShellType shells[] = {
    shell<Cell::tri3, 1>("shell3"),
    shell<Cell::tri3, 3, Tying::mitc>("shell3_mitc"),
    shell<Cell::tri3_bubble, 3, Tying::mitc>("shell3_mitc_plus"),
    shell<Cell::tri6, 6>("shell6"),

    shell<Cell::tri6, 3, Tying::mitc>("shell6_mitc"),
    shell<Cell::tri6, 6, Tying::selective>("shell6_selective"),
    shell<Cell::tri6, 3>("shell6_reduced"),
    shell<Cell::quad4, 4>("shell4"),
    shell<Cell::quad4, 4, Tying::selective>("shell4_selective"),
    shell<Cell::quad4, 1>("shell4_reduced"),
    shell<Cell::quad4, 4, Tying::mitc>("shell4_mitc"),
    shell<Cell::quad4, 4, Tying::mitc_plus>("shell4_mitc_plus"),
    stabilized("shell4_1pt"),
    shell<Cell::quad8, 9>("shell8"),
    shell<Cell::quad8, 9, Tying::selective>("shell8_selective"),
    shell<Cell::quad8, 4>("shell8_reduced"),
    shell<Cell::quad9, 9>("shell9"),
    shell<Cell::quad9, 9, Tying::selective>("shell9_selective"),
    shell<Cell::quad9, 4>("shell9_reduced"),
    shell<Cell::quad9, 9, Tying::mitc>("shell9_mitc"),
};

}  // namespace

std::optional<ShellType> find_shell(std::string_view name) {
  for (const auto& s : shells)
    if (s.name == name) return s;
  return std::nullopt;
}

ShellFailure evaluate_shells(const ShellType& shell, const ShellView& view, const SheetLaw& law) {
  const int n_packs = (view.n_cells + pack_width - 1) / pack_width;
  int failed = INT_MAX;  // shell_faults cell + fault
#pragma omp parallel for schedule(static) reduction(min : failed)
  for (int pack = 0; pack < n_packs; ++pack) {
    const auto failure = shell.evaluate_pack(view, law, pack);
    if (failure.cell >= 0) failed = std::min(failed, shell_faults * failure.cell + static_cast<int>(failure.fault));
  }
  if (failed == INT_MAX) return {};
  return {failed / shell_faults, static_cast<ShellFault>(failed % shell_faults)};
}

}  // namespace presswork
