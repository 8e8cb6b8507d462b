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

// Inverse of the mean sides' components along the law's x and y; false where that does not exist.
bool invert_reference(const double x[4][3], const double axis[3], double inverse[4], double& area) {
  double p[3], q[3], e1[3], e2[3], e3[3];
  for (int i = 0; i < 3; ++i) p[i] = x[2][i] - x[0][i], q[i] = x[3][i] - x[1][i];
  shell4::cross(p, q, e3);
  const double twice = std::sqrt(shell4::dot(e3, e3));
  area = 0.5 * twice;
  if (!(twice > 1e-12 * (shell4::dot(p, p) + shell4::dot(q, q)))) return false;
  shell4::scale(e3, 1.0 / twice);
  const double along = shell4::dot(axis, e3), length = std::sqrt(shell4::dot(axis, axis));
  for (int i = 0; i < 3; ++i) e1[i] = axis[i] - along * e3[i];
  const double plane = std::sqrt(shell4::dot(e1, e1));
  if (!(plane > 1e-6 * length)) return false;
  shell4::scale(e1, 1.0 / plane);
  shell4::cross(e3, e1, e2);
  double g1[3], g2[3];
  for (int i = 0; i < 3; ++i) g1[i] = p[i] - q[i], g2[i] = p[i] + q[i];
  const double a = shell4::dot(g1, e1), b = shell4::dot(g2, e1), c = shell4::dot(g1, e2), d = shell4::dot(g2, e2);
  const double over = 1.0 / (a * d - b * c);
  inverse[0] = d * over, inverse[1] = -b * over, inverse[2] = -c * over, inverse[3] = a * over;
  return true;
}

StateRows rows_of(const ShellSection& section) {
  return {shell4::thickness,
          shell4::work,
          shell4::hourglass_work,
          shell4::head_rows,
          static_cast<int>(section.rule.height.size()),
          std::visit([](const auto& law) { return law.rows(); }, section.law)};
}

}  // namespace

template <class Real>
Shell4Block<Real>::Shell4Block(const Nodes<Real>& nodes, ShellSection section, std::vector<int> connectivity,
                               const double* thickness, const double* axis)
    : ElementBlock<Real>(4, std::move(connectivity), rows_of(section)), section_(std::move(section)) {
  section_.control.density = section_.density;
  for (int e = 0; e < this->n_; ++e) {
    double x[4][3], inverse[4], area;
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i)
        x[a][i] = nodes.position.data()[std::size_t(Nodes<Real>::position_stride) * this->connectivity_[4 * e + a] + i];
    if (!invert_reference(x, axis + 3 * e, inverse, area))
      throw std::invalid_argument("shell " + std::to_string(e) +
                                  " has no area, or the axis of its material is normal to it");
    this->set_value(e, shell4::thickness, thickness[e]);
    for (int i = 0; i < 4; ++i) this->set_value(e, shell4::reference + i, inverse[i]);
    this->mass_[e] = section_.density * area * thickness[e];
    this->inertia_ratio_[e] = ratio_of_inertia(area, thickness[e]);
  }
}

template <class Real>
template <bool warped, class Law>
void Shell4Block<Real>::advance_packs(const Law& law, const Nodes<Real>& nodes, const ShellControl& control, int first,
                                      int last, Real* force) {
  for (int pack = first; pack < last; ++pack) {
    P x[4][3], v[4][3], w[4][3], nodal[24];
    gather_positions<4>(nodes, this->pack_nodes(pack), x);
    gather_motion<4>(nodes, this->pack_nodes(pack), v, w);
    shell4::advance<warped>(law, section_.rule, control, x, v, w, this->pack_state(pack), nodal);
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
        if (section_.warped)
          advance_packs<true>(law, nodes, control, first, last, force);
        else
          advance_packs<false>(law, nodes, control, first, last, force);
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
    const P bound = shell4::bound_frequency(young, poisson, g, state[shell4::thickness], mass, ratio);
    for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
  }
}

template class Shell4Block<double>;
template class Shell4Block<float>;

}  // namespace presswork::explicit_dynamics
