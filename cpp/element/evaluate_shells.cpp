// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_shells.hpp"

#include <climits>
#include <cstring>

namespace presswork {

namespace {

template <class Cell, int n_points>
void tabulate(double* N, double* dN, double* weight, double* dN_at_nodes) {
  static const ShapeTable<Cell, n_points> table;
  std::memcpy(N, table.N, sizeof table.N);
  std::memcpy(dN, table.dN, sizeof table.dN);
  std::memcpy(weight, table.weight, sizeof table.weight);
  constexpr int nodes = Cell::nodes;
  constexpr double square[9][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
  constexpr double corner[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  for (int a = 0; a < nodes; ++a) {
    const double* at = Cell::is_triangle ? corner[a] : square[a];
    double values[nodes];
    Cell::shape(at, values, reinterpret_cast<double (*)[2]>(dN_at_nodes + 2 * nodes * a));
  }
}

template <class Cell, int n_points, Tying tying = Tying::none>
constexpr ShellType shell(std::string_view name) {
  using Evaluator = ShellPack<Cell, n_points, tying, Pack>;
  using MeshCell = std::conditional_t<std::is_same_v<Cell, Tri3Bubble>, Tri3, Cell>;
  return {name,
          Evaluator::mesh_nodes,
          n_points,
          Evaluator::internal_values,
          &Evaluator::evaluate_pack,
          &tabulate<MeshCell, n_points>};
}

constexpr ShellType stabilized(std::string_view name) {
  using Evaluator = StabilizedPack<Pack>;
  return {name, 4, 1, Evaluator::internal_values, &Evaluator::evaluate_pack, &tabulate<Quad4, 1>};
}

const ShellType shells[] = {
    shell<Tri3, 1>("shell3"),
    shell<Tri3, 3, Tying::mitc>("shell3_mitc"),
    shell<Tri3Bubble, 3, Tying::mitc>("shell3_mitc_plus"),
    shell<Tri6, 6>("shell6"),

    shell<Tri6, 3, Tying::mitc>("shell6_mitc"),
    shell<Tri6, 6, Tying::selective>("shell6_selective"),
    shell<Tri6, 3>("shell6_reduced"),
    shell<Quad4, 4>("shell4"),
    shell<Quad4, 4, Tying::selective>("shell4_selective"),
    shell<Quad4, 1>("shell4_reduced"),
    shell<Quad4, 4, Tying::mitc>("shell4_mitc"),
    shell<Quad4, 4, Tying::mitc_plus>("shell4_mitc_plus"),
    stabilized("shell4_1pt"),
    shell<Quad8, 9>("shell8"),
    shell<Quad8, 9, Tying::selective>("shell8_selective"),
    shell<Quad8, 4>("shell8_reduced"),
    shell<Quad9, 9>("shell9"),
    shell<Quad9, 9, Tying::selective>("shell9_selective"),
    shell<Quad9, 4>("shell9_reduced"),
    shell<Quad9, 9, Tying::mitc>("shell9_mitc"),
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
