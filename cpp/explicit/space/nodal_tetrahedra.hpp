// SPDX-License-Identifier: Apache-2.0
// tet4_nodal: the linear tetrahedron with the nodal mean of J in the explicit loop (Bonet & Burton 1998).
//
// A node's volume is a quarter of those of its cells. Over a cycle it changes by the ratio r_a, and the law takes F of
// the cycle with the mean of its nodes' changes in place of its own:
//
//     F (Jbar/J)^(1/3),    ln Jbar = (1/4) sum_a ln r_a
//
// so that every law gives stress and history as in other elements. With V the cells' volumes, D the nodes' and N the
// incidence over four, the pressures' forces are those of the energy of Q = N D^-1 N^T V, which is symmetric and whose
// values lie from 0 to 1: the cells' own frequencies stay a bound.
//
// What Q does not see, cells whose volumes change while those of their nodes stay, is held by a stress of its own:
//
//     dp_e = 2 fraction G_now (ln J - ln Jbar),    G_now = G before first yield, then flow + slope/3, at most G
//
// whose energy is that of 1 - Q, not negative; G_now as in quad4_1pt, so that it stays weak beside plastic flow.
#pragma once

#include <memory>
#include <vector>

#include "explicit/interaction.hpp"
#include "explicit/space/solids.hpp"

namespace presswork::explicit_dynamics {

// Volumes of cells and, in a second list of pieces, of nodes: followed after every move of the nodes.
class NodalVolumes {
 public:
  using Nodes = SpaceNodes<double>;

  // cells (n, 4)
  NodalVolumes(int n_nodes, const std::vector<int>& cells);

  // What the loop is to have among its interactions, in this order.
  class OfCells final : public Interaction<Nodes> {
   public:
    explicit OfCells(NodalVolumes& of) : of_(of) {}
    Phase phase() const override { return Phase::nodes; }
    void begin(Nodes& nodes, int n_cycles) override { of_.begin(nodes, n_cycles); }
    int n_following() const override { return count_chunks(of_.n_cells()); }
    double follow(Nodes& nodes, const Step&, int piece) override {
      of_.measure_cells(nodes, 0.0, piece * chunk, std::min(of_.n_cells(), (piece + 1) * chunk));
      return 0.0;
    }

   private:
    NodalVolumes& of_;
  } of_cells{*this};
  class OfNodes final : public Interaction<Nodes> {
   public:
    explicit OfNodes(NodalVolumes& of) : of_(of) {}
    Phase phase() const override { return Phase::nodes; }
    int n_following() const override { return count_chunks(of_.n_nodes()); }
    double follow(Nodes&, const Step&, int piece) override {
      of_.measure_nodes(piece * chunk, std::min(of_.n_nodes(), (piece + 1) * chunk));
      return 0.0;
    }

   private:
    NodalVolumes& of_;
  } of_nodes{*this};

  // ln r of a node in the last move.
  double change(int node) const { return change_[node]; }

 private:
  int n_cells() const { return static_cast<int>(volume_.size()); }
  int n_nodes() const { return static_cast<int>(change_.size()); }
  // Where the nodes stand before the first of n cycles; without any the elements are tried by a move of one second.
  void begin(const Nodes& nodes, int n_cycles);
  // Cells [first, last) where the nodes were some time ago [s].
  void measure_cells(const Nodes& nodes, double ago, int first, int last);
  void measure_nodes(int first, int last);

  std::vector<int> cells_;              // (n, 4)
  std::vector<int> start_, entry_;      // cells of each node: entry[start[a]] to entry[start[a + 1] - 1]
  std::vector<double> volume_;          // (n) six times those of the cells [mm3]
  std::vector<double> nodal_, change_;  // (n_nodes) sums of these, and ln r
};

// cells (n, 4) at the nodes' positions; density [t/mm3]; fraction: of the shear modulus; volumes: of the same cells, to
// outlive the block. Throws std::invalid_argument for a cell that is turned inside out.
std::unique_ptr<SpaceSolids> make_nodal_tetrahedra(std::vector<int> cells, const SpaceNodes<double>& nodes,
                                                   SpaceSolidLaw law, double density, double fraction,
                                                   const NodalVolumes& volumes);

}  // namespace presswork::explicit_dynamics
