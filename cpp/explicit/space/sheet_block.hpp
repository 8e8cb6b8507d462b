// SPDX-License-Identifier: Apache-2.0
// Blocks of shells, as contact, refinement and reports know them: layers, thickness, springs of a squeezed sheet.
#pragma once

#include <stdexcept>

#include "explicit/element_block.hpp"
#include "explicit/space/nodes.hpp"
#include "tensor/carried_sum.hpp"

namespace presswork::explicit_dynamics {

// Where what is reported of a shell stands in its state; layers start at `layers`, `law` rows each.
struct StateRows {
  int thickness, work, hourglass_work;  // work [N mm]: of the stresses, of the hourglass forces (-1: there are none)
  // points in the plane, points across the thickness, which come first, and rows of each: sum, difference, shear of
  // stress, then the law's history
  int layers, in_plane, across, law;
  int end_of_layers() const { return layers + in_plane * across * law; }
  // Of a squeezed shell: pressure through the thickness of the first point in the plane, and from it to that of the
  // next; spring of a node [N/mm] (squeezed_section.hpp).
  int pressure, pressure_step = 0, spring;
  // First rows of what the undeformed shape gives (4), of hourglass forces (6); -1 of shells that cannot be split.
  int reference = -1, hourglass = -1;
  int shear = -1;  // of transverse shear stress (2) of the first point in the plane; pressure_step on the next's
};

struct ShellSection;

template <class Real>
class SheetBlock : public ElementBlock<SpaceNodes<Real>> {
 public:
  const StateRows& rows() const { return rows_; }
  virtual const ShellSection& section() const = 0;

  // Mass [t] and rotary inertia over mass [mm2], shared out to an element's nodes, to each the same.
  void add_masses(std::vector<double>& sum) const override {
    for (std::size_t i = 0; i < this->connectivity_.size(); ++i) {
      const double share = mass_[i / this->nodes_each_] / this->nodes_each_;
      const auto node = static_cast<std::size_t>(this->connectivity_[i]);
      sum[2 * node] += share;
      sum[2 * node + 1] += share * inertia_ratio_[i / this->nodes_each_];
    }
  }
  double mass(int element) const override { return mass_[element]; }
  double area(int element) const { return area_[element]; }                    // of the undeformed shell [mm2]
  double inertia_ratio(int element) const { return inertia_ratio_[element]; }  // rotary inertia over mass [mm2]
  // By how much tools are nearer to each other at an element than they are drawn [mm]: dies are stepped for zones of a
  // blank that are thinner than the rest. Empty: nowhere.
  void set_relief(std::vector<double> relief) { relief_ = std::move(relief); }
  double relief(int element) const { return relief_.empty() ? 0.0 : relief_[element]; }
  bool is_relieved() const { return !relief_.empty(); }
  double true_mass(int element) const override { return true_mass_[element]; }
  double added_mass(int element) const override { return mass_[element] - true_mass_[element]; }
  void scale_mass(int element, double factor) override { mass_[element] *= factor; }

  // Take the springs of squeezed shells from their masses and a step.
  void set_springs(double dt) {
    for (int e = 0; e < this->n_; ++e)
      this->set_value(e, rows_.spring, std::min(stiffest_spring_[e], mass_[e] / (this->nodes_each_ * dt * dt)));
  }

  // Take over the state of an element of a like block, or, of a share of it below one, that of the child that it has
  // been split into: mass and work by the share, no hourglass forces, the undeformed shape its own.
  void inherit(int element, const SheetBlock& from, int parent, double share) {
    if (share < 1.0 && rows_.reference < 0) throw std::invalid_argument("shells of this kind cannot be split");
    for (int r = 0; r < this->n_rows_; ++r) {
      double x = from.value(parent, r);
      if (share < 1.0) {
        if (r >= rows_.reference && r < rows_.reference + 4) continue;
        if (r >= rows_.hourglass && r < rows_.hourglass + 6) x = 0.0;
        if (r == rows_.work || r == rows_.hourglass_work) x *= share;
      }
      this->set_value(element, r, x);
    }
    mass_[element] = share * from.mass_[parent];
    this->damage.inherit(element, from.damage, parent);
  }

  // Take over mass and shape of the elements of a like block; their layers stay as they are, without stress.
  void take_shape(const SheetBlock& from) {
    mass_ = from.mass_;
    for (int e = 0; e < this->n_; ++e) {
      for (int r = 0; r < rows_.layers; ++r) this->set_value(e, r, from.value(e, r));
      for (int r = 0; rows_.hourglass >= 0 && r < 6; ++r) this->set_value(e, rows_.hourglass + r, 0.0);
      for (int q = 0; q < rows_.in_plane; ++q) {
        for (int r = 0; r < 2; ++r) this->set_value(e, rows_.shear + q * rows_.pressure_step + r, 0.0);
        this->set_value(e, rows_.pressure + q * rows_.pressure_step, 0.0);
      }
      for (int k = 0; k < rows_.in_plane * rows_.across; ++k)
        for (int r = 0; r < 3; ++r) this->set_value(e, rows_.layers + k * rows_.law + r, 0.0);
      clear_rounding(e);
    }
  }

  PointLayout layout() const override { return {rows_.layers, rows_.law, rows_.in_plane * rows_.across, 3, 3}; }
  void list_state(const std::string& owner, std::vector<StateField>& fields) override {
    fields.push_back(row_field(owner, "mass", mass_.data(), mass_.size()));
    fields.push_back(this->rows_field(owner, "shell", 0, rows_.layers));
    const int end = rows_.end_of_layers();
    StateField layers = this->rows_field(owner, "layers", rows_.layers, end - rows_.layers);
    layers.shape = {std::size_t(this->n_), std::size_t(rows_.in_plane), std::size_t(rows_.across),
                    std::size_t(rows_.law)};
    fields.push_back(std::move(layers));
    if (this->n_rows_ > end) fields.push_back(this->rows_field(owner, "rounding", end, this->n_rows_ - end));
  }
  // Forget what rounding took from the layers of an element.
  void clear_rounding(int e) {
    for (int r = rows_.end_of_layers(); r < this->n_rows_; ++r) this->set_value(e, r, 0.0);
  }

 protected:
  SheetBlock(int nodes_each, std::vector<int> connectivity, StateRows rows)
      : ElementBlock<SpaceNodes<Real>>(nodes_each, std::move(connectivity), count_rows(rows), rows.work,
                                       rows.hourglass_work, rows.in_plane * rows.across),
        rows_(rows),
        mass_(this->n_),
        true_mass_(this->n_),
        inertia_ratio_(this->n_),
        area_(this->n_),
        stiffest_spring_(this->n_) {}

  // Layers in single precision have as many rows of rounding behind them (layered_section.hpp).
  static int count_rows(const StateRows& rows) {
    const int end = rows.end_of_layers();
    return is_single<Real> ? 2 * end - rows.layers : end;
  }

  StateRows rows_;
  std::vector<double> mass_, true_mass_, inertia_ratio_, area_, stiffest_spring_, relief_;
};

}  // namespace presswork::explicit_dynamics
