// SPDX-License-Identifier: Apache-2.0
// What makes one degenerated shell differ from another: the cell, the points in its plane, and where the covariant
// strains are sampled. All of it is constant tables.
//
// With nodal positions x_a and directors d_a (vectors), every covariant strain is a bilinear form of nodal values:
//   in-plane component c of {11, 22, 12 (engineering)}     1/2 sum_ab G_c[a][b] x_a.x_b,  G_11[a][b] = N_a,1 N_b,1 ...
//   transverse shear component k of {13, 23}               sum_ab H_k[a][b] x_a.d_b,      H_k[a][b] = N_a,k N_b
// so mixed interpolation, which replaces a component by values at tying points, is a sum of such tables.
//
//   none        strains where they are integrated (Ahmad, Irons & Zienkiewicz 1970)
//   selective   transverse shear from the points of the reduced rule
//   mitc        quad4: Dvorkin & Bathe 1984; tri3 and tri6: Lee & Bathe 2004 (MITC3, MITC6a); tri3_bubble: Lee, Lee &
//               Bathe 2014 (MITC3+); quad9: Huang & Hinton 1986 (MITC9 with its points moved to the sides)
//   mitc_plus   quad4: Ko, Lee & Bathe 2017 (MITC4+), with the curvatures tied as the membrane strains are
//
// The bubble of tri3_bubble has no position, x_4 = 0: it bends the field of directors alone (shell_bubble.hpp).
#pragma once

#include "reference/quad.hpp"
#include "reference/tri.hpp"

namespace presswork {

enum class Tying { none, selective, mitc, mitc_plus };

template <class Cell, int n_points, Tying tying>
struct ShellTable {
  static constexpr int nodes = Cell::nodes, points = n_points;
  static constexpr bool ties_in_plane =
      tying == Tying::mitc_plus ||
      (tying == Tying::mitc && (std::is_same_v<Cell, Tri6> || std::is_same_v<Cell, Quad9>));
  ShapeTable<Cell, n_points> shape;
  double x[n_points][2];
  double G[n_points][3][nodes][nodes];
  double H[n_points][2][nodes][nodes];
  // mitc_plus: G + R[q][c] sum_k W_k M[k], with weights W_k of the cell's own
  double M[5][nodes][nodes] = {}, R[n_points][3] = {};

  static const ShellTable& get() {
    static const ShellTable table;
    return table;
  }

  ShellTable() {
    place_points();
    for (int q = 0; q < n_points; ++q) {
      const double r = x[q][0], s = x[q][1];
      Form in_plane[3] = {stretch(0, r, s), stretch(1, r, s), stretch(2, r, s)};
      Form across[2] = {shear(0, r, s), shear(1, r, s)};
      if constexpr (tying == Tying::selective) tie_selectively(r, s, across);
      if constexpr (tying == Tying::mitc) {
        if constexpr (std::is_same_v<Cell, Quad4>) tie_quad4(r, s, across);
        if constexpr (std::is_same_v<Cell, Tri3>) tie_tri3(r, s, across);
        if constexpr (std::is_same_v<Cell, Tri3Bubble>) tie_tri3_bubble(r, s, across);
        if constexpr (std::is_same_v<Cell, Tri6>) tie_tri6(r, s, in_plane, across);
        if constexpr (std::is_same_v<Cell, Quad9>) tie_quad9(r, s, in_plane, across);
      }
      if constexpr (tying == Tying::mitc_plus) tie_quad4(r, s, across), tie_membrane(q, r, s, in_plane);
      for (int a = 0; a < nodes; ++a)
        for (int b = 0; b < nodes; ++b) {
          for (int c = 0; c < 3; ++c) G[q][c][a][b] = in_plane[c].at[a][b];
          for (int k = 0; k < 2; ++k) H[q][k][a][b] = across[k].at[a][b];
        }
    }
  }

 private:
  // Bilinear form of nodal values
  struct Form {
    double at[nodes][nodes] = {};

    Form& operator+=(const Form& other) { return add(other, 1.0); }
    Form& add(const Form& other, double factor) {
      for (int a = 0; a < nodes; ++a)
        for (int b = 0; b < nodes; ++b) at[a][b] += factor * other.at[a][b];
      return *this;
    }
    friend Form operator+(Form one, const Form& other) { return one += other; }
    friend Form operator-(Form one, const Form& other) { return one.add(other, -1.0); }
    friend Form operator*(double factor, const Form& form) { return Form().add(form, factor); }
  };

  void place_points() {
    const auto rule = Cell::template rule<n_points>();
    for (int q = 0; q < n_points; ++q)
      for (int i = 0; i < 2; ++i) x[q][i] = rule[q].at[i];
  }

