// SPDX-License-Identifier: Apache-2.0
// UMAT in plane stress: von Mises with linear hardening, by the return mapping of Simo & Hughes (1998), box 3.3.
// PROPS: E, nu, yield stress, H. State variables: plastic strain; sums of TIME(2), KSPT, NOEL and NTENS of the last
// call.
#include <cmath>
#include <cstddef>

extern "C" void umat_(double* stress, double* statev, double* ddsdde, double*, double*, double*, double*, double*,
                      double*, double*, const double*, const double* dstran, const double* time, const double*,
                      const double*, const double*, const double*, const double*, const char*, const int* ndi,
                      const int*, const int* ntens, const int*, const double* props, const int*, const double* coords,
                      const double*, double* pnewdt, const double*, const double*, const double* dfgrd1,
                      const int* noel, const int* npt, const int*, const int* kspt, const int*, const int*,
                      std::size_t) {
  if (*ntens != 3 || *ndi != 2) {
    *pnewdt = 0.5;
    return;
  }
  const double E = props[0], nu = props[1], yield = props[2], H = props[3];
  const double G = E / (2 * (1 + nu)), plane = E / (1 - nu * nu);
  const double e[3] = {dstran[0], dstran[1], dstran[2]};
  stress[0] += plane * (e[0] + nu * e[1]), stress[1] += plane * (e[1] + nu * e[0]), stress[2] += G * e[2];
  const double told[6] = {time[1], double(*kspt), double(*noel), double(*npt), coords[0], dfgrd1[0]};
  for (int i = 0; i < 6; ++i) statev[1 + i] = told[i];
  // 1. f = phi^2/2 - kappa^2/3, in the eigenvectors of C and P
  const double sum = stress[0] + stress[1], difference = stress[1] - stress[0], shear = stress[2];
  const double a = sum * sum / 6, b = difference * difference / 2 + 2 * shear * shear;
  const double by_a = E / (3 * (1 - nu)), by_b = 2 * G, alpha = statev[0], share = std::sqrt(2.0 / 3);
  double dg = 0.0, phi2 = a + b, kappa = yield + H * alpha;
  const bool plastic = 0.5 * phi2 > kappa * kappa / 3;
  for (int k = 0; plastic && k < 100; ++k) {
    const double p = 1 + by_a * dg, q = 1 + by_b * dg;
    phi2 = a / (p * p) + b / (q * q);
    const double phi = std::sqrt(phi2), slope = -2 * (a * by_a / (p * p * p) + b * by_b / (q * q * q));
    kappa = yield + H * (alpha + share * dg * phi);
    const double f = 0.5 * phi2 - kappa * kappa / 3;
    const double df = 0.5 * slope - 2.0 / 3 * kappa * H * share * (phi + dg * slope / (2 * phi));
    const double step = f / df;
    dg -= step;
    if (std::fabs(step) < 1e-15 * (std::fabs(dg) + 1e-20)) break;
  }
  // 2. stress = Xi C^-1 trial, Xi = (C^-1 + dg P)^-1
  const double p = 1 + by_a * dg, q = 1 + by_b * dg;
  const double along = plane * (1 + nu) / p, across = plane * (1 - nu) / q;
  const double end_sum = sum / p, end_difference = difference / q;
  stress[0] = 0.5 * (end_sum - end_difference), stress[1] = 0.5 * (end_sum + end_difference), stress[2] = shear / q;
  double Xi[3][3] = {{0.5 * (along + across), 0.5 * (along - across), 0.0},
                     {0.5 * (along - across), 0.5 * (along + across), 0.0},
                     {0.0, 0.0, G / q}};
  if (plastic) {
    phi2 = a / (p * p) + b / (q * q);
    statev[0] = alpha + share * dg * std::sqrt(phi2);
    const double n[3] = {(2 * stress[0] - stress[1]) / 3, (2 * stress[1] - stress[0]) / 3, 2 * stress[2]};
    double N[3] = {}, length = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) N[i] += Xi[i][j] * n[j];
    for (int i = 0; i < 3; ++i) length += n[i] * N[i];
    const double over = 1 / (length + 2.0 / 3 * H * phi2 / (1 - 2.0 / 3 * H * dg));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) Xi[i][j] -= N[i] * N[j] * over;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) ddsdde[i + 3 * j] = Xi[i][j];
}
