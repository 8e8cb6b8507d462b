// SPDX-License-Identifier: Apache-2.0
#include "explicit/shell3_block.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "explicit/gather.hpp"

namespace presswork::explicit_dynamics {

namespace {

// As that of a 4-node shell of twice the area, so that rotations do not rule the step.
double ratio_of_inertia(double area, double thickness) { return area / 6.0 + thickness * thickness / 9.0; }

}  // namespace

template <class Real>
Shell3Block<Real>::Shell3Block(const Nodes<Real>& nodes, ShellSection section, std::vector<int> connectivity,
                               const double* thickness, const double* axis)
    : ElementBlock<Real>(3, std::move(connectivity), rows_of(section)), section_(std::move(section)) {
  for (int e = 0; e < this->n_; ++e) {
    double p[3], q[3], inverse[4], area;
    const double* x[3];
    for (int a = 0; a < 3; ++a)
      x[a] = nodes.position.data() + std::size_t(Nodes<Real>::position_stride) * this->connectivity_[3 * e + a];
    // p - q and p + q are the sides that begin at the first node
    for (int i = 0; i < 3; ++i) p[i] = 0.5 * (x[1][i] + x[2][i]) - x[0][i], q[i] = 0.5 * (x[2][i] - x[1][i]);
    if (!invert_reference(p, q, axis + 3 * e, inverse, area))
      throw std::invalid_argument("triangle " + std::to_string(e) +
                                  " has no area, or the axis of its material is normal to it");
    this->set_value(e, shell4::thickness, thickness[e]);
    for (int i = 0; i < 4; ++i) this->set_value(e, shell4::reference + i, inverse[i]);
    this->mass_[e] = section_.density * area * thickness[e];
    this->inertia_ratio_[e] = ratio_of_inertia(area, thickness[e]);
  }
}

template <class Real>
template <class Law>
void Shell3Block<Real>::advance_packs(const Law& law, const Nodes<Real>& nodes, double dt, int first, int last,
                                      Real* force) {
  for (int pack = first; pack < last; ++pack) {
    P x[3][3], v[3][3], w[3][3], nodal[18];
    gather_positions<3>(nodes, this->pack_nodes(pack), x);
    gather_motion<3>(nodes, this->pack_nodes(pack), v, w);
    shell3::advance(law, section_.rule, dt, x, v, w, this->pack_state(pack), nodal);
    for (int lane = 0; lane < lanes; ++lane)
      for (int i = 0; i < 18; ++i) force[18 * (std::size_t(pack - first) * lanes + lane) + i] = nodal[i][lane];
  }
}

template <class Real>
void Shell3Block<Real>::advance(const Nodes<Real>& nodes, double dt, int first, int last, Real* force) {
  std::visit([&](const auto& law) { advance_packs(law, nodes, dt, first, last, force); }, section_.law);
}

template <class Real>
void Shell3Block<Real>::bound_frequencies(const Nodes<Real>& nodes, double* squared) const {
  const auto [young, poisson] =
      std::visit([](const auto& law) { return std::pair(law.young, law.poisson); }, section_.law);
#pragma omp parallel for schedule(static)
  for (int pack = 0; pack < this->n_packs(); ++pack) {
    P x[3][3], mass, ratio;
    gather_positions<3>(nodes, this->pack_nodes(pack), x);
    const int used = std::min(lanes, this->n_ - pack * lanes);
    for (int lane = 0; lane < lanes; ++lane) {
      const int e = pack * lanes + std::min(lane, used - 1);
      mass.set(lane, static_cast<Real>(this->mass_[e]));
      ratio.set(lane, static_cast<Real>(this->inertia_ratio_[e]));
    }
    const P* state = this->pack_state(pack);
    shell3::Sides<P> sides;
    shell3::measure_sides(x, state + shell4::reference, sides);
    const P bound = shell3::bound_frequency(young, poisson, sides, state[shell4::thickness], mass, ratio);
    for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
  }
}

template class Shell3Block<double>;
template class Shell3Block<float>;

}  // namespace presswork::explicit_dynamics
