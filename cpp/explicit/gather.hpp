// SPDX-License-Identifier: Apache-2.0
// Nodes of a pack of elements, lane by lane: positions, velocities, angular velocities, room between tools.
#pragma once

#include "explicit/space/nodes.hpp"
#include "tensor/records.hpp"

namespace presswork::explicit_dynamics {

// x: positions; in single precision those less the first node's, subtracted in double precision (elements use
// differences alone).
template <int count>
[[gnu::always_inline]] inline void gather_positions(const SpaceNodes<double>& nodes, const int* node,
                                                    Pack x[count][3]) {
  for (int a = 0; a < count; ++a, node += Pack::width) {
    const double* from[Pack::width];
    for (int lane = 0; lane < Pack::width; ++lane)
      from[lane] = nodes.position.data() + std::size_t(SpaceNodes<double>::position_stride) * node[lane];
    Pack four[4];
    load_records<4>(from, four);
    for (int i = 0; i < 3; ++i) x[a][i] = four[i];
  }
}
template <int count>
[[gnu::always_inline]] inline void gather_positions(const SpaceNodes<float>& nodes, const int* node,
                                                    FloatPack x[count][3]) {
  constexpr int width = FloatPack::width;
  alignas(64) float relative[count][width][4];
  for (int lane = 0; lane < width; ++lane) {
    const double* origin = nodes.position.data() + std::size_t(SpaceNodes<float>::position_stride) * node[lane];
    for (int a = 1; a < count; ++a) {
      const double* at =
          nodes.position.data() + std::size_t(SpaceNodes<float>::position_stride) * node[a * width + lane];
      for (int i = 0; i < 4; ++i) relative[a][lane][i] = static_cast<float>(at[i] - origin[i]);
    }
  }
  for (int i = 0; i < 3; ++i) x[0][i] = FloatPack(0.0f);
  for (int a = 1; a < count; ++a) {
    const float* from[width];
    for (int lane = 0; lane < width; ++lane) from[lane] = relative[a][lane];
    FloatPack four[4];
    load_records<4>(from, four);
    for (int i = 0; i < 3; ++i) x[a][i] = four[i];
  }
}

template <int count, class Real>
[[gnu::always_inline]] inline void gather_motion(const SpaceNodes<Real>& nodes, const int* node,
                                                 PackOf<Real> v[count][3], PackOf<Real> w[count][3]) {
  constexpr int width = PackOf<Real>::width;
  for (int a = 0; a < count; ++a, node += width) {
    const Real* from[width];
    for (int lane = 0; lane < width; ++lane)
      from[lane] = nodes.motion.data() + std::size_t(SpaceNodes<Real>::motion_stride) * node[lane];
    PackOf<Real> eight[8];
    load_records<8>(from, eight);
    for (int i = 0; i < 3; ++i) v[a][i] = eight[i], w[a][i] = eight[3 + i];
  }
}

template <int count, class Real>
[[gnu::always_inline]] inline void gather_room(const SpaceNodes<Real>& nodes, const int* node,
                                               PackOf<Real> room[count]) {
  constexpr int width = PackOf<Real>::width;
  for (int a = 0; a < count; ++a, node += width)
    for (int lane = 0; lane < width; ++lane) room[a].set(lane, static_cast<Real>(nodes.room[node[lane]]));
}

}  // namespace presswork::explicit_dynamics
