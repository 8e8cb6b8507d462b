// SPDX-License-Identifier: Apache-2.0
// Shells of one section and law, in packs of SIMD width: what the explicit loop knows of them.
#pragma once

#include <memory>
#include <vector>

#include "element/shell4_one_point.hpp"
#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

struct ShellSection {
  std::variant<FastMises, GeneralSheet> law;
  LayerRule rule;
  double density;  // [t/mm3]
  bool warped;     // with the warping terms
  ShellControl control;
};

// State is kept as [pack][row][lane]: rows of shell4::Row, then (layers, rows of the law). The last pack is filled up
// with copies of the last element that take part in no assembly.
class ShellBlock {
 public:
  // connectivity (n, 4), thickness (n) [mm], axis (n, 3): direction of the law's x, of any length, projected on the
  // element. Throws std::invalid_argument for an element that has no area or that its axis is normal to.
  ShellBlock(const Nodes& nodes, ShellSection section, std::vector<int> connectivity, const double* thickness,
             const double* axis);

  int n() const { return n_; }
  int n_packs() const { return n_packs_; }
  int rows() const { return rows_; }
  int points() const { return static_cast<int>(section_.rule.height.size()); }
  int law_rows() const { return law_rows_; }
  const std::vector<int>& connectivity() const { return connectivity_; }
  const ShellSection& section() const { return section_; }

  // Mass [t] and rotary inertia over mass [mm2], in place; the loop adds them up to the nodes.
  std::vector<double>& mass() { return mass_; }
  const std::vector<double>& inertia_ratio() const { return inertia_ratio_; }

  // Advance packs [first, last) by dt; force: (packs, lanes, 24), from the first pack on.
  void advance(const Nodes& nodes, double dt, int first, int last, double* force);
  // Bound of each element's squared frequency [1/s2] (n).
  void bound_frequencies(const Nodes& nodes, double* squared) const;

  double value(int element, int row) const { return state_.data()[index(element, row)]; }
  void set_value(int element, int row, double x) { state_.data()[index(element, row)] = x; }
  AlignedArray& state() { return state_; }
  const AlignedArray& state() const { return state_; }

 private:
  std::size_t index(int element, int row) const {
    return (std::size_t(element / pack_width) * rows_ + row) * pack_width + element % pack_width;
  }
  void load(const Nodes& nodes, int pack, Pack x[4][3], Pack v[4][3], Pack w[4][3]) const;
  template <bool warped, class Law>
  void advance_packs(const Law& law, const Nodes& nodes, const ShellControl& control, int first, int last,
                     double* force);

  ShellSection section_;
  int n_, n_packs_, law_rows_, rows_;
  std::vector<int> connectivity_;  // (n, 4)
  std::vector<int> packed_;        // [pack][node][lane]
  std::vector<double> mass_, inertia_ratio_;
  AlignedArray state_;
};

}  // namespace presswork::explicit_dynamics
