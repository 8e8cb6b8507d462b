// SPDX-License-Identifier: Apache-2.0
// Section of a shell: points through the thickness, and the kinds of law that they can carry.
//
// In-plane tensors are kept as sum xx + yy, difference xx - yy and shear xy (of strain: engineering shear), in which
// isotropic laws are diagonal. A law has
//   rows()                                     values that a point keeps: sum, difference, shear of stress, then others
//   advance(sum, difference, shear, now, k, state, rounding)  updates those of layer k by increments of strain; gives
//                                              that of thickness strain. rounding: of those values in single precision,
//                                              which is carried to the next increment
//   young_at(state)                            Young's modulus at present
//   young, poisson                             elasticity, for transverse shear, stable step and hourglass control
//   can_fail                                   whether it may find no stress: its sum is then NaN
#pragma once

#include "element/umat_layer.hpp"
#include "material/tabulated_mises.hpp"

namespace presswork {

// Which shells a pack has, for laws from shared libraries, and what the calls told.
struct ShellPlaces {
  int first = 0;    // in the block
  UmatLanes lanes;  // places alone; coordinates of the centre
  LawFault fault = {};
};

// What acts on the layers of a point in a step, beside strain.
template <class T>
struct LayerConditions {
  double dt;                       // [s]
  const T* temperature = nullptr;  // given to each layer [degrees C]; null: that of the law's start
  int point = 0;                   // in the plane
  ShellPlaces* places = nullptr;   // null but for laws from shared libraries
  double slower = 1.0;             // by which the process takes longer than it is computed
  std::ptrdiff_t stride = 1;       // from the temperature of a layer to that of the next

  // Time of the process, by which laws take their rates [s].
  PRESSWORK_DEVICE double law_dt() const { return dt * slower; }
  PRESSWORK_DEVICE T temperature_or(double start, int layer) const {
    return temperature ? temperature[layer * stride] : T(start);
  }
  // those of another point in the plane, of so many layers each
  PRESSWORK_DEVICE LayerConditions at_point(int other, int layers) const {
    return {dt, temperature ? temperature + other * layers * stride : nullptr, other, places, slower, stride};
  }
};

// Any SheetLaw, always in double precision. x of its frame is the frame's first axis.
struct GeneralSheet {
  static constexpr bool can_fail = true;
  static constexpr int most_rows = 3 + most_kept<3>;
  SheetLaw law;
  double young = law.young, poisson = law.poisson;

  PRESSWORK_DEVICE int rows() const { return 3 + law.history_size(); }

  template <class T>
  PRESSWORK_DEVICE T young_at(const T* state) const {
    return law.young_at(state[3]);
  }
  PRESSWORK_DEVICE float young_at(const float* state) const {
    return static_cast<float>(law.young_at(double(state[3])));
  }
#if !defined(__CUDACC__)
  FloatPack young_at(const FloatPack* state) const {
    FloatPack young;
    for (int half = 0; half < 2; ++half) narrow(law.young_at(widen(state[3], half)), half, young);
    return young;
  }
#endif

  template <class T>
  PRESSWORK_DEVICE T advance(T sum, T difference, T shear, const LayerConditions<T>& now, int layer, T* state,
                             T* = nullptr) const {
    const LawInput<3, T> in{{T(0.5) * (sum + difference), T(0.5) * (sum - difference), shear},
                            now.law_dt(),
                            now.temperature_or(law.flow.thermal.start, layer)};
    const T xx = T(0.5) * (state[0] + state[1]), yy = T(0.5) * (state[0] - state[1]);
    T across;
    state[0] = xx, state[1] = yy;
    auto failed = update_sheet(law, in, state, state, across, static_cast<T(*)[3]>(nullptr));
    const T s_xx = state[0], s_yy = state[1];
    state[0] = select(failed, T(NAN), s_xx + s_yy);
    state[1] = s_xx - s_yy;
    return across;
  }

