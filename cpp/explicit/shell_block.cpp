// SPDX-License-Identifier: Apache-2.0
#include "explicit/shell_block.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

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

}  // namespace

ShellBlock::ShellBlock(const Nodes& nodes, ShellSection section, std::vector<int> connectivity, const double* thickness,
                       const double* axis)
    : section_(std::move(section)),
      n_(static_cast<int>(connectivity.size() / 4)),
      n_packs_((n_ + pack_width - 1) / pack_width),
      law_rows_(std::visit([](const auto& law) { return law.rows(); }, section_.law)),
      rows_(shell4::head_rows + points() * law_rows_),
      connectivity_(std::move(connectivity)),
      packed_(std::size_t(n_packs_) * 4 * pack_width),
      mass_(n_),
      inertia_ratio_(n_),
      state_(std::size_t(n_packs_) * rows_ * pack_width) {
  section_.control.density = section_.density;
  for (int slot = 0; slot < n_packs_ * pack_width; ++slot) {
    const int e = std::min(slot, n_ - 1);
    double x[4][3], inverse[4], area;
    for (int a = 0; a < 4; ++a) {
      const int node = connectivity_[4 * e + a];
      packed_[(slot / pack_width * 4 + a) * pack_width + slot % pack_width] = node;
      for (int i = 0; i < 3; ++i) x[a][i] = nodes.position.data()[Nodes::position_stride * node + i];
    }
    if (!invert_reference(x, axis + 3 * e, inverse, area))
      throw std::invalid_argument("shell " + std::to_string(e) +
                                  " has no area, or the axis of its material is normal to it");
    set_value(slot, shell4::thickness, thickness[e]);
    for (int i = 0; i < 4; ++i) set_value(slot, shell4::reference + i, inverse[i]);
    mass_[e] = section_.density * area * thickness[e];
    inertia_ratio_[e] = ratio_of_inertia(area, thickness[e]);
  }
}

void ShellBlock::load(const Nodes& nodes, int pack, Pack x[4][3], Pack v[4][3], Pack w[4][3]) const {
  const int* node = &packed_[std::size_t(pack) * 4 * pack_width];
  for (int a = 0; a < 4; ++a, node += pack_width) {
    const double *position[pack_width], *motion[pack_width];
    for (int lane = 0; lane < pack_width; ++lane) {
      position[lane] = nodes.position.data() + std::size_t(Nodes::position_stride) * node[lane];
      motion[lane] = nodes.motion.data() + std::size_t(Nodes::motion_stride) * node[lane];
    }
    Pack four[4], eight[8];
    load_records<4>(position, four);
    load_records<8>(motion, eight);
    for (int i = 0; i < 3; ++i) x[a][i] = four[i], v[a][i] = eight[i], w[a][i] = eight[3 + i];
  }
}

template <bool warped, class Law>
void ShellBlock::advance_packs(const Law& law, const Nodes& nodes, const ShellControl& control, int first, int last,
                               double* force) {
  for (int pack = first; pack < last; ++pack) {
    Pack x[4][3], v[4][3], w[4][3], nodal[24];
    load(nodes, pack, x, v, w);
    auto* state = reinterpret_cast<Pack*>(state_.data() + std::size_t(pack) * rows_ * pack_width);
    shell4::advance<warped>(law, section_.rule, control, x, v, w, state, nodal);
    double* to[pack_width];
    for (int lane = 0; lane < pack_width; ++lane)
      to[lane] = force + 24 * (std::size_t(pack - first) * pack_width + lane);
    store_records<24>(nodal, to);
  }
}

void ShellBlock::advance(const Nodes& nodes, double dt, int first, int last, double* force) {
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

void ShellBlock::bound_frequencies(const Nodes& nodes, double* squared) const {
  const auto [young, poisson] =
      std::visit([](const auto& law) { return std::pair(law.young, law.poisson); }, section_.law);
#pragma omp parallel for schedule(static)
  for (int pack = 0; pack < n_packs_; ++pack) {
    Pack x[4][3], v[4][3], w[4][3], mass, ratio;
    load(nodes, pack, x, v, w);
    const int lanes = std::min(pack_width, n_ - pack * pack_width);
    for (int lane = 0; lane < pack_width; ++lane) {
      const int e = pack * pack_width + std::min(lane, lanes - 1);
      mass.set(lane, mass_[e]);
      ratio.set(lane, inertia_ratio_[e]);
    }
    const auto* state = reinterpret_cast<const Pack*>(state_.data() + std::size_t(pack) * rows_ * pack_width);
    shell4::Geometry<Pack> g;
    shell4::measure(x, state + shell4::reference, g);
    const Pack bound = shell4::bound_frequency(young, poisson, g, state[shell4::thickness], mass, ratio);
    for (int lane = 0; lane < lanes; ++lane) squared[pack * pack_width + lane] = bound[lane];
  }
}

}  // namespace presswork::explicit_dynamics
