// SPDX-License-Identifier: Apache-2.0
// One-point hexahedra of the explicit loop: uniform strain with hourglass control (Flanagan & Belytschko 1981, Int. J.
// Numer. Meth. Engng 17, 679-706), evaluated without a tangent on state that is kept by packs.
//
// The map is x = c + p xi + q eta + r zeta + h1 eta zeta + h2 zeta xi + h3 xi eta + h4 xi eta zeta. Everything runs on
// these modes in place of nodes: sums over the nodes with the signs of a mode, found by butterflies. The volume average
// of grad N_a, which makes the volume's derivative exact and passes the patch test on distorted cells, is
//     V grad N_a = sum_m mode_m(a) B_m,
//     B_xi = q x r + h3 x h2 / 3,   B_xi_eta = (q x h1 + h2 x p) / 3,   and so on in turn; of xi eta zeta it is 0.
// Hourglass forces Q = R Q_n + k gamma.du of the four modes behind zeta, k = 2 fraction G_now V sum |grad N|^2 as that
// of the quadrilateral (solid2d_forces.hpp); gamma at the end of the cycle spreads them, which keeps the balance of
// moments.
//
// The strain of a cycle is logarithmic to its third order, E - E^2 + 4/3 E^3 with E = (F^T F - 1)/2, in the axes of its
// start; the rotation that of Hughes & Winget 1980, exact for a rigid one. Cycles strain a cell by a thousandth.
#pragma once

#include "element/solid_space.hpp"
#include "element/space_cycle.hpp"

namespace presswork {

// Signs of the modes at the nodes of Hex8: 1, xi, eta, zeta, eta zeta, zeta xi, xi eta, xi eta zeta.
struct HexModes {
  static constexpr int count = 8, hourglass = 4;  // the number of the first hourglass mode

  // Sums over the nodes with the signs of each mode.
  template <class T>
  PRESSWORK_INLINE static void sum(const T x[8][3], T (&out)[count][3]) {
    for (int i = 0; i < 3; ++i) {
      // 1. along xi: nodes 0 1, 3 2, 4 5, 7 6
      const T s0 = x[0][i] + x[1][i], d0 = x[1][i] - x[0][i], s1 = x[3][i] + x[2][i], d1 = x[2][i] - x[3][i];
      const T s2 = x[4][i] + x[5][i], d2 = x[5][i] - x[4][i], s3 = x[7][i] + x[6][i], d3 = x[6][i] - x[7][i];
      // 2. along eta, 3. along zeta
      const T ss0 = s0 + s1, se0 = s1 - s0, ds0 = d0 + d1, de0 = d1 - d0;
      const T ss1 = s2 + s3, se1 = s3 - s2, ds1 = d2 + d3, de1 = d3 - d2;
      out[0][i] = ss0 + ss1, out[3][i] = ss1 - ss0;
      out[2][i] = se0 + se1, out[4][i] = se1 - se0;
      out[1][i] = ds0 + ds1, out[5][i] = ds1 - ds0;
      out[6][i] = de0 + de1, out[7][i] = de1 - de0;
    }
  }
  // The other way: at each node the sum of the modes with their signs; mode 0 is nought.
  template <class T>
  PRESSWORK_INLINE static void spread(const T (&m)[count][3], T* out, int stride) {
    for (int i = 0; i < 3; ++i) {
      const T low[4] = {-m[3][i], m[1][i] - m[5][i], m[2][i] - m[4][i], m[6][i] - m[7][i]};
      const T high[4] = {m[3][i], m[1][i] + m[5][i], m[2][i] + m[4][i], m[6][i] + m[7][i]};
      for (int top = 0; top < 2; ++top) {
        const T* c = top ? high : low;
        const T near = c[0] - c[2], far = c[0] + c[2], near_xi = c[1] - c[3], far_xi = c[1] + c[3];
        T* to = out + std::size_t(4) * top * stride + i;
        to[0] = near - near_xi, to[stride] = near + near_xi;
        to[2 * stride] = far + far_xi, to[3 * stride] = far - far_xi;
      }
    }
  }
};

// On one cell or a pack of them.
template <class T>
struct HexOnePoint {
  static constexpr int nodes = 8, modes = HexModes::hourglass;
  // Rows of a cell's state before the point's: work of the stress, of the hourglass forces, these forces.
  enum : int { work = 0, hourglass_work = 1, hourglass = 2, point = 14 };