  PRESSWORK_DEVICE float advance(float sum, float difference, float shear, const LayerConditions<float>& now, int layer,
                                 float* state, float* rounding) const {
    double wide[most_rows];
    const double degrees = now.temperature ? double(now.temperature[layer * now.stride]) : law.flow.thermal.start;
    for (int i = 0; i < rows(); ++i) wide[i] = double(state[i]) + rounding[i];
    const LayerConditions<double> own{now.law_dt(), &degrees};
    const double across = advance(double(sum), double(difference), double(shear), own, 0, wide);
    for (int i = 0; i < rows(); ++i) {
      state[i] = static_cast<float>(wide[i]);
      rounding[i] = static_cast<float>(wide[i] - state[i]);
    }
    return static_cast<float>(across);
  }

#if !defined(__CUDACC__)
  FloatPack advance(FloatPack sum, FloatPack difference, FloatPack shear, const LayerConditions<FloatPack>& now,
                    int layer, FloatPack* state, FloatPack* rounding) const {
    Pack wide[most_rows];
    const FloatPack degrees = now.temperature_or(law.flow.thermal.start, layer);
    FloatPack across;
    for (int half = 0; half < 2; ++half) {
      for (int i = 0; i < rows(); ++i) wide[i] = widen(state[i], half) + widen(rounding[i], half);
      const Pack given = widen(degrees, half);
      const LayerConditions<Pack> own{now.law_dt(), &given};
      narrow(advance(widen(sum, half), widen(difference, half), widen(shear, half), own, 0, wide), half, across);
      for (int i = 0; i < rows(); ++i) {
        narrow(wide[i], half, state[i]);
        narrow(wide[i] - widen(state[i], half), half, rounding[i]);
      }
    }
    return across;
  }
#endif
};

#if !defined(__CUDACC__)

// A routine from a shared library, in double precision alone. A layer keeps the equivalent plastic strain, the
// routine's state variables and UmatHistory<3>.
struct UserSheet {
  static constexpr bool can_fail = true;
  SheetUmat law;
  double young = law.young, poisson = law.poisson;

  int rows() const { return 3 + law.history_size(); }
  template <class T>
  T young_at(const T*) const {
    return T(young);
  }

  Pack advance(Pack sum, Pack difference, Pack shear, const LayerConditions<Pack>& now, int layer, Pack* state,
               Pack* = nullptr) const {
    const int kept = law.history_size() - 1;
    thread_local std::vector<double> history;
    history.resize(std::size_t(2) * kept * pack_width);
    UmatLanes& lanes = now.places->lanes;
    Pack across(0.0);
    for (int lane = 0; lane < lanes.count; ++lane) {
      double* before = &history[std::size_t(2) * kept * lane];
      for (int i = 0; i < kept; ++i) before[i] = state[4 + i][lane];
      lanes.history_n[lane] = before, lanes.history[lane] = before + kept;
      UmatPlace& place = lanes.place[lane];
      place.dt = now.law_dt(), place.point = now.point + 1, place.section_point = layer + 1;
      const double strain[3] = {0.5 * (sum[lane] + difference[lane]), 0.5 * (sum[lane] - difference[lane]),
                                shear[lane]};
      double stress[3] = {0.5 * (state[0][lane] + state[1][lane]), 0.5 * (state[0][lane] - state[1][lane]),
                          state[2][lane]};
      double eqps = 0.0, thickness = 0.0;
      UmatPoint p{};
      const LawStatus status = umat::advance_layer(law, lanes, lane, strain, stress, eqps, thickness, p);
      if (status != LawStatus::done) {
        now.places->fault.note(status, now.places->first + lane, p.step_factor);
        stress[0] = NAN;
      }
      state[0].set(lane, stress[0] + stress[1]), state[1].set(lane, stress[0] - stress[1]);
      state[2].set(lane, stress[2]), state[3].set(lane, eqps), across.set(lane, thickness);
      for (int i = 0; i < kept; ++i) state[4 + i].set(lane, lanes.history[lane][i]);
    }
    for (int i = 0; i < 4 + kept; ++i) umat::repeat_last(lanes.count, state[i]);
    umat::repeat_last(lanes.count, across);
    return across;
  }
};

#endif

struct FastMises : TabulatedMises {
  static constexpr bool can_fail = false;
  PRESSWORK_DEVICE static constexpr int rows() { return 4; }

