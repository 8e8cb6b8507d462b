// SPDX-License-Identifier: Apache-2.0
// Kinematics of one increment in the plane and in axisymmetry (Cheng 1995, sections 4, 5 and 11).
//
// The deformation gradient of the increment, F = dx(t+dt)/dx(t), has four in-plane components and the hoop (or
// out-of-plane) one: order 11, 12, 21, 22, 33. It is split F = R U; the strain increment is a function of U, expressed
// in the frame that has not yet turned, where the stress integrator works. Strain order: xx, yy, zz, xy (engineering).
//
// Derivatives are taken along the spatial velocity gradient l, dF = l F, in the frame turned back by R:
// l* = R^T l R. There dU = l* U - dtheta J U, with J the quarter turn and dtheta from the symmetry of dU.
#pragma once

#include "tensor/pack.hpp"

namespace presswork {

enum class StrainMeasure : int { log = 0, stretch = 1, green_lagrange = 2, small = 3 };

template <class T>
struct Increment {
  T strain[4];      // xx, yy, zz, xy (engineering), unrotated frame
  T cosine, sine;   // rotation R = [c -s; s c]
  T jacobian;       // det F
  T dstrain[4][5];  // d strain / d l*, l* in order 11, 12, 21, 22, 33
  T dtheta[5];      // d theta / d l*
};

// 1/m + s/3m^3 + ... = atanh(rho/m)/rho with s = rho^2, and its slope in s; the series joins where the closed form
// cancels.
template <class T>
PRESSWORK_DEVICE void divided_atanh(T m, T s, T& g, T& g_s) {
  T z2 = s / (m * m);
  T inv_m = T(1.0) / m;
  T series = inv_m * (T(1.0) + z2 * (T(1.0 / 3) + z2 * (T(1.0 / 5) + z2 * (T(1.0 / 7) + z2 * T(1.0 / 9)))));
  T series_s = inv_m * inv_m * inv_m *
               (T(1.0 / 3) + z2 * (T(2.0 / 5) + z2 * (T(3.0 / 7) + z2 * (T(4.0 / 9) + z2 * T(5.0 / 11)))));
  g = series, g_s = series_s;
  auto small = z2 < T(1e-3);
  if (!any(invert(small))) return;
  T safe_s = select(small, T(0.25) * m * m, s);
  T rho = square_root(safe_s);
  T closed = T(0.5) * logarithm((m + rho) / (m - rho)) / rho;
  T closed_s = (m / (m * m - safe_s) - closed) / (T(2.0) * safe_s);
  g = select(small, series, closed);
  g_s = select(small, series_s, closed_s);
}

// ln x; the series of 2 atanh((x - 1)/(x + 1)) where x is within a hundredth of 1, as the stretch of a small increment
// is.
template <class T>
T logarithm_of_stretch(T x) {
  const T z = (x - T(1.0)) / (x + T(1.0)), z2 = z * z;
  const T series = (z + z) * (T(1.0) + z2 * (T(1.0 / 3) + z2 * (T(1.0 / 5) + z2 * T(1.0 / 7))));
  const auto small = z2 < T(2.5e-5);
  return any(invert(small)) ? select(small, series, logarithm(x)) : series;
}

// Polar decomposition and strain of one increment; derivatives only if with_derivative.
// F: 11, 12, 21, 22, 33. A determinant or hoop stretch that is not positive must be caught by the caller.
template <class T>
void measure_increment(const T F[5], StrainMeasure measure, bool with_derivative, Increment<T>& out) {
  // 1. R from the symmetry of R^T F, then U
  T a = F[0] + F[3], b = F[2] - F[1];
  T trace = square_root(a * a + b * b);
  T c = a / trace, s = b / trace;
  T u11 = c * F[0] + s * F[2], u12 = c * F[1] + s * F[3], u22 = c * F[3] - s * F[1];
  T plane_det = F[0] * F[3] - F[1] * F[2];
  out.cosine = c;
  out.sine = s;
  out.jacobian = plane_det * F[4];

  // 2. strain
  T m = T(0.5) * (u11 + u22), d = T(0.5) * (u11 - u22);
  T g(0.0), g_s(0.0);
  switch (measure) {
    case StrainMeasure::log: {
      T rho2 = d * d + u12 * u12;
      divided_atanh(m, rho2, g, g_s);
      T mean = T(0.5) * logarithm_of_stretch(plane_det);
      out.strain[0] = mean + g * d;
      out.strain[1] = mean - g * d;
      out.strain[2] = logarithm_of_stretch(F[4]);
      out.strain[3] = T(2.0) * g * u12;
      break;
    }
    case StrainMeasure::stretch:
      out.strain[0] = u11 - T(1.0);
      out.strain[1] = u22 - T(1.0);
      out.strain[2] = F[4] - T(1.0);
      out.strain[3] = T(2.0) * u12;
      break;
    case StrainMeasure::green_lagrange:
      out.strain[0] = T(0.5) * (u11 * u11 + u12 * u12 - T(1.0));
      out.strain[1] = T(0.5) * (u22 * u22 + u12 * u12 - T(1.0));
      out.strain[2] = T(0.5) * (F[4] * F[4] - T(1.0));
      out.strain[3] = u12 * (u11 + u22);
      break;
    case StrainMeasure::small:
      out.strain[0] = F[0] - T(1.0);
      out.strain[1] = F[3] - T(1.0);
      out.strain[2] = F[4] - T(1.0);
      out.strain[3] = F[1] + F[2];
      break;
  }
  if (!with_derivative) return;

  // 3. derivative along each component of l* (11, 12, 21, 22)
  const T dA[4][4] = {{u11, u12, T(0.0), T(0.0)},  // l* U for unit l*: rows 11, 12, 21, 22
                      {u12, u22, T(0.0), T(0.0)},
                      {T(0.0), T(0.0), u11, u12},
                      {T(0.0), T(0.0), u12, u22}};
  T inv_det = T(1.0) / plane_det;
  for (int k = 0; k < 4; ++k) {
    T dtheta = (dA[k][2] - dA[k][1]) / trace;
    out.dtheta[k] = dtheta;
    T du11 = dA[k][0] + dtheta * u12;  // J U = [-u12 -u22; u11 u12]
    T du12 = dA[k][1] + dtheta * u22;
    T du22 = dA[k][3] - dtheta * u12;
    T dm = T(0.5) * (du11 + du22), dd = T(0.5) * (du11 - du22);
    switch (measure) {
      case StrainMeasure::log: {
        T half_ds = d * dd + u12 * du12;
        T dmean = (m * dm - half_ds) * inv_det;
        T dg = T(2.0) * g_s * half_ds - dm * inv_det;
        out.dstrain[0][k] = dmean + dg * d + g * dd;
        out.dstrain[1][k] = dmean - dg * d - g * dd;
        out.dstrain[3][k] = T(2.0) * (dg * u12 + g * du12);
        break;
      }
      case StrainMeasure::stretch:
        out.dstrain[0][k] = du11;
        out.dstrain[1][k] = du22;
        out.dstrain[3][k] = T(2.0) * du12;
        break;
      case StrainMeasure::green_lagrange:
        out.dstrain[0][k] = u11 * du11 + u12 * du12;
        out.dstrain[1][k] = u22 * du22 + u12 * du12;
        out.dstrain[3][k] = du12 * (u11 + u22) + u12 * (du11 + du22);
        break;
      case StrainMeasure::small: {
        // dF = R (l* U), sym(F) - 1 in the fixed frame
        T f11 = c * dA[k][0] - s * dA[k][2], f12 = c * dA[k][1] - s * dA[k][3];
        T f21 = s * dA[k][0] + c * dA[k][2], f22 = s * dA[k][1] + c * dA[k][3];
        out.dstrain[0][k] = f11;
        out.dstrain[1][k] = f22;
        out.dstrain[3][k] = f12 + f21;
        break;
      }
    }
    out.dstrain[2][k] = T(0.0);
  }
  // 4. and along l*33
  out.dtheta[4] = T(0.0);
  for (auto& row : out.dstrain) row[4] = T(0.0);
  if (measure == StrainMeasure::log)
    out.dstrain[2][4] = T(1.0);
  else if (measure == StrainMeasure::green_lagrange)
    out.dstrain[2][4] = F[4] * F[4];
  else
    out.dstrain[2][4] = F[4];
}

// R s R^T of a stress in order xx, yy, zz, xy.
template <class T>
void turn_stress(T c, T s, const T in[4], T out[4]) {
  T cc = c * c, ss = s * s, cs = c * s;
  out[0] = cc * in[0] + ss * in[1] - T(2.0) * cs * in[3];
  out[1] = ss * in[0] + cc * in[1] + T(2.0) * cs * in[3];
  out[2] = in[2];
  out[3] = cs * (in[0] - in[1]) + (cc - ss) * in[3];
}

// The same of a strain, whose shear is engineering.
template <class T>
void turn_strain(T c, T s, const T in[4], T out[4]) {
  const T tensor[4] = {in[0], in[1], in[2], T(0.5) * in[3]};
  turn_stress(c, s, tensor, out);
  out[3] *= T(2.0);
}

// A D A^T of a tangent d stress/d strain, A the matrix that turns a stress by cosine c and sine s.
template <class T>
void turn_tangent(T c, T s, const T D[4][4], T out[4][4]) {
  T half[4][4];
  for (int i = 0; i < 4; ++i) turn_stress(c, s, D[i], half[i]);  // by columns: the strain's side
  for (int j = 0; j < 4; ++j) {
    const T column[4] = {half[0][j], half[1][j], half[2][j], half[3][j]};
    T turned[4];
    turn_stress(c, s, column, turned);
    for (int i = 0; i < 4; ++i) out[i][j] = turned[i];
  }
}

}  // namespace presswork
