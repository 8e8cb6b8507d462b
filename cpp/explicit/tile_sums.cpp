// SPDX-License-Identifier: Apache-2.0
#include "explicit/tile_sums.hpp"

#include <algorithm>
#include <cstdint>
#include <type_traits>

namespace presswork::explicit_dynamics {

namespace {

typedef double Pair __attribute__((vector_size(16)));

// The numbers of a node as one vector; that of six takes in the two that follow.
template <int numbers>
using Sum = std::conditional_t<numbers == 6, Record, Pair>;
template <int numbers>
constexpr int beyond = numbers == 6 ? spare : 0;

template <int numbers, class Real>
inline Sum<numbers> load(const Real* from) {
  if constexpr (numbers == 6) {
    return load_record(from);
  } else {
    Pair p;
    std::memcpy(&p, from, sizeof p);
    return p;
  }
}
template <int numbers, class Real>
inline void store(const Sum<numbers>& sum, Real* to) {
  if constexpr (numbers == 6)
    store_record<numbers>(sum, to);
  else
    std::memcpy(to, &sum, sizeof sum);
}

}  // namespace

// Cuts the blocks into tiles: 64 to 512 elements, as equal as can be and their number even for any usual number of
// threads. They begin at multiples of the widest pack there is, whatever the pack compiled for.
template <class Real, int numbers>
void TileSums<Real, numbers>::cut_blocks(const std::vector<TiledBlock>& blocks) {
  constexpr int group = 16, even = 32;
  tiles_.clear();
  scratch_size_ = 0;
  int numbered_from = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto [n, lanes, nodes_each, record, connectivity] = blocks[b];
    const int groups = (n + group - 1) / group, n_packs = (n + lanes - 1) / lanes, group_packs = group / lanes;
    int n_tiles = (n + 511) / 512;
    n_tiles = groups >= 4 * even ? (n_tiles + even - 1) / even * even : (groups + 3) / 4;
    const auto bound = [&](std::int64_t i) {
      return std::min(n_packs, static_cast<int>(i * groups / n_tiles) * group_packs);
    };
    for (int t = 0; t < n_tiles; ++t) {
      tiles_.push_back({static_cast<int>(b), bound(t), bound(t + 1), numbered_from, 0, 0});
      const auto packs = static_cast<std::size_t>(bound(t + 1) - bound(t));
      scratch_size_ = std::max(scratch_size_, packs * lanes * record + beyond<numbers>);
    }
    numbered_from += n;
  }
}

// Which tile each node belongs to, and what it adds up there.
template <class Real, int numbers>
void TileSums<Real, numbers>::cut(int n_nodes, const std::vector<TiledBlock>& blocks) {
  constexpr int none = -1, rim = -2;
  cut_blocks(blocks);
  const auto for_each_use = [&](int t, auto&& use) {  // of a node by an element of tile t: node, offset of its force
    const Tile& tile = tiles_[t];
    const TiledBlock& block = blocks[tile.block];
    const int first = tile.first * block.lanes;
    for (int e = first; e < std::min(block.n, tile.last * block.lanes); ++e)
      for (int a = 0; a < block.nodes_each; ++a)
        use(block.connectivity[std::size_t(block.nodes_each) * e + a], (e - first) * block.record + a * numbers);
  };
  const int n_tiles = static_cast<int>(tiles_.size());
  std::vector<int> owner(n_nodes, none);
  for (int t = 0; t < n_tiles; ++t)
    for_each_use(t, [&](int node, int) { owner[node] = owner[node] == none || owner[node] == t ? t : rim; });

  std::vector<std::vector<int>> rows(n_nodes);  // of kept_
  std::vector<std::pair<int, int>> uses;        // node, offset
  int n_kept = 0;
  target_.clear(), entry_.clear(), entry_start_.assign(1, 0);
  for (int t = 0; t < n_tiles; ++t) {
    tiles_[t].nodes_first = static_cast<int>(target_.size());
    uses.clear();
    for_each_use(t, [&](int node, int offset) { uses.emplace_back(node, offset); });
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const int node = uses[i].first;
      if (i == 0 || uses[i - 1].first != node || owner[node] == rim) {
        if (i > 0) entry_start_.push_back(static_cast<int>(entry_.size()));
        if (owner[node] == rim) rows[node].push_back(n_kept);
        target_.push_back(owner[node] == rim ? -1 - n_kept++ : node);
      }
      entry_.push_back(uses[i].second);
    }
    entry_start_.push_back(static_cast<int>(entry_.size()));
    tiles_[t].nodes_last = static_cast<int>(target_.size());
  }
  kept_ = AlignedArray<Real>(std::size_t(numbers) * n_kept + beyond<numbers>);
  rim_node_.clear(), rim_kept_.clear(), rim_start_.assign(1, 0);
  for (int node = 0; node < n_nodes; ++node) {
    if (rows[node].empty()) continue;
    rim_node_.push_back(node);
    rim_kept_.insert(rim_kept_.end(), rows[node].begin(), rows[node].end());
    rim_start_.push_back(static_cast<int>(rim_kept_.size()));
  }
}

template <class Real, int numbers>
void TileSums<Real, numbers>::sum_tile(const Tile& tile, const Real* scratch, Real* force) {
  for (int i = tile.nodes_first; i < tile.nodes_last; ++i) {
    Sum<numbers> sum{};
    for (int s = entry_start_[i]; s < entry_start_[i + 1]; ++s) sum += load<numbers>(scratch + entry_[s]);
    const int to = target_[i];
    Real* row = to >= 0 ? force + std::size_t(numbers) * to : kept_.data() + std::size_t(numbers) * (-1 - to);
    store<numbers>(sum, row);
  }
}

template <class Real, int numbers>
void TileSums<Real, numbers>::close_rims(int first, int last, Real* force) const {
  for (int i = first; i < last; ++i) {
    Sum<numbers> sum{};
    for (int s = rim_start_[i]; s < rim_start_[i + 1]; ++s)
      sum += load<numbers>(kept_.data() + std::size_t(numbers) * rim_kept_[s]);
    store<numbers>(sum, force + std::size_t(numbers) * rim_node_[i]);
  }
}

template class TileSums<double, 6>;
template class TileSums<float, 6>;
template class TileSums<double, 2>;

}  // namespace presswork::explicit_dynamics
