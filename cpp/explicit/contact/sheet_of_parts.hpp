// SPDX-License-Identifier: Apache-2.0
// A whole sheet as each part of it knows it, for contact of shells with shells: where the nodes are that may touch, how
// they move, and how thick the shells are. The parts tell each other in every cycle (neighbours.hpp), of the pairs of
// node and shell alone that do not sleep (shell_contact.hpp); of the whole sheet where contact looks for pairs anew.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "explicit/contact/tool_contact.hpp"
#include "explicit/neighbours.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class SheetOfParts {
 public:
  // place: of each node of the whole sheet its number in this part, -1: it is not here. cell: the number in the whole
  // sheet, of n_cells, of each element of the part.
  SheetOfParts(std::vector<int> place, const std::vector<int>& cell, int n_cells)
      : place_(std::move(place)),
        element_(n_cells, -1),
        position_(4 * place_.size(), 0.0),
        motion_(8 * place_.size(), Real(0)),
        thickness_(n_cells, 0.0) {
    for (std::size_t e = 0; e < cell.size(); ++e) element_[cell[e]] = static_cast<int>(e);
    for (std::size_t i = 0; i < place_.size(); ++i) all_nodes_.push_back(static_cast<int>(i));
    for (int c = 0; c < n_cells; ++c) all_cells_.push_back(c);
  }

  // Numbers in this part of the nodes of the whole sheet.
  const int* place() const { return place_.data(); }

  // Learn of nodes and cells of the whole sheet, or of all; all parts call this for the same ones. own: this part.
  template <class View>
  void learn(const std::vector<int>& nodes, const std::vector<int>& cells, const View& own, Neighbours& parts) {
    // 1. owners tell of nodes, and all parts that have a shell of its thickness, which has the same bits in each
    told_.assign(of_node * nodes.size() + cells.size(), -std::numeric_limits<double>::infinity());
    double* to = told_.data();
    for (int node : nodes) {
      if (const int here = place_[node]; here >= 0 && !parts.is_ghost[here]) {
        std::copy_n(own.position + 4 * std::size_t(here), 3, to);
        for (int i = 0; i < 3; ++i) to[3 + i] = double(own.motion[8 * std::size_t(here) + i]);
      }
      to += of_node;
    }
    for (int cell : cells) {
      if (element_[cell] >= 0) *to = own.thickness(element_[cell]);
      ++to;
    }
    if (!told_.empty()) parts.find_largest(told_.data(), static_cast<int>(told_.size()));
    // 2. all know
    const double* from = told_.data();
    for (int node : nodes) {
      std::copy_n(from, 3, position_.data() + 4 * std::size_t(node));
      for (int i = 0; i < 3; ++i) motion_[8 * std::size_t(node) + i] = static_cast<Real>(from[3 + i]);
      from += of_node;
    }
    for (int cell : cells) thickness_[cell] = *from++;
  }
  template <class View>
  void learn_all(const View& own, Neighbours& parts) {
    learn(all_nodes_, all_cells_, own, parts);
  }

  // What contact must know, as learnt last, after a step of dt.
  auto view(double dt) const {
    return SheetView{position_.data(), motion_.data(), [this](int cell) { return thickness_[cell]; },
                     [](int) { return 0.0; }, dt};
  }

 private:
  static constexpr std::size_t of_node = 6;  // numbers: place and velocity
  std::vector<int> place_, element_, all_nodes_, all_cells_;
  std::vector<double> position_;
  std::vector<Real> motion_;
  std::vector<double> thickness_, told_;
};

}  // namespace presswork::explicit_dynamics
