// SPDX-License-Identifier: Apache-2.0
// Solids in space of one kind, law and density in the explicit loop: the fully integrated elements of
// element/solid.hpp, evaluated without a tangent, on state that is kept by packs.
//
// The internal energy is the work of the nodal forces over the cycles, which is that of the stresses to the order of
// the step; so the forces of the last cycle are part of the state.
#pragma once

#include <memory>
#include <string_view>
#include <variant>

#include "explicit/element_block.hpp"
#include "explicit/space/nodes.hpp"
#include "material/elastic_plastic.hpp"
#include "material/law_data.hpp"
#include "material/von_mises.hpp"

namespace presswork::explicit_dynamics {

using SpaceSolidLaw = std::variant<Owned<VonMises>, Owned<SolidLaw>>;

class SpaceSolids : public ElementBlock<SpaceNodes<double>> {
 public:
  using Nodes = SpaceNodes<double>;

  void add_masses(std::vector<double>& sum) const override {
    for (std::size_t i = 0; i < connectivity_.size(); ++i)
      sum[Nodes::masses * std::size_t(connectivity_[i])] += mass_factor_[i / nodes_each_] * nodal_mass_[i];
  }
  double mass(int cell) const override { return mass_factor_[cell] * true_mass(cell); }
  double true_mass(int cell) const override {
    double sum = 0.0;
    for (int a = 0; a < nodes_each_; ++a) sum += nodal_mass_[std::size_t(cell) * nodes_each_ + a];
    return sum;
  }
  double added_mass(int cell) const override { return (mass_factor_[cell] - 1.0) * true_mass(cell); }
  void scale_mass(int cell, double factor) override { mass_factor_[cell] *= factor; }
  PointLayout layout() const override { return {first_point(), point_rows_, n_points_, 6, 6}; }
  void list_state(const std::string& owner, std::vector<StateField>& fields) override;

 protected:
  // Rows: work, forces on the nodes, then of each point stress (6), equivalent plastic strain and what the law keeps.
  static constexpr int work_row = 0, force_row = 1;
  SpaceSolids(int nodes_each, std::vector<int> cells, int n_points, int kept)
      : ElementBlock<Nodes>(nodes_each, std::move(cells), force_row + 3 * nodes_each + n_points * (7 + kept), work_row,
                            -1, n_points),
        n_points_(n_points),
        point_rows_(7 + kept),
        nodal_mass_(connectivity_.size()),
        mass_factor_(n_, 1.0) {}
  int first_point() const { return force_row + 3 * nodes_each_; }

  int n_points_, point_rows_;
  std::vector<double> nodal_mass_;   // (n, nodes): density times int N_a dV [t]
  std::vector<double> mass_factor_;  // (n) of mass scaling, from 1
};

// cells (n, nodes) of element "hex8" or "hex8_fbar" at the nodes' positions; density [t/mm3]. Throws
// std::invalid_argument for another element, or for a cell that is turned inside out.
std::unique_ptr<SpaceSolids> make_space_solids(std::string_view element, std::vector<int> cells,
                                               const SpaceNodes<double>& nodes, SpaceSolidLaw law, double density);

}  // namespace presswork::explicit_dynamics
