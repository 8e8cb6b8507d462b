// SPDX-License-Identifier: Apache-2.0
// Forces and tangent of a solid in the plane (solid.hpp) at a point: of stress, of F-bar, of hourglass control.
#pragma once

#include "element/solid2d_geometry.hpp"

namespace presswork {

template <int nodes, class T = Pack>
struct SolidForces {
  static constexpr int freedoms = 2 * nodes;

  static void add_force(const T now[][3], const T s[4], T dv, T* force) {
    T sx = s[0] * dv, sy = s[1] * dv, sh = s[2] * dv, sxy = s[3] * dv;
    for (int a = 0; a < nodes; ++a) {
      force[2 * a] += sx * now[a][0] + sxy * now[a][1] + sh * now[a][2];
      force[2 * a + 1] += sxy * now[a][0] + sy * now[a][1];
    }
  }

  static void add_stiffness(const T now[][3], const T m[5][5], T dv, T* K) {
    for (int b = 0; b < nodes; ++b) {
      T x = now[b][0] * dv, y = now[b][1] * dv, h = now[b][2] * dv;
      T along[5][2];
      for (int r = 0; r < 5; ++r) {
        along[r][0] = m[r][0] * x + m[r][1] * y + m[r][4] * h;
        along[r][1] = m[r][2] * x + m[r][3] * y;
      }
      for (int a = 0; a < nodes; ++a)
        for (int j = 0; j < 2; ++j) {
          K[(2 * a) * freedoms + 2 * b + j] +=
              now[a][0] * along[0][j] + now[a][1] * along[1][j] + now[a][2] * along[4][j];
          K[(2 * a + 1) * freedoms + 2 * b + j] += now[a][0] * along[2][j] + now[a][1] * along[3][j];
        }
    }
  }

  // F-bar: + int G^T q (mean divergence - divergence) dv, q = (a:I - 2 sigma)/3, in plane strain (a:I - sigma)/2.
  static void add_fbar(const SolidSection& section, const T now[][3], const T m[5][5], const T s[4], T dv,
                       const T* mean_div, T* K) {
    const T sigma[5] = {s[0], s[3], s[3], s[1], s[2]};
    T qv[5];
    for (int r = 0; r < 5; ++r)
      qv[r] = section.axisymmetric ? T(1.0 / 3) * (m[r][0] + m[r][3] + m[r][4] - T(2.0) * sigma[r])
                                   : T(0.5) * (m[r][0] + m[r][3] - sigma[r]);
    for (int a = 0; a < nodes; ++a) {
      T fx = (now[a][0] * qv[0] + now[a][1] * qv[1] + now[a][2] * qv[4]) * dv;
      T fy = (now[a][0] * qv[2] + now[a][1] * qv[3]) * dv;
      for (int c = 0; c < nodes; ++c) {
        T dx = mean_div[2 * c] - now[c][0] - now[c][2], dy = mean_div[2 * c + 1] - now[c][1];
        K[(2 * a) * freedoms + 2 * c] += fx * dx;
        K[(2 * a) * freedoms + 2 * c + 1] += fx * dy;
        K[(2 * a + 1) * freedoms + 2 * c] += fy * dx;
        K[(2 * a + 1) * freedoms + 2 * c + 1] += fy * dy;
      }
    }
  }

  // B-bar, which is F-bar with small displacements: the mean divergence in the virtual strain too, so that the
  // stiffness is symmetric. Adds what add_force and add_stiffness lack.
  static void add_bbar(const SolidSection& section, const T now[][3], const T m[5][5], const T s[4], T dv,
                       const T* mean_div, T* force, T* K) {
    const int rows = section.axisymmetric ? 3 : 2;
    constexpr int diagonal[3] = {0, 3, 4};
    const T part(1.0 / rows);
    T more[freedoms], pressure(0.0), stiff(0.0), left[5], right[5];
    for (int r = 0; r < rows; ++r) pressure += part * s[r];
    for (int a = 0; a < nodes; ++a) {
      more[2 * a] = mean_div[2 * a] - now[a][0] - now[a][2];
      more[2 * a + 1] = mean_div[2 * a + 1] - now[a][1];
    }
    for (int i = 0; i < freedoms; ++i) force[i] += more[i] * pressure * dv;
    if (!K) return;
    for (int r = 0; r < 5; ++r) {
      left[r] = right[r] = T(0.0);
      for (int c = 0; c < rows; ++c) left[r] += part * m[r][diagonal[c]], right[r] += part * m[diagonal[c]][r];
    }
    for (int r = 0; r < rows; ++r) stiff += part * left[diagonal[r]];
    T on[freedoms], by[freedoms];
    for (int a = 0; a < nodes; ++a) {
      on[2 * a] = now[a][0] * left[0] + now[a][1] * left[1] + now[a][2] * left[4];
      on[2 * a + 1] = now[a][0] * left[2] + now[a][1] * left[3];
      by[2 * a] = now[a][0] * right[0] + now[a][1] * right[1] + now[a][2] * right[4];
      by[2 * a + 1] = now[a][0] * right[2] + now[a][1] * right[3];
    }
    for (int i = 0; i < freedoms; ++i)
      for (int j = 0; j < freedoms; ++j)
        K[i * freedoms + j] += dv * (on[i] * more[j] + more[i] * by[j] + stiff * more[i] * more[j]);
  }

