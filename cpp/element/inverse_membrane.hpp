// SPDX-License-Identifier: Apache-2.0
// A triangle of a finished part whose three places in the blank are sought: membrane with the bending of the part's
// curvature, deformation theory of plasticity, total logarithmic strain. Theory: docs/theory/one_step.md.
//
// F carries the flat blank into the plane of the triangle. Through the thickness, at the height z over the mid-surface,
// it is (1 + z B) F with B the part's curvature. Per initial volume, with E = ln(F'F)/2 in the blank's own axes
// (x along the rolling direction),
//
//   W = integral of the flow stress over e,   e^2 = E' Q E,   Q the inverse of Hill's matrix of plane stress
//
// A layer that was formed before counts E from the strain at which it is free of stress, and the flow stress from the
// plastic strain that it has: deformation theory from stage to stage.
//
// and the forces of the corners are d(A0 t0 W)/d(final place) at a fixed blank. The sheet that has thinned carries as
// if it had not (factor t0/t): deformation theory would else let it tear at its largest force, which no designer asks
// for.
#pragma once

#include <algorithm>
#include <cmath>

#include "material/hardening.hpp"
#include "tensor/dual.hpp"

namespace presswork {

// Stress against total strain: elastic up to the yield stress, then hardening by plastic strain.
struct DeformationLaw {
  Hardening hardening;
  double young;
  double strain_metric[3][3];  // Q, over (xx, yy, 2 xy)

