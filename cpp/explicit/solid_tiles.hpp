// SPDX-License-Identifier: Apache-2.0
// Cells of explicit solids in tiles, the forces of which stay in the cache: nodes inside a tile are summed up there and
// then, and those on its rim leave a partial sum, which a second pass adds to those of the other tiles; all in a fixed
// order, whatever the number of threads.
#pragma once

#include <vector>

#include "explicit/solid_block.hpp"

namespace presswork::explicit_dynamics {

class SolidTiles {
 public:
  struct Tile {
    int block, first, last;  // packs of the block
    int numbered_from;       // number of the block's first cell in the loop
    int nodes_first, nodes_last;
  };

  void cut(int n_nodes, const std::vector<SolidBlock>& blocks);

  const std::vector<Tile>& tiles() const { return tiles_; }
  std::size_t scratch_size() const { return scratch_size_; }  // of the largest tile: records of its cells' forces
  int n_rims() const { return static_cast<int>(rim_node_.size()); }

  // Add up the forces of a tile's cells, to internal_force (n, 2) or to partial sums.
  void sum_tile(const Tile& tile, const double* scratch, double* internal_force);
  // Add up the partial sums of nodes on rims.
  void sum_rims(int first, int last, double* internal_force) const;

 private:
  void cut_blocks(const std::vector<SolidBlock>& blocks);

  std::vector<Tile> tiles_;
  std::size_t scratch_size_ = 0;
  // Nodes of the tiles, one tile after the other: where the sum goes, a node or, below zero, a row of partial_ (as -1 -
  // row); and the entries to add up, offsets in the tile's forces.
  std::vector<int> target_, entry_start_, entry_;
  std::vector<double> partial_;                          // (rows, 2)
  std::vector<int> rim_node_, rim_start_, rim_partial_;  // nodes on rims and their rows of partial_
};

}  // namespace presswork::explicit_dynamics
