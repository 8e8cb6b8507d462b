// SPDX-License-Identifier: Apache-2.0
// Plane-strain or axisymmetric solids of one kind, law and density in the explicit loop. The elements are those of
// element/solid2d_one_point.hpp.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "element/solid2d_one_point.hpp"
#include "explicit/element_block.hpp"
#include "explicit/plane/nodes.hpp"

namespace presswork::explicit_dynamics {

using PlaneSolidLaw = std::variant<Owned<AdiabaticMises>, Owned<PlaneLaw>, Owned<CycleUmat<4>>>;

class PlaneSolids : public ElementBlock<PlaneNodes> {
 public:
  void add_masses(std::vector<double>& sum) const override {
    for (std::size_t i = 0; i < connectivity_.size(); ++i)
      sum[connectivity_[i]] += mass_factor_[i / nodes_each_] * nodal_mass_[i];
  }
  double mass(int cell) const override { return mass_factor_[cell] * true_mass(cell); }
  double added_mass(int cell) const override { return (mass_factor_[cell] - 1.0) * true_mass(cell); }
  void scale_mass(int cell, double factor) override { mass_factor_[cell] *= factor; }
  double true_mass(int cell) const override {
    double sum = 0.0;
    for (int a = 0; a < nodes_each_; ++a) sum += nodal_mass_[std::size_t(cell) * nodes_each_ + a];
    return sum;
  }
  PointLayout layout() const override { return {CycleRow::stress, 0, 1, 4, CycleRow::eqps - CycleRow::stress}; }
  // What the law keeps besides the rows of CycleRow, before the first cycle. Throws std::invalid_argument for another
  // number of values.
  void start_law(const std::vector<double>& kept) {
    if (int(kept.size()) != n_rows_ - CycleRow::count)
      throw std::invalid_argument("kept must have " + std::to_string(n_rows_ - CycleRow::count) +
                                  " values for this law");
    for (int e = 0; e < n_; ++e)
      for (int i = 0; i < int(kept.size()); ++i) set_value(e, CycleRow::count + i, kept[i]);
  }
  // Rows are those of CycleRow, then what the law keeps besides.
  void list_state(const std::string& owner, std::vector<StateField>& fields) override;

 protected:
  PlaneSolids(int nodes_each, std::vector<int> cells, int n_rows)
      : ElementBlock<PlaneNodes>(nodes_each, std::move(cells), n_rows, CycleRow::work, CycleRow::hourglass_work, 1),
        nodal_mass_(connectivity_.size()),
        mass_factor_(n_, 1.0) {}

  std::vector<double> nodal_mass_;   // (n, nodes): density times int N_a dV [t]
  std::vector<double> mass_factor_;  // (n) of mass scaling, from 1
};

// cells (n, nodes) of element "tri3" or "quad4_1pt"; points (n_points, 2) [mm]; density [t/mm3]. Throws
// std::invalid_argument for another element.
std::unique_ptr<PlaneSolids> make_plane_solids(std::string_view element, std::vector<int> cells, const double* points,
                                               PlaneSolidLaw law, double density, const SolidSection& section);

}  // namespace presswork::explicit_dynamics
