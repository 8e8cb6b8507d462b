// SPDX-License-Identifier: Apache-2.0
// Degenerated shells, layered, in large rotation and large strain: one kernel for every cell and every choice of where
// strains are sampled (shell_table.hpp), on one lane or a SIMD pack.
//
// Updated Lagrangian. With x the nodal positions, d the unit directors, z the distance from the mid-surface, h the
// thickness at the point (its own, not interpolated), at t and t+dt:
//   surface     a_i = sum N_a,i x_a,   b_i = sum N_a,i d_a,   layer  g_i = a_i + z b_i
//   strain      E_ij = 1/2 (g_i.g_j |t+dt - g_i.g_j |t) = E0 + z E1 + z^2 E2,   shear_i = a_i.d |t+dt - a_i.d |t
// written as products with the increment, so that nothing cancels however thin the shell. E2 is taken 6/5 times, since
// layers outside a bend become thinner and those inside thicker ("Tight bends", docs/theory/shells.md). Stress of a
// layer: shell_layer.hpp. Transverse shear is elastic, constant through the thickness, with the factor 5/6; its
// contravariant components p^i per area of the reference cell are kept, p^i += 5/6 G h A^ij shear_j (a Lie derivative:
// objective, and no frame to turn). The force at the end of an increment is that at the start of the next
// (docs/theory/shells.md): the metric comes from the strains' tables, and all layers of a point share the change of its
// thickness. Internal work: sum over layers of S:dE, plus p.dshear; three resultants (1, z, z^2) of the layers carry it
// to the nodes, so the cost of a layer is that of its law.
//
// Six freedoms a node: displacement, and the rotation vector of the increment (director.hpp). The residual's derivative
// is complete: law, stress on second derivatives of strain, and curvature of the rotation. `penalty` adds the Kirchhoff
// term K_p of Cheng (1995, eq. 29) to the tangent alone: penalty times the elastic shear stiffness; no answer depends
// on it.
//
// With small displacements positions and directors are the undeformed ones, strains and d - d0 = theta x d0 are linear
// in the increment, forces are those on the undeformed shell, and the thickness stays.
//
// Cells are taken pack_width at a time as solid_block.hpp does; row = 6 node + freedom.
#pragma once

#include "element/director.hpp"
#include "element/shell_layer.hpp"
#include "element/shell_table.hpp"

namespace presswork {

inline constexpr double shear_factor = 5.0 / 6.0;
inline constexpr double square_share = 6.0 / 5.0;  // how many times E2 is taken

template <class Cell, int n_points, Tying tying, class T = Pack>
struct Shell {
  using Table = ShellTable<Cell, n_points, tying>;
  static constexpr int nodes = Cell::nodes, freedoms = 6 * nodes;
  static constexpr bool has_bubble =
      std::is_same_v<Cell, Tri3Bubble>;  // the last "node": no position, and it does not turn
  static constexpr int mesh_nodes = has_bubble ? nodes - 1 : nodes;

  // The tables with what a cell's own shape adds to them (shell_table.hpp)
  struct Forms {
    const Table& table;
    T bilinear[tying == Tying::mitc_plus ? nodes : 1][nodes];

    T G(int q, int c, int a, int b) const {
      if constexpr (tying == Tying::mitc_plus) return T(table.G[q][c][a][b]) + T(table.R[q][c]) * bilinear[a][b];
      return T(table.G[q][c][a][b]);
    }
    T H(int q, int k, int a, int b) const { return T(table.H[q][k][a][b]); }