  // The shear modulus before first yield, then flow + slope/3 of the hardening at t, at most the shear modulus.
  PRESSWORK_DEVICE static T hourglass_modulus(T elastic, T eqps_n, T flow, T slope) {
    return select(eqps_n > T(0.0), smaller(flow + slope * T(1.0 / 3), elastic), elastic);
  }

  // Returns the work of the hourglass forces; modulus as above.
  static T add_hourglass(T modulus, double fraction, const T x[][2], const T du[][2], const SolidPoint<nodes, T>& g,
                         const T now[][3], T Q[2], T* force, T* K, bool small = false) {
    // 1. hourglass vectors at t and at t+dt: orthogonal to every linear field there
    constexpr double h[4] = {1, -1, 1, -1};
    T at_t[2] = {T(0.0), T(0.0)}, at_end[2] = {T(0.0), T(0.0)}, norm(0.0), gamma[4], gamma_end[4];
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 2; ++i) {
        at_t[i] += T(h[a]) * x[a][i];
        at_end[i] += T(h[a]) * (small ? x[a][i] : x[a][i] + du[a][i]);
        norm += g.grad[a][i] * g.grad[a][i];
      }
    for (int a = 0; a < 4; ++a) {
      gamma[a] = T(0.25) * (T(h[a]) - at_t[0] * g.grad[a][0] - at_t[1] * g.grad[a][1]);
      gamma_end[a] = T(0.25) * (T(h[a]) - at_end[0] * now[a][0] - at_end[1] * now[a][1]);
    }
    // 2. forces, turned with the material; gamma at t+dt keeps the balance of moments
    const T k = T(2.0 * fraction) * modulus * g.volume_t * norm;
    T a = g.F[0] + g.F[3], b = g.F[2] - g.F[1], trace = square_root(a * a + b * b);
    T c = small ? T(1.0) : a / trace, s = small ? T(0.0) : b / trace;
    T turned[2] = {c * Q[0] - s * Q[1], s * Q[0] + c * Q[1]};
    T work(0.0);
    for (int i = 0; i < 2; ++i) {
      T mode(0.0);
      for (int n = 0; n < 4; ++n) mode += gamma[n] * du[n][i];
      Q[i] = turned[i] + k * mode;
      work += T(0.5) * (turned[i] + Q[i]) * mode;
      for (int n = 0; n < 4; ++n) force[2 * n + i] += gamma_end[n] * Q[i];
    }
    // 3. tangent: dQ (stiffness, and turning: dtheta = (a db - b da) / (a^2 + b^2)) and d gamma_end = -B (gamma_end.du)
    if (!K) return work;
    T inv = T(1.0) / (trace * trace);
    for (int m = 0; m < 4; ++m) {
      const T dtheta[2] = {(-a * g.grad[m][1] - b * g.grad[m][0]) * inv, (a * g.grad[m][0] - b * g.grad[m][1]) * inv};
      for (int n = 0; n < 4; ++n)
        for (int j = 0; j < 2; ++j) {
          T* column = K + 2 * n * freedoms + 2 * m + j;
          column[j * freedoms] += k * gamma_end[n] * gamma[m];
          if (small) continue;
          column[0] += -gamma_end[n] * turned[1] * dtheta[j] - Q[0] * now[n][j] * gamma_end[m];
          column[freedoms] += gamma_end[n] * turned[0] * dtheta[j] - Q[1] * now[n][j] * gamma_end[m];
        }
    }
    return work;
  }
};

}  // namespace presswork
