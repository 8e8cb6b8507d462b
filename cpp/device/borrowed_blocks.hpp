// SPDX-License-Identifier: Apache-2.0
// Blocks of elements of a loop as a device takes them, and what goes back into the loop.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/cycle.hpp"
#include "explicit/space/loop.hpp"
#include "explicit/space/shell_section.hpp"
#include "explicit/space/solids.hpp"

namespace presswork::device {

using explicit_dynamics::ElementBlock;
using explicit_dynamics::ShellSection;
using explicit_dynamics::ShellTreatment;
using explicit_dynamics::SpaceLoop;
using explicit_dynamics::SpaceNodes;
using explicit_dynamics::SpaceSection;
using explicit_dynamics::SpaceSolids;

// What a block of shells has that no device computes; empty where there is nothing.
inline std::string find_lack_of_shells(const ShellSection& section, int corners) {
  if (corners == 4 && section.treatment != ShellTreatment::stabilized && section.treatment != ShellTreatment::mitc)
    return "shells of one point without physical hourglass control";
  if (std::holds_alternative<UserSheet>(section.law)) return "laws of shared libraries (UMAT)";
  return "";
}

inline std::string find_lack_of_solids(const SpaceSolids* solids) {
  const auto kind = solids ? solids->section().kind : SpaceSection::Kind::integrated;
  if (kind == SpaceSection::Kind::by_umat) return "laws of shared libraries (UMAT)";
  if (kind != SpaceSection::Kind::integrated) return "";
  return "solids other than hex8_1pt and tet4_nodal";
}

// A block, of which nothing lacks.
template <class Real>
class BorrowedBlock {
 public:
  BorrowedBlock(SpaceLoop<Real>& loop, int number, int first_slot) : own_(*loop.blocks[number]) {
    const std::size_t n = own_.n(), corners = own_.nodes_each(), rows = own_.n_rows();
    const bool is_sheet = loop.is_sheet(number);
    node.resize(corners * n), state_.resize(rows * n);
    if (is_sheet) mass_.resize(n), inertia_ratio_.resize(n);
    for (std::size_t e = 0; e < n; ++e) {
      if (is_sheet) {
        mass_[e] = static_cast<Real>(loop.sheet(number).mass(int(e)));
        inertia_ratio_[e] = static_cast<Real>(loop.sheet(number).inertia_ratio(int(e)));
      }
      for (std::size_t a = 0; a < corners; ++a) node[a * n + e] = own_.connectivity()[corners * e + a];
      for (std::size_t r = 0; r < rows; ++r) state_[r * n + e] = static_cast<Real>(own_.value(int(e), int(r)));
    }
    const std::size_t points = own_.has_temperatures() ? own_.n_temperatures() : 0;
    temperature_.resize(points * n);
    take_temperatures();
    Elements<Real> elements{own_.n(),
                            own_.n_rows(),
                            first_slot,
                            node.data(),
                            state_.data(),
                            static_cast<int>(points),
                            points > 0 ? temperature_.data() : nullptr,
                            own_.slower,
                            own_.work_row(),
                            own_.hourglass_row(),
                            is_sheet ? mass_.data() : nullptr,
                            is_sheet ? inertia_ratio_.data() : nullptr};
    elements.damage = see_damage();
    if (is_sheet)
      see_shells(elements, loop.sheet(number).section());
    else if constexpr (std::is_same_v<Real, double>)
      see_solids(elements, dynamic_cast<const SpaceSolids&>(own_), loop.nodes);
  }
  BorrowedBlock(const BorrowedBlock&) = delete;
  BorrowedBlock& operator=(const BorrowedBlock&) = delete;

  // The state, or a row of it; and damage.
  void give_back() const {
    for (int r = 0; r < own_.n_rows(); ++r) give_back_row(r);
  }
  void give_back_damage() const {
    for (std::size_t c = 0; c < damage_.size(); ++c)
      for (int e = 0; e < n(); ++e)
        for (int k = 0; k < own_.damage.points(); ++k)
          own_.damage.value(c, e, k) = damage_[c][std::size_t(k) * n() + e];
  }
  void give_back_row(int r) const {
    for (int e = 0; e < n(); ++e) own_.set_value(e, r, double(state_[std::size_t(r) * n() + e]));
  }
  // Those that are given now; false where none were when the block was borrowed.
  bool take_temperatures() {
    if (temperature_.empty()) return !own_.has_temperatures();
    for (int e = 0; e < n(); ++e)
      for (int k = 0; k < own_.n_temperatures(); ++k)
        temperature_[std::size_t(k) * n() + e] = static_cast<Real>(own_.temperature(e, k));
    return true;
  }
  Real* row(int r) { return &state_[std::size_t(r) * n()]; }
  const Block<Real>& view() const { return *view_; }
  int n() const { return own_.n(); }
  int first_slot() const {
    return std::visit([](const auto& of) { return of.first_slot; }, *view_);
  }

  // The first element that has failed, and why, by the cycles from then on, as elements.hpp has it; 0 where none has.
  std::pair<int, int> find_failed() const {
    const auto first =
        std::max_element(failed_.begin(), failed_.end(), [](int a, int b) { return a / reasons < b / reasons; });
    if (first == failed_.end()) return {0, 0};
    return {static_cast<int>(first - failed_.begin()), *first};
  }

