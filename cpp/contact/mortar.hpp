// SPDX-License-Identifier: Apache-2.0
// Segment-to-segment contact of two straight edges in the plane: the integrals of a mortar method.
//
// The slave edge runs from a to b, the master edge from c to d, each body on the left of its edge, so that the edges
// run against each other. Points of the slave are projected along its normal onto the master; the integrals run over
// the part of the slave that lies opposite the master: xi from lo to hi. There both gap and shape functions are
// polynomials of xi, and three Gauss points integrate them exactly, the radius of axisymmetry included.
//
// Pressure is interpolated linearly between the ends of an edge (phi_A). An edge of three nodes is two straight halves;
// its forces go to all three nodes by their quadratic shape functions N_i, so that a constant pressure between straight
// edges gives the consistent nodal forces. Reference: Puso, Laursen, Solberg (2008) for the pairing of orders; Yang,
// Laursen, Meng (2005) for mortar contact at large deformation. Unlike them the normal is that of each slave edge, not
// averaged at the nodes: the method needs no neighbours.
#pragma once

#include <cmath>
#include <numbers>

#include "tensor/dual.hpp"

namespace presswork::mortar {

// Cosine between the edges' directions above which they do not face each other, and below which they do in full.
inline constexpr double facing = -0.3, facing_in_full = -0.7;

enum class Overlap { none, apart, too_deep, found };

template <class T, int nodes>
struct Integrals {
  T weight[2];         // int phi_A dA
  T gap[2];            // int phi_A g dA, positive when the bodies are apart
  T slip[2];           // int phi_A (moved_slave - moved_master) . tangent dA
  T slave[nodes][2];   // int N_i phi_A dA
  T master[nodes][2];  // the same for the master's shape functions at the projected points
  T tangent[2];        // from a to b
  T normal[2];         // out of the slave
};

struct Limits {
  double reach;  // a mean gap larger than this counts as no contact [mm]
  double depth;  // and so does a penetration deeper than this
};

// Shape functions of an edge (first, last[, mid-side]) at s in [-1, 1].
template <class T, int nodes>
void shape_functions(const T& s, T (&N)[nodes]) {
  if constexpr (nodes == 2) {
    N[0] = T(0.5) * (T(1.0) - s), N[1] = T(0.5) * (T(1.0) + s);
  } else {
    N[0] = T(0.5) * s * (s - T(1.0)), N[1] = T(0.5) * s * (s + T(1.0)), N[2] = T(1.0) - s * s;
  }
}

// Coordinate s in [-1, 1] of the whole edge at xi in [0, 1] of its half (or of itself, with two nodes).
template <class T, int nodes>
T on_edge(int half, const T& xi) {
  return nodes == 2 ? T(2.0) * xi - T(1.0) : xi + T(half - 1.0);
}

// The part of the slave opposite the master, and the gap there: gap(xi) = gap_at_c + eta n.(d - c).
template <class T>
struct Facing {
  T length, tangent[2], normal[2], xi_c, xi_d, lo, hi, gap_c, slope;
  T share;  // 0 to 1: what counts of the integrals, so that a pair comes in and goes out smoothly
  T eta(const T& xi) const { return (xi - xi_c) / (xi_d - xi_c); }
  T gap(const T& xi) const { return gap_c + eta(xi) * slope; }
};

// 0 below 0, 1 above 1, smooth between.
template <class T>
T ramp(const T& x) {
  const T t = smaller(T(1.0), larger(T(0.0), x));
  return t * t * (T(3.0) - T(2.0) * t);
}

// x: a, b, c, d, two coordinates each.
template <class T>
Overlap face(const T* x, const Limits& limits, Facing<T>& f) {
  const T dx = x[2] - x[0], dy = x[3] - x[1], mx = x[6] - x[4], my = x[7] - x[5];
  f.length = square_root(dx * dx + dy * dy);
  f.tangent[0] = dx / f.length, f.tangent[1] = dy / f.length;
  f.normal[0] = f.tangent[1], f.normal[1] = -f.tangent[0];
  const T along = f.tangent[0] * mx + f.tangent[1] * my, master_length = square_root(mx * mx + my * my);
  if (!(value_of(along) < facing * value_of(master_length))) return Overlap::none;
  const T cx = x[4] - x[0], cy = x[5] - x[1];
  f.xi_c = (f.tangent[0] * cx + f.tangent[1] * cy) / f.length;
  f.xi_d = f.xi_c + along / f.length;
  f.lo = larger(T(0.0), f.xi_d), f.hi = smaller(T(1.0), f.xi_c);
  if (!(value_of(f.hi) - value_of(f.lo) > 1e-9)) return Overlap::none;
  f.gap_c = f.normal[0] * cx + f.normal[1] * cy;
  f.slope = f.normal[0] * mx + f.normal[1] * my;
  const T middle = f.gap(T(0.5) * (f.lo + f.hi));
  if (value_of(middle) > limits.reach) return Overlap::apart;
  if (value_of(middle) < -limits.depth) return Overlap::too_deep;
  f.share = ramp((T(facing) - along / master_length) / T(facing - facing_in_full));
  return Overlap::found;
}

// x: a, b, c, d now; x_n: where they were when the increment began. thickness: extent normal to the plane [mm], or
// 0 for a full ring about x = 0. The halves count only for edges of three nodes.
template <class T, int nodes>
Overlap integrate(const T* x, const double* x_n, int slave_half, int master_half, const Limits& limits,
                  double thickness, Integrals<T, nodes>& out) {
  Facing<T> f;
  if (const Overlap overlap = face(x, limits, f); overlap != Overlap::found) return overlap;
  out = Integrals<T, nodes>{};
  for (int k = 0; k < 2; ++k) out.tangent[k] = f.tangent[k], out.normal[k] = f.normal[k];
  T moved[4];  // along the tangent
  for (int i = 0; i < 4; ++i)
    moved[i] = (x[2 * i] - T(x_n[2 * i])) * f.tangent[0] + (x[2 * i + 1] - T(x_n[2 * i + 1])) * f.tangent[1];
  constexpr double at[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr double gauss_weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  const T middle = T(0.5) * (f.lo + f.hi), half = T(0.5) * (f.hi - f.lo);
  for (int q = 0; q < 3; ++q) {
    const T xi = middle + T(at[q]) * half, eta = f.eta(xi);
    T area = T(gauss_weight[q]) * half * f.length * f.share;
    if (thickness == 0.0)
      area *= T(2.0 * std::numbers::pi) * (x[0] + xi * (x[2] - x[0]));
    else
      area *= T(thickness);
    const T s = on_edge<T, nodes>(slave_half, xi);
    const T phi[2] = {T(0.5) * (T(1.0) - s), T(0.5) * (T(1.0) + s)};
    T N_slave[nodes], N_master[nodes];
    shape_functions<T, nodes>(s, N_slave);
    shape_functions<T, nodes>(on_edge<T, nodes>(master_half, eta), N_master);
    const T gap = f.gap(xi);
    const T slip = moved[0] + xi * (moved[1] - moved[0]) - moved[2] - eta * (moved[3] - moved[2]);
    for (int A = 0; A < 2; ++A) {
      const T share = area * phi[A];
      out.weight[A] += share;
      out.gap[A] += share * gap;
      out.slip[A] += share * slip;
      for (int i = 0; i < nodes; ++i) {
        out.slave[i][A] += share * N_slave[i];
        out.master[i][A] += share * N_master[i];
      }
    }
  }
  return Overlap::found;
}

}  // namespace presswork::mortar
