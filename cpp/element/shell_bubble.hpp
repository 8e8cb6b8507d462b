// SPDX-License-Identifier: Apache-2.0
// The bubble of a 3-node shell: a field of directors of its own, 27 z r s times the vector
//
//   d_4 = q^1 a_1 + q^2 a_2,   a_i = x_(i+1) - x_1 the sides of the flat triangle at the same instant
//
// so a rigid motion leaves q alone. q belongs to the cell and is found with it: the force on q is zero at every
// evaluation (a few steps of Newton), so the nodes see a force that depends on them alone, and its exact derivative.
// Lee, Lee & Bathe (2014) and Jeon, Lee, Lee & Bathe (2015) have two rotations of a fourth director in its place, and
// condense them iteration by iteration: the same for small strains.
//
// Rows are 6 node + (x | d) component, the bubble the fourth node, without a position. Its q takes the rows of d_4.
#pragma once

#include "element/director.hpp"

namespace presswork {

template <class T>
struct Bubble {
  static constexpr int nodes = 3, freedoms = 24, at = 21;  // row of d_4
  T q_n[2], q[2];                                          // at t and t+dt [1/mm]
  T side_n[2][3], side[2][3];                              // a_1, a_2
  bool small = false;                                      // displacements: d_4 is none at the start, and a_i stay

  void span(const T x[][3], const T u[][3]) {
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < 3; ++i) {
        side_n[k][i] = x[k + 1][i] - x[0][i];
        side[k][i] = small ? side_n[k][i] : side_n[k][i] + (u[k + 1][i] - u[0][i]);
      }
  }

  // d_4 at t, and its change
  void direct(T d[3], T change[3]) const {
    for (int i = 0; i < 3; ++i) {
      d[i] = small ? T(0.0) : q_n[0] * side_n[0][i] + q_n[1] * side_n[1][i];
      change[i] = T(0.0);
      for (int k = 0; k < 2; ++k) change[i] += (q[k] - q_n[k]) * side[k][i] + q_n[k] * (side[k][i] - side_n[k][i]);
    }
  }

  // From x and d of four nodes to x and d of three and q, in place
  void reduce(T force[freedoms], T (*K)[freedoms]) const {
    const T on_bubble[3] = {force[at], force[at + 1], force[at + 2]};
    const T part[nodes] = {-(q[0] + q[1]), q[0], q[1]};  // d_4 by x_a
    for (int a = 0; a < nodes && !small; ++a)
      for (int i = 0; i < 3; ++i) {
        force[6 * a + i] += part[a] * on_bubble[i];
        for (int j = 0; j < freedoms; ++j) K[6 * a + i][j] += part[a] * K[at + i][j];
      }
    for (int a = 0; a < nodes && !small; ++a)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < freedoms; ++j) K[j][6 * a + i] += part[a] * K[j][at + i];
    for (int k = 0; k < 2; ++k) force[at + k] = dot3(side[k], on_bubble);
    for (int j = 0; j < freedoms; ++j) {
      const T row[3] = {K[at][j], K[at + 1][j], K[at + 2][j]};
      for (int k = 0; k < 2; ++k) K[at + k][j] = dot3(side[k], row);
    }
    for (int j = 0; j < at + 2; ++j) {
      const T column[3] = {K[j][at], K[j][at + 1], K[j][at + 2]};
      for (int k = 0; k < 2; ++k) K[j][at + k] = dot3(side[k], column);
    }
    // a_k moves with x
    for (int k = 0; k < 2 && !small; ++k)
      for (int i = 0; i < 3; ++i) {
        K[6 * (k + 1) + i][at + k] += on_bubble[i], K[at + k][6 * (k + 1) + i] += on_bubble[i];
        K[i][at + k] -= on_bubble[i], K[at + k][i] -= on_bubble[i];
      }
  }

  // How force and stiffness of the nodes hang on q
  struct Coupling {
    T force[2], inverse[2][2];  // of q: force, and inverse of its stiffness
    T row[2][6 * nodes], column[6 * nodes][2];
  };

  Coupling couple(const T force[freedoms], const T (*K)[freedoms]) const {
    Coupling c;
    const T over = T(1.0) / (K[at][at] * K[at + 1][at + 1] - K[at][at + 1] * K[at + 1][at]);
    c.inverse[0][0] = K[at + 1][at + 1] * over, c.inverse[0][1] = -K[at][at + 1] * over;
    c.inverse[1][0] = -K[at + 1][at] * over, c.inverse[1][1] = K[at][at] * over;
    for (int k = 0; k < 2; ++k) {
      c.force[k] = force[at + k];
      for (int i = 0; i < 6 * nodes; ++i) c.row[k][i] = K[at + k][i], c.column[i][k] = K[i][at + k];
    }
    return c;
  }

  // A step of Newton for the force on q; gives the square of the turn it means
  T step(const Coupling& c) {
    T change[2], turn[3];
    for (int k = 0; k < 2; ++k) {
      change[k] = -(c.inverse[k][0] * c.force[0] + c.inverse[k][1] * c.force[1]);
      q[k] += change[k];
    }
    for (int i = 0; i < 3; ++i) turn[i] = change[0] * side[0][i] + change[1] * side[1][i];
    return dot3(turn, turn);
  }

  // Take q out of force and stiffness of the nodes. What a step would still change in the force is taken with it.
  static void condense(const Coupling& c, T force[freedoms], T (*K)[freedoms]) {
    for (int i = 0; i < 6 * nodes; ++i) {
      T w[2];
      for (int k = 0; k < 2; ++k) w[k] = c.column[i][0] * c.inverse[0][k] + c.column[i][1] * c.inverse[1][k];
      force[i] -= w[0] * c.force[0] + w[1] * c.force[1];
      for (int j = 0; j < 6 * nodes; ++j) K[i][j] -= w[0] * c.row[0][j] + w[1] * c.row[1][j];
    }
  }
};

}  // namespace presswork
