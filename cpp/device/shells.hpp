// SPDX-License-Identifier: Apache-2.0
// Shells in the device's cycle: those of one point, of four nodes with physical stabilisation and of three nodes, and
// MITC4+.
#pragma once

#include "device/elements.hpp"
#include "device/law_tables.hpp"
#include "element/shell3_one_point.hpp"
#include "element/shell4_mitc.hpp"
#include "material/elastic_plastic_update.hpp"

namespace presswork::device {

// Whether the law of a shell has found no stress: forces are no numbers though the motion is finite.
template <int corners, class Real>
PRESSWORK_INLINE bool lacks_stress(const Nodes<Real>& nodes, const Elements<Real>& of, int shell, const Real* force) {
  if (force[0] == force[0]) return false;
  Real x[corners][3], v[corners][3], w[corners][3];
  gather_corners<corners>(nodes, of, shell, x, v, w);
  bool finite = true;
  for (int a = 0; a < corners; ++a)
    for (int i = 0; i < 3; ++i)
      finite = finite && x[a][i] - x[a][i] == 0 && v[a][i] - v[a][i] == 0 && w[a][i] - w[a][i] == 0;
  return finite;
}

// Leave the forces of a shell at its corners, none where its law fails.
template <class Law, int corners, class Real>
PRESSWORK_INLINE void leave_shell_forces(const Nodes<Real>& nodes, const Elements<Real>& of, int shell, Real* force) {
  if constexpr (Law::can_fail)
    if (lacks_stress<corners>(nodes, of, shell, force)) {
      of.fail(nodes, shell, LawStatus::no_stress);
      for (int i = 0; i < freedoms * corners; ++i) force[i] = 0;
    }
  leave_forces<corners>(nodes, of, shell, force);
}

template <class Real, int corners, class OfLaw>
struct OnePointShells : Elements<Real> {
  using Law = OfLaw;
  static constexpr int n_corners = corners, thickness_row = shell4::thickness, spring_row = shell4::spring;
  static constexpr int first_measure = thickness_row, n_measures = 1;
  Law law;
  LayerRule rule;

  PRESSWORK_INLINE void advance(const Nodes<Real>& nodes, const double* room_at, double dt, int shell) const {
    if constexpr (Law::can_fail)
      if (this->is_over(nodes, shell)) return;
    const std::size_t n = this->n;
    Real x[corners][3], v[corners][3], w[corners][3], state[shell4::head_rows], force[freedoms * corners];
    gather_corners<corners>(nodes, *this, shell, x, v, w);
    Real* rows = this->state + shell;
    for (int r = 0; r < shell4::head_rows; ++r) state[r] = rows[r * n];
    const auto layers = layers_apart(law, rule.points, rows + shell4::head_rows * n, static_cast<std::ptrdiff_t>(n));
    LayerConditions<Real> now{dt, this->temperature ? this->temperature + shell : nullptr};
    now.slower = this->slower, now.stride = static_cast<std::ptrdiff_t>(n);
    Real room[corners];
    for (int a = 0; room_at && a < corners; ++a) room[a] = static_cast<Real>(room_at[this->node[a * n + shell]]);
    const Real* between = room_at ? room : nullptr;
    if constexpr (corners == 4)
      shell4::advance_stabilized(law, rule, now, x, v, w, between, state, layers, force);
    else
      shell3::advance(law, rule, now, x, v, w, between, state, layers, force);
    for (int r = 0; r < shell4::head_rows; ++r) rows[r * n] = state[r];
    leave_shell_forces<Law, corners>(nodes, *this, shell, force);
  }
  PRESSWORK_INLINE double bound(const Nodes<Real>& nodes, int shell) const {
    Real x[corners][3], v[corners][3], w[corners][3], inverse[4];
    gather_corners<corners>(nodes, *this, shell, x, v, w);
    const auto row = [&](int r) { return this->state[std::size_t(r) * this->n + shell]; };
    for (int i = 0; i < 4; ++i) inverse[i] = row(shell4::reference + i);
    const Real thickness = row(shell4::thickness), mass = this->mass[shell], ratio = this->inertia_ratio[shell];
    if constexpr (corners == 4) {
      shell4::Geometry<Real> g;
      shell4::measure(x, inverse, g);
      return shell4::bound_stabilized(law.young, law.poisson, g, thickness, mass, ratio);
    } else {
      shell3::Sides<Real> sides;
      shell3::measure_sides(x, inverse, sides);
      return shell3::bound_frequency(law.young, law.poisson, sides, thickness, mass, ratio);
    }
  }
  template <class F>
  void for_each_table(const F& f) {
    device::for_each_table(law, f);
  }
};

// Those of 2 x 2 points, MITC4+: the rows of a point are read where they are used.
template <class Real, class OfLaw>
struct MitcShells : Elements<Real> {
  using Law = OfLaw;
  static constexpr int n_corners = 4, thickness_row = shell4_mitc::thickness, spring_row = shell4_mitc::spring;
  static constexpr int first_measure = thickness_row, n_measures = 1;
  Law law;
  LayerRule rule;

  PRESSWORK_INLINE void advance(const Nodes<Real>& nodes, const double* room_at, double dt, int shell) const {
    if constexpr (Law::can_fail)
      if (this->is_over(nodes, shell)) return;
    Real x[4][3], v[4][3], w[4][3], force[freedoms * 4], room[4];
    gather_corners<4>(nodes, *this, shell, x, v, w);
    const auto stride = static_cast<std::ptrdiff_t>(this->n);
    const shell4_mitc::RowsApart<Real> rows{this->state + shell, stride};
    const auto layers =
        layers_apart(law, shell4_mitc::points * rule.points, rows.first + shell4_mitc::head_rows * stride, stride);
    LayerConditions<Real> now{dt, this->temperature ? this->temperature + shell : nullptr};
    now.slower = this->slower, now.stride = stride;
    for (int a = 0; room_at && a < 4; ++a)
      room[a] = static_cast<Real>(room_at[this->node[a * std::size_t(this->n) + shell]]);
    shell4_mitc::advance(law, rule, now, x, v, w, room_at ? room : nullptr, rows, layers, force);
    leave_shell_forces<Law, 4>(nodes, *this, shell, force);
  }
  PRESSWORK_INLINE double bound(const Nodes<Real>& nodes, int shell) const {
    Real x[4][3], v[4][3], w[4][3];
    gather_corners<4>(nodes, *this, shell, x, v, w);
    const shell4_mitc::RowsApart<Real> rows{this->state + shell, static_cast<std::ptrdiff_t>(this->n)};
    return shell4_mitc::bound_frequency(law.young, law.poisson, x, rows, this->mass[shell], this->inertia_ratio[shell]);
  }
  template <class F>
  void for_each_table(const F& f) {
    device::for_each_table(law, f);
  }
};

}  // namespace presswork::device