  std::vector<int> node;  // (corners, n)

 private:
  void see_solids(Elements<Real>& elements, const SpaceSolids& solids, const SpaceNodes<Real>& nodes) {
    const SpaceSection section = solids.section();
    see_failures(elements);
    for (int a = 0; a < own_.nodes_each(); ++a)
      for (int e = 0; e < own_.n(); ++e) nodal_mass_.push_back(solids.nodal_mass(e, a));
    std::visit(
        [&]<class Law>(const Law& law) {
          const SolidElements<Law> of{elements, law, section.fraction, nodal_mass_.data()};
          if (section.kind == SpaceSection::Kind::one_point)
            view_ = OnePointHexahedra<Law>{of};
          else
            view_ = NodalTetrahedra<Law>{of, see_volumes(nodes)};
        },
        section.law);
  }
  // Volumes of nodes where these are.
  NodalVolumes see_volumes(const SpaceNodes<Real>& nodes) {
    const std::size_t n = own_.n();
    first_cell_.assign(nodes.n + 1, 0), cell_.resize(node.size()), nodal_.assign(nodes.n, 0.0);
    for (int i : node) ++first_cell_[i + 1];
    for (int i = 0; i < nodes.n; ++i) first_cell_[i + 1] += first_cell_[i];
    std::vector<int> next(first_cell_.begin(), first_cell_.end() - 1);
    for (std::size_t e = 0; e < n; ++e) {
      double x[4][3];
      for (int a = 0; a < 4; ++a)
        for (int i = 0; i < 3; ++i) x[a][i] = nodes.position.data()[4 * std::size_t(node[a * n + e]) + i];
      const double volume = six_volumes(x);
      for (int a = 0; a < 4; ++a) {
        cell_[next[node[a * n + e]]++] = static_cast<int>(e);
        nodal_[node[a * n + e]] += volume;
      }
    }
    return {first_cell_.data(), cell_.data(), nullptr, nodal_.data(), nullptr};
  }
  DamageOfBlock see_damage() {
    auto& from = own_.damage;
    if (from.empty()) return {};
    const auto& layout = from.layout();
    const std::size_t n = own_.n();
    flowed_.resize(layout.count * n);
    for (int e = 0; e < own_.n(); ++e)
      for (int k = 0; k < layout.count; ++k)
        flowed_[k * n + e] = own_.value(e, layout.first + k * layout.rows + layout.eqps);
    for (std::size_t c = 0; c < from.count(); ++c) {
      const auto& each = from.criteria()[c];
      auto& values = damage_.emplace_back(layout.count * n);
      for (int e = 0; e < own_.n(); ++e)
        for (int k = 0; k < layout.count; ++k) values[k * n + e] = from.value(c, e, k);
      criteria_.push_back({each.law, each.temperature, each.rise, values.data()});
    }
    return {static_cast<int>(from.count()),
            layout.first,
            layout.rows,
            layout.count,
            layout.components,
            layout.eqps,
            criteria_.data(),
            flowed_.data()};
  }
  void see_failures(Elements<Real>& elements) {
    failed_.resize(elements.n);
    elements.failed = failed_.data();
  }
  void see_shells(Elements<Real>& elements, const ShellSection& section) {
    const auto see = [&]<class Law>(const Law& law) {
      if (Law::can_fail) see_failures(elements);
      if (own_.nodes_each() == 4 && section.treatment == ShellTreatment::mitc)
        view_ = MitcShells<Real, Law>{elements, law, section.rule};
      else if (own_.nodes_each() == 4)
        view_ = OnePointShells<Real, 4, Law>{elements, law, section.rule};
      else
        view_ = OnePointShells<Real, 3, Law>{elements, law, section.rule};
    };
    if (const auto* general = std::get_if<GeneralSheet>(&section.law))
      see(*general);
    else
      see(std::get<FastMises>(section.law));
  }

  ElementBlock<SpaceNodes<Real>>& own_;
  std::vector<Real> state_, temperature_, mass_, inertia_ratio_;
  std::vector<double> flowed_;
  std::vector<std::vector<double>> damage_;  // by criterion (points, n)
  std::vector<Criterion> criteria_;
  std::vector<int> failed_;                 // (n)
  std::vector<double> nodal_mass_, nodal_;  // of solids (corners, n); of NodalVolumes
  std::vector<int> first_cell_, cell_;      // of NodalVolumes
  std::optional<Block<Real>> view_;
};

// The slots of the corners round each node, the elements in turn.
template <class Real>
void list_corners(const std::vector<std::unique_ptr<BorrowedBlock<Real>>>& blocks, int n_nodes, std::vector<int>& first,
                  std::vector<int>& list) {
  first.assign(n_nodes + 1, 0);
  for (const auto& block : blocks)
    for (int node : block->node) ++first[node + 1];
  for (int node = 0; node < n_nodes; ++node) first[node + 1] += first[node];
  list.resize(first[n_nodes]);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (const auto& block : blocks)
    for (int e = 0; e < block->n(); ++e)
      for (std::size_t slot = e; slot < block->node.size(); slot += block->n())
        list[next[block->node[slot]]++] = block->first_slot() + static_cast<int>(slot);
}

}  // namespace presswork::device
