// SPDX-License-Identifier: Apache-2.0
// Plane-strain and axisymmetric solids: T3, T6, Q4, Q8, Q9, standard, F-bar or one-point with hourglass control.
//
// Updated Lagrangian: gradients are taken on the configuration at t, F is the increment's, the residual and tangent are
// integrated over the configuration at t+dt. x is the radius and y the axis in axisymmetry; integrals carry 2 pi r, so
// that nodal forces are those of the whole ring; in plane strain they carry the depth.
//
// fbar (de Souza Neto et al. 1996, with the element's volume average in place of the centroid): the stress is that of
// F (Jbar/J)^(1/3), in plane strain of the in-plane part times (Jbar/J)^(1/2); Jbar = v(t+dt)/v(t) of the element.
// one_point (Flanagan & Belytschko 1981): centroid stress, and hourglass forces Q = R Q_n + k gamma.du on the hourglass
// vector gamma, k = 2 fraction * G_now * V * sum |grad N|^2 with G_now = G before first yield, then flow + slope/3 (at
// most G), so that the control stays weak beside plastic flow. In axisymmetry gradients and N/r are the element's
// volume averages.
//
// Elements are taken pack_width at a time; lane l of pack p is element p*pack_width + l. The last pack repeats the last
// element. Element matrices are written as [pack][row][column][lane], forces as [pack][row][lane]; row = 2 node +
// component.
#pragma once

#include <numbers>
#include <type_traits>

#include "element/point_response.hpp"
#include "element/umat_response.hpp"
#include "reference/cells.hpp"

namespace presswork {

enum class Treatment { standard, fbar, one_point };

// Views of one block of cells; arrays are C-contiguous. q is the rule's number of points.
struct BlockView {
  int n_cells;
  const int* connectivity;  // (n_cells, nodes)
  const double* points;     // (n_points, 2) at t [mm]
  const double* increment;  // (n_points, 2) displacement since t [mm]
  bool axisymmetric;
  double depth;               // plane strain [mm]
  const double* stress_n;     // (n_cells, q, 4) [MPa]
  const double* eqps_n;       // (n_cells, q)
  const double* hourglass_n;  // (n_cells, 2) [N], one_point only
  double hourglass_fraction;
  double* stress;
  double* eqps;
  double* hourglass;
  double* volume;     // (n_cells, q) [mm3] at t+dt
  double* force;      // (n_packs, 2 nodes, pack_width) [N]
  double* stiffness;  // (n_packs, 2 nodes, 2 nodes, pack_width) [N/mm], or null
  bool symmetric;     // keep the symmetric part of the stiffness
  // of a law from a shared library
  const double* user_n = nullptr;  // (n_cells, q, n_state + UmatHistory::size)
  double* user = nullptr;
  int first_cell = 0;          // of the block in the mesh
  UmatPlace when = {};         // stage, increment and times
  UmatFault* fault = nullptr;  // (n_packs)
  // of AdiabaticMises: user is the rise of temperature (n_cells, q), when.dt the time of the increment
  double* work = nullptr;  // (n_cells, 2) [N mm]: those of stress and of hourglass control are added, or null
};

template <Cell cell, int n_points, Treatment treatment>
struct Solid2d {
  static constexpr int nodes = node_count(cell);
  static constexpr int freedoms = 2 * nodes;
  using T = Pack;

  struct PointGeometry {
    T grad[nodes][2], hoop[nodes];  // at t: gradients and N/r (zero in plane strain)
    T F[5];
    T volume_t, jacobian;
  };

  static const ShapeTable<cell, n_points>& table() {
    static const ShapeTable<cell, n_points> shared;
    return shared;
  }

  // Gradients, N/r and volume of one point at t; true in lanes where the cell is turned inside out there.
  static Pack::Mask measure_reference(const BlockView& b, const T x[][2], int q, PointGeometry& g) {
    const auto& shape = table();
    T det;
    gradients_at(x, shape.dN[q], g.grad, det);
    T thickness(b.depth), inv_r(0.0);
    if (b.axisymmetric) {
      T r(0.0);
      for (int a = 0; a < nodes; ++a) r += T(shape.N[q][a]) * x[a][0];
      thickness = T(2.0 * std::numbers::pi) * r;
      inv_r = T(1.0) / r;
    }
    for (int a = 0; a < nodes; ++a) g.hoop[a] = T(shape.N[q][a]) * inv_r;
    g.volume_t = T(shape.weight[q]) * det * thickness;
    return !(det > T(0.0));
  }

