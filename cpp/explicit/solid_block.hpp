// SPDX-License-Identifier: Apache-2.0
// Plane-strain or axisymmetric solids of one kind, law and density in the explicit loop: state, masses, bound of the
// frequency. The elements are those of element/solid2d_one_point.hpp.
#pragma once

#include <string_view>
#include <vector>

#include "element/solid2d_one_point.hpp"
#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

// The laws of a block; a law from a shared library with the elastic constants of its first tangent.
struct OwnedUmat {
  Umat umat;
  double young, poisson;
};
using SolidLawChoice = std::variant<Owned<AdiabaticMises>, Owned<PlaneLaw>, OwnedUmat>;

class SolidBlock {
 public:
  static constexpr int lanes = pack_width;
  static constexpr int node_record = 4;   // of a node, as cells load it: x, y, then by how much the cycle moves it
  static constexpr int force_record = 8;  // of a cell: x and y of the force on four nodes, a triangle's last unused
  // cells (n, nodes) of element "tri3" or "quad4_1pt"; points (n_points, 2) [mm]; density [t/mm3]. Throws
  // std::invalid_argument for another element.
  SolidBlock(std::string_view element, std::vector<int> cells, const double* points, SolidLawChoice law, double density,
             const SolidSection& section);

  int n() const { return n_; }
  int n_packs() const { return (n_ + lanes - 1) / lanes; }
  int nodes_each() const { return nodes_; }

  // Advance packs [first, last) by the moves of a cycle of dt that has taken the nodes to where they are; nodes:
  // records as above; time: at its start [s]; force: records of their cells, from the first pack on. Returns -1, or
  // `reasons` times the number of a cell plus why it failed: 0 turned inside out, else a LawStatus.
  static constexpr int reasons = 8;
  int advance(const double* nodes, double dt, double time, int first, int last, double* force) {
    return (this->*advance_)(nodes, dt, time, first, last, force);
  }
  // Bound of each cell's squared frequency [1/s2], elastic, at the present positions.
  void bound_frequencies(const double* nodes, double* squared) const { (this->*bound_)(nodes, squared); }

  // Rows of a cell's state: those of CycleRow, then what the law keeps besides.
  int rows() const { return rows_; }
  double value(int cell, int row) const { return state_.data()[index(cell, row)]; }
  // Sets the copies in the last pack as well.
  void set_value(int cell, int row, double x) {
    for (int copy = cell; copy < (cell == n_ - 1 ? n_packs() * lanes : cell + 1); ++copy)
      state_.data()[index(copy, row)] = x;
  }

  // Temperatures (n) given to the cells [degrees C] from now on.
  void set_temperature(const double* degrees);

  const std::vector<int> cells;     // (n, nodes)
  std::vector<double> mass;         // (n, nodes) of its nodes [t]: density times int N_a dV
  std::vector<double> mass_factor;  // (n) of mass scaling, from 1

 private:
  template <class Cell>
  void use(const double* points);
  void start_law();
  template <class Cell, class Law>
  int advance_packs(const double* nodes, double dt, double time, int first, int last, double* force);
  template <class Cell>
  void bound_packs(const double* nodes, double* squared) const;
  template <class Cell>
  void set_masses(const double* points);
  std::size_t index(int cell, int row) const {
    return (std::size_t(cell / lanes) * rows_ + row) * lanes + cell % lanes;
  }

  // what kernels see of the law
  auto view(const Owned<AdiabaticMises>& law) const { return law.view; }
  auto view(const Owned<PlaneLaw>& law) const { return law.view; }
  auto view(const OwnedUmat& law) const { return CycleUmat{&law.umat, law.young, law.poisson}; }

  SolidLawChoice law_;
  double density_;
  SolidSection section_;
  int nodes_ = 0, n_ = 0, rows_ = 0;
  // Packs: [pack][node][lane], [pack][row][lane]. The last is filled up with copies of the last cell that take part in
  // no assembly.
  std::vector<int> packed_;
  AlignedArray<double> state_;
  AlignedArray<double> temperature_;  // [pack][lane]; none: that of the law's start
  int (SolidBlock::*advance_)(const double*, double, double, int, int, double*) = nullptr;
  void (SolidBlock::*bound_)(const double*, double*) const = nullptr;
};

}  // namespace presswork::explicit_dynamics
