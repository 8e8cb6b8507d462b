// SPDX-License-Identifier: Apache-2.0
// Pieces of work shared out to threads: each works through a share of its own, the same in every cycle, so that its
// data stay in its cache, and one that has finished takes pieces from the end of another's. No thread then waits long
// for one that the machine holds up, or the pieces of which cost more.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

namespace presswork::explicit_dynamics {

class WorkShares {
 public:
  WorkShares(int n_pieces, int most_threads) : n_pieces_(n_pieces), shares_(most_threads) {}

  // Deal one of n threads its share, anew: by the thread itself, between the barriers of the last round and the next.
  void deal(int thread, int n) {
    const auto bound = [&](std::uint64_t t) { return t * n_pieces_ / n; };
    shares_[thread].rest.store(bound(thread) << 32 | bound(thread + 1), std::memory_order_relaxed);
  }

  // The next piece for a thread, or -1 when all are taken.
  int take(int thread) {
    const int n = static_cast<int>(shares_.size());
    for (int i = 0; i < n; ++i)
      if (const int piece = take_from((thread + i) % n, i == 0); piece >= 0) return piece;
    return -1;
  }

 private:
  struct alignas(64) Share {
    std::atomic<std::uint64_t> rest{0};  // first in the upper half, end in the lower
  };

  int take_from(int owner, bool front) {
    std::uint64_t rest = shares_[owner].rest.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint64_t first = rest >> 32, end = rest & 0xffffffff;
      if (first >= end) return -1;
      const std::uint64_t left = front ? (first + 1) << 32 | end : first << 32 | (end - 1);
      if (shares_[owner].rest.compare_exchange_weak(rest, left, std::memory_order_relaxed))
        return static_cast<int>(front ? first : end - 1);
    }
  }

  std::uint64_t n_pieces_;
  std::vector<Share> shares_;
};

}  // namespace presswork::explicit_dynamics
