// SPDX-License-Identifier: Apache-2.0
// tet4_nodal of the explicit loop on one cell or a pack of them: what explicit/space/nodal_tetrahedra.hpp says.
#pragma once

#include "element/solid2d_forces.hpp"
#include "element/solid_space.hpp"
#include "element/space_cycle.hpp"
#include "reference/tet.hpp"

namespace presswork {

// Six times the volume of a cell with its corners at x (4) of T[3].
// A function of its own, so that its bits do not depend on where it is called.
template <class T>
[[gnu::noinline]] PRESSWORK_DEVICE T six_volumes(const T (*x)[3]) {
  T edge[3][3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) edge[a][i] = x[a + 1][i] - x[0][i];
  return edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) +
         edge[0][1] * (edge[1][2] * edge[2][0] - edge[1][0] * edge[2][2]) +
         edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
}

template <class T>
struct NodalTetrahedron {
  static constexpr int nodes = 4;
  using Body = SolidSpace<Tet4, 1, T>;
  using Point = typename Body::Point;
  // Rows of a cell's state before the point's: work of the forces, of what holds the cell's own dilatation, the stress
  // that does, the forces of the last cycle.
  enum : int { work = 0, held_work = 1, pressure = 2, force_row = 3, point = force_row + 3 * nodes };

  // Gradients and volume with the corners at x; true in lanes where the cell is turned inside out.
  PRESSWORK_DEVICE static Mask<T> measure(const T x[nodes][3], Point& g) {
    T J[9], cofactor[9];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) J[3 * i + j] = x[j + 1][i] - x[0][i];
    Body::find_cofactors(J, cofactor);
    const T det = stretch::determinant(J), inverse = T(1.0) / det;
    for (int i = 0; i < 3; ++i) {
      for (int a = 1; a < nodes; ++a) g.grad[a][i] = inverse * cofactor[3 * i + a - 1];
      g.grad[0][i] = -inverse * (cofactor[3 * i] + cofactor[3 * i + 1] + cofactor[3 * i + 2]);
    }
    g.volume_t = T(1.0 / 6) * det;
    return invert(det > T(0.0));
  }

  // Bound of the highest squared frequency [1/s2], elastic, at x, as of fully integrated cells: the nodal mean of the
  // dilatation has less energy than the cells' own. mass of the cell's nodes [t].
  PRESSWORK_DEVICE static T bound_frequency(double bulk, double shear, const T x[nodes][3], const T mass[nodes]) {
    Point g;
    measure(x, g);
    T bound(0.0);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) bound += g.volume_t * g.grad[a][i] * g.grad[a][i] / mass[a];
    return T(bulk + 2.0 * shear) * bound;
  }

  // One cycle of dt, by du from x at its start; mean: of the logarithms by which the nodes' volumes change. Advances
  // the state in place, whose rows from force_row on have the nodal forces then. Gives lanes where the cell is turned
  // inside out, and in `failed` those where the law finds no stress; in both the state stays.
  template <class Law>
  PRESSWORK_DEVICE static Mask<T> advance(const Law& law, double fraction, double dt, T given, const T x[nodes][3],
                                          const T du[nodes][3], T mean, T* state, Mask<T>& failed) {
    Point g;
    const Mask<T> measured = measure(x, g), bad = either(measured, Body::deform(du, false, g));
    if (any(bad)) return bad;

    // 1. stress with the nodes' dilatation
    const T own = logarithm(g.jacobian);
    T F[9], *s0 = state + point, s1[most_point_values<6>], flow, slope;
    for (int i = 0; i < 9; ++i) F[i] = g.F[i];
    Body::use_mean_dilatation({}, exponential(mean), g, false, F);
    const T eqps_n = s0[6];
    find_flow(law, given, s0, flow, slope);
    PointSettings settings;
    settings.tangent = TangentKind::none;
    SpaceResponse<T> response;
    failed = respond(settings, law, F, dt, given, s0, s1, response);
    if (any(failed)) return bad;

    // 2. what holds the cell's own dilatation
    const T modulus = SolidForces<4, T>::hourglass_modulus(T(law.shear_modulus()), eqps_n, flow, slope);
    const T held = state[pressure] + T(2.0 * fraction) * modulus * (own - mean);

    // 3. forces, and their work over the cycle
    const T volume = g.volume_t * g.jacobian;
    T stress[6], now[3 * nodes], done(0.0);
    for (int i = 0; i < 6; ++i) stress[i] = i < 3 ? s1[i] + held : s1[i];
    typename Body::Gradients gradients;
    Body::push_forward(g, false, gradients);
    for (T& force : now) force = T(0.0);
    Body::add_force(gradients, stress, volume, now);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        T& force = state[force_row + 3 * a + i];
        done += T(0.5) * (force + now[3 * a + i]) * du[a][i];
        force = now[3 * a + i];
      }
    const T lost = T(0.5) * (state[pressure] * g.volume_t + held * volume) * own;
    state[work] += done - lost;
    state[held_work] += lost;
    state[pressure] = held;
    keep_point(law, s1, s0);
    return bad;
  }
};

}  // namespace presswork
