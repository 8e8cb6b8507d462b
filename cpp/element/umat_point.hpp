// SPDX-License-Identifier: Apache-2.0
// A point whose law is a routine from a shared library: what it keeps, and one call of it, whatever its number of
// components. umat_response.hpp, umat_space.hpp and umat_layer.hpp make of it a point of a solid in the plane, of one
// in space, and a layer of a shell.
#pragma once

#include <algorithm>

#include "kinematics/increment.hpp"
#include "kinematics/stretch.hpp"
#include "material/umat.hpp"

namespace presswork {

// History of a point behind the routine's own state variables.
template <int N>
struct UmatHistory {
  static constexpr int F = 0;           // of the whole deformation, by columns
  static constexpr int strain = 9;      // sum of the turned increments (N)
  static constexpr int energy = 9 + N;  // elastic, plastic, creep per volume, as the routine keeps them
  static constexpr int heat = 12 + N;   // that the routine says it has generated in the last increment, per volume
  static constexpr int work = 13 + N;   // of the stress in the last increment, per volume, by the trapezoidal rule
  static constexpr int size = 14 + N;
};

// The lanes of one point in a pack.
struct UmatLanes {
  int count;                    // lanes beyond it repeat the last cell
  UmatPlace place[pack_width];  // where each is
  const double* history_n[pack_width];
  double* history[pack_width];  // n_state values, then UmatHistory
};

// The worst of what the calls of a law have told; status done while all is well.
struct LawFault {
  LawStatus status = LawStatus::done;
  int cell = -1;             // in the block
  double step_factor = 1.0;  // the least that was asked for

  void note(LawStatus other, int where, double factor) {
    if (other == LawStatus::smaller && factor < step_factor) step_factor = factor;
    if (static_cast<int>(other) > static_cast<int>(status)) status = other, cell = where;
  }
};

namespace umat {

// Rotation of an increment, as tensors of N components feel it.
template <int N>
struct Turn;

// The lamina frame turns with the material.
template <>
struct Turn<3> {
  void stress(const double in[3], double out[3]) const { std::copy_n(in, 3, out); }
  void strain(const double in[3], double out[3]) const { std::copy_n(in, 3, out); }
  void fill(double out[9]) const {
    constexpr double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::copy_n(one, 9, out);
  }
};

template <>
struct Turn<4> {
  double c, s;

  void stress(const double in[4], double out[4]) const { turn_stress(c, s, in, out); }
  void strain(const double in[4], double out[4]) const { turn_strain(c, s, in, out); }
  void fill(double out[9]) const {
    const double columns[9] = {c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0};
    std::copy_n(columns, 9, out);
  }
};

template <>
struct Turn<6> {
  double R[3][3];

  void stress(const double in[6], double out[6]) const { stretch::turn_tensor(R, in, out); }
  void strain(const double in[6], double out[6]) const {
    double tensor[6];
    for (int i = 0; i < 6; ++i) tensor[i] = i < 3 ? in[i] : 0.5 * in[i];
    stretch::turn_tensor(R, tensor, out);
    for (int i = 3; i < 6; ++i) out[i] *= 2.0;
  }
  void fill(double out[9]) const {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out[i + 3 * j] = R[i][j];
  }
};

// Calls the routine for one lane. F: of the increment, by columns; increment: of strain, in the axes that have not
// turned; stress: in those in, in the turned ones out, as the tangent in p.
template <int N>
LawStatus advance(const Umat& law, const UmatLanes& lanes, int lane, const Turn<N>& turn, const double F[9],
                  const double increment[N], double stress[N], double& eqps, UmatPoint& p) {
  using History = UmatHistory<N>;
  const double *history_n = lanes.history_n[lane], *tail_n = history_n + law.n_state, *F_n = tail_n + History::F;
  double *history = lanes.history[lane], *tail = history + law.n_state;
  double before[N], step[N], strain[N], whole[9];
  turn.stress(stress, before);
  turn.strain(tail_n + History::strain, p.strain);
  turn.strain(increment, p.increment);
  turn.fill(p.rotation);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      whole[i + 3 * j] = F[i] * F_n[3 * j] + F[i + 3] * F_n[1 + 3 * j] + F[i + 6] * F_n[2 + 3 * j];
  std::copy_n(before, N, p.stress);
  std::copy_n(F_n, 9, p.F_n);
  std::copy_n(whole, 9, p.F);
  std::copy_n(tail_n + History::energy, 3, p.energy);
  std::copy_n(history_n, law.n_state, history);
  for (int i = 0; i < N; ++i) step[i] = p.increment[i], strain[i] = p.strain[i] + step[i];
  const LawStatus status = law.call(N, lanes.place[lane], p, history);
  if (status != LawStatus::done) return status;
  std::copy_n(whole, 9, tail + History::F);
  std::copy_n(strain, N, tail + History::strain);
  std::copy_n(p.energy, 3, tail + History::energy);
  double work = 0.0;
  for (int i = 0; i < N; ++i) work += 0.5 * (before[i] + p.stress[i]) * step[i];
  tail[History::heat] = p.heat * lanes.place[lane].dt;
  tail[History::work] = work;
  std::copy_n(p.stress, N, stress);
  eqps = law.plastic_strain ? history[law.plastic_strain - 1] : 0.0;
  return status;
}

// Lanes of a pack that stand for no cell of their own repeat the last.
template <class... Values>
void repeat_last(int count, Values&... values) {
  for (int lane = count; lane < pack_width; ++lane) (values.set(lane, values[count - 1]), ...);
}

}  // namespace umat

}  // namespace presswork
