// SPDX-License-Identifier: Apache-2.0
// Heat conduction in a cell: Fourier's law on the shape functions of the cell, one temperature a node.
//
// flow_a = int k(T) grad N_a . grad T dV                        heat that leaves node a through the cell [N mm/s]
// K_ab   = d flow_a / d T_b = int k grad N_a . grad N_b + k' N_b grad N_a . grad T dV
// (Lewis, Morgan, Thomas & Seetharamu 1996, ch. 3). The rows of both add up to zero in a: no heat is made or lost.
// K is symmetric where the conductivity k is constant. In axisymmetry integrals carry 2 pi r, in the plane the depth.
//
// The capacity is lumped: node a stands for the volume int N_a dV, or, of cells where that is not positive at every
// node (tri6, quad8), for a part of the cell's volume in proportion to int N_a^2 dV (Hinton, Rock & Zienkiewicz 1976).
// A lumped capacity does not overshoot however short the time step, as a consistent one does below h^2 / (6 alpha).
#pragma once

#include <type_traits>

#include "element/solid.hpp"

namespace presswork {

// A quantity that depends on temperature: linear between rows, constant beyond the first and the last.
struct TemperatureTable {
  static constexpr int columns = 3;
  const double* row;  // (n, 3): temperature [degrees C], increasing, value, and slope up to the next row, 0 in the last
  int n;

  template <class T>
  void find(T temperature, T& value, T& slope) const {
    value = T(row[1]), slope = T(0.0);
    for (int i = 0; i < n; ++i) {
      const double* r = row + columns * i;
      const auto below = temperature < T(r[0]);
      value = select(below, value, T(r[1]) + T(r[2]) * (temperature - T(r[0])));
      slope = select(below, slope, T(r[2]));
    }
  }
};

template <int dim, class Cell, int n_points, class T>
struct HeatCell {
  using Body = SolidBody<dim, Cell, n_points, T>;
  static constexpr int nodes = Cell::nodes;
  static constexpr bool by_squares = std::is_same_v<Cell, Tri6> || std::is_same_v<Cell, Quad8>;

  // Heat that leaves the nodes at temperatures theta and, if K is given, its derivative K[nodes * a + b]. True in lanes
  // where the cell is turned inside out.
  static Mask<T> conduct(const SolidSection& section, const TemperatureTable& conductivity, const T x[][dim],
                         const T* theta, T* flow, T* K) {
    Mask<T> bad = T(1.0) < T(0.0);
    for (int a = 0; a < nodes; ++a) flow[a] = T(0.0);
    if (K)
      for (int i = 0; i < nodes * nodes; ++i) K[i] = T(0.0);
    for (int q = 0; q < n_points; ++q) {
      typename Body::Point g;
      bad = either(bad, Body::measure_reference(section, x, q, g));
      const double* N = Body::table().N[q];
      T temperature(0.0), gradient[dim], k, slope;
      for (int i = 0; i < dim; ++i) gradient[i] = T(0.0);
      for (int a = 0; a < nodes; ++a) {
        temperature += T(N[a]) * theta[a];
        for (int i = 0; i < dim; ++i) gradient[i] += theta[a] * g.grad[a][i];
      }
      conductivity.find(temperature, k, slope);
      k = k * g.volume_t, slope = slope * g.volume_t;
      for (int a = 0; a < nodes; ++a) {
        const T along = dot(g.grad[a], gradient);
        flow[a] += k * along;
        if (!K) continue;
        for (int b = 0; b < nodes; ++b) K[nodes * a + b] += k * dot(g.grad[a], g.grad[b]) + slope * T(N[b]) * along;
      }
    }
    return bad;
  }

  // Volume that each node stands for [mm3].
  static void lump(const SolidSection& section, const T x[][dim], T* volume) {
    T total(0.0), sum(0.0);
    for (int a = 0; a < nodes; ++a) volume[a] = T(0.0);
    for (int q = 0; q < n_points; ++q) {
      typename Body::Point g;
      Body::measure_reference(section, x, q, g);
      total += g.volume_t;
      for (int a = 0; a < nodes; ++a) {
        const double N = Body::table().N[q][a];
        volume[a] += T(by_squares ? N * N : N) * g.volume_t;
      }
    }
    if constexpr (by_squares) {
      for (int a = 0; a < nodes; ++a) sum += volume[a];
      for (int a = 0; a < nodes; ++a) volume[a] = volume[a] * total / sum;
    }
  }

 private:
  static T dot(const T* a, const T* b) {
    T sum = a[0] * b[0];
    for (int i = 1; i < dim; ++i) sum += a[i] * b[i];
    return sum;
  }
};

}  // namespace presswork