  struct Geometry {
    T B[HexModes::count][3];  // as above; row 0 is not used
    T volume;
  };

  // From sums of positions; true in lanes where the volume is not positive.
  PRESSWORK_DEVICE static Mask<T> measure(const T (&sums)[HexModes::count][3], Geometry& g) {
    T m[HexModes::count][3];
    for (int k = 1; k < HexModes::count; ++k)
      for (int i = 0; i < 3; ++i) m[k][i] = T(0.125) * sums[k][i];
    const T third(1.0 / 3);
    for (int a = 0; a < 3; ++a) {  // p, q, r are 1 to 3; h1, h2, h3 are 4 to 6
      const T *q = m[1 + (a + 1) % 3], *r = m[1 + (a + 2) % 3];
      const T *h2 = m[4 + (a + 1) % 3], *h3 = m[4 + (a + 2) % 3];
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        g.B[1 + a][i] = q[j] * r[k] - q[k] * r[j] + third * (h3[j] * h2[k] - h3[k] * h2[j]);
        // of the mode of the two other directions: (r x h2 + h3 x q) / 3
        g.B[4 + a][i] = third * (r[j] * h2[k] - r[k] * h2[j] + h3[j] * q[k] - h3[k] * q[j]);
      }
    }
    for (int i = 0; i < 3; ++i) g.B[7][i] = g.B[0][i] = T(0.0);
    g.volume = T(0.0);
    for (int k = 1; k < 7; ++k) g.volume += sums[k][0] * g.B[k][0];
    return invert(g.volume > T(0.0));
  }

  // V^2 sum_a |grad N_a|^2
  PRESSWORK_DEVICE static T square_gradients(const Geometry& g) {
    T sum(0.0);
    for (int k = 1; k < 7; ++k)
      for (int i = 0; i < 3; ++i) sum += g.B[k][i] * g.B[k][i];
    return T(8.0) * sum;
  }

  struct Motion {
    T H[3][3];         // F - 1 of the cycle
    T strain[6];       // logarithmic, in the axes of the start; engineering
    T rotation[3][3];  // of the cycle
    T jacobian, cofactor[9];
  };

