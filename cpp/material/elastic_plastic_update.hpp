// SPDX-License-Identifier: Apache-2.0
// Definitions of elastic_plastic.hpp, compiled once for each number of components: elastic_plastic_{3,4,6}.cpp.
#pragma once

#include <algorithm>

#include "material/elastic_plastic.hpp"
#include "material/mises_sheet.hpp"

namespace presswork {

namespace elastic_plastic {

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
void update_range(const ElasticPlastic<N>& law, std::size_t n, const double* strain, double dt,
                  const double* temperature, const double* mixture, double* stress, double* history, double* thickness,
                  double* tangent, std::uint8_t* failed) {
  const std::size_t size = law.history_size();
  std::vector<T> state(2 * (N + size));
  T *s0 = state.data(), *s1 = s0 + N + size;
  for (std::size_t first = 0; first < n; first += width) {
    const int lanes = static_cast<int>(std::min<std::size_t>(width, n - first));
    LawInput<N, T> in;
    T D[N][N];
    in.dt = dt;
    for (int i = 0; i < N; ++i) {
      load(in.strain[i], strain + N * first + i, lanes, N);
      load(s0[i], stress + N * first + i, lanes, N);
    }
    load(in.temperature, temperature + first, lanes, 1);
    T given[mixture_size];
    if (mixture) {
      for (int i = 0; i < mixture_size; ++i) load(given[i], mixture + mixture_size * first + i, lanes, mixture_size);
      in.mixture = given;
    }
    for (std::size_t i = 0; i < size; ++i) load(s0[N + i], history + size * first + i, lanes, size);
    Mask<T> lost;
    if constexpr (N == 3) {
      T across;
      lost = update_sheet(law, in, s0, s1, across, tangent ? D : nullptr);
      store(across, thickness + first, lanes, 1);
    } else {
      lost = update(law, in, s0, s1, tangent ? D : nullptr);
    }
    for (int i = 0; i < N; ++i) store(s1[i], stress + N * first + i, lanes, N);
    for (std::size_t i = 0; i < size; ++i) store(s1[N + i], history + size * first + i, lanes, size);
    if (tangent)
      for (int i = 0; i < N * N; ++i) store(D[i / N][i % N], tangent + N * N * first + i, lanes, N * N);
    for (int lane = 0; lane < lanes; ++lane) failed[first + lane] = lane_of(lost, lane);
  }
}

}  // namespace elastic_plastic

template <int N, class T>
PRESSWORK_DEVICE Mask<T> update(const ElasticPlastic<N>& law, const LawInput<N, T>& in, const T* s0, T* s1,
                                T (*tangent)[N]) {
  const auto run = [&](const Elasticity<N, T>& elastic, const LawInput<N, T>& given, const T* from) {
    if constexpr (N == 3 && is_of_doubles<T>)
      if (!tangent && law.is_plain()) return return_mises_sheet(law.flow, elastic, given, from, s1);
    return choose(law.yield, [&](const auto& yield) {
      return choose(law.kinematic, [&](const auto& kinematic) {
        return return_to_yield(yield, kinematic, law.flow, elastic, given, from, s1, tangent);
      });
    });
  };
  const bool heats = law.thermoelastic.active();
  if (!heats && !law.phases) return run(law.elasticity(s0[N]), in, s0);
  const T* mixture = law.phases ? in.mixture : nullptr;
  const Heated<N, T> heated(law, in.temperature, s0, mixture);
  T stress[N];
  for (int i = 0; i < N; ++i) stress[i] = s0[i];
  LawInput<N, T> own = in;
  heated.take_off(in.strain, own.strain);
  const Mask<T> failed = run(heated.elastic, own, heated.state);
  for (int i = 0; i < N; ++i) s1[i] = select(failed, stress[i], s1[i] * heated.flow);
  if (mixture && tangent)
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) tangent[i][j] = tangent[i][j] * heated.flow;
  if (law.phases)
    for (int k = 0, at = law.mixture_at(); k < 2; ++k)
      s1[at + k] = mixture ? select(failed, heated.state[at + k], mixture[k]) : heated.state[at + k];
  const int last = law.state_size() - 1;
  if (heats) s1[last] = select(failed, heated.state[last], heated.temperature - T(law.flow.thermal.start));
  return failed;
}

template <int N>
void update_points(const ElasticPlastic<N>& law, std::size_t n, const double* strain, double dt,
                   const double* temperature, const double* mixture, double* stress, double* history, double* thickness,
                   double* tangent, std::uint8_t* failed, bool packed) {
  auto run = packed ? elastic_plastic::update_range<Pack, pack_width, N> : elastic_plastic::update_range<double, 1, N>;
  run(law, n, strain, dt, temperature, mixture, stress, history, thickness, tangent, failed);
}

template <int N>
void differentiate_points(const ElasticPlastic<N>& law, std::size_t n, const double* strain, double dt,
                          const double* temperature, const double* mixture, const double* stress, const double* history,
                          double* derivative) {
  using D = Dual<double, N>;
  const std::size_t size = law.history_size();
  std::vector<D> s0(N + size), s1(N + size);
  for (std::size_t point = 0; point < n; ++point) {
    LawInput<N, D> in;
    in.dt = dt, in.temperature = D(temperature[point]);
    D given[mixture_size];
    if (mixture) {
      for (int i = 0; i < mixture_size; ++i) given[i] = D(mixture[mixture_size * point + i]);
      in.mixture = given;
    }
    for (int i = 0; i < N; ++i) {
      in.strain[i] = D::variable(strain[N * point + i], i);
      s0[i] = D(stress[N * point + i]);
    }
    for (std::size_t i = 0; i < size; ++i) s0[N + i] = D(history[size * point + i]);
    update<N, D>(law, in, s0.data(), s1.data(), nullptr);
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) derivative[N * (N * point + i) + j] = s1[i].slope[j];
  }
}

}  // namespace presswork