  // in-plane strain c at (r, s)
  static Form stretch(int c, double r, double s) {
    double N[nodes], dN[nodes][2];
    const double at[2] = {r, s};
    Cell::shape(at, N, dN);
    Form form;
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b)
        form.at[a][b] = c < 2 ? dN[a][c] * dN[b][c] : dN[a][0] * dN[b][1] + dN[a][1] * dN[b][0];
    return form;
  }
  // transverse shear strain k at (r, s)
  static Form shear(int k, double r, double s) {
    double N[nodes], dN[nodes][2];
    const double at[2] = {r, s};
    Cell::shape(at, N, dN);
    Form form;
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b) form.at[a][b] = dN[a][k] * N[b];
    return form;
  }

  // shear from the reduced rule: its one point, or linear (triangle) and bilinear through its points
  static void tie_selectively(double r, double s, Form across[2]) {
    const double g = std::sqrt(1.0 / 3);
    for (int k = 0; k < 2; ++k) {
      if constexpr (std::is_same_v<Cell, Tri3>) {
        across[k] = shear(k, 1.0 / 3, 1.0 / 3);
      } else if constexpr (std::is_same_v<Cell, Quad4>) {
        across[k] = shear(k, 0.0, 0.0);
      } else if constexpr (std::is_same_v<Cell, Tri6>) {
        const double z = 1 - r - s;  // through (1/6, 1/6), (2/3, 1/6), (1/6, 2/3)
        across[k] = (2 * z - 1.0 / 3) * shear(k, 1.0 / 6, 1.0 / 6) + (2 * r - 1.0 / 3) * shear(k, 2.0 / 3, 1.0 / 6) +
                    (2 * s - 1.0 / 3) * shear(k, 1.0 / 6, 2.0 / 3);
      } else {
        across[k] = Form();
        for (double u : {-g, g})
          for (double v : {-g, g}) across[k].add(shear(k, u, v), 0.25 * (1 + r * u / (g * g)) * (1 + s * v / (g * g)));
      }
    }
  }

  static void tie_quad4(double r, double s, Form across[2]) {
    across[0] = 0.5 * (1 - s) * shear(0, 0.0, -1.0) + 0.5 * (1 + s) * shear(0, 0.0, 1.0);
    across[1] = 0.5 * (1 - r) * shear(1, -1.0, 0.0) + 0.5 * (1 + r) * shear(1, 1.0, 0.0);
  }

  // in-plane strains from the mid-sides and the centre; their bilinear part, of factors s s, r r and 2 r s, is R's
  void tie_membrane(int q, double r, double s, Form in_plane[3]) {
    const Form at[5] = {stretch(0, 0, 1), stretch(0, 0, -1), stretch(1, 1, 0), stretch(1, -1, 0), stretch(2, 0, 0)};
    in_plane[0] = 0.5 * (1 + s) * at[0] + 0.5 * (1 - s) * at[1];
    in_plane[1] = 0.5 * (1 + r) * at[2] + 0.5 * (1 - r) * at[3];
    in_plane[2] = at[4] + 0.5 * r * (at[0] - at[1]) + 0.5 * s * (at[2] - at[3]);
    R[q][0] = s * s - 1, R[q][1] = r * r - 1, R[q][2] = 2 * r * s;
    for (int k = 0; k < 5; ++k)
      for (int a = 0; a < nodes; ++a)
        for (int b = 0; b < nodes; ++b) M[k][a][b] = at[k].at[a][b];
  }

  // constant along each side, from the mid-sides (1/2, 0), (0, 1/2), (1/2, 1/2)
  static void tie_tri3(double r, double s, Form across[2]) {
    const Form one = shear(0, 0.5, 0.0), two = shear(1, 0.0, 0.5);
    const Form turn = two - one - shear(1, 0.5, 0.5) + shear(0, 0.5, 0.5);
    across[0] = one + s * turn;
    across[1] = two - r * turn;
  }

  // eqs. (9)-(11) of Lee, Lee & Bathe: a constant part from inside, where the bubble acts, and a turning part from
  // close to the centre, which in-plane twist does not stiffen
  static void tie_tri3_bubble(double r, double s, Form across[2]) {
    constexpr double third = 1.0 / 3, d = 1e-4;
    const Form corner = shear(0, 1.0 / 6, 1.0 / 6) + shear(1, 1.0 / 6, 1.0 / 6);
    const Form turn = shear(0, third + d, third + d) - shear(0, third + d, third - 2 * d) -
                      shear(1, third + d, third + d) + shear(1, third - 2 * d, third + d);
    across[0] = 2 * third * (shear(0, 2 * third, 1.0 / 6) - 0.5 * shear(1, 2 * third, 1.0 / 6)) + third * corner +
                third * (3 * s - 1) * turn;
    across[1] = 2 * third * (shear(1, 1.0 / 6, 2 * third) - 0.5 * shear(0, 1.0 / 6, 2 * third)) + third * corner +
                third * (1 - 3 * r) * turn;
  }

  // In-plane: the stretch along each side is linear, from the two Gauss points of the side and a point inside. Shear:
  // 13 = a + b r + c s + s (k r + l s), 23 = f + g r + h s - r (k r + l s), from the tangential shear at the Gauss
  // points of the sides and both components at the centre.
  static void tie_tri6(double r, double s, Form in_plane[3], Form across[2]) {
    const double root = std::sqrt(3.0), near = 0.5 - 0.5 / root, far = 0.5 + 0.5 / root;
    auto linear = [&](const Form& first, const Form& second, const Form& inside, double along, double into) {
      const Form slope = root * (second - first), start = 0.5 * (first + second) - 0.5 * slope;
      return start + along * slope + into * root * (inside - start - near * slope);
    };
    auto third_side = [](double u, double v) { return stretch(0, u, v) + stretch(1, u, v) - stretch(2, u, v); };
    in_plane[0] = linear(stretch(0, near, 0), stretch(0, far, 0), stretch(0, near, 1 / root), r, s);
    in_plane[1] = linear(stretch(1, 0, near), stretch(1, 0, far), stretch(1, 1 / root, near), s, r);
    const Form slant = linear(third_side(far, near), third_side(near, far), third_side(near, near), s, 1 - r - s);
    in_plane[2] = in_plane[0] + in_plane[1] - slant;

    auto along_third = [](double u, double v) { return shear(1, u, v) - shear(0, u, v); };
    const Form b = root * (shear(0, far, 0) - shear(0, near, 0)), h = root * (shear(1, 0, far) - shear(1, 0, near));
    const Form a = 0.5 * (shear(0, far, 0) + shear(0, near, 0)) - 0.5 * b;
    const Form f = 0.5 * (shear(1, 0, far) + shear(1, 0, near)) - 0.5 * h;
    const Form rise = root * (along_third(near, far) - along_third(far, near));
    const Form at_two = 0.5 * (along_third(near, far) + along_third(far, near)) - 0.5 * rise, at_three = at_two + rise;
    const Form sum = 2 * (f - a) - b + h - at_two - at_three;
    const Form one = shear(0, 1.0 / 3, 1.0 / 3) - a - 1.0 / 3 * b, two = shear(1, 1.0 / 3, 1.0 / 3) - f - 1.0 / 3 * h;
    const Form c = 6 * one - 3 * two - sum, g = 6 * two - 3 * one + sum;
    const Form k = f - a + g - b - at_two, l = f - a + h - c - at_three;
    across[0] = a + r * b + s * c + s * (r * k + s * l);
    across[1] = f + r * g + s * h - r * (r * k + s * l);
  }

  // 11 and 13: linear in r through +-1/sqrt 3, quadratic in s through -1, 0, 1; 22 and 23 turned; 12: bilinear through
  // the 2x2 points. MITC9 (Bucalem & Bathe 1993) has +-sqrt(3/5) for -1 and 1, inside: what neighbours then do not
  // share makes too many constraints, and distorted thin meshes lock.
  static void tie_quad9(double r, double s, Form in_plane[3], Form across[2]) {
    const double g = std::sqrt(1.0 / 3);
    auto linear = [&](double at, double u) { return 0.5 * (1 + u * at / (g * g)); };
    auto quadratic = [](double at, double v) { return v == 0.0 ? 1 - at * at : 0.5 * at * (at + v); };
    for (int c = 0; c < 3; ++c) in_plane[c] = Form();
    across[0] = across[1] = Form();
    for (double u : {-g, g}) {
      for (double v : {-1.0, 0.0, 1.0}) {
        in_plane[0].add(stretch(0, u, v), linear(r, u) * quadratic(s, v));
        in_plane[1].add(stretch(1, v, u), linear(s, u) * quadratic(r, v));
        across[0].add(shear(0, u, v), linear(r, u) * quadratic(s, v));
        across[1].add(shear(1, v, u), linear(s, u) * quadratic(r, v));
      }
      for (double v : {-g, g}) in_plane[2].add(stretch(2, u, v), linear(r, u) * linear(s, v));
    }
  }
};

}  // namespace presswork