    // Ko, Lee & Bathe's eqs. for the strain that is bilinear in the plane: x_d = c_r x_r + c_s x_s were the cell flat
    void fit(const T x[][3]) {
      if constexpr (tying == Tying::mitc_plus) {
        T r[3], s[3], d[3], n[3], over_r[3], over_s[3], c_r, c_s;
        for (int i = 0; i < 3; ++i) {
          r[i] = x[1][i] + x[2][i] - x[0][i] - x[3][i];
          s[i] = x[2][i] + x[3][i] - x[0][i] - x[1][i];
          d[i] = x[0][i] + x[2][i] - x[1][i] - x[3][i];
        }
        cross3(r, s, n);
        cross3(s, n, over_r), cross3(n, r, over_s);
        const T over = T(1.0) / dot3(n, n);
        c_r = dot3(d, over_r) * over, c_s = dot3(d, over_s) * over;
        // below 1 in a convex quadrilateral; 1 where two corners meet
        const T square = smaller(c_r * c_r + c_s * c_s, T(0.99));
        const T scale = T(1.0) / (square - T(1.0)), half = T(0.5) * scale;
        const T weight[5] = {half * c_r * (c_r - T(1.0)), half * c_r * (c_r + T(1.0)), half * c_s * (c_s - T(1.0)),
                             half * c_s * (c_s + T(1.0)), scale * c_r * c_s};
        for (int a = 0; a < nodes; ++a)
          for (int b = 0; b < nodes; ++b) {
            bilinear[a][b] = T(0.0);
            for (int k = 0; k < 5; ++k) bilinear[a][b] += weight[k] * T(table.M[k][a][b]);
          }
      }
    }
  };

  struct Nodes {
    T x[nodes][3], u[nodes][3], d[nodes][3];  // position, displacement, director at t
    DirectorTurn<T> turn[nodes];
  };

  // First derivatives of the strains by nodal values, at one configuration
  struct Gradient {
    T V[3][nodes][3], W[3][nodes][3];  // dE0/dx = V, dE1/dx = W, dE1/dd = V, dE2/dd = 6/5 W
    T X[2][nodes][3], Y[2][nodes][3];  // dshear/dx, dshear/dd
  };

  struct Strain {
    T E[3][3], shear[2];  // E0, E1, E2
  };

  // Geometry of the surface at a point at t
  struct Surface {
    T a[3][3];           // coefficients of the metric g_11, g_22, g_12 by powers of z: a[power][component]
    T area, inverse[3];  // A^11, A^22, A^12
  };

  // Resultants of the layers by powers of z, moments of their moduli at constant thickness, and what E0, E1, E2 change
  // the logarithm of the thickness by; until that is known, the volume and the area of all layers
  struct Resultants {
    T S[3][3];
    T C[5][3][3];
    T thickness[3][3], area[3][3];

    // Layers of a sheet of constant thickness to those of one that is so many times as thick: volume over area
    void change_thickness(T volume, T whole_area) {
      const T stretch = volume / whole_area, by_volume = T(1.0) / volume, by_area = T(1.0) / whole_area;
      for (auto& row : S)
        for (auto& s : row) s *= stretch;
      for (auto& matrix : C)
        for (auto& row : matrix)
          for (auto& c : row) c *= stretch;
      for (int p = 0; p < 3; ++p)
        for (int c = 0; c < 3; ++c) thickness[p][c] = by_volume * thickness[p][c] - by_area * area[p][c];
    }
  };

