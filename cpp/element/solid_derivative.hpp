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
  const double* hourglass;  // (2), as BlockView::hourglass_n
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
  T dilatation() const { return T(0.0); }
  void begin_bubble(T& relaxed) const { relaxed = T(1.0 + state.hourglass[0]); }
  void keep_bubble(double) {}
};

// x, du, along, force and derivative (nodes, d), d freedoms a node. False if the cell is turned inside out.
template <int dim, class Cell, int n_points, Treatment treatment>
bool differentiate_cell(const SolidSection& section, PointSettings settings, const VonMises& law,
                        const CellState& state, const double* x, const double* du, const double* along, double* force,
                        double* derivative) {
  using T = Dual<double, 1>;
  using Kernel = SolidKernel<dim, Cell, n_points, treatment, T>;
  constexpr int nodes = Cell::nodes, width = Kernel::node_freedoms;
  settings.tangent = TangentKind::none;
  T place[nodes][width], moved[nodes][width], found[nodes * width];
  for (int a = 0; a < nodes; ++a)
    for (int i = 0; i < width; ++i) {
      place[a][i] = T(x[width * a + i]);
      moved[a][i] = T(du[width * a + i]);
      moved[a][i].slope[0] = along[width * a + i];
    }
  CellPoints<typename Kernel::Body, T> points(settings, law, state);
  if (any(Kernel::evaluate(section, settings, place, moved, points, found, nullptr))) return false;
  for (int i = 0; i < nodes * width; ++i) force[i] = found[i].value, derivative[i] = found[i].slope[0];
  return true;
}

}  // namespace presswork
