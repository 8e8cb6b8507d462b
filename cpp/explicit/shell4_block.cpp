// SPDX-License-Identifier: Apache-2.0
#include "explicit/shell4_block.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "explicit/gather.hpp"

namespace presswork::explicit_dynamics {

namespace {

// Rotary inertia over mass: A/12 + t^2/9, with which rotations never rule the step of a shell thinner than its sides.
double ratio_of_inertia(double area, double thickness) { return area / 12.0 + thickness * thickness / 9.0; }

}  // namespace

template <class Real>
Shell4Block<Real>::Shell4Block(const Nodes<Real>& nodes, ShellSection section, std::vector<int> connectivity,
                               const double* thickness, const double* axis)
    : ElementBlock<Real>(4, std::move(connectivity), rows_of(section)), section_(std::move(section)) {
  section_.control.density = section_.density;
  for (int e = 0; e < this->n_; ++e) {
    double p[3], q[3], inverse[4], twice;
    const double* x[4];
    for (int a = 0; a < 4; ++a)
      x[a] = nodes.position.data() + std::size_t(Nodes<Real>::position_stride) * this->connectivity_[4 * e + a];
    for (int i = 0; i < 3; ++i) p[i] = x[2][i] - x[0][i], q[i] = x[3][i] - x[1][i];
    if (!invert_reference(p, q, axis + 3 * e, inverse, twice))
      throw std::invalid_argument("shell " + std::to_string(e) +
                                  " has no area, or the axis of its material is normal to it");
    const double area = 0.5 * twice;
    this->set_value(e, shell4::thickness, thickness[e]);
    for (int i = 0; i < 4; ++i) this->set_value(e, shell4::reference + i, inverse[i]);
    this->mass_[e] = section_.density * area * thickness[e];
    this->inertia_ratio_[e] = ratio_of_inertia(area, thickness[e]);
  }
}

template <class Real>
template <Treatment treatment, class Law>
void Shell4Block<Real>::advance_packs(const Law& law, const Nodes<Real>& nodes, const ShellControl& control, int first,
                                      int last, Real* force) {
  for (int pack = first; pack < last; ++pack) {
    P x[4][3], v[4][3], w[4][3], nodal[24];
    gather_positions<4>(nodes, this->pack_nodes(pack), x);
    gather_motion<4>(nodes, this->pack_nodes(pack), v, w);
    if constexpr (treatment == Treatment::stabilized)
      shell4::advance_stabilized(law, section_.rule, control.dt, x, v, w, this->pack_state(pack), nodal);
    else
      shell4::advance<treatment == Treatment::warped>(law, section_.rule, control, x, v, w, this->pack_state(pack),
                                                      nodal);
    Real* to[lanes];
    for (int lane = 0; lane < lanes; ++lane) to[lane] = force + 24 * (std::size_t(pack - first) * lanes + lane);
    store_records<24>(nodal, to);
  }
}

template <class Real>
void Shell4Block<Real>::advance(const Nodes<Real>& nodes, double dt, int first, int last, Real* force) {
  ShellControl control = section_.control;
  control.dt = dt;
  std::visit(
      [&](const auto& law) {
        switch (section_.treatment) {
          case Treatment::plain:
            return advance_packs<Treatment::plain>(law, nodes, control, first, last, force);
          case Treatment::warped:
            return advance_packs<Treatment::warped>(law, nodes, control, first, last, force);
          case Treatment::stabilized:
            return advance_packs<Treatment::stabilized>(law, nodes, control, first, last, force);
        }
      },
      section_.law);
}

template <class Real>
void Shell4Block<Real>::bound_frequencies(const Nodes<Real>& nodes, double* squared) const {
  const auto [young, poisson] =
      std::visit([](const auto& law) { return std::pair(law.young, law.poisson); }, section_.law);
#pragma omp parallel for schedule(static)
  for (int pack = 0; pack < this->n_packs(); ++pack) {
    P x[4][3], mass, ratio;
    gather_positions<4>(nodes, this->pack_nodes(pack), x);
    const int used = std::min(lanes, this->n_ - pack * lanes);
    for (int lane = 0; lane < lanes; ++lane) {
      const int e = pack * lanes + std::min(lane, used - 1);
      mass.set(lane, static_cast<Real>(this->mass_[e]));
      ratio.set(lane, static_cast<Real>(this->inertia_ratio_[e]));
    }
    const P* state = this->pack_state(pack);
    shell4::Geometry<P> g;
    shell4::measure(x, state + shell4::reference, g);
    P bound = shell4::bound_frequency(young, poisson, g, state[shell4::thickness], mass, ratio);
    if (section_.treatment == Treatment::stabilized) bound *= shell4::stabilized_excess(g);
    for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
  }
}

template class Shell4Block<double>;
template class Shell4Block<float>;

}  // namespace presswork::explicit_dynamics