  // Secant modulus, flow stress over e, and its derivative by y = e^2, of a sheet hardened by the plastic strain p0.
  template <class S>
  void secant(S y, S p0, S& modulus, S& slope) const {
    S e = square_root(larger(y, S(1e-30))), stress, tangent;
    flow(e, p0, stress, tangent);
    modulus = stress / e;
    slope = (tangent - modulus) / (S(2.0) * e * e);
  }
  // Stress and its slope at the strain e since the sheet was free of stress, hardened by p0: the plastic strain p
  // that is added solves Y(p0 + p) = E (e - p).
  template <class S>
  void flow(S e, S p0, S& stress, S& tangent) const {
    S yield, h;
    hardening.evaluate(p0, yield, h);
    auto elastic = S(young) * e < yield;
    S p = larger(e - yield / S(young), S(0.0));
    for (int i = 0; i < 40; ++i) {
      S y, slope;
      hardening.evaluate(p0 + p, y, slope);
      S next = larger(p + (S(young) * (e - p) - y) / (S(young) + slope), S(0.0));
      S moved = next - p;
      p = next;
      if (!any(moved * moved > S(1e-28) * (S(1e-6) + p * p))) break;
    }
    hardening.evaluate(p0 + p, stress, h);
    stress = select(elastic, S(young) * e, stress);
    tangent = select(elastic, S(young), S(young) * h / (S(young) + h));
  }
};

// atanh(sqrt s)/sqrt s and its first two derivatives; 0 <= s < 1.
template <class S>
void area_tangent_ratio(S s, S& a, S& a1, S& a2) {
  static constexpr double series[] = {1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13, 1.0 / 11,
                                      1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
  S b(0.0), b1(0.0), b2(0.0);
  for (double c : series) {
    b2 = b2 * s + S(2.0) * b1;
    b1 = b1 * s + b;
    b = b * s + S(c);
  }
  S big = larger(s, S(0.02)), q = square_root(big), rest = S(1.0) / (S(1.0) - big);
  S closed = S(0.5) * logarithm((S(1.0) + q) / (S(1.0) - q)) / q;
  S closed1 = (rest - closed) / (S(2.0) * big), closed2 = (rest * rest - S(3.0) * closed1) / (S(2.0) * big);
  auto small = s < S(0.02);
  a = select(small, b, closed);
  a1 = select(small, b1, closed1);
  a2 = select(small, b2, closed2);
}
template <class S, int N>
void area_tangent_ratio(const Dual<S, N>& s, Dual<S, N>& a, Dual<S, N>& slope) {
  S v, v1, v2;
  area_tangent_ratio(s.value, v, v1, v2);
  a = s.chain(v, v1);
  slope = s.chain(v1, v2);
}
inline void area_tangent_ratio(double s, double& a, double& slope) {
  double a2;
  area_tangent_ratio(s, a, slope, a2);
}
inline void area_tangent_ratio(Pack s, Pack& a, Pack& slope) {
  Pack a2;
  area_tangent_ratio(s, a, slope, a2);
}

template <class S>
S secant_modulus(const DeformationLaw& law, S y, S p0) {
  S modulus, slope;
  law.secant(y, p0, modulus, slope);
  return modulus;
}
template <class S, int N>
Dual<S, N> secant_modulus(const DeformationLaw& law, const Dual<S, N>& y, S p0) {
  S modulus, slope;
  law.secant(y.value, p0, modulus, slope);
  return y.chain(modulus, slope);
}

// What a layer has gone through: logarithmic strain (xx, yy, 2 xy) at which it is free of stress, and its equivalent
// plastic strain.
template <class S>
struct Formed {
  S strain[3], hardened;
};

// What a layer has gone through once it is strained so: the strain since it was free of stress less its elastic part,
// stress over Young's modulus along the same direction, stays.
inline Formed<double> form_layer(const DeformationLaw& law, const Formed<double>& before, const double strain[3]) {
  double since[3], e = 0.0, stress, tangent;
  for (int i = 0; i < 3; ++i) since[i] = strain[i] - before.strain[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) e += since[i] * law.strain_metric[i][j] * since[j];
  e = std::sqrt(e);
  law.flow(e, before.hardened, stress, tangent);
  const double plastic = std::max(e - stress / law.young, 0.0);
  Formed<double> now = before;
  now.hardened += plastic;
  for (int i = 0; i < 3; ++i) now.strain[i] += since[i] * (plastic / std::max(e, 1e-300));
  return now;
}

// First Piola-Kirchhoff stress P = dW/dF (rows x 2) of the deformation F.
template <int rows, class T, class S>
void deformation_stress(const DeformationLaw& law, const Formed<S>& formed, const T F[rows][2], T P[rows][2]) {
  T c11 = F[0][0] * F[0][0], c22 = F[0][1] * F[0][1], c12 = F[0][0] * F[0][1];
  for (int i = 1; i < rows; ++i) {
    c11 = c11 + F[i][0] * F[i][0];
    c22 = c22 + F[i][1] * F[i][1];
    c12 = c12 + F[i][0] * F[i][1];
  }
  T m = T(0.5) * (c11 + c22), d = T(0.5) * (c11 - c22), det = c11 * c22 - c12 * c12;
  T inverse_m = T(1.0) / m, s = (d * d + c12 * c12) * inverse_m * inverse_m, a, a1;
  area_tangent_ratio(s, a, a1);
  // E = ln det/4 + a/(2m) (C - m)
  T mean = T(0.25) * logarithm(det), b = T(0.5) * a * inverse_m;
  T exx = mean + b * d - T(formed.strain[0]), eyy = mean - b * d - T(formed.strain[1]);
  T gxy = T(2.0) * b * c12 - T(formed.strain[2]);
  const auto& q = law.strain_metric;
  T mx = T(q[0][0]) * exx + T(q[0][1]) * eyy + T(q[0][2]) * gxy;
  T my = T(q[1][0]) * exx + T(q[1][1]) * eyy + T(q[1][2]) * gxy;
  T mg = T(q[2][0]) * exx + T(q[2][1]) * eyy + T(q[2][2]) * gxy;
  T secant = secant_modulus(law, exx * mx + eyy * my + gxy * mg, formed.hardened);
  mx = secant * mx;
  my = secant * my;
  mg = secant * mg;
  // S = 2 dW/dC
  T trace = mx + my, half = T(0.5) * (mx - my), along = d * (mx - my) + T(2.0) * c12 * mg;  // M : (C - m)
  T on_inverse = T(0.5) * trace / det;
  T on_deviator = along * a1 * inverse_m * inverse_m * inverse_m;
  T on_unit = -along * inverse_m * inverse_m * (a1 * s + T(0.5) * a);
  T two_b = T(2.0) * b;
  T sxx = on_inverse * c22 + two_b * half + on_deviator * d + on_unit;
  T syy = on_inverse * c11 - two_b * half - on_deviator * d + on_unit;
  T sxy = two_b * mg + on_deviator * c12 - on_inverse * c12;
  for (int i = 0; i < rows; ++i) {
    P[i][0] = F[i][0] * sxx + F[i][1] * sxy;
    P[i][1] = F[i][0] * sxy + F[i][1] * syy;
  }
}

struct InverseLayers {
  int n;
  const double *height, *weight;  // height from -1 to 1, weights that add up to one
};

// Forces (3 corners, 2) in the triangle's plane. edges: columns are the final edges 01 and 02; curvature: B (xx, yy,
// xy) [1/mm]; blank: the three places in the blank [mm]. Returns the blank's area times two, above zero unless it is
// turned over.
template <class T, class S>
T inverse_membrane(const DeformationLaw& law, const InverseLayers& layers, double thickness, const Formed<S>* formed,
                   const S edges[2][2], const S curvature[3], const T blank[3][2], T force[3][2]) {
  T d[2][2];
  for (int i = 0; i < 2; ++i) {
    d[i][0] = blank[1][i] - blank[0][i];
    d[i][1] = blank[2][i] - blank[0][i];
  }
  T area2 = d[0][0] * d[1][1] - d[0][1] * d[1][0], one_over = T(1.0) / area2;
  T inverse[2][2] = {{d[1][1] * one_over, -d[0][1] * one_over}, {-d[1][0] * one_over, d[0][0] * one_over}};
  T F[2][2];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) F[i][j] = T(edges[i][0]) * inverse[0][j] + T(edges[i][1]) * inverse[1][j];
  T stretch = F[0][0] * F[1][1] - F[0][1] * F[1][0];  // of area: t0/t
  T half = T(0.5 * thickness) / stretch, sum[2][2] = {{T(0.0), T(0.0)}, {T(0.0), T(0.0)}};
  for (int k = 0; k < layers.n; ++k) {
    T z = half * T(layers.height[k]);
    T a = T(1.0) + z * T(curvature[0]), b = z * T(curvature[2]), c = T(1.0) + z * T(curvature[1]);
    T G[2][2], P[2][2];
    for (int j = 0; j < 2; ++j) {
      G[0][j] = a * F[0][j] + b * F[1][j];
      G[1][j] = b * F[0][j] + c * F[1][j];
    }
    deformation_stress<2>(law, formed[k], G, P);
    for (int j = 0; j < 2; ++j) {
      sum[0][j] += T(layers.weight[k]) * (a * P[0][j] + b * P[1][j]);
      sum[1][j] += T(layers.weight[k]) * (b * P[0][j] + c * P[1][j]);
    }
  }
  T volume = T(0.5 * thickness) * area2 * larger(stretch, T(1.0));
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) force[j + 1][i] = volume * (sum[i][0] * inverse[j][0] + sum[i][1] * inverse[j][1]);
    force[0][i] = -force[1][i] - force[2][i];
  }
  return area2;
}

}  // namespace presswork
