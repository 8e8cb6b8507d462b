// SPDX-License-Identifier: Apache-2.0
#include "element/shell4_mitc.hpp"
#include "explicit/space/shell_block.hpp"

namespace presswork::explicit_dynamics {

namespace {

struct Mitc {
  static constexpr int nodes = 4;
  static constexpr const char* name = "shell ";

  static StateRows rows(const ShellSection& section) {
    return {.thickness = shell4_mitc::thickness,
            .work = shell4_mitc::work,
            .hourglass_work = -1,
            .layers = shell4_mitc::head_rows,
            .in_plane = shell4_mitc::points,
            .across = section.rule.points,
            .law = std::visit([](const auto& law) { return law.rows(); }, section.law),
            .pressure = int(shell4_mitc::first_point) + int(shell4_mitc::pressure),
            .pressure_step = shell4_mitc::point_rows,
            .spring = shell4_mitc::spring,
            .shear = int(shell4_mitc::first_point) + int(shell4_mitc::shear)};
  }

  // As that of the shell of one point.
  static double inertia_ratio(double area, double thickness) { return area / 12.0 + thickness * thickness / 9.0; }

  template <class Set>
  static bool begin(const double x[4][3], const double axis[3], double thickness, double& area, const Set& set) {
    double g[2][3], h[3];
    shell4::to_patterns(x, g[0], g[1], h);
    area = 0.0;
    set(shell4_mitc::thickness, thickness);
    for (int q = 0; q < shell4_mitc::points; ++q) {
      double p[3], r[3], inverse[4], of_point;  // p - r and p + r are the base vectors
      for (int i = 0; i < 3; ++i) {
        const double a1 = g[0][i] + shell4_mitc::at_s(q) * h[i], a2 = g[1][i] + shell4_mitc::at_r(q) * h[i];
        p[i] = 0.5 * (a1 + a2), r[i] = 0.5 * (a2 - a1);
      }
      if (!invert_reference(p, r, axis, inverse, of_point)) return false;
      area += 2.0 * of_point;
      const int first = shell4_mitc::first_point + q * shell4_mitc::point_rows;
      set(first + shell4_mitc::point_thickness, thickness);
      for (int i = 0; i < 4; ++i) set(first + shell4_mitc::reference + i, inverse[i]);
    }
    return true;
  }

  template <class T, class Law>
  [[gnu::always_inline]] static void advance(const Law& law, const ShellSection& section, const LayerConditions<T>& now,
                                             const T x[4][3], const T v[4][3], const T w[4][3], const T* room, T* state,
                                             T* force) {
    const auto layers = layers_in_row(law, shell4_mitc::points * section.rule.points, state + shell4_mitc::head_rows);
    shell4_mitc::advance(law, section.rule, now, x, v, w, room, state, layers, force);
  }

  template <class T>
  static T bound_frequency(double young, double poisson, const T x[4][3], const T* state, T mass, T ratio) {
    return shell4_mitc::bound_frequency(young, poisson, x, state, mass, ratio);
  }
};

}  // namespace

template <class Real>
std::unique_ptr<SheetBlock<Real>> make_mitc_shells(const SpaceNodes<Real>& nodes, ShellSection section,
                                                   std::vector<int> connectivity, const double* thickness,
                                                   const double* axis) {
  return std::make_unique<ShellBlock<Real, Mitc>>(nodes, std::move(section), std::move(connectivity), thickness, axis);
}

template std::unique_ptr<SheetBlock<double>> make_mitc_shells(const SpaceNodes<double>&, ShellSection, std::vector<int>,
                                                              const double*, const double*);
template std::unique_ptr<SheetBlock<float>> make_mitc_shells(const SpaceNodes<float>&, ShellSection, std::vector<int>,
                                                             const double*, const double*);

}  // namespace presswork::explicit_dynamics
