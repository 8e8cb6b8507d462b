// SPDX-License-Identifier: Apache-2.0
// Shells of the explicit loop taken in tiles (tile_sums.hpp).
#pragma once

#include <memory>
#include <vector>

#include "explicit/element_block.hpp"
#include "explicit/tile_sums.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class Tiles {
 public:
  // Cut the blocks, whose elements are numbered in the order of the blocks, into tiles.
  void cut(int n_nodes, const std::vector<std::unique_ptr<ElementBlock<Real>>>& blocks) {
    std::vector<TiledBlock> views;
    blocks_.clear();
    for (const auto& block : blocks) {
      const int each = block->nodes_each();
      views.push_back({block->n(), block->lanes, each, each * freedoms, block->connectivity().data()});
      blocks_.push_back(block.get());
    }
    sums_.cut(n_nodes, views);
  }

  int n() const { return static_cast<int>(sums_.tiles().size()); }
  int n_rim_nodes() const { return sums_.n_rim_nodes(); }
  AlignedArray<Real> make_scratch() const { return sums_.make_scratch(); }

  // Advance the elements of a tile by dt and sum up their forces, as rows (n_nodes, 6) and in partial sums. Gives the
  // first element whose material law has failed, or -1.
  int advance(int number, const Nodes<Real>& nodes, double dt, Real* scratch, Real* force) {
    const Tile& tile = sums_.tiles()[number];
    const int failed = blocks_[tile.block]->advance(nodes, dt, tile.first, tile.last, scratch);
    sums_.sum_tile(tile, scratch, force);
    return failed < 0 ? -1 : tile.numbered_from + failed;
  }
  // Add up the partial sums of rim nodes [first, last); when all tiles have been advanced.
  void close_rims(int first, int last, Real* force) const { sums_.close_rims(first, last, force); }

 private:
  TileSums<Real, freedoms> sums_;
  std::vector<ElementBlock<Real>*> blocks_;
};

}  // namespace presswork::explicit_dynamics
