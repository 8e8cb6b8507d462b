// SPDX-License-Identifier: Apache-2.0
#include "material/anisotropic_law.hpp"

#include <algorithm>

namespace presswork {

namespace {

inline void load(double& to, const double* from, int, std::size_t) { to = *from; }
inline void store(const double& from, double* to, int, std::size_t) { *to = from; }
inline void load(Pack& to, const double* from, int lanes, std::size_t stride) {
  for (int lane = 0; lane < pack_width; ++lane) to.set(lane, from[std::min(lane, lanes - 1) * stride]);
}
inline void store(const Pack& from, double* to, int lanes, std::size_t stride) {
  for (int lane = 0; lane < lanes; ++lane) to[lane * stride] = from[lane];
}
inline bool lane_of(bool mask, int) { return mask; }
inline bool lane_of(Pack::Mask mask, int lane) { return mask[lane] != 0; }

template <class T, int width, int N>
void update_range(const AnisotropicLaw<N>& law, std::size_t n, const double* strain, double dt, const double* softening,
                  double* stress, double* history, double* thickness, double* tangent, std::uint8_t* failed) {
  const std::size_t size = law.history_size();
  std::vector<T> h(size);
  for (std::size_t first = 0; first < n; first += width) {
    const int lanes = static_cast<int>(std::min<std::size_t>(width, n - first));
    T e[N], s[N], soft, D[N][N];
    for (int i = 0; i < N; ++i) {
      load(e[i], strain + N * first + i, lanes, N);
      load(s[i], stress + N * first + i, lanes, N);
    }
    load(soft, softening + first, lanes, 1);
    for (std::size_t i = 0; i < size; ++i) load(h[i], history + size * first + i, lanes, size);
    Mask<T> lost;
    if constexpr (N == 3) {
      T across;
      lost = update_sheet(law, e, dt, soft, s, h.data(), across, tangent ? D : nullptr);
      store(across, thickness + first, lanes, 1);
    } else {
      lost = update_law(law, e, dt, soft, s, h.data(), tangent ? D : nullptr);
    }
    for (int i = 0; i < N; ++i) store(s[i], stress + N * first + i, lanes, N);
    for (std::size_t i = 0; i < size; ++i) store(h[i], history + size * first + i, lanes, size);
    if (tangent)
      for (int i = 0; i < N * N; ++i) store(D[i / N][i % N], tangent + N * N * first + i, lanes, N * N);
    for (int lane = 0; lane < lanes; ++lane) failed[first + lane] = lane_of(lost, lane);
  }
}

}  // namespace

template <int N>
void update_points(const AnisotropicLaw<N>& law, std::size_t n, const double* strain, double dt,
                   const double* softening, double* stress, double* history, double* thickness, double* tangent,
                   std::uint8_t* failed, bool packed) {
  auto update = packed ? update_range<Pack, pack_width, N> : update_range<double, 1, N>;
  update(law, n, strain, dt, softening, stress, history, thickness, tangent, failed);
}

template void update_points(const SheetLaw&, std::size_t, const double*, double, const double*, double*, double*,
                            double*, double*, std::uint8_t*, bool);
template void update_points(const SolidLaw&, std::size_t, const double*, double, const double*, double*, double*,
                            double*, double*, std::uint8_t*, bool);

}  // namespace presswork