  template <class T>
  PRESSWORK_DEVICE T young_at(const T*) const {
    return T(young);
  }

  template <class T>
  PRESSWORK_INLINE T advance(T sum, T difference, T shear, const LayerConditions<T>&, int, T* state, T* rounding,
                             T* squares = nullptr) const {
    return TabulatedMises::advance(sum, difference, shear, state, rounding, squares);
  }
};

inline constexpr double negligible_square = 1e-12;   // [MPa2]: square of a stress that is none
inline constexpr double elastic_ratio = 1.0 - 2e-6;  // of stress to trial stress: what is more is round-off of floats

// Points through the thickness: heights in half thicknesses, -1 to 1, and weights that add up to one.
struct LayerRule {
  static constexpr int most_points = 51;
  int points = 0;
  double height[most_points], weight[most_points];
};

// The layers of a section one behind the other, as packs keep them: (points, rows); behind those of all points of the
// element, in single precision, as many rows of rounding. open: the values of a layer, with `rounding` theirs; skip:
// goes on to the layers of the next point in the plane.
template <class T>
struct LayersInRow {
  T* first;
  int rows, all;  // of a layer, of the element
  T* rounding = nullptr;
  PRESSWORK_INLINE T* open(int k) {
    if constexpr (is_single<T>) rounding = first + all + k * rows;
    return first + k * rows;
  }
  PRESSWORK_DEVICE void close(int, const T*) const {}
  PRESSWORK_DEVICE void skip(int layers) { first += layers * rows; }
};

// Those of a law of so many rows, each value `stride` behind the one before, as neighbouring lanes of a GPU keep them:
// one layer at a time is in registers. Without `fixed` the number of rows is known in the run alone.
template <class T, int most, bool fixed>
struct LayersApart {
  T* first;
  std::ptrdiff_t stride;
  int in_run, all;
  T now[most], rounding[is_single<T> ? most : 1];
  PRESSWORK_INLINE int rows() const { return fixed ? most : in_run; }
  PRESSWORK_INLINE T* open(int k) {
    for (int i = 0; i < rows(); ++i) now[i] = first[(k * rows() + i) * stride];
    if constexpr (is_single<T>)
      for (int i = 0; i < rows(); ++i) rounding[i] = first[(all + k * rows() + i) * stride];
    return now;
  }
  PRESSWORK_INLINE void close(int k, const T* point) const {
    for (int i = 0; i < rows(); ++i) first[(k * rows() + i) * stride] = point[i];
    if constexpr (is_single<T>)
      for (int i = 0; i < rows(); ++i) first[(all + k * rows() + i) * stride] = rounding[i];
  }
  PRESSWORK_INLINE void skip(int layers) { first += layers * rows() * stride; }
};

// points: layers of the element.
template <class T>
PRESSWORK_INLINE auto layers_apart(const FastMises& law, int points, T* first, std::ptrdiff_t stride) {
  return LayersApart<T, FastMises::rows(), true>{first, stride, law.rows(), points * law.rows(), {}, {}};
}
template <class T>
PRESSWORK_INLINE auto layers_apart(const GeneralSheet& law, int points, T* first, std::ptrdiff_t stride) {
  return LayersApart<T, GeneralSheet::most_rows, false>{first, stride, law.rows(), points * law.rows(), {}, {}};
}
template <class T, class Law>
PRESSWORK_INLINE LayersInRow<T> layers_in_row(const Law& law, int points, T* first) {
  return {first, law.rows(), points * law.rows()};
}

// Stress resultants of one shell [N/mm] and [N], sums and differences as above: of force, then of moment.
template <class T>
struct Resultants {
  T force[3], moment[3];
  T thickness_strain;  // increment, mean over the layers
  T work;              // of the increment, by area [N/mm]
};

// Square of von Mises' stress, by sum, difference and shear.
template <class T>
PRESSWORK_INLINE T mises_square(T sum, T difference, T shear) {
  return T(0.25) * sum * sum + T(0.75) * difference * difference + T(3.0) * shear * shear;
}

// Advance layer k; gives the increment of thickness strain. squares, unless null: of von Mises' stress of the elastic
// trial and after the increment.
template <class T, class Law>
PRESSWORK_INLINE T advance_layer(const Law& law, T sum, T difference, T shear, const LayerConditions<T>& now, int k,
                                 T* point, T* rounding, T* squares) {
  if constexpr (std::is_same_v<Law, FastMises>) {
    return law.advance(sum, difference, shear, now, k, point, rounding, squares);
  } else {
    if (squares) {
      const T young = law.young_at(point), d = young * T(1.0 / (1.0 + law.poisson));
      squares[0] = mises_square(point[0] + young * T(1.0 / (1.0 - law.poisson)) * sum, point[1] + d * difference,
                                point[2] + T(0.5) * d * shear);
    }
    const T across = law.advance(sum, difference, shear, now, k, point, rounding);
    if (squares) squares[1] = mises_square(point[0], point[1], point[2]);
    return across;
  }
}

// Advance all layers by the increments of membrane strain and curvature [1/mm]; layers: LayersInRow or LayersApart, in
// place.
// retained, unless null: what plastic flow leaves of stress beside that at the centre, as means over the layers of von
// Mises' stress after the step over the elastic trial's, for membrane and for bending; 1 in elastic steps.
template <class T, class Law, class Layers>
PRESSWORK_INLINE void advance_section(const Law& law, const LayerRule& rule, const T membrane[3], const T curvature[3],
                                      T thickness, const LayerConditions<T>& now, Layers layers, Resultants<T>& out,
                                      T* retained = nullptr) {
  T half = T(0.5) * thickness, bend[3], mean[3], turn[3], work(0.0), across(0.0);
  T found[2] = {T(negligible_square), T(negligible_square)}, trial[2] = {T(negligible_square), T(negligible_square)};
  for (int i = 0; i < 3; ++i) bend[i] = half * curvature[i], mean[i] = turn[i] = T(0.0);
  const int points = rule.points;
  for (int k = 0; k < points; ++k) {
    T* point = layers.open(k);
    const T height(rule.height[k]), weight(rule.weight[k]);
    T sum = membrane[0] + height * bend[0], difference = membrane[1] + height * bend[1];
    T shear = membrane[2] + height * bend[2];
    T before[3] = {point[0], point[1], point[2]};
    T squares[2];
    across += weight *
              advance_layer(law, sum, difference, shear, now, k, point, layers.rounding, retained ? squares : nullptr);
    if (retained) {
      const T of_bending = weight * height * height;
      trial[0] += weight * squares[0], trial[1] += of_bending * squares[0];
      found[0] += weight * squares[1], found[1] += of_bending * squares[1];
    }
    // stress : strain = (sums + differences)/2 + shear
    work += weight * (T(0.5) * ((before[0] + point[0]) * sum + (before[1] + point[1]) * difference) +
                      (before[2] + point[2]) * shear);
    for (int i = 0; i < 3; ++i) {
      T part = weight * point[i];
      mean[i] += part;
      turn[i] += height * part;
    }
    layers.close(k, point);
  }
  for (int i = 0; i < 3; ++i) out.force[i] = thickness * mean[i], out.moment[i] = thickness * half * turn[i];
  out.thickness_strain = across;
  out.work = T(0.5) * thickness * work;
  if (retained)
    for (int i = 0; i < 2; ++i) {
      T ratio = square_root(found[i] / trial[i]);
      retained[i] = select(ratio < T(elastic_ratio), ratio, T(1.0));
    }
}

}  // namespace presswork
