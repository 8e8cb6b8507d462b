// SPDX-License-Identifier: Apache-2.0
// Sums over the threads of a block of `chunk`, in an order that is always the same: pairs of lanes of a warp, then the
// warps in turn. The first thread gets the sum.
#pragma once

#include "device/passes.hpp"

namespace presswork::device {

template <class Number, class Join>
__device__ Number reduce(Number own, const Join& join) {
  constexpr int warp = 32, warps = chunk / warp;
  __shared__ Number of_warp[warps];
  for (int step = warp / 2; step > 0; step /= 2) own = join(own, __shfl_down_sync(0xffffffffu, own, step));
  if (threadIdx.x % warp == 0) of_warp[threadIdx.x / warp] = own;
  __syncthreads();
  if (threadIdx.x == 0)
    for (int w = 1; w < warps; ++w) own = join(own, of_warp[w]);
  __syncthreads();  // it may be asked for again
  return own;
}

// All threads of the block must call it. A block that no tool touches ends at once.
inline __device__ ContactSums reduce_sums(const ContactSums& own) {
  const auto add = [](double a, double b) { return a + b; };
  const ContactSums none;
  const bool any = own.friction != 0.0 || own.damping != 0.0 || own.squeeze != 0.0 || own.force[0] != 0.0 ||
                   own.force[1] != 0.0 || own.force[2] != 0.0 || own.lost != none.lost;
  if (!__syncthreads_or(any)) return none;
  ContactSums sum;
  sum.friction = reduce(own.friction, add), sum.damping = reduce(own.damping, add);
  sum.squeeze = reduce(own.squeeze, add);
  for (int i = 0; i < 3; ++i) sum.force[i] = reduce(own.force[i], add);
  sum.lost = reduce(own.lost, [](int a, int b) { return a < b ? a : b; });
  return sum;
}

// All threads of the block must call it. A block that no wall touches ends at once.
inline __device__ WallSums reduce_wall_sums(const WallSums& own) {
  if (!__syncthreads_or(own.of[0] != 0.0 || own.of[1] != 0.0 || own.of[2] != 0.0 || own.of[3] != 0.0)) return {};
  WallSums sum;
  for (int i = 0; i < 4; ++i) sum.of[i] = reduce(own.of[i], [](double a, double b) { return a + b; });
  return sum;
}

inline __device__ double reduce_largest(double own) {
  return reduce(own, [](double a, double b) { return a > b ? a : b; });
}

inline __device__ Found reduce_found(const Found& own) {
  Found all;
  for (int i = 0; i < 5; ++i) all.sum[i] = reduce(own.sum[i], [](double a, double b) { return a + b; });
  all.most = reduce(own.most, [](double a, double b) { return a > b ? a : b; });
  all.first = reduce(own.first, [](int a, int b) { return a < b ? a : b; });
  return all;
}

}  // namespace presswork::device