  // The same for the one point of an axisymmetric quadrilateral: volume averages, so that a homogeneous stress is in
  // equilibrium in cells of any shape, which the centroid's values do not give.
  static Pack::Mask measure_mean(const T x[][2], PointGeometry& g) {
    static const ShapeTable<cell, 4> rule;
    T V(0.0), worst(1.0);
    for (int a = 0; a < nodes; ++a) g.grad[a][0] = g.grad[a][1] = g.hoop[a] = T(0.0);
    for (int p = 0; p < 4; ++p) {
      T grad[nodes][2], det, r(0.0);
      gradients_at(x, rule.dN[p], grad, det);
      for (int a = 0; a < nodes; ++a) r += T(rule.N[p][a]) * x[a][0];
      T area = T(2.0 * std::numbers::pi * rule.weight[p]) * det, volume = area * r;
      for (int a = 0; a < nodes; ++a) {
        for (int i = 0; i < 2; ++i) g.grad[a][i] += volume * grad[a][i];
        g.hoop[a] += area * T(rule.N[p][a]);
      }
      V += volume;
      worst = smaller(worst, det);
    }
    T inv = T(1.0) / V;
    for (int a = 0; a < nodes; ++a) g.grad[a][0] *= inv, g.grad[a][1] *= inv, g.hoop[a] *= inv;
    g.volume_t = V;
    return !(worst > T(0.0));
  }

  static void gradients_at(const T x[][2], const double dN[][2], T grad[][2], T& det) {
    T j00(0.0), j01(0.0), j10(0.0), j11(0.0);
    for (int a = 0; a < nodes; ++a) {
      T nx(dN[a][0]), ny(dN[a][1]);
      j00 += nx * x[a][0], j01 += nx * x[a][1], j10 += ny * x[a][0], j11 += ny * x[a][1];
    }
    det = j00 * j11 - j01 * j10;
    T inv = T(1.0) / det;
    for (int a = 0; a < nodes; ++a) {
      T nx(dN[a][0]), ny(dN[a][1]);
      grad[a][0] = (j11 * nx - j01 * ny) * inv;
      grad[a][1] = (j00 * ny - j10 * nx) * inv;
    }
  }

  // F of the increment; true in lanes where the point is turned inside out.
  static Pack::Mask deform(const T du[][2], PointGeometry& g) {
    T* F = g.F;
    F[0] = F[3] = F[4] = T(1.0), F[1] = F[2] = T(0.0);
    for (int a = 0; a < nodes; ++a) {
      F[0] += du[a][0] * g.grad[a][0], F[1] += du[a][0] * g.grad[a][1];
      F[2] += du[a][1] * g.grad[a][0], F[3] += du[a][1] * g.grad[a][1];
      F[4] += du[a][0] * g.hoop[a];
    }
    T plane = F[0] * F[3] - F[1] * F[2];
    g.jacobian = plane * F[4];
    // a trace of F that is not positive is a half turn: outside what an increment may do
    T worst = smaller(smaller(plane, F[4]), F[0] + F[3]);
    return !(worst > T(1e-6));
  }

