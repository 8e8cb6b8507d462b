// SPDX-License-Identifier: Apache-2.0
// Plane-strain or axisymmetric solids of one kind, law and density in the explicit loop: state, masses, bound of the
// frequency. The elements themselves are those of the implicit procedure (element/solid2d.hpp), evaluated without a
// tangent.
#pragma once

#include <string_view>
#include <vector>

#include "element/solid2d.hpp"

namespace presswork::explicit_dynamics {

// What is common to the blocks of a run.
struct SolidSettings {
  bool axisymmetric = false;
  double depth = 1.0;  // of plane strain [mm]
  double hourglass_fraction = 0.05;
  StrainMeasure measure = StrainMeasure::log;
};

class SolidBlock {
 public:
  // cells (n, nodes) of element "tri3" or "quad4_1pt"; points (n_points, 2) [mm]; density [t/mm3]. Throws
  // std::invalid_argument for another element.
  SolidBlock(std::string_view element, std::vector<int> cells, const double* points, const AdiabaticMises& law,
             double density, const SolidSettings& settings);

  int n() const { return n_; }
  int n_packs() const { return (n_ + pack_width - 1) / pack_width; }
  int nodes_each() const { return nodes_; }
  std::size_t force_size() const { return std::size_t(n_packs()) * 2 * nodes_ * pack_width; }

  // Advance a pack from points by increment in dt; force as in BlockView. Returns the number of a cell turned inside
  // out, or -1.
  int advance(const double* points, const double* increment, double dt, double* force, int pack);
  // Bound of each cell's squared frequency [1/s2], elastic, at the given points.
  void bound_frequencies(const double* points, double* squared) const;

  std::vector<int> cells;                       // (n, nodes)
  std::vector<double> mass;                     // (n, nodes) of its nodes [t]: density times int N_a dV
  std::vector<double> mass_factor;              // (n) of mass scaling, from 1
  std::vector<double> stress, eqps, rise;       // (n, 4), (n), (n)
  std::vector<double> hourglass, volume, work;  // (n, 2), (n), (n, 2) as in BlockView

 private:
  using Advance = int (*)(const BlockView&, const PointSettings&, const AdiabaticMises&, int);
  using Measure = void (*)(const SolidBlock&, const double* points, int pack, double* squared);
  template <Cell cell, Treatment treatment>
  void use();
  template <Cell cell, Treatment treatment>
  static void bound_pack(const SolidBlock& block, const double* points, int pack, double* squared);
  template <Cell cell>
  void set_masses(const double* points);
  BlockView view(const double* points, const double* increment, double dt, double* force);

  AdiabaticMises law_;
  double density_;
  SolidSettings settings_;
  int nodes_ = 0, n_ = 0;
  Advance advance_ = nullptr;
  Measure bound_ = nullptr;
  void (SolidBlock::*weigh_)(const double*) = nullptr;
};

}  // namespace presswork::explicit_dynamics