  static void differentiate(const Forms& forms, int q, const T x[][3], const T d[][3], Gradient& g) {
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 3; ++c) {
          T v(0.0), w(0.0);
          for (int b = 0; b < nodes; ++b) {
            v += forms.G(q, c, a, b) * x[b][i];
            w += forms.G(q, c, a, b) * d[b][i];
          }
          g.V[c][a][i] = v, g.W[c][a][i] = w;
        }
        for (int k = 0; k < 2; ++k) {
          T v(0.0), w(0.0);
          for (int b = 0; b < nodes; ++b) {
            v += forms.H(q, k, a, b) * d[b][i];
            w += forms.H(q, k, b, a) * x[b][i];
          }
          g.X[k][a][i] = v, g.Y[k][a][i] = w;
        }
      }
  }

  // Strain of the increment: bilinear forms change by the gradient half-way times the increment, exactly
  static void measure(const Gradient& mid, const Nodes& n, Strain& e) {
    for (int c = 0; c < 3; ++c) {
      T e0(0.0), e1(0.0), e2(0.0);
      for (int a = 0; a < nodes; ++a) {
        e0 += dot3(mid.V[c][a], n.u[a]);
        e1 += dot3(mid.V[c][a], n.turn[a].change) + dot3(mid.W[c][a], n.u[a]);
        e2 += dot3(mid.W[c][a], n.turn[a].change);
      }
      e.E[0][c] = e0, e.E[1][c] = e1, e.E[2][c] = T(square_share) * e2;
    }
    for (int k = 0; k < 2; ++k) {
      T shear(0.0);
      for (int a = 0; a < nodes; ++a) shear += dot3(mid.X[k][a], n.u[a]) + dot3(mid.Y[k][a], n.turn[a].change);
      e.shear[k] = shear;
    }
  }

  // a_i and the direction of d at a point; gives the lanes turned inside out: a_1 x a_2 against d
  static Mask<T> base_vectors(const Table& table, int q, const T x[][3], const T d[][3], T a[2][3], T b[2][3]) {
    T mean[3] = {T(0.0), T(0.0), T(0.0)}, normal[3];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 2; ++k) {
        a[k][i] = b[k][i] = T(0.0);
        for (int n = 0; n < nodes; ++n) {
          a[k][i] += T(table.shape.dN[q][n][k]) * x[n][i];
          b[k][i] += T(table.shape.dN[q][n][k]) * d[n][i];
        }
      }
    for (int n = 0; n < nodes; ++n)
      for (int i = 0; i < 3; ++i) mean[i] += T(table.shape.N[q][n]) * d[n][i];
    cross3(a[0], a[1], normal);
    return !(dot3(normal, mean) > T(0.0));
  }

  // The metric comes from the tables that the strains come from, so that it changes by twice the increment's strain and
  // stress that a converged increment left is in balance where the next one starts.
  static Mask<T> measure_surface(const Forms& forms, int q, const Nodes& n, Surface& s) {
    T a[2][3], b[2][3];
    auto bad = base_vectors(forms.table, q, n.x, n.d, a, b);
    if constexpr (Table::ties_in_plane) {
      Gradient g;
      differentiate(forms, q, n.x, n.d, g);
      for (int c = 0; c < 3; ++c) {
        const T half(c == 2 ? 0.5 : 1.0);
        for (auto& power : s.a) power[c] = T(0.0);
        for (int node = 0; node < nodes; ++node) {
          s.a[0][c] += half * dot3(g.V[c][node], n.x[node]);
          s.a[1][c] += T(2.0) * half * dot3(g.W[c][node], n.x[node]);
          s.a[2][c] += T(square_share) * half * dot3(g.W[c][node], n.d[node]);
        }
      }
    } else {
      for (int c = 0; c < 3; ++c) {
        const int i = c == 1, j = c != 0;
        s.a[0][c] = dot3(a[i], a[j]);
        s.a[1][c] = dot3(a[i], b[j]) + dot3(b[i], a[j]);
        s.a[2][c] = T(square_share) * dot3(b[i], b[j]);
      }
    }
    T squared = s.a[0][0] * s.a[0][1] - s.a[0][2] * s.a[0][2];
    T over = T(1.0) / squared;
    s.area = square_root(squared);
    s.inverse[0] = s.a[0][1] * over, s.inverse[1] = s.a[0][0] * over, s.inverse[2] = -s.a[0][2] * over;
    return bad;
  }

  // Q: covariant strain (11, 22, 12 engineering) -> lamina strain, at height z; gives the area there
  static T lamina_map(const Surface& s, T z, const T direction[2], T Q[3][3]) {
    T g[3];
    for (int c = 0; c < 3; ++c) g[c] = s.a[0][c] + z * (s.a[1][c] + z * s.a[2][c]);
    T area = square_root(g[0] * g[1] - g[2] * g[2]), length = square_root(g[0]), over = T(1.0) / length;
    T c = direction[0], sn = direction[1];
    T along = g[2] * over, across = area * over;  // g_2 along and across g_1
    T g2x = along * c - across * sn, g2y = along * sn + across * c;
    T inv = T(1.0) / area;
    T p[2] = {g2y * inv, -g2x * inv}, r[2] = {-length * sn * inv, length * c * inv};  // g^1, g^2
    for (int i = 0; i < 2; ++i) Q[i][0] = p[i] * p[i], Q[i][1] = r[i] * r[i], Q[i][2] = p[i] * r[i];
    Q[2][0] = T(2.0) * p[0] * p[1], Q[2][1] = T(2.0) * r[0] * r[1], Q[2][2] = p[0] * r[1] + p[1] * r[0];
    return area;
  }

  static void add_layer(const LayerResponse<T>& r, const T Q[3][3], T weight, T z, bool with_modulus, Resultants& sum) {
    T power = weight, force[3], modulus[3][3];
    for (int i = 0; i < 3; ++i) force[i] = Q[0][i] * r.force[0] + Q[1][i] * r.force[1] + Q[2][i] * r.force[2];
    if (with_modulus) {
      T half[3][3];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          half[i][j] = r.modulus[i][0] * Q[0][j] + r.modulus[i][1] * Q[1][j] + r.modulus[i][2] * Q[2][j];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) modulus[i][j] = Q[0][i] * half[0][j] + Q[1][i] * half[1][j] + Q[2][i] * half[2][j];
    }
    for (int k = 0; k < 5; ++k, power *= z) {
      if (k < 3)
        for (int i = 0; i < 3; ++i) sum.S[k][i] += power * force[i];
      if (with_modulus)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) sum.C[k][i][j] += power * modulus[i][j];
    }
  }

  static void add_force(const Gradient& g, const Resultants& r, const T shear[2], T force[freedoms]) {
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        T &x = force[6 * a + i], &d = force[6 * a + 3 + i];
        for (int c = 0; c < 3; ++c) {
          x += r.S[0][c] * g.V[c][a][i] + r.S[1][c] * g.W[c][a][i];
          d += r.S[1][c] * g.V[c][a][i] + T(square_share) * r.S[2][c] * g.W[c][a][i];
        }
        for (int k = 0; k < 2; ++k) x += shear[k] * g.X[k][a][i], d += shear[k] * g.Y[k][a][i];
      }
  }

  // Law and, if asked, stress on second derivatives of strain, by nodal positions and directors: row = 6 node + (x | d)
  // component
  static void add_stiffness(const Forms& forms, int q, const Gradient& g, const Resultants& r, const T shear[2],
                            const T D[2][2], bool with_stress, T (*K)[freedoms]) {
    const T two(square_share);
    for (int b = 0; b < nodes; ++b)
      for (int j = 0; j < 3; ++j) {
        T by_x[3][3], by_d[3][3], px[2], pd[2];  // what x and d of node b change the resultants by
        for (int k = 0; k < 3; ++k)
          for (int c = 0; c < 3; ++c) {
            by_x[k][c] = by_d[k][c] = T(0.0);
            for (int e = 0; e < 3; ++e) {
              by_x[k][c] += r.C[k][c][e] * g.V[e][b][j] + r.C[k + 1][c][e] * g.W[e][b][j];
              by_d[k][c] += r.C[k + 1][c][e] * g.V[e][b][j] + two * r.C[k + 2][c][e] * g.W[e][b][j];
            }
          }
        for (int k = 0; k < 2; ++k) {
          px[k] = D[k][0] * g.X[0][b][j] + D[k][1] * g.X[1][b][j];
          pd[k] = D[k][0] * g.Y[0][b][j] + D[k][1] * g.Y[1][b][j];
        }
        T thickness_x(0.0), thickness_d(0.0);
        for (int c = 0; c < 3; ++c) {
          thickness_x += r.thickness[0][c] * g.V[c][b][j] + r.thickness[1][c] * g.W[c][b][j];
          thickness_d += r.thickness[1][c] * g.V[c][b][j] + two * r.thickness[2][c] * g.W[c][b][j];
        }
        for (int a = 0; a < nodes; ++a)
          for (int i = 0; i < 3; ++i) {
            T xx(0.0), xd(0.0), dx(0.0), dd(0.0), force_x(0.0), force_d(0.0);
            for (int c = 0; c < 3; ++c) {
              const T V = g.V[c][a][i], W = g.W[c][a][i];
              xx += V * by_x[0][c] + W * by_x[1][c];
              xd += V * by_d[0][c] + W * by_d[1][c];
              dx += V * by_x[1][c] + two * W * by_x[2][c];
              dd += V * by_d[1][c] + two * W * by_d[2][c];
              force_x += r.S[0][c] * V + r.S[1][c] * W;
              force_d += r.S[1][c] * V + two * r.S[2][c] * W;
            }
            T* row_x = &K[6 * a + i][6 * b + j];
            T* row_d = &K[6 * a + 3 + i][6 * b + j];
            row_x[0] += xx + g.X[0][a][i] * px[0] + g.X[1][a][i] * px[1] + force_x * thickness_x;
            row_x[3] += xd + g.X[0][a][i] * pd[0] + g.X[1][a][i] * pd[1] + force_x * thickness_d;
            row_d[0] += dx + g.Y[0][a][i] * px[0] + g.Y[1][a][i] * px[1] + force_d * thickness_x;
            row_d[3] += dd + g.Y[0][a][i] * pd[0] + g.Y[1][a][i] * pd[1] + force_d * thickness_d;
          }
      }
    if (!with_stress) return;
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b) {
        T xx(0.0), xd(0.0), dd(0.0), dx;
        for (int c = 0; c < 3; ++c) {
          T G = forms.G(q, c, a, b);
          xx += G * r.S[0][c], xd += G * r.S[1][c], dd += two * G * r.S[2][c];
        }
        dx = xd;
        for (int k = 0; k < 2; ++k) xd += forms.H(q, k, a, b) * shear[k], dx += forms.H(q, k, b, a) * shear[k];
        for (int i = 0; i < 3; ++i) {
          K[6 * a + i][6 * b + i] += xx, K[6 * a + i][6 * b + 3 + i] += xd;
          K[6 * a + 3 + i][6 * b + i] += dx, K[6 * a + 3 + i][6 * b + 3 + i] += dd;
        }
      }
  }

  // From directors to rotation vectors, in place: forces first, as the curvature of the rotation needs them
  static void take_rotations(const Nodes& n, T force[freedoms], T (*K)[freedoms], bool small) {
    T slope[mesh_nodes][3][3];
    for (int a = 0; a < mesh_nodes; ++a) {
      T* f = force + 6 * a + 3;
      const T moment[3] = {f[0], f[1], f[2]};
      small ? n.turn[a].differentiate_linearly(slope[a]) : n.turn[a].differentiate(slope[a]);
      for (int j = 0; j < 3; ++j)
        f[j] = moment[0] * slope[a][0][j] + moment[1] * slope[a][1][j] + moment[2] * slope[a][2][j];
      if (!K) continue;
      T second[3][3] = {};
      if (!small) n.turn[a].curve(moment, second);
      for (int row = 0; row < 6 * mesh_nodes; ++row) {
        T* k = &K[row][6 * a + 3];
        const T old[3] = {k[0], k[1], k[2]};
        for (int j = 0; j < 3; ++j) k[j] = old[0] * slope[a][0][j] + old[1] * slope[a][1][j] + old[2] * slope[a][2][j];
      }
      for (int column = 0; column < 6 * mesh_nodes; ++column) {
        const T old[3] = {K[6 * a + 3][column], K[6 * a + 4][column], K[6 * a + 5][column]};
        for (int i = 0; i < 3; ++i)
          K[6 * a + 3 + i][column] = old[0] * slope[a][0][i] + old[1] * slope[a][1][i] + old[2] * slope[a][2][i];
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K[6 * a + 3 + i][6 * a + 3 + j] += second[i][j];
    }
  }
};

}  // namespace presswork
