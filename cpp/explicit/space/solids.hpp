// SPDX-License-Identifier: Apache-2.0
// Solids in space of one kind, law and density in the explicit loop: the fully integrated elements of
// element/solid.hpp, evaluated without a tangent, on state that is kept by packs, and hexahedra of one point
// (element/hex_one_point.hpp), and tetrahedra with the nodal mean of J (nodal_tetrahedra.hpp).
//
// The internal energy of fully integrated ones is the work of the nodal forces over the cycles, which is that of the
// stresses to the order of the step; so the forces of the last cycle are part of the state.
#pragma once

#include <memory>
#include <stdexcept>
#include <string_view>
#include <variant>

#include "element/solid_space.hpp"
#include "element/umat_space_cycle.hpp"
#include "explicit/element_block.hpp"
#include "explicit/gather.hpp"
#include "explicit/space/nodes.hpp"
#include "material/elastic_plastic.hpp"
#include "material/law_data.hpp"
#include "material/von_mises.hpp"

namespace presswork::explicit_dynamics {

// How a block of solids is computed, as a device takes it.
struct SpaceSection {
  enum class Kind { integrated, one_point, nodal, by_umat } kind = Kind::integrated;
  std::variant<VonMises, SolidLaw> law;
  double fraction = 0.0;  // of the shear modulus, of what holds motions that the points do not see
};

using SpaceSolidLaw = std::variant<Owned<VonMises>, Owned<SolidLaw>, Owned<CycleUmat<6>>>;

template <class Law>
SpaceSection make_section(SpaceSection::Kind kind, const Law& law, double fraction) {
  if constexpr (std::is_same_v<Law, CycleUmat<6>>)
    return {SpaceSection::Kind::by_umat, {}, 0.0};
  else
    return {kind, law, fraction};
}

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
  // Of node a of a cell, with what scaling has added [t].
  double nodal_mass(int cell, int a) const {
    return mass_factor_[cell] * nodal_mass_[std::size_t(cell) * nodes_each_ + a];
  }
  void scale_mass(int cell, double factor) override { mass_factor_[cell] *= factor; }
  virtual SpaceSection section() const { return {}; }
  PointLayout layout() const override { return {first_point_, point_rows_, n_points_, 6, 6}; }
  void list_state(const std::string& owner, std::vector<StateField>& fields) override;
  // What the law keeps behind the equivalent plastic strain at every point, before the first cycle. Throws
  // std::invalid_argument for another number of values.
  void start_law(const std::vector<double>& kept) {
    if (int(kept.size()) != point_rows_ - 7)
      throw std::invalid_argument("kept must have " + std::to_string(point_rows_ - 7) + " values for this law");
    for (int e = 0; e < n_; ++e)
      for (int q = 0; q < n_points_; ++q)
        for (int i = 7; i < point_rows_; ++i) set_value(e, first_point_ + q * point_rows_ + i, kept[i - 7]);
  }
  std::vector<int> number;  // (n) of the cells, from 0, as a law from a shared library is told; empty: as they come

 protected:
  // Rows from first_point on: of each point stress (6), equivalent plastic strain and what the law keeps.
  // hourglass_row: -1 where there are no hourglass forces.
  SpaceSolids(int nodes_each, std::vector<int> cells, int first_point, int n_points, int kept, int work_row,
              int hourglass_row)
      : ElementBlock<Nodes>(nodes_each, std::move(cells), first_point + n_points * (7 + kept), work_row, hourglass_row,
                            n_points),
        first_point_(first_point),
        n_points_(n_points),
        point_rows_(7 + kept),
        nodal_mass_(connectivity_.size()),
        mass_factor_(n_, 1.0) {}
  // Row sums of the consistent mass, by the rule of n points. Throws std::invalid_argument for a cell that is turned
  // inside out.
  template <class Cell, int n>
  void set_masses(const Nodes& nodes, double density);
  PackPlace place_of(int pack, double time, double dt) const {
    const int first = pack * lanes;
    return {first, std::min(lanes, n_ - first), number.empty() ? nullptr : number.data(), time,
            dt,    pack_temperature(pack),      pack_state(pack) + first_point_,          point_rows_};
  }
  // The first of a pack's cells that is turned inside out, or whose law has told why it finds no stress.
  int name_failed(int pack, const Pack::Mask& turned, const Pack::Mask& no_stress, LawStatus told) const {
    const bool inside_out = any(turned);
    const Pack::Mask& bad = inside_out ? turned : no_stress;
    int lane = 0;
    while (!bad[lane]) ++lane;
    return reasons * std::min(pack * lanes + lane, n_ - 1) + static_cast<int>(inside_out ? LawStatus::done : told);
  }
  // Masses of the nodes of a pack's cells [t].
  void load_masses(int pack, Pack* mass) const {
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t e = std::min(pack * lanes + lane, n_ - 1);
      for (int a = 0; a < nodes_each_; ++a) mass[a].set(lane, mass_factor_[e] * nodal_mass_[e * nodes_each_ + a]);
    }
  }

  int first_point_, n_points_, point_rows_;
  std::vector<double> nodal_mass_;   // (n, nodes): density times int N_a dV [t]
  std::vector<double> mass_factor_;  // (n) of mass scaling, from 1
};

template <class Cell, int n>
void SpaceSolids::set_masses(const Nodes& nodes, double density) {
  using Body = SolidSpace<Cell, n, Pack>;
  for (int pack = 0; pack < n_packs(); ++pack) {
    Pack x[Cell::nodes][3];
    gather_positions<Cell::nodes>(nodes, pack_nodes(pack), x);
    for (int q = 0; q < n; ++q) {
      typename Body::Point g;
      const Pack::Mask bad = Body::measure_reference({}, x, q, g);
      if (any(bad))
        throw std::invalid_argument("cell " + std::to_string(name_failed(pack, bad, bad, LawStatus::done) / reasons) +
                                    " is turned inside out: give its nodes in the order of the element");
      for (int lane = 0; lane < std::min(lanes, n_ - pack * lanes); ++lane)
        for (int a = 0; a < Cell::nodes; ++a)
          nodal_mass_[(std::size_t(pack) * lanes + lane) * Cell::nodes + a] +=
              density * g.volume_t[lane] * Body::table().N[q][a];
    }
  }
}

// cells (n, nodes) of element "hex8", "hex8_fbar" or "hex8_1pt" at the nodes' positions; density [t/mm3];
// hourglass_fraction: of the shear modulus, of hex8_1pt. Throws std::invalid_argument for another element, or for a
// cell that is turned inside out.
std::unique_ptr<SpaceSolids> make_space_solids(std::string_view element, std::vector<int> cells,
                                               const SpaceNodes<double>& nodes, SpaceSolidLaw law, double density,
                                               double hourglass_fraction);
// Of hex8_1pt.
std::unique_ptr<SpaceSolids> make_one_point_hexahedra(std::vector<int> cells, const SpaceNodes<double>& nodes,
                                                      SpaceSolidLaw law, double density, double hourglass_fraction);

}  // namespace presswork::explicit_dynamics
