// SPDX-License-Identifier: Apache-2.0
#include "explicit/tiles.hpp"

#include <algorithm>
#include <cstdint>

namespace presswork::explicit_dynamics {

// Cuts the blocks into tiles: 64 to 512 elements, as equal as can be and their number even for any usual number of
// threads. They begin at multiples of the widest pack there is, whatever the pack compiled for.
template <class Real>
void Tiles<Real>::cut_blocks(const std::vector<std::unique_ptr<ElementBlock<Real>>>& blocks) {
  constexpr int group = 16, group_packs = group / ElementBlock<Real>::lanes, even = 32;
  tiles_.clear();
  scratch_size_ = 0;
  int numbered_from = 0;
  for (const auto& block : blocks) {
    const int groups = (block->n() + group - 1) / group;
    int n_tiles = (block->n() + 511) / 512;
    n_tiles = groups >= 4 * even ? (n_tiles + even - 1) / even * even : (groups + 3) / 4;
    for (int t = 0; t < n_tiles; ++t) {
      const auto bound = [&](std::int64_t i) {
        return std::min(block->n_packs(), static_cast<int>(i * groups / n_tiles) * group_packs);
      };
      tiles_.push_back({block.get(), bound(t), bound(t + 1), numbered_from, 0, 0});
      const auto packs = static_cast<std::size_t>(tiles_.back().last - tiles_.back().first);
      scratch_size_ =
          std::max(scratch_size_, packs * ElementBlock<Real>::lanes * block->nodes_each() * freedoms + spare);
    }
    numbered_from += block->n();
  }
}

// Which tile each node belongs to, and what it adds up there.
template <class Real>
void Tiles<Real>::cut(int n_nodes, const std::vector<std::unique_ptr<ElementBlock<Real>>>& blocks) {
  constexpr int none = -1, rim = -2, lanes = ElementBlock<Real>::lanes;
  cut_blocks(blocks);
  const auto for_each_use = [&](int t, auto&& use) {  // of a node by an element of tile t: node, offset of its force
    const Tile& tile = tiles_[t];
    const int each = tile.block->nodes_each(), first = tile.first * lanes;
    for (int e = first; e < std::min(tile.block->n(), tile.last * lanes); ++e)
      for (int a = 0; a < each; ++a)
        use(tile.block->connectivity()[std::size_t(each) * e + a], ((e - first) * each + a) * freedoms);
  };
  const int n_tiles = static_cast<int>(tiles_.size());
  std::vector<int> owner(n_nodes, none);
  for (int t = 0; t < n_tiles; ++t)
    for_each_use(t, [&](int node, int) { owner[node] = owner[node] == none || owner[node] == t ? t : rim; });

  std::vector<std::vector<int>> rows(n_nodes);  // of partial_
  std::vector<std::pair<int, int>> uses;        // node, offset
  int n_partial = 0;
  target_.clear(), entry_.clear(), entry_start_.assign(1, 0);
  for (int t = 0; t < n_tiles; ++t) {
    tiles_[t].nodes_first = static_cast<int>(target_.size());
    uses.clear();
    for_each_use(t, [&](int node, int offset) { uses.emplace_back(node, offset); });
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const int node = uses[i].first;
      if (i == 0 || uses[i - 1].first != node) {
        if (i > 0) entry_start_.push_back(static_cast<int>(entry_.size()));
        if (owner[node] == rim) rows[node].push_back(n_partial);
        target_.push_back(owner[node] == rim ? -1 - n_partial++ : node);
      }
      entry_.push_back(uses[i].second);
    }
    entry_start_.push_back(static_cast<int>(entry_.size()));
    tiles_[t].nodes_last = static_cast<int>(target_.size());
  }
  partial_ = AlignedArray<Real>(row_at(n_partial) + spare);
  rim_node_.clear(), rim_partial_.clear(), rim_start_.assign(1, 0);
  for (int node = 0; node < n_nodes; ++node) {
    if (rows[node].empty()) continue;
    rim_node_.push_back(node);
    rim_partial_.insert(rim_partial_.end(), rows[node].begin(), rows[node].end());
    rim_start_.push_back(static_cast<int>(rim_partial_.size()));
  }
}

template <class Real>
int Tiles<Real>::advance(int number, const Nodes<Real>& nodes, double dt, Real* scratch, Real* force) {
  const Tile& tile = tiles_[number];
  const int failed = tile.block->advance(nodes, dt, tile.first, tile.last, scratch);
  for (int i = tile.nodes_first; i < tile.nodes_last; ++i) {
    Record sum{};
    for (int s = entry_start_[i]; s < entry_start_[i + 1]; ++s) sum += load_record(scratch + entry_[s]);
    const int to = target_[i];
    store_record<freedoms>(sum, to >= 0 ? force + row_at(to) : partial_.data() + row_at(-1 - to));
  }
  return failed < 0 ? -1 : tile.numbered_from + failed;
}

template <class Real>
void Tiles<Real>::close_rims(int first, int last, Real* force) const {
  for (int i = first; i < last; ++i) {
    Record sum{};
    for (int s = rim_start_[i]; s < rim_start_[i + 1]; ++s)
      sum += load_record(partial_.data() + row_at(rim_partial_[s]));
    store_record<freedoms>(sum, force + row_at(rim_node_[i]));
  }
}

template class Tiles<double>;
template class Tiles<float>;

}  // namespace presswork::explicit_dynamics
