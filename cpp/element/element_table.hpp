// SPDX-License-Identifier: Apache-2.0
// The table of elements: what each is called, what it is made of, and where it serves. The kernels' lists
// (evaluate_block.cpp, evaluate_shells.cpp) hold its rows; Python reads them all, and has no list of its own.
#pragma once

#include <string_view>
#include <vector>

namespace presswork {

enum class Family : int { plane, space, shell };  // solids in the plane and in axisymmetry; solids in space; shells

struct ElementRow {
  std::string_view name;
  std::string_view cell;  // of the mesh: tri3, quad4, hex8 ...
  int nodes;
  int points;  // integration points of a cell; of a shell those in its plane
  Family family;
  std::string_view description;
  bool in_implicit = true, in_explicit = false;
  bool has_pressure = false;  // as a freedom of its nodes

  constexpr int dim() const { return family == Family::plane ? 2 : 3; }
  constexpr int freedoms() const { return family == Family::shell ? 6 : dim() + has_pressure; }  // of a node
};

// Every row, solids first.
std::vector<ElementRow> list_elements();

}  // namespace presswork
