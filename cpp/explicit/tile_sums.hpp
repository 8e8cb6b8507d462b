// SPDX-License-Identifier: Apache-2.0
// Elements of the explicit loops in tiles, and their nodal forces summed up without atomics, always in the same order.
//
// The forces of a tile's elements stay in the cache: nodes inside a tile are summed up there and then, and those on its
// rim keep each element's force for a second pass. So every sum goes through the elements in the order of their
// numbers, and does not depend on how they are cut into tiles, or divided over ranks.
#pragma once

#include <vector>

#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

// What is to be known of a block of elements. In a tile's forces each element has a record, in which the numbers of its
// nodes follow each other.
struct TiledBlock {
  int n, lanes;             // elements, and how many are in a pack
  int nodes_each, record;   // numbers in a record
  const int* connectivity;  // (n, nodes_each)
};

struct Tile {
  int block, first, last;       // packs of the block
  int numbered_from;            // number of the block's first element in the loop
  int nodes_first, nodes_last;  // of TileSums
};

// numbers: of the force on a node, 6 (shells) or 2 (solids in the plane).
template <class Real, int numbers>
class TileSums {
 public:
  // Cut the blocks, whose elements are numbered in the order of the blocks, into tiles.
  void cut(int n_nodes, const std::vector<TiledBlock>& blocks);

  const std::vector<Tile>& tiles() const { return tiles_; }
  int n_rim_nodes() const { return static_cast<int>(rim_node_.size()); }
  // Room for the forces of the elements of any tile; one for each thread.
  AlignedArray<Real> make_scratch() const { return AlignedArray<Real>(scratch_size_); }

  // Sum up the forces of a tile's elements, as rows (n_nodes, numbers), and keep those on rim nodes.
  void sum_tile(const Tile& tile, const Real* scratch, Real* force);
  // Add up the forces on rim nodes [first, last); when all tiles have been summed up.
  void close_rims(int first, int last, Real* force) const;

 private:
  void cut_blocks(const std::vector<TiledBlock>& blocks);

  std::vector<Tile> tiles_;
  std::size_t scratch_size_ = 0;  // of the largest tile
  // Nodes of the tiles, one tile after the other: where the sum goes, a row of the forces or, below zero, of kept_
  // (as -1 - row), one of each element; and the entries to add up, offsets in the tile's forces.
  std::vector<int> target_, entry_start_, entry_;
  AlignedArray<Real> kept_;                           // (rows, numbers) and what a load takes in beyond
  std::vector<int> rim_node_, rim_start_, rim_kept_;  // nodes on rims and their rows of kept_
};

}  // namespace presswork::explicit_dynamics
