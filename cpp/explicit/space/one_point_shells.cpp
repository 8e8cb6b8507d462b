// SPDX-License-Identifier: Apache-2.0
#include "element/shell3_one_point.hpp"
#include "element/shell4_stabilized.hpp"
#include "explicit/space/shell_block.hpp"

namespace presswork::explicit_dynamics {

namespace {

template <int count>
struct OnePoint {
  static constexpr int nodes = count;

  static StateRows rows(const ShellSection& section) {
    return {.thickness = shell4::thickness,
            .work = shell4::work,
            .hourglass_work = shell4::hourglass_work,
            .layers = shell4::head_rows,
            .in_plane = 1,
            .across = section.rule.points,
            .law = std::visit([](const auto& law) { return law.rows(); }, section.law),
            .pressure = shell4::pressure,
            .spring = shell4::spring,
            .reference = shell4::reference,
            .hourglass = shell4::hourglass,
            .shear = shell4::shear_xz};
  }

  // p - q and p + q are the sides of the reference, of which the frame knows the inverse; p x q is `per_area` areas.
  template <class Set>
  static bool begin_from(const double p[3], const double q[3], double per_area, const double axis[3], double thickness,
                         double& area, const Set& set) {
    double inverse[4];
    if (!invert_reference(p, q, axis, inverse, area)) return false;
    area /= per_area;
    set(shell4::thickness, thickness);
    for (int i = 0; i < 4; ++i) set(shell4::reference + i, inverse[i]);
    return true;
  }
};

struct Triangle : OnePoint<3> {
  static constexpr const char* name = "triangle ";

  // As that of a 4-node shell of twice the area, so that rotations do not rule the step.
  static double inertia_ratio(double area, double thickness) { return area / 6.0 + thickness * thickness / 9.0; }

  template <class Set>
  static bool begin(const double x[3][3], const double axis[3], double thickness, double& area, const Set& set) {
    double p[3], q[3];
    for (int i = 0; i < 3; ++i) p[i] = 0.5 * (x[1][i] + x[2][i]) - x[0][i], q[i] = 0.5 * (x[2][i] - x[1][i]);
    return begin_from(p, q, 1.0, axis, thickness, area, set);
  }

  template <class T, class Law>
  [[gnu::always_inline]] static void advance(const Law& law, const ShellSection& section, const LayerConditions<T>& now,
                                             const T x[3][3], const T v[3][3], const T w[3][3], const T* room, T* state,
                                             T* force) {
    const auto layers = layers_in_row(law, section.rule.points, state + shell4::head_rows);
    shell3::advance(law, section.rule, now, x, v, w, room, state, layers, force);
  }

  template <class T>
  static T bound_frequency(double young, double poisson, const T x[3][3], const T* state, T mass, T ratio) {
    shell3::Sides<T> sides;
    shell3::measure_sides(x, state + shell4::reference, sides);
    return shell3::bound_frequency(young, poisson, sides, state[shell4::thickness], mass, ratio);
  }
};

template <ShellTreatment treatment>
struct Quadrilateral : OnePoint<4> {
  static constexpr const char* name = "shell ";

  // A/12 + t^2/9, with which rotations never rule the step of a shell thinner than its sides.
  static double inertia_ratio(double area, double thickness) { return area / 12.0 + thickness * thickness / 9.0; }

  template <class Set>
  static bool begin(const double x[4][3], const double axis[3], double thickness, double& area, const Set& set) {
    double p[3], q[3];
    for (int i = 0; i < 3; ++i) p[i] = x[2][i] - x[0][i], q[i] = x[3][i] - x[1][i];
    return begin_from(p, q, 2.0, axis, thickness, area, set);
  }

  template <class T, class Law>
  [[gnu::always_inline]] static void advance(const Law& law, const ShellSection& section, const LayerConditions<T>& now,
                                             const T x[4][3], const T v[4][3], const T w[4][3], const T* room, T* state,
                                             T* force) {
    if constexpr (treatment == ShellTreatment::stabilized) {
      const auto layers = layers_in_row(law, section.rule.points, state + shell4::head_rows);
      shell4::advance_stabilized(law, section.rule, now, x, v, w, room, state, layers, force);
    } else {
      shell4::advance<treatment == ShellTreatment::warped>(law, section.rule, section.control, now, x, v, w, room,
                                                           state, force);
    }
  }

  template <class T>
  static T bound_frequency(double young, double poisson, const T x[4][3], const T* state, T mass, T ratio) {
    shell4::Geometry<T> g;
    shell4::measure(x, state + shell4::reference, g);
    if constexpr (treatment == ShellTreatment::stabilized)
      return shell4::bound_stabilized(young, poisson, g, state[shell4::thickness], mass, ratio);
    else
      return shell4::bound_frequency(young, poisson, g, state[shell4::thickness], mass, ratio);
  }
};

}  // namespace

template <class Real>
std::unique_ptr<SheetBlock<Real>> make_one_point_shells(int nodes_each, const SpaceNodes<Real>& nodes,
                                                        ShellSection section, std::vector<int> connectivity,
                                                        const double* thickness, const double* axis) {
  const auto make = [&]<class Kind>() -> std::unique_ptr<SheetBlock<Real>> {
    return std::make_unique<ShellBlock<Real, Kind>>(nodes, std::move(section), std::move(connectivity), thickness,
                                                    axis);
  };
  if (nodes_each == 3) return make.template operator()<Triangle>();
  switch (section.treatment) {
    case ShellTreatment::plain:
      return make.template operator()<Quadrilateral<ShellTreatment::plain>>();
    case ShellTreatment::warped:
      return make.template operator()<Quadrilateral<ShellTreatment::warped>>();
    default:
      return make.template operator()<Quadrilateral<ShellTreatment::stabilized>>();
  }
}

template std::unique_ptr<SheetBlock<double>> make_one_point_shells(int, const SpaceNodes<double>&, ShellSection,
                                                                   std::vector<int>, const double*, const double*);
template std::unique_ptr<SheetBlock<float>> make_one_point_shells(int, const SpaceNodes<float>&, ShellSection,
                                                                  std::vector<int>, const double*, const double*);

}  // namespace presswork::explicit_dynamics
