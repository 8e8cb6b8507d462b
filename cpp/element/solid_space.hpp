// SPDX-License-Identifier: Apache-2.0
// Geometry, forces and tangent of a solid in space (solid.hpp): gradients and volume at t, F of the increment, means
// over the element.
#pragma once

#include "element/solid2d_geometry.hpp"
#include "element/space_response.hpp"
#include "reference/hex.hpp"

namespace presswork {

// At one point.
template <int nodes, class T>
struct SpacePoint {
  T grad[nodes][3];  // at t
  T F[9];
  T volume_t, jacobian;
};

template <class Cell, int n_points, class T>
struct SolidSpace {
  static constexpr int dim = 3, nodes = Cell::nodes, freedoms = 3 * nodes, components = 6, gradients = 9;
  using Point = SpacePoint<nodes, T>;
  using Gradients = T[nodes][3];
  using Response = SpaceResponse<T>;

  static const ShapeTable<Cell, n_points>& table() {
    static const ShapeTable<Cell, n_points> shared;
    return shared;
  }

  // Gradients and volume of point q at t; true in lanes where the cell is turned inside out there.
  static Mask<T> measure_reference(const SolidSection&, const T x[][3], int q, Point& g) {
    const auto& shape = table();
    T J[9];  // dx_i / d xi_j
    for (auto& entry : J) entry = T(0.0);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) J[3 * i + j] += T(shape.dN[q][a][j]) * x[a][i];
    T det = stretch::determinant(J), cofactor[9];
    find_cofactors(J, cofactor);
    T inv = T(1.0) / det;
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        g.grad[a][i] = T(0.0);
        for (int j = 0; j < 3; ++j) g.grad[a][i] += cofactor[3 * i + j] * T(shape.dN[q][a][j]);
        g.grad[a][i] *= inv;
      }
    g.volume_t = T(shape.weight[q]) * det;
    return invert(det > T(0.0));
  }

  // A^-T det A
  PRESSWORK_DEVICE static void find_cofactors(const T A[9], T cofactor[9]) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        cofactor[3 * i + j] = A[3 * r + c] * A[3 * s + d] - A[3 * r + d] * A[3 * s + c];
      }
  }

  // F of the increment; true in lanes where the point is turned inside out, which small displacements cannot do.
  PRESSWORK_DEVICE static Mask<T> deform(const T du[][3], bool small, Point& g) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        T sum(i == j ? 1.0 : 0.0);
        for (int a = 0; a < nodes; ++a) sum += du[a][i] * g.grad[a][j];
        g.F[3 * i + j] = sum;
      }
    if (small) {
      g.jacobian = T(1.0);
      return invert(T(0.0) < T(1.0));
    }
    g.jacobian = stretch::determinant(g.F);
    return invert(g.jacobian > T(1e-6));
  }

  // Gradients on the configuration at t+dt; small: as at t.
  PRESSWORK_DEVICE static void push_forward(const Point& g, bool small, Gradients& now) {
    if (small) {
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < 3; ++i) now[a][i] = g.grad[a][i];
      return;
    }
    T cofactor[9], inv = T(1.0) / g.jacobian;
    find_cofactors(g.F, cofactor);
    for (auto& c : cofactor) c *= inv;
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i)
        now[a][i] =
            cofactor[3 * i] * g.grad[a][0] + cofactor[3 * i + 1] * g.grad[a][1] + cofactor[3 * i + 2] * g.grad[a][2];
  }

  // Element volume ratio Jbar, and (with stiffness) the mean divergence row of every freedom. small: the mean of tr
  // strain in its place.
  static T mean_dilatation(const Point* g, bool with_row, bool small, T* mean_div) {
    T v(0.0), V(0.0);
    for (int q = 0; q < n_points; ++q) {
      v += g[q].volume_t * (small ? g[q].F[0] + g[q].F[4] + g[q].F[8] - T(3.0) : g[q].jacobian);
      V += g[q].volume_t;
    }
    if (with_row || small) {
      const T whole = small ? V : v;
      for (int i = 0; i < freedoms; ++i) mean_div[i] = T(0.0);
      for (int q = 0; q < n_points; ++q) {
        Gradients now;
        push_forward(g[q], small, now);
        T weight = g[q].volume_t * g[q].jacobian / whole;
        for (int a = 0; a < nodes; ++a)
          for (int i = 0; i < 3; ++i) mean_div[3 * a + i] += weight * now[a][i];
      }
    }
    return v / V;
  }

  PRESSWORK_DEVICE static void use_mean_dilatation(const SolidSection&, T mean, const Point& g, bool small, T F[9]) {
    if (small) {
      T more = (mean - (F[0] + F[4] + F[8] - T(3.0))) * T(1.0 / 3);
      for (int i = 0; i < 9; i += 4) F[i] += more;
      return;
    }
    T factor = power(mean / g.jacobian, 1.0 / 3);
    for (int i = 0; i < 9; ++i) F[i] *= factor;
  }

  PRESSWORK_DEVICE static void add_force(const Gradients& now, const T s[6], T dv, T* force) {
    T p[6];
    for (int i = 0; i < 6; ++i) p[i] = s[i] * dv;
    for (int a = 0; a < nodes; ++a) {
      force[3 * a] += p[0] * now[a][0] + p[3] * now[a][1] + p[5] * now[a][2];
      force[3 * a + 1] += p[3] * now[a][0] + p[1] * now[a][1] + p[4] * now[a][2];
      force[3 * a + 2] += p[5] * now[a][0] + p[4] * now[a][1] + p[2] * now[a][2];
    }
  }

  // Rows of B^T of node a applied to a symmetric tensor.
  static void apply(const T grad[3], const T s[6], T out[3]) {
    out[0] = grad[0] * s[0] + grad[1] * s[3] + grad[2] * s[5];
    out[1] = grad[0] * s[3] + grad[1] * s[1] + grad[2] * s[4];
    out[2] = grad[0] * s[5] + grad[1] * s[4] + grad[2] * s[2];
  }

  static void add_stiffness(const Gradients& now, const Response& r, T dv, T* K) {
    for (int b = 0; b < nodes; ++b) {
      const T x = now[b][0] * dv, y = now[b][1] * dv, z = now[b][2] * dv;
      T along[3][6];  // C B_b dv
      for (int i = 0; i < 6; ++i) {
        const auto& c = r.modulus[i];
        along[0][i] = c[0] * x + c[3] * y + c[5] * z;
        along[1][i] = c[3] * x + c[1] * y + c[4] * z;
        along[2][i] = c[5] * x + c[4] * y + c[2] * z;
      }
      T pull[3];
      const T grad[3] = {x, y, z};
      apply(grad, r.stress, pull);
      for (int a = 0; a < nodes; ++a) {
        T initial(0.0);
        if (r.with_initial_stress) initial = now[a][0] * pull[0] + now[a][1] * pull[1] + now[a][2] * pull[2];
        for (int j = 0; j < 3; ++j) {
          T column[3];
          apply(now[a], along[j], column);
          column[j] += initial;
          for (int i = 0; i < 3; ++i) K[(3 * a + i) * freedoms + 3 * b + j] += column[i];
        }
      }
    }
  }

  // F-bar: + int G^T q (mean divergence - divergence) dv, q = (a : I - 2 sigma)/3 with a : I = C : I + sigma.
  static void add_fbar(const SolidSection&, const Gradients& now, const Response& r, T dv, const T* mean_div, T* K) {
    T q[6];
    for (int i = 0; i < 6; ++i)
      q[i] = T(1.0 / 3) * dv *
             (r.modulus[i][0] + r.modulus[i][1] + r.modulus[i][2] -
              (r.with_initial_stress ? T(1.0) : T(2.0)) * r.stress[i]);
    for (int a = 0; a < nodes; ++a) {
      T f[3];
      apply(now[a], q, f);
      for (int c = 0; c < nodes; ++c)
        for (int j = 0; j < 3; ++j) {
          const T d = mean_div[3 * c + j] - now[c][j];
          for (int i = 0; i < 3; ++i) K[(3 * a + i) * freedoms + 3 * c + j] += f[i] * d;
        }
    }
  }

  // B-bar, which is F-bar with small displacements: the mean divergence in the virtual strain too, so that the
  // stiffness is symmetric. Adds what add_force and add_stiffness lack.
  static void add_bbar(const SolidSection&, const Gradients& now, const Response& r, T dv, const T* mean_div, T* force,
                       T* K) {
    T more[freedoms], left[6], right[6], stiff(0.0);
    const T third(1.0 / 3), pressure = third * (r.stress[0] + r.stress[1] + r.stress[2]);
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        more[3 * a + i] = mean_div[3 * a + i] - now[a][i];
        force[3 * a + i] += more[3 * a + i] * pressure * dv;
      }
    if (!K) return;
    const auto& C = r.modulus;
    for (int i = 0; i < 6; ++i) {
      left[i] = third * (C[i][0] + C[i][1] + C[i][2]);
      right[i] = third * (C[0][i] + C[1][i] + C[2][i]);
    }
    for (int i = 0; i < 3; ++i) stiff += third * left[i];
    T on[freedoms], by[freedoms];
    for (int a = 0; a < nodes; ++a) apply(now[a], left, on + 3 * a), apply(now[a], right, by + 3 * a);
    for (int i = 0; i < freedoms; ++i)
      for (int j = 0; j < freedoms; ++j)
        K[i * freedoms + j] += dv * (on[i] * more[j] + more[i] * by[j] + stiff * more[i] * more[j]);
  }
};

}  // namespace presswork
