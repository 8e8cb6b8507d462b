// SPDX-License-Identifier: Apache-2.0
// Which shells of a sheet lie near its nodes, and which of them a node can never touch.
//
// A shell so near along the sheet that it could not be touched without overlap of the material is left out: nearer, in
// the undeformed mesh, than a fold without inner radius has round its mid-surface, pi/2 t, and a tenth.
#pragma once

#include <cstddef>
#include <vector>

#include "contact/closest_on_cell.hpp"

namespace presswork::contact {

class NearShells {
 public:
  // The nodes of cell i, in turn round it, are cell_node[cell_start[i]] to cell_node[cell_start[i + 1] - 1].
  // undeformed (n_nodes, 3) [mm]; thickness: the largest [mm].
  NearShells(int n_nodes, std::vector<int> cell_start, std::vector<int> cell_node, const double* undeformed,
             double thickness);

 protected:
  // Shells near each node, rising: those of node i are entries start[i] to start[i + 1] - 1.
  struct Entries {
    std::vector<int> start, cell, node;
    std::vector<double> gap;  // to touching [mm]
  };

  int corners(int cell) const { return cell_start_[cell + 1] - cell_start_[cell]; }
  // List shells within `margin` of touching each node. position: of node i at position[stride * i]. half: thickness of
  // nodes and cells [mm].
  void list_near(const double* position, int stride, const std::vector<double>& half_node,
                 const std::vector<double>& half_cell, double margin, Entries& near) const;

  int n_nodes_;
  std::vector<int> cell_start_, cell_node_;
  std::vector<int> node_start_, node_cell_, node_corner_;  // cells of each node, and which of their corners it is

 private:
  static constexpr double fold = 1.1 * 1.571;  // along the sheet over its thickness: nearer shells are left out
  void leave_out_near(const double* undeformed, double radius);

  std::vector<int> left_out_start_, left_out_;  // of each node: cells, rising
};

}  // namespace presswork::contact