  // Gradients on the configuration at t+dt, and N/r there (zero in plane strain).
  static void push_forward(const PointGeometry& g, T now[][3]) {
    T inv = T(1.0) / (g.F[0] * g.F[3] - g.F[1] * g.F[2]), inv_hoop = T(1.0) / g.F[4];
    for (int a = 0; a < nodes; ++a) {
      now[a][0] = (g.grad[a][0] * g.F[3] - g.grad[a][1] * g.F[2]) * inv;
      now[a][1] = (g.grad[a][1] * g.F[0] - g.grad[a][0] * g.F[1]) * inv;
      now[a][2] = g.hoop[a] * inv_hoop;
    }
  }

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
  static void add_fbar(const BlockView& b, const T now[][3], const T m[5][5], const T s[4], T dv, const T* mean_div,
                       T* K) {
    const T sigma[5] = {s[0], s[3], s[3], s[1], s[2]};
    T qv[5];
    for (int r = 0; r < 5; ++r)
      qv[r] = b.axisymmetric ? T(1.0 / 3) * (m[r][0] + m[r][3] + m[r][4] - T(2.0) * sigma[r])
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

  // Returns the work of the hourglass forces.
  static T add_hourglass(const VonMises& law, double fraction, const T x[][2], const T du[][2], const PointGeometry& g,
                         const T now[][3], T eqps_n, T Q[2], T* force, T* K) {
    // 1. hourglass vectors at t and at t+dt: orthogonal to every linear field there
    constexpr double h[4] = {1, -1, 1, -1};
    T at_t[2] = {T(0.0), T(0.0)}, at_end[2] = {T(0.0), T(0.0)}, norm(0.0), gamma[4], gamma_end[4];
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 2; ++i) {
        at_t[i] += T(h[a]) * x[a][i];
        at_end[i] += T(h[a]) * (x[a][i] + du[a][i]);
        norm += g.grad[a][i] * g.grad[a][i];
      }
    for (int a = 0; a < 4; ++a) {
      gamma[a] = T(0.25) * (T(h[a]) - at_t[0] * g.grad[a][0] - at_t[1] * g.grad[a][1]);
      gamma_end[a] = T(0.25) * (T(h[a]) - at_end[0] * now[a][0] - at_end[1] * now[a][1]);
    }
    // 2. modulus now
    T flow, slope;
    law.hardening.evaluate(eqps_n, flow, slope);
    const T elastic(law.shear_modulus());
    T modulus = select(eqps_n > T(0.0), smaller(flow + slope * T(1.0 / 3), elastic), elastic);
    T k = T(2.0 * fraction) * modulus * g.volume_t * norm;
    // 3. forces, turned with the material; gamma at t+dt keeps the balance of moments
    T a = g.F[0] + g.F[3], b = g.F[2] - g.F[1], trace = square_root(a * a + b * b);
    T c = a / trace, s = b / trace;
    T turned[2] = {c * Q[0] - s * Q[1], s * Q[0] + c * Q[1]};
    T work(0.0);
    for (int i = 0; i < 2; ++i) {
      T mode(0.0);
      for (int n = 0; n < 4; ++n) mode += gamma[n] * du[n][i];
      Q[i] = turned[i] + k * mode;
      work += T(0.5) * (turned[i] + Q[i]) * mode;
      for (int n = 0; n < 4; ++n) force[2 * n + i] += gamma_end[n] * Q[i];
    }
    // 4. tangent: dQ (stiffness, and turning: dtheta = (a db - b da) / (a^2 + b^2)) and d gamma_end = -B (gamma_end.du)
    if (!K) return work;
    T inv = T(1.0) / (trace * trace);
    for (int m = 0; m < 4; ++m) {
      const T dtheta[2] = {(-a * g.grad[m][1] - b * g.grad[m][0]) * inv, (a * g.grad[m][0] - b * g.grad[m][1]) * inv};
      for (int n = 0; n < 4; ++n)
        for (int j = 0; j < 2; ++j) {
          T* column = K + 2 * n * freedoms + 2 * m + j;
          column[0] += -gamma_end[n] * turned[1] * dtheta[j] - Q[0] * now[n][j] * gamma_end[m];
          column[freedoms] += gamma_end[n] * turned[0] * dtheta[j] - Q[1] * now[n][j] * gamma_end[m];
          column[j * freedoms] += k * gamma_end[n] * gamma[m];
        }
    }
    return work;
  }

  // Element volume ratio Jbar, and (with stiffness) the mean divergence row of every freedom.
  static T mean_dilatation(const PointGeometry* g, bool with_row, T* mean_div) {
    T v(0.0), V(0.0);
    for (int q = 0; q < n_points; ++q) v += g[q].volume_t * g[q].jacobian, V += g[q].volume_t;
    if (with_row) {
      for (int i = 0; i < freedoms; ++i) mean_div[i] = T(0.0);
      for (int q = 0; q < n_points; ++q) {
        T now[nodes][3], weight = g[q].volume_t * g[q].jacobian / v;
        push_forward(g[q], now);
        for (int a = 0; a < nodes; ++a) {
          mean_div[2 * a] += weight * (now[a][0] + now[a][2]);
          mean_div[2 * a + 1] += weight * now[a][1];
        }
      }
    }
    return v / V;
  }

