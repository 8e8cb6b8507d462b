// SPDX-License-Identifier: Apache-2.0
// Finite rotation of a director: d = exp(theta) d0 with theta the rotation vector of the increment, and its first and
// second derivatives by theta. With s = theta.theta
//
//   d = cos(sqrt s) d0 + a(s) theta x d0 + b(s) (theta.d0) theta,   a = sin(sqrt s)/sqrt s,   b = (1 - cos(sqrt s))/s
//
// a and b are power series, to the last bit for a rotation of less than half a turn, which is all that an increment may
// do. theta is the unknown itself, so second derivatives are symmetric and Newton's convergence is quadratic.
#pragma once

#include "tensor/pack.hpp"

namespace presswork {

inline constexpr double largest_turn_squared = 9.0;  // rotation vectors of an increment are shorter than 3 rad

template <class T>
PRESSWORK_DEVICE T dot3(const T a[3], const T b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
void cross3(const T a[3], const T b[3], T c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

template <class T>
struct DirectorTurn {
  T theta[3], d0[3], turned[3];  // turned = theta x d0
  T along;                       // theta.d0
  T a, a_s, a_ss, b, b_s, b_ss;  // the series and their derivatives by s
  T s, change[3];                // d - d0, without cancellation

  // value, first and second derivative of sum_k (-s)^k/(2k + first)! by Horner's rule
  static void series(T s, int first, T& f, T& f_s, T& f_ss) {
    constexpr int terms = 15;
    double coefficient[terms], factorial = 1.0;
    for (int i = 2; i <= first; ++i) factorial *= i;
    for (int k = 0; k < terms; ++k) {
      coefficient[k] = (k % 2 ? -1.0 : 1.0) / factorial;
      factorial *= (2.0 * k + first + 1.0) * (2.0 * k + first + 2.0);
    }
    f = f_s = f_ss = T(0.0);
    for (int k = terms - 1; k >= 0; --k) {
      f_ss = f_ss * s + f_s;
      f_s = f_s * s + f;
      f = f * s + T(coefficient[k]);
    }
    f_ss = T(2.0) * f_ss;
  }

  void turn(const T rotation[3], const T start[3]) {
    for (int i = 0; i < 3; ++i) theta[i] = rotation[i], d0[i] = start[i];
    s = dot3(theta, theta);
    series(s, 1, a, a_s, a_ss);
    series(s, 2, b, b_s, b_ss);
    cross3(theta, d0, turned);
    along = dot3(theta, d0);
    for (int i = 0; i < 3; ++i) change[i] = a * turned[i] + b * (along * theta[i] - s * d0[i]);
  }

  // Small displacements: d - d0 = theta x d0
  void turn_linearly(const T rotation[3], const T start[3]) {
    for (int i = 0; i < 3; ++i) theta[i] = rotation[i], d0[i] = start[i];
    cross3(theta, d0, turned);
    s = T(0.0);
    for (int i = 0; i < 3; ++i) change[i] = turned[i];
  }
  void differentiate_linearly(T slope[3][3]) const {
    const T cross[3][3] = {{T(0.0), d0[2], -d0[1]}, {-d0[2], T(0.0), d0[0]}, {d0[1], -d0[0], T(0.0)}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) slope[i][j] = cross[i][j];
  }

  // slope[i][j] = d d_i/d theta_j
  void differentiate(T slope[3][3]) const {
    const T cross[3][3] = {{T(0.0), d0[2], -d0[1]}, {-d0[2], T(0.0), d0[0]}, {d0[1], -d0[0], T(0.0)}};
    for (int i = 0; i < 3; ++i) {
      T radial = T(2.0) * (a_s * turned[i] + b_s * along * theta[i]) - a * d0[i];
      for (int j = 0; j < 3; ++j) slope[i][j] = radial * theta[j] + a * cross[i][j] + b * theta[i] * d0[j];
      slope[i][i] += b * along;
    }
  }

  // second[i][j] = d2 (f.d)/d theta_i d theta_j
  void curve(const T f[3], T second[3][3]) const {
    T w[3], mixed[3], f_d = dot3(f, d0), f_theta = dot3(f, theta);
    cross3(d0, f, w);
    T theta_w = dot3(theta, w), product = f_theta * along;
    for (int i = 0; i < 3; ++i) mixed[i] = T(2.0) * (a_s * w[i] + b_s * (f[i] * along + d0[i] * f_theta));
    T round = T(2.0) * (a_s * theta_w + b_s * product) - a * f_d;
    T radial = T(4.0) * (a_ss * theta_w + b_ss * product) - T(2.0) * a_s * f_d;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        second[i][j] = radial * theta[i] * theta[j] + theta[i] * mixed[j] + mixed[i] * theta[j] +
                       b * (f[i] * d0[j] + d0[i] * f[j]);
      second[i][i] += round;
    }
  }
};

}  // namespace presswork
