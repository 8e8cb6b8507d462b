// SPDX-License-Identifier: Apache-2.0
// The forces of one solid cell and their exact derivative along a move of its nodes, by dual numbers: what the tangent
// is checked against. The same kernel as evaluate_pack's, on another scalar.
#pragma once

#include "element/solid.hpp"

namespace presswork {

// State of a cell at t; c is the number of stress components, q of points.
struct CellState {
  const double* stress;     // (q, c) [MPa]
  const double* eqps;       // (q)
  const double* hourglass;  // (2) [N], one_point only
};

template <class Body, class T>
struct CellPoints {
  static constexpr int components = Body::components;
  const PointSettings& settings;
  const VonMises& law;
  const CellState& state;
  T s0[components + 1], s1[components + 1];

  CellPoints(const PointSettings& settings, const VonMises& law, const CellState& state)
      : settings(settings), law(law), state(state) {}

  void advance(int q, const T (*)[Body::dim], const T (*)[Body::dim], const typename Body::Point*, const T* F,
               typename Body::Response& response) {
    for (int i = 0; i < components; ++i) s0[i] = T(state.stress[components * q + i]);
    s0[components] = T(state.eqps[q]);
    respond(settings, law, F, 1.0, T(0.0), s0, s1, response);
  }
  void keep(int, T) {}
  void begin_hourglass(T Q[2], T& modulus) const {
    for (int i = 0; i < 2; ++i) Q[i] = T(state.hourglass[i]);
    double flow, slope;
    law.flow_at_rest(state.eqps[0], 0.0, flow, slope);
    modulus = T(SolidForces<4, double>::hourglass_modulus(law.shear_modulus(), state.eqps[0], flow, slope));
  }
  void keep_hourglass(const T*) {}
};

// x, du, along (nodes, dim); force and derivative (nodes, dim). False if the cell is turned inside out.
template <int dim, class Cell, int n_points, Treatment treatment>
bool differentiate_cell(const SolidSection& section, PointSettings settings, const VonMises& law,
                        const CellState& state, const double* x, const double* du, const double* along, double* force,
                        double* derivative) {
  using T = Dual<double, 1>;
  using Kernel = Solid<dim, Cell, n_points, treatment, T>;
  constexpr int nodes = Cell::nodes;
  settings.tangent = TangentKind::none;
  T place[nodes][dim], moved[nodes][dim], found[nodes * dim];
  for (int a = 0; a < nodes; ++a)
    for (int i = 0; i < dim; ++i) {
      place[a][i] = T(x[dim * a + i]);
      moved[a][i] = T(du[dim * a + i]);
      moved[a][i].slope[0] = along[dim * a + i];
    }
  CellPoints<typename Kernel::Body, T> points(settings, law, state);
  if (any(Kernel::evaluate(section, settings, place, moved, points, found, nullptr))) return false;
  for (int i = 0; i < nodes * dim; ++i) force[i] = found[i].value, derivative[i] = found[i].slope[0];
  return true;
}

}  // namespace presswork
