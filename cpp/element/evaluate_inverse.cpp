// SPDX-License-Identifier: Apache-2.0
#include "element/evaluate_inverse.hpp"

#include <algorithm>
#include <climits>

namespace presswork {

namespace {

constexpr int width = pack_width;

// One pack of triangles; T is Pack or Dual<Pack, 6>.
template <class T>
int evaluate_pack(const InverseBlock& b, const DeformationLaw& law, int pack, double* force, double* stiffness) {
  constexpr bool with_slopes = !std::is_same_v<T, Pack>;
  const InverseLayers layers{static_cast<int>(b.height.size()), b.height.data(), b.weight.data()};
  int cell[width];
  Pack edges[2][2], curvature[3];
  T blank[3][2], local[3][2];
  Formed<Pack> formed[most_inverse_layers];
  for (int lane = 0; lane < width; ++lane) cell[lane] = std::min(pack * width + lane, b.n - 1);
  for (int lane = 0; lane < width; ++lane) {
    for (int i = 0; i < 4; ++i) edges[i / 2][i % 2].set(lane, b.edges[4 * std::size_t(cell[lane]) + i]);
    for (int i = 0; i < 3; ++i) curvature[i].set(lane, b.curvature[3 * std::size_t(cell[lane]) + i]);
  }
  for (int k = 0; k < layers.n; ++k)
    for (int lane = 0; lane < width; ++lane) {
      const double* given = b.formed + 4 * (layers.n * std::size_t(cell[lane]) + k);
      for (int i = 0; i < 3; ++i) formed[k].strain[i].set(lane, given[i]);
      formed[k].hardened.set(lane, given[3]);
    }
  for (int i = 0; i < 6; ++i) {
    Pack place;
    for (int lane = 0; lane < width; ++lane) {
      const int node = b.triangles[3 * std::size_t(cell[lane]) + i / 2];
      place.set(lane, b.blank[2 * std::size_t(node) + i % 2]);
    }
    if constexpr (with_slopes)
      blank[i / 2][i % 2] = T::variable(place, i);
    else
      blank[i / 2][i % 2] = place;
  }
  Pack area2 = value_of(inverse_membrane(law, layers, b.thickness, formed, edges, curvature, blank, local));
  int failed = INT_MAX;
  for (int lane = 0; lane < width && pack * width + lane < b.n; ++lane) {
    const std::size_t c = cell[lane];
    if (!(area2[lane] > 0.0)) failed = std::min(failed, cell[lane]);
    const double *axes = b.axes + 6 * c, share = b.share[c];
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < 3; ++k)
        force[9 * c + 3 * a + k] =
            share * (axes[k] * value_of(local[a][0])[lane] + axes[3 + k] * value_of(local[a][1])[lane]);
    if constexpr (with_slopes) {
      for (int a = 0; a < 3; ++a) {
        const double* basis = b.bases + 6 * std::size_t(b.triangles[3 * c + a]);
        for (int i = 0; i < 2; ++i) {
          double along[2];
          for (int j = 0; j < 2; ++j) {
            along[j] = 0.0;
            for (int k = 0; k < 3; ++k) along[j] += basis[3 * i + k] * axes[3 * j + k];
          }
          for (int j = 0; j < 6; ++j)
            stiffness[(36 * std::size_t(pack) + 6 * (2 * a + i) + j) * width + lane] =
                share * (along[0] * local[a][0].slope[j][lane] + along[1] * local[a][1].slope[j][lane]);
        }
      }
    }
  }
  return failed;
}

}  // namespace

int evaluate_inverse(const InverseBlock& block, const DeformationLaw& law, double* force, double* stiffness) {
  const int n_packs = (block.n + width - 1) / width;
  int failed = INT_MAX;
#pragma omp parallel for schedule(static) reduction(min : failed)
  for (int pack = 0; pack < n_packs; ++pack) {
    const int cell = stiffness ? evaluate_pack<Dual<Pack, 6>>(block, law, pack, force, stiffness)
                               : evaluate_pack<Pack>(block, law, pack, force, nullptr);
    failed = std::min(failed, cell);
  }
  return failed == INT_MAX ? -1 : failed;
}

}  // namespace presswork