  static void use_mean_dilatation(const BlockView& b, T mean, const PointGeometry& g, T F[5]) {
    T ratio = mean / g.jacobian;
    T factor = b.axisymmetric ? map_lanes(ratio, [](double v) { return std::cbrt(v); }) : square_root(ratio);
    for (int i = 0; i < 4; ++i) F[i] *= factor;
    if (b.axisymmetric) F[4] *= factor;
  }

  // Where the lanes of point q are, for a law from a shared library.
  static UmatLanes find_lanes(const BlockView& b, const Umat& law, const int cells[], int count, const T x[][2],
                              const T du[][2], const PointGeometry* g, int q) {
    UmatLanes lanes;
    lanes.count = count;
    T area(0.0), at[2] = {T(0.0), T(0.0)};
    for (int p = 0; p < n_points; ++p) {
      T thickness(b.depth);
      if (b.axisymmetric) {
        thickness = T(0.0);
        for (int a = 0; a < nodes; ++a) thickness += T(2.0 * std::numbers::pi * table().N[p][a]) * x[a][0];
      }
      area += g[p].volume_t / thickness;
    }
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 2; ++i) at[i] += T(table().N[q][a]) * (x[a][i] + du[a][i]);
    const std::size_t row = law.n_state + UmatHistory::size;
    for (int lane = 0; lane < count; ++lane) {
      UmatPlace& place = lanes.place[lane] = b.when;
      place.coordinates[0] = at[0][lane], place.coordinates[1] = at[1][lane];
      place.length = std::sqrt(area[lane]);
      place.cell = b.first_cell + cells[lane] + 1;
      place.point = q + 1;
      const std::size_t start = (static_cast<std::size_t>(cells[lane]) * n_points + q) * row;
      lanes.history_n[lane] = b.user_n + start;
      lanes.history[lane] = b.user + start;
    }
    return lanes;
  }

