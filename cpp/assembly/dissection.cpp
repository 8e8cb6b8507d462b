// SPDX-License-Identifier: Apache-2.0
#include "assembly/dissection.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

namespace presswork {

namespace {

constexpr int leaf = 4;               // nodes that are not dissected any more
constexpr double of_imbalance = 4.0;  // factor on a separator's size for the square of what the halves differ by
constexpr int low = 0, high = 1, none = -1;

class Dissection {
 public:
  Dissection(const double* points, int n, const int* indptr, const int* indices, int freedoms)
      : points_(points), nodes_(n), begin_(n + 1, 0), half_(n, none), match_(n, none), from_(n, none), trial_(n) {
    std::iota(nodes_.begin(), nodes_.end(), 0);
    const auto for_edges = [&](auto&& act) {
      for (int a = 0; a < n; ++a) {
        int last = a;
        for (int k = indptr[freedoms * a]; k < indptr[freedoms * a + 1]; ++k) {
          const int b = indices[k] / freedoms;
          if (b > last) act(a, last = b);
        }
      }
    };
    for_edges([&](int a, int b) { ++begin_[a + 1], ++begin_[b + 1]; });
    for (int a = 0; a < n; ++a) begin_[a + 1] += begin_[a];
    beside_.resize(begin_[n]);
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for_edges([&](int a, int b) { beside_[next[a]++] = b, beside_[next[b]++] = a; });
  }

  std::vector<int> run() {
    order(nodes_);
    return std::move(nodes_);
  }

 private:
  struct Cut {
    int n_low = 0, n_high = 0;
    double cost = 0.0;
  };

  std::span<const int> neighbours(int node) const {
    return {beside_.data() + begin_[node], static_cast<std::size_t>(begin_[node + 1] - begin_[node])};
  }

  // Puts nodes into the order of elimination: one half, the other half, what separates them.
  void order(std::span<int> own) {
    if (own.size() <= leaf) return;
    const std::span<int> trial = std::span(trial_).first(own.size());
    Cut best = cut(own, 0);
    std::copy(own.begin(), own.end(), trial.begin());
    if (const Cut other = cut(trial, 1); other.cost < best.cost) {
      best = other;
      std::copy(trial.begin(), trial.end(), own.begin());
    }
    order(own.first(best.n_low));
    order(own.subspan(best.n_low, best.n_high));
  }

  // Puts the nodes of the lower half along an axis first, those of the upper half next, the separator last.
  Cut cut(std::span<int> own, int axis) {
    const auto middle = own.begin() + own.size() / 2;
    std::nth_element(own.begin(), middle, own.end(), [&](int a, int b) {
      const double *at = points_ + 2 * std::size_t(a), *other = points_ + 2 * std::size_t(b);
      if (at[axis] != other[axis]) return at[axis] < other[axis];
      return at[1 - axis] != other[1 - axis] ? at[1 - axis] < other[1 - axis] : a < b;
    });
    for (auto it = own.begin(); it != own.end(); ++it) half_[*it] = it < middle ? low : high;
    separate({own.begin(), middle});
    const auto kept = [&](int side) { return [this, side](int node) { return half_[node] == side; }; };
    const auto highs = std::partition(own.begin(), own.end(), kept(low));
    const auto rest = std::partition(highs, own.end(), kept(high));
    Cut found{static_cast<int>(highs - own.begin()), static_cast<int>(rest - highs), 0.0};
    const double differ = static_cast<double>(found.n_low - found.n_high) / own.size();
    found.cost = static_cast<double>(own.end() - rest) * (1.0 + of_imbalance * differ * differ);
    for (int node : own) half_[node] = none;
    return found;
  }

  // Takes the least separator out of its halves.
  void separate(std::span<const int> lows) {
    // 1. a maximum matching of the edges between the halves: ways from free nodes that alternate, breadth first
    border_.clear();
    for (int node : lows)
      if (std::ranges::any_of(neighbours(node), [&](int other) { return half_[other] == high; }))
        border_.push_back(node);
    for (int node : border_) {
      reach({&node, 1}, true);
      for (int other : reached_) from_[other] = none;
    }
    // 2. Koenig's cover: upper nodes that alternating ways reach from free lower ones, and lower ones out of reach
    std::vector<int> free;
    for (int node : border_)
      if (match_[node] == none) free.push_back(node);
    reach(free, false);
    for (int node : border_) {
      const bool is_reached = match_[node] == none || from_[match_[node]] != none;
      if (!is_reached) half_[node] = none;
    }
    for (int other : reached_) half_[other] = none, from_[other] = none;
    for (int node : border_) {
      if (match_[node] != none) match_[match_[node]] = none;
      match_[node] = none;
    }
  }

  // Finds the upper nodes on alternating ways from lower ones; if it may grow, the first free one enlarges the
  // matching.
  void reach(std::span<const int> starts, bool may_grow) {
    reached_.clear();
    front_.assign(starts.begin(), starts.end());
    for (std::size_t k = 0; k < front_.size(); ++k)
      for (int other : neighbours(front_[k])) {
        if (half_[other] != high || from_[other] != none) continue;
        from_[other] = front_[k];
        reached_.push_back(other);
        if (match_[other] != none) {
          front_.push_back(match_[other]);
        } else if (may_grow) {
          for (int at = other; at != none;) {
            const int node = from_[at], before = match_[node];
            match_[node] = at, match_[at] = node;
            at = before;
          }
          return;
        }
      }
  }

  const double* points_;
  std::vector<int> nodes_, begin_, beside_;
  std::vector<int> half_, match_, from_;  // of each node: its half, its partner, the lower node it was reached from
  std::vector<int> trial_, border_, front_, reached_;
};

}  // namespace

std::vector<int> dissect(const double* points, int n, const int* indptr, const int* indices, int freedoms) {
  return Dissection(points, n, indptr, indices, freedoms).run();
}

}  // namespace presswork
