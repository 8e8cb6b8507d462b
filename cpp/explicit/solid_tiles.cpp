// SPDX-License-Identifier: Apache-2.0
#include "explicit/solid_tiles.hpp"

#include <algorithm>
#include <cstring>

namespace presswork::explicit_dynamics {

namespace {

typedef double Pair __attribute__((vector_size(16)));

inline Pair load_pair(const double* from) {
  Pair p;
  std::memcpy(&p, from, sizeof p);
  return p;
}

}  // namespace

// 64 to 512 cells each, as equal as can be and their number even for any usual number of threads. They begin at
// multiples of the widest pack there is, whatever the pack compiled for.
void SolidTiles::cut_blocks(const std::vector<SolidBlock>& blocks) {
  constexpr int group = 8, group_packs = group / SolidBlock::lanes, even = 32;
  tiles_.clear();
  scratch_size_ = 0;
  int numbered_from = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const SolidBlock& block = blocks[b];
    const int groups = (block.n() + group - 1) / group;
    int n_tiles = (block.n() + 511) / 512;
    n_tiles = groups >= 8 * even ? (n_tiles + even - 1) / even * even : (groups + 7) / 8;
    for (int t = 0; t < n_tiles; ++t) {
      const auto bound = [&](std::int64_t i) {
        return std::min(block.n_packs(), static_cast<int>(i * groups / n_tiles) * group_packs);
      };
      tiles_.push_back({static_cast<int>(b), bound(t), bound(t + 1), numbered_from, 0, 0});
      const auto packs = static_cast<std::size_t>(tiles_.back().last - tiles_.back().first);
      scratch_size_ = std::max(scratch_size_, packs * SolidBlock::lanes * SolidBlock::force_record);
    }
    numbered_from += block.n();
  }
}

// Which tile each node belongs to, and what it adds up there.
void SolidTiles::cut(int n_nodes, const std::vector<SolidBlock>& blocks) {
  constexpr int none = -1, rim = -2, lanes = SolidBlock::lanes;
  cut_blocks(blocks);
  const auto for_each_use = [&](int t, auto&& use) {  // of a node by a cell of tile t: node, offset of its force
    const Tile& tile = tiles_[t];
    const SolidBlock& block = blocks[tile.block];
    const int each = block.nodes_each(), first = tile.first * lanes;
    for (int e = first; e < std::min(block.n(), tile.last * lanes); ++e)
      for (int a = 0; a < each; ++a)
        use(block.cells[std::size_t(each) * e + a], (e - first) * SolidBlock::force_record + 2 * a);
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
  partial_.assign(2 * std::size_t(n_partial), 0.0);
  rim_node_.clear(), rim_partial_.clear(), rim_start_.assign(1, 0);
  for (int node = 0; node < n_nodes; ++node) {
    if (rows[node].empty()) continue;
    rim_node_.push_back(node);
    rim_partial_.insert(rim_partial_.end(), rows[node].begin(), rows[node].end());
    rim_start_.push_back(static_cast<int>(rim_partial_.size()));
  }
}

void SolidTiles::sum_tile(const Tile& tile, const double* scratch, double* internal_force) {
  for (int i = tile.nodes_first; i < tile.nodes_last; ++i) {
    Pair sum{};
    for (int s = entry_start_[i]; s < entry_start_[i + 1]; ++s) sum += load_pair(scratch + entry_[s]);
    const int to = target_[i];
    std::memcpy(to >= 0 ? internal_force + 2 * std::size_t(to) : partial_.data() + 2 * std::size_t(-1 - to), &sum,
                sizeof sum);
  }
}

void SolidTiles::sum_rims(int first, int last, double* internal_force) const {
  for (int i = first; i < last; ++i) {
    Pair sum{};
    for (int s = rim_start_[i]; s < rim_start_[i + 1]; ++s)
      sum += load_pair(partial_.data() + 2 * std::size_t(rim_partial_[s]));
    std::memcpy(internal_force + 2 * std::size_t(rim_node_[i]), &sum, sizeof sum);
  }
}

}  // namespace presswork::explicit_dynamics