  // Evaluate the pack whose first cell is `first`. Returns the index of a cell turned inside out, or -1.
  template <class Law>
  static int evaluate(const BlockView& b, const PointSettings& settings, const Law& law, int pack) {
    constexpr bool is_umat = std::is_same_v<Law, Umat>, is_adiabatic = std::is_same_v<Law, AdiabaticMises>;
    static_assert(!(is_umat && treatment == Treatment::one_point), "hourglass control needs a flow stress");
    const int first = pack * pack_width;
    int cells[pack_width];
    T x[nodes][2], du[nodes][2];
    for (int lane = 0; lane < pack_width; ++lane) {
      cells[lane] = first + lane < b.n_cells ? first + lane : b.n_cells - 1;
      for (int a = 0; a < nodes; ++a) {
        const int node = b.connectivity[cells[lane] * nodes + a];
        for (int i = 0; i < 2; ++i) {
          x[a][i].set(lane, b.points[2 * node + i]);
          du[a][i].set(lane, b.increment[2 * node + i]);
        }
      }
    }

    // 1. kinematics of every point, before anything is computed from it
    PointGeometry g[n_points];
    Pack::Mask bad{};
    for (int q = 0; q < n_points; ++q) {
      bool measured = false;
      if constexpr (treatment == Treatment::one_point)
        if ((measured = b.axisymmetric)) bad |= measure_mean(x, g[q]);
      if (!measured) bad |= measure_reference(b, x, q, g[q]);
      bad |= deform(du, g[q]);
    }
    for (int lane = 0; lane < pack_width; ++lane)
      if (bad[lane]) return cells[lane];

    T force[freedoms];
    alignas(64) T K[freedoms * freedoms];
    const bool with_K = b.stiffness != nullptr;
    for (auto& f : force) f = T(0.0);
    if (with_K)
      for (auto& k : K) k = T(0.0);
    T mean_div[freedoms], mean(1.0);
    if constexpr (treatment == Treatment::fbar) mean = mean_dilatation(g, with_K, mean_div);

    // 2. stress, internal force and tangent point by point
    for (int q = 0; q < n_points; ++q) {
      PointState<T> state;
      for (int lane = 0; lane < pack_width; ++lane) {
        const std::size_t at = static_cast<std::size_t>(cells[lane]) * n_points + q;
        for (int i = 0; i < 4; ++i) state.stress[i].set(lane, b.stress_n[4 * at + i]);
        state.eqps.set(lane, b.eqps_n[at]);
      }
      T eqps_n = state.eqps;
      T F[5] = {g[q].F[0], g[q].F[1], g[q].F[2], g[q].F[3], g[q].F[4]};
      if constexpr (treatment == Treatment::fbar) use_mean_dilatation(b, mean, g[q], F);
      PointResponse<T> response;
      T stress_work(0.0), hourglass_work(0.0);
      if constexpr (is_umat) {
        const UmatLanes lanes = find_lanes(b, law, cells, std::min(pack_width, b.n_cells - first), x, du, g, q);
        respond(settings, law, lanes, first, F, state, response, b.fault[pack]);
      } else if constexpr (is_adiabatic) {
        T rise;
        for (int lane = 0; lane < pack_width; ++lane)
          rise.set(lane, b.user_n[static_cast<std::size_t>(cells[lane]) * n_points + q]);
        stress_work = respond(settings, law, F, b.when.dt, state, rise, response) * g[q].volume_t;
        for (int lane = 0; lane < pack_width && first + lane < b.n_cells; ++lane)
          b.user[static_cast<std::size_t>(cells[lane]) * n_points + q] = rise[lane];
      } else {
        respond(settings, law, F, state, response);
      }

      T now[nodes][3], dv = g[q].volume_t * g[q].jacobian;
      push_forward(g[q], now);
      add_force(now, response.stress, dv, force);
      if (with_K) {
        add_stiffness(now, response.modulus, dv, K);
        if constexpr (treatment == Treatment::fbar)
          add_fbar(b, now, response.modulus, response.stress, dv, mean_div, K);
      }
      if constexpr (treatment == Treatment::one_point) {
        T Q[2];
        for (int lane = 0; lane < pack_width; ++lane)
          for (int i = 0; i < 2; ++i) Q[i].set(lane, b.hourglass_n[2 * cells[lane] + i]);
        const VonMises* mises;
        if constexpr (is_adiabatic)
          mises = &law.mises;
        else
          mises = &law;
        hourglass_work =
            add_hourglass(*mises, b.hourglass_fraction, x, du, g[q], now, eqps_n, Q, force, with_K ? K : nullptr);
        for (int lane = 0; lane < pack_width && first + lane < b.n_cells; ++lane)
          for (int i = 0; i < 2; ++i) b.hourglass[2 * cells[lane] + i] = Q[i][lane];
      }
      for (int lane = 0; lane < pack_width && first + lane < b.n_cells; ++lane) {
        const std::size_t at = static_cast<std::size_t>(cells[lane]) * n_points + q;
        for (int i = 0; i < 4; ++i) b.stress[4 * at + i] = state.stress[i][lane];
        b.eqps[at] = state.eqps[lane];
        b.volume[at] = dv[lane];
        if constexpr (is_adiabatic)
          if (b.work) {
            b.work[2 * cells[lane]] += stress_work[lane];
            b.work[2 * cells[lane] + 1] += hourglass_work[lane];
          }
      }
    }

    // 3. out
    for (int i = 0; i < freedoms; ++i) store(b.force, static_cast<std::size_t>(pack) * freedoms + i, force[i]);
    if (!with_K) return -1;
    const std::size_t base = static_cast<std::size_t>(pack) * freedoms * freedoms;
    for (int i = 0; i < freedoms; ++i)
      for (int j = 0; j < freedoms; ++j) {
        T k = b.symmetric ? T(0.5) * (K[i * freedoms + j] + K[j * freedoms + i]) : K[i * freedoms + j];
        store(b.stiffness, base + i * freedoms + j, k);
      }
    return -1;
  }

  static void store(double* array, std::size_t index, T value) {
    for (int lane = 0; lane < pack_width; ++lane) array[index * pack_width + lane] = value[lane];
  }
};

}  // namespace presswork
