// SPDX-License-Identifier: Apache-2.0
// Shells of one point in the device's cycle: those of four nodes with physical stabilisation, and those of three.
#pragma once

#include "device/elements.hpp"
#include "device/law_tables.hpp"
#include "element/shell3_one_point.hpp"
#include "element/shell4_stabilized.hpp"
#include "material/elastic_plastic_update.hpp"

namespace presswork::device {

template <class Real, int corners, class OfLaw>
struct OnePointShells : Elements<Real> {
  using Law = OfLaw;
  static constexpr int n_corners = corners, thickness_row = shell4::thickness, spring_row = shell4::spring;
  Law law;
  LayerRule rule;

  PRESSWORK_INLINE void advance(const Nodes<Real>& nodes, const double* room_at, double dt, int shell) const {
    const std::size_t n = this->n;
    Real x[corners][3], v[corners][3], w[corners][3], state[shell4::head_rows], force[freedoms * corners];
    gather_corners<corners>(nodes, *this, shell, x, v, w);
    Real* rows = this->state + shell;
    for (int r = 0; r < shell4::head_rows; ++r) state[r] = rows[r * n];
    const auto layers = layers_apart(law, rows + shell4::head_rows * n, static_cast<std::ptrdiff_t>(n));
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
    leave_forces<corners>(nodes, *this, shell, force);
  }
  template <class F>
  void for_each_table(const F& f) {
    device::for_each_table(law, f);
  }
};

}  // namespace presswork::device
