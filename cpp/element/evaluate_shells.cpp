// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_shells.hpp"

#include <climits>
#include <cstring>
#include <vector>

#include "element/evaluate_block.hpp"

namespace presswork {

namespace {

template <class Cell, int n_points>
void tabulate(double* N, double* dN, double* weight, double* dN_at_nodes) {
  static const ShapeTable<Cell, n_points> table;
  std::memcpy(N, table.N, sizeof table.N);
  std::memcpy(dN, table.dN, sizeof table.dN);
  std::memcpy(weight, table.weight, sizeof table.weight);
  constexpr int nodes = Cell::nodes;
  for (int a = 0; a < nodes; ++a) {
    double values[nodes];
    Cell::shape(Cell::places[a], values, reinterpret_cast<double (*)[2]>(dN_at_nodes + 2 * nodes * a));
  }
}

template <class Cell, int n_points, Tying tying = Tying::none>
constexpr ShellType shell(std::string_view name, std::string_view description, bool in_explicit = false) {
  using Evaluator = ShellPack<Cell, n_points, tying, Pack>;
  using MeshCell = std::conditional_t<std::is_same_v<Cell, Tri3Bubble>, Tri3, Cell>;
  const ElementRow row{name, Cell::name, Evaluator::mesh_nodes, n_points, Family::shell, description,
                       true, in_explicit};
  return {row, Evaluator::internal_values, &Evaluator::evaluate_pack, &tabulate<MeshCell, n_points>};
}

constexpr ShellType stabilized(std::string_view name, std::string_view description) {
  using Evaluator = StabilizedPack<Pack>;
  const ElementRow row{name, Quad4::name, 4, 1, Family::shell, description, true, true};
  return {row, Evaluator::internal_values, &Evaluator::evaluate_pack, &tabulate<Quad4, 1>};
}

// Of the explicit loop alone (explicit/space/one_point_shells.cpp).
constexpr ShellType explicit_shell(std::string_view name, std::string_view description) {
  return {{name, Tri3::name, 3, 1, Family::shell, description, false, true}, 0, nullptr, nullptr};
}

// The recommended ones of each cell first.
constexpr ShellType shells[] = {
    shell<Tri3Bubble, 3, Tying::mitc>("shell3_mitc_plus",
                                      "3-node shells, tied transverse shear and a bubble of the directors (MITC3+)"),
    shell<Tri3, 3, Tying::mitc>("shell3_mitc", "3-node shells, tied transverse shear (MITC3)"),
    shell<Tri3, 1>("shell3", "3-node degenerated shells, one point; they lock"),
    explicit_shell("shell3_1pt", "3-node shells, one point, shear tied at the sides' middles"),
    shell<Tri6, 3, Tying::mitc>("shell6_mitc", "6-node shells, all strains tied (MITC6)"),
    shell<Tri6, 6>("shell6", "6-node degenerated shells, 6 points"),
    shell<Tri6, 6, Tying::selective>("shell6_selective", "6-node degenerated shells, transverse shear from 3 points"),
    shell<Tri6, 3>("shell6_reduced", "6-node degenerated shells, 3 points"),
    shell<Quad4, 4, Tying::mitc_plus>("shell4_mitc_plus",
                                      "4-node shells, tied transverse shear and in-plane strains (MITC4+)", true),
    shell<Quad4, 4, Tying::mitc>("shell4_mitc", "4-node shells, tied transverse shear (MITC4)"),
    stabilized("shell4_1pt", "4-node shells, one point, physical stabilisation"),
    shell<Quad4, 4>("shell4", "4-node degenerated shells, 2 x 2 points; they lock"),
    shell<Quad4, 4, Tying::selective>("shell4_selective",
                                      "4-node degenerated shells, transverse shear from the centre"),
    shell<Quad4, 1>("shell4_reduced", "4-node degenerated shells, one point, no hourglass control"),
    shell<Quad8, 4>("shell8_reduced", "8-node degenerated shells, 2 x 2 points"),
    shell<Quad8, 9>("shell8", "8-node degenerated shells, 3 x 3 points"),
    shell<Quad8, 9, Tying::selective>("shell8_selective",
                                      "8-node degenerated shells, transverse shear from 2 x 2 points"),
    shell<Quad9, 9, Tying::mitc>("shell9_mitc", "9-node shells, all strains tied (MITC9, on the sides)"),
    shell<Quad9, 9>("shell9", "9-node degenerated shells, 3 x 3 points"),
    shell<Quad9, 9, Tying::selective>("shell9_selective",
                                      "9-node degenerated shells, transverse shear from 2 x 2 points"),
    shell<Quad9, 4>("shell9_reduced", "9-node degenerated shells, 2 x 2 points"),
};

}  // namespace

std::span<const ShellType> shell_elements() { return shells; }

std::vector<ElementRow> list_elements() {
  std::vector<ElementRow> rows;
  for (const auto& element : solid_elements()) rows.push_back(element);
  rows.push_back(ElementRow{"hex8_1pt", "hex8", 8, 1, Family::space,
                            "8-node hexahedra, one point with hourglass control", false, true});
  rows.push_back(
      ElementRow{"tet4_nodal", "tet4", 4, 1, Family::space, "4-node tetrahedra, nodal mean of J", false, true});
  for (const auto& element : shells) rows.push_back(element);
  return rows;
}

std::optional<ShellType> find_shell(std::string_view name) {
  for (const auto& s : shells)
    if (s.name == name && s.in_implicit) return s;
  return std::nullopt;
}

ShellFailure evaluate_shells(const ShellType& shell, ShellView view, const ShellLaw& law, LawFault& fault) {
  const int n_packs = (view.n_cells + pack_width - 1) / pack_width;
  int failed = INT_MAX;  // shell_faults cell + fault
  std::vector<LawFault> faults(law.user ? n_packs : 0);
  view.fault = faults.data();
  const bool shared = law.own || law.user->umat->thread_safe;
#pragma omp parallel for schedule(static) reduction(min : failed) if (shared)
  for (int pack = 0; pack < n_packs; ++pack) {
    const auto failure = shell.evaluate_pack(view, law, pack);
    if (failure.cell >= 0) failed = std::min(failed, shell_faults * failure.cell + static_cast<int>(failure.fault));
  }
  for (const auto& f : faults) fault.note(f.status, f.cell, f.step_factor);
  if (failed == INT_MAX) return {};
  return {failed / shell_faults, static_cast<ShellFault>(failed % shell_faults)};
}

}  // namespace presswork