  // True in lanes where the cell is turned inside out.
  PRESSWORK_DEVICE static Mask<T> deform(const Geometry& g, const T (&moves)[HexModes::count][3], Motion& motion) {
    auto& H = motion.H;
    const T inverse = T(1.0) / g.volume;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        T sum(0.0);
        for (int k = 1; k < 7; ++k) sum += moves[k][i] * g.B[k][j];
        H[i][j] = inverse * sum;
      }
    T F[9];
    for (int i = 0; i < 9; ++i) F[i] = H[i / 3][i % 3] + T(i % 4 == 0 ? 1.0 : 0.0);
    SolidSpace<Hex8, 1, T>::find_cofactors(F, motion.cofactor);
    motion.jacobian = F[0] * motion.cofactor[0] + F[1] * motion.cofactor[1] + F[2] * motion.cofactor[2];
    find_strain(H, motion.strain);
    find_rotation(H, motion.rotation);
    return invert(motion.jacobian > T(1e-6));
  }

  PRESSWORK_DEVICE static void find_strain(const T (&H)[3][3], T strain[6]) {
    T E[3][3], square[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        E[i][j] = E[j][i] = T(0.5) * (H[i][j] + H[j][i] + H[0][i] * H[0][j] + H[1][i] * H[1][j] + H[2][i] * H[2][j]);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        square[i][j] = square[j][i] = E[i][0] * E[0][j] + E[i][1] * E[1][j] + E[i][2] * E[2][j];
    for (int k = 0; k < 6; ++k) {
      const int i = voigt_row(k), j = voigt_column(k);
      const T cube = square[i][0] * E[0][j] + square[i][1] * E[1][j] + square[i][2] * E[2][j];
      strain[k] = T(k < 3 ? 1.0 : 2.0) * (E[i][j] - square[i][j] + T(4.0 / 3) * cube);
    }
  }

  // (1 - W/2)^-1 (1 + W/2), W the skew part of 2 H (2 + H)^-1, the gradient of the velocity times dt at half the cycle.
  PRESSWORK_DEVICE static void find_rotation(const T (&H)[3][3], T (&R)[3][3]) {
    T A[9], cofactor[9];
    for (int i = 0; i < 9; ++i) A[i] = T(0.5) * H[i / 3][i % 3] + T(i % 4 == 0 ? 1.0 : 0.0);
    SolidSpace<Hex8, 1, T>::find_cofactors(A, cofactor);
    const T inverse = T(1.0) / (A[0] * cofactor[0] + A[1] * cofactor[1] + A[2] * cofactor[2]);
    T G[3][3];  // H A^-1, A^-1_kj = cofactor_jk / det
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        G[i][j] = inverse * (H[i][0] * cofactor[3 * j] + H[i][1] * cofactor[3 * j + 1] + H[i][2] * cofactor[3 * j + 2]);
    const T w[3] = {T(0.25) * (G[2][1] - G[1][2]), T(0.25) * (G[0][2] - G[2][0]), T(0.25) * (G[1][0] - G[0][1])};
    const T square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], scale = T(2.0) / (T(1.0) + square);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R[i][j] = scale * w[i] * w[j] + (i == j ? T(1.0) - scale * square : T(0.0));
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      R[j][i] += scale * w[k], R[i][j] -= scale * w[k];
    }
  }

  // One cycle of dt, by du to x at its end: advances the state in place and gives the nodal forces, `stride` packs a
  // node. Gives lanes where the cell is turned inside out, when the pack's state stays, and in `failed` those where the
  // law finds no stress.
  template <class Law>
  [[gnu::flatten]] PRESSWORK_DEVICE static Mask<T> advance(const Law& law, double fraction, double dt, T given,
                                                           const T x[8][3], const T du[8][3], T* state, T* force,
                                                           int stride, Mask<T>& failed) {
    // 1. modes at the end and of the cycle's move, gradients at its start
    T at_end[HexModes::count][3], moves[HexModes::count][3], at_start[HexModes::count][3];
    HexModes::sum(x, at_end);
    HexModes::sum(du, moves);
    for (int k = 0; k < HexModes::count; ++k)
      for (int i = 0; i < 3; ++i) at_start[k][i] = at_end[k][i] - moves[k][i];
    Geometry g;
    Motion motion;
    Mask<T> bad = measure(at_start, g);
    bad = either(bad, deform(g, moves, motion));
    if (any(bad)) return bad;

    // 2. stress in the axes of the start, turned; work by the mean stress
    T* s0 = state + point;
    T s1[most_point_values<6>], flow, slope;
    LawInput<6, T> in;
    in.dt = dt, in.temperature = given;
    for (int i = 0; i < 6; ++i) in.strain[i] = motion.strain[i];
    find_flow(law, given, s0, flow, slope);
    const T elastic(law.shear_modulus());
    const T modulus = select(s0[6] > T(0.0), smaller(flow + slope * T(1.0 / 3), elastic), elastic);
    T unturned[6], done(0.0);
    failed = advance_point(law, in, motion.H, motion.rotation, s0, s1, unturned);
    for (int i = 0; i < 6; ++i) done += T(0.5) * (s0[i] + motion.jacobian * unturned[i]) * in.strain[i];
    keep_point(law, s1, s0);
    state[work] += done * g.volume;

    // 3. hourglass forces, turned with the material
    const T k = T(2.0 * fraction) * modulus * square_gradients(g) / g.volume;
    T Q[modes][3], lost(0.0);
    for (int mode = 0; mode < modes; ++mode) {
      T* kept = state + hourglass + 3 * mode;
      const T *along = moves[HexModes::hourglass + mode], *place = at_start[HexModes::hourglass + mode];
      for (int i = 0; i < 3; ++i) {
        const T slip = along[i] - (place[0] * motion.H[i][0] + place[1] * motion.H[i][1] + place[2] * motion.H[i][2]);
        const auto& R = motion.rotation[i];
        const T turned = R[0] * kept[0] + R[1] * kept[1] + R[2] * kept[2];
        Q[mode][i] = turned + T(0.125) * k * slip;
        lost += T(0.0625) * (turned + Q[mode][i]) * slip;
      }
    }
    for (int i = 0; i < 3 * modes; ++i) state[hourglass + i] = Q[i / 3][i % 3];
    state[hourglass_work] += lost;

    // 4. forces on the configuration at the end: (sigma v - sum Q at_end / 8) F^-T B / V on the modes of B, Q / 8 on
    // the hourglass modes
    T pull[3][3], by[3][3], on[HexModes::count][3];
    const T volume = g.volume * motion.jacobian, inverse = T(1.0) / volume;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        pull[i][j] = volume * s1[voigt_of(i, j)];
        for (int mode = 0; mode < modes; ++mode)
          pull[i][j] -= T(0.125) * Q[mode][i] * at_end[HexModes::hourglass + mode][j];
      }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        by[i][j] = inverse * (pull[i][0] * motion.cofactor[j] + pull[i][1] * motion.cofactor[3 + j] +
                              pull[i][2] * motion.cofactor[6 + j]);
    for (int m = 1; m < HexModes::count; ++m)
      for (int i = 0; i < 3; ++i) {
        on[m][i] = by[i][0] * g.B[m][0] + by[i][1] * g.B[m][1] + by[i][2] * g.B[m][2];
        if (m >= HexModes::hourglass) on[m][i] += T(0.125) * Q[m - HexModes::hourglass][i];
      }
    HexModes::spread(on, force, stride);
    return bad;
  }

  // Bound of the highest squared frequency [1/s2], elastic, at x; mass of the cell's nodes [t].
  //
  // With L = sum v_a grad N_a: tr L^2 <= S v^2, |L|^2 <= l v^2 for v^2 = sum m_a v_a^2, S and l trace and largest
  // eigenvalue of M = sum grad N_a grad N_a / m_a. The energy K tr^2 + 2 G |dev|^2 is at most 2 G l + (K - 2 G / 3)
  // tr^2, so at most 2 G l + max(K - 2 G / 3, 0) S. l by trace and norm (Wolkowicz & Styan 1980). The hourglass control
  // adds at most its own.
  PRESSWORK_DEVICE static T bound_frequency(double bulk, double shear, double fraction, const T x[8][3],
                                            const T mass[8]) {
    T sums[HexModes::count][3], M[3][3] = {}, inertia(0.0), B[nodes][3];
    Geometry g;
    HexModes::sum(x, sums);
    measure(sums, g);
    HexModes::spread(g.B, &B[0][0], 3);
    for (int a = 0; a < nodes; ++a) {
      const T inverse = T(1.0) / mass[a];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) M[i][j] += inverse * B[a][i] * B[a][j];
      for (int mode = HexModes::hourglass; mode < HexModes::count; ++mode) {
        constexpr int signs[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
        const int s =
            mode == 7 ? signs[a][0] * signs[a][1] * signs[a][2] : signs[a][(mode - 3) % 3] * signs[a][(mode - 2) % 3];
        const T gamma =
            T(0.125) *
            (T(double(s)) - (sums[mode][0] * B[a][0] + sums[mode][1] * B[a][1] + sums[mode][2] * B[a][2]) / g.volume);
        inertia += gamma * gamma * inverse;
      }
    }
    T trace(0.0), squares(0.0);
    for (int i = 0; i < 3; ++i) {
      trace += M[i][i];
      for (int j = 0; j < 3; ++j) squares += M[i][j] * M[i][j];
    }
    const T third(1.0 / 3);
    const T largest = third * trace + square_root(larger(T(2.0 / 3) * (squares - third * trace * trace), T(0.0)));
    const T bound = T(2.0 * shear) * largest + T(larger(bulk - 2.0 / 3.0 * shear, 0.0)) * trace;
    return (bound + T(2.0 * fraction * shear) * square_gradients(g) * inertia) / g.volume;
  }
};

}  // namespace presswork
