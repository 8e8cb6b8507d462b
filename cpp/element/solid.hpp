// SPDX-License-Identifier: Apache-2.0
// Solids of any dimension, cell and treatment on any scalar: standard, F-bar, or one point with hourglass control.
//
// Updated Lagrangian: gradients are taken on the configuration at t, F is the increment's, the residual and tangent are
// integrated over the configuration at t+dt. What a dimension is made of stands in solid_plane.hpp and solid_space.hpp.
//
// fbar (de Souza Neto et al. 1996, with the element's volume average in place of the centroid): the stress is that of
// F (Jbar/J)^(1/3), in plane strain of the in-plane part times (Jbar/J)^(1/2); Jbar = v(t+dt)/v(t) of the element.
// one_point (Flanagan & Belytschko 1981), in the plane: centroid stress, and hourglass forces Q = R Q_n + k gamma.du on
// the hourglass vector gamma, k = 2 fraction * G_now * V * sum |grad N|^2 with G_now = G before first yield, then flow
// + slope/3 (at most G), so that the control stays weak beside plastic flow. In axisymmetry gradients and N/r are the
// element's volume averages.
//
// With settings.small_displacements the points are the undeformed ones, gradients and volumes those at the start, and
// F-bar becomes B-bar (Hughes 1980, with the element's volume average), in the virtual strain too.
#pragma once

#include <algorithm>
#include <type_traits>

#include "element/solid_mixed.hpp"
#include "element/solid_plane.hpp"
#include "element/solid_space.hpp"

namespace presswork {

enum class Treatment { standard, fbar, one_point, mixed };

template <int dim, class Cell, int n_points, class T>
using SolidBody = std::conditional_t<dim == 2, SolidPlane<Cell, n_points, T>, SolidSpace<Cell, n_points, T>>;

template <int dim, class Cell, int n_points, Treatment treatment, class T>
struct Solid : SolidBody<dim, Cell, n_points, T> {
  using Body = SolidBody<dim, Cell, n_points, T>;
  using Point = typename Body::Point;
  static constexpr int nodes = Cell::nodes, node_freedoms = dim, freedoms = dim * nodes;
  static_assert(Cell::dim == dim && !(treatment == Treatment::one_point && dim == 3));

  // One cell, or a pack of them, with its nodes at x, moved by du: nodal forces and, if K is given, the tangent. True
  // in lanes where the cell is turned inside out; then nothing is written. `points` keeps the state of the points:
  //     advance(q, x, du, g, F, response)    stress and modulus of point q after F
  //     keep(q, volume)                      keeps its new state
  //     begin_hourglass(Q, modulus), keep_hourglass(Q)     of one_point
  template <class Points>
  [[gnu::always_inline]] static inline Mask<T> evaluate(const SolidSection& section, const PointSettings& settings,
                                                        const T x[][dim], const T du[][dim], Points& points, T* force,
                                                        T* K) {
    // 1. kinematics of every point, before anything is computed from it
    Point g[n_points];
    const bool small = settings.small_displacements;
    Mask<T> bad = T(1.0) < T(0.0);
    for (int q = 0; q < n_points; ++q) {
      bool measured = false;
      if constexpr (treatment == Treatment::one_point)
        if ((measured = section.axisymmetric)) bad = either(bad, Body::measure_mean(x, g[q]));
      if (!measured) bad = either(bad, Body::measure_reference(section, x, q, g[q]));
      bad = either(bad, Body::deform(du, small, g[q]));
    }
    if (any(bad)) return bad;

    for (int i = 0; i < freedoms; ++i) force[i] = T(0.0);
    if (K)
      for (int i = 0; i < freedoms * freedoms; ++i) K[i] = T(0.0);
    T mean_div[freedoms], mean(1.0);
    if constexpr (treatment == Treatment::fbar) mean = Body::mean_dilatation(g, K != nullptr, small, mean_div);

    // 2. stress, internal force and tangent point by point
    for (int q = 0; q < n_points; ++q) {
      T F[Body::gradients];
      std::copy_n(g[q].F, Body::gradients, F);
      if constexpr (treatment == Treatment::fbar) Body::use_mean_dilatation(section, mean, g[q], small, F);
      typename Body::Response response;
      points.advance(q, x, du, g, F, response);

      T dv = g[q].volume_t * g[q].jacobian;
      typename Body::Gradients now;
      Body::push_forward(g[q], small, now);
      Body::add_force(now, response.stress, dv, force);
      if (K) {
        Body::add_stiffness(now, response, dv, K);
        if constexpr (treatment == Treatment::fbar)
          if (!small) Body::add_fbar(section, now, response, dv, mean_div, K);
      }
      if constexpr (treatment == Treatment::fbar)
        if (small) Body::add_bbar(section, now, response, dv, mean_div, force, K);
      if constexpr (treatment == Treatment::one_point) {
        T Q[2], modulus;
        points.begin_hourglass(Q, modulus);
        Body::Forces::add_hourglass(modulus, section.hourglass_fraction, x, du, g[q], now, Q, force, K, small);
        points.keep_hourglass(Q);
      }
      points.keep(q, dv);
    }
    return bad;
  }
};

template <int dim, class Cell, int n_points, Treatment treatment, class T>
struct KernelOf {
  using Type = Solid<dim, Cell, n_points, treatment, T>;
};
template <class T>
struct KernelOf<3, Tet4, 1, Treatment::mixed, T> {
  using Type = MixedTetrahedron<T>;
};
template <int dim, class Cell, int n_points, Treatment treatment, class T>
using SolidKernel = typename KernelOf<dim, Cell, n_points, treatment, T>::Type;

}  // namespace presswork
