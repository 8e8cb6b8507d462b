// SPDX-License-Identifier: Apache-2.0
// Elements of the explicit loop taken in tiles, and their nodal forces summed up without atomics, always in the same
// order.
//
// The forces of a tile's elements stay in the cache: nodes inside a tile are summed up there and then, and those on its
// rim leave a partial sum, which a second pass adds to those of the other tiles.
#pragma once

#include <memory>
#include <vector>

#include "explicit/element_block.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class Tiles {
 public:
  // Cut the blocks, whose elements are numbered in the order of the blocks, into tiles.
  void cut(int n_nodes, const std::vector<std::unique_ptr<ElementBlock<Real>>>& blocks);

  int n() const { return static_cast<int>(tiles_.size()); }
  int n_rim_nodes() const { return static_cast<int>(rim_node_.size()); }
  // Room for the forces of the elements of any tile; one for each thread.
  AlignedArray<Real> make_scratch() const { return AlignedArray<Real>(scratch_size_); }

  // Advance the elements of a tile by dt and sum up their forces, as rows (n_nodes, 6) and in partial sums. Gives the
  // first element whose material law has failed, or -1.
  int advance(int tile, const Nodes<Real>& nodes, double dt, Real* scratch, Real* force);
  // Add up the partial sums of rim nodes [first, last); when all tiles have been advanced.
  void close_rims(int first, int last, Real* force) const;

 private:
  struct Tile {
    ElementBlock<Real>* block;
    int first, last;              // packs
    int numbered_from;            // number of the block's first element in the loop
    int nodes_first, nodes_last;  // in target_
  };
  void cut_blocks(const std::vector<std::unique_ptr<ElementBlock<Real>>>& blocks);

  std::vector<Tile> tiles_;
  std::size_t scratch_size_ = 0;  // of the largest tile
  // Nodes of the tiles, one tile after the other: where the sum goes, a row of the forces or, below zero, of partial_
  // (as -1 - row); and the entries to add up, offsets in the tile's forces.
  std::vector<int> target_, entry_start_, entry_;
  AlignedArray<Real> partial_;                           // (rows, 6) and two
  std::vector<int> rim_node_, rim_start_, rim_partial_;  // nodes on rims and their rows of partial_
};

}  // namespace presswork::explicit_dynamics
