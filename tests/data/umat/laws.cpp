// SPDX-License-Identifier: Apache-2.0
// UMATs for the tests, in the calling convention of compiled Fortran; PROPS(1) says which:
//   1  von Mises with Swift hardening K (e0 + p)^n: PROPS 1, E, nu, K, e0, n; one state variable p
//   2  neo-Hookean of the whole deformation gradient: PROPS 2, mu, kappa; DDSDDE of the Jaumann rate of Kirchhoff
//   stress 3  von Mises with Prager's back stress, which it turns by ROTSIG: PROPS 3, E, nu, yield stress, H; state
//      variables: back stress (NTENS), plastic strain, and 1 at the first call
//   4  elastic, and asks for PNEWDT = PROPS(4) where a strain increment is above PROPS(5): PROPS 4, E, nu, factor,
//   limit 5  elastic; writes what it is called with into twelve state variables 6  elastic; calls XIT where PROPS(4) is
//   negative, gives no number where STRAN(2) is below -PROPS(5) 7  elastic, writes one state variable more than it has
#include <algorithm>
#include <cmath>

extern "C" void xit_();
extern "C" void rotsig_(const double*, const double*, double*, const int*, const int*, const int*);
extern "C" void sinv_(const double*, double*, double*, const int*, const int*);

namespace {

void elastic(int n, double E, double nu, double* D) {
  const double G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu));
  std::fill_n(D, n * n, 0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) D[i + n * j] = lame + (i == j ? 2 * G : 0.0);
  for (int i = 3; i < n; ++i) D[i + n * i] = G;
}

void add(int n, const double* D, const double* e, double* s) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) s[i] += D[i + n * j] * e[j];
}

// Radial return of stress - back to flow(p); slope is that of flow, H Prager's; n of unit length.
template <class Flow>
void radial_return(int components, double E, double nu, double* stress, double* D, double* back, double H, double& p,
                   Flow flow) {
  const double G = E / (2 * (1 + nu));
  double xi[6], mean = (stress[0] + stress[1] + stress[2]) / 3;
  for (int i = 0; i < components; ++i) xi[i] = stress[i] - (i < 3 ? mean : 0.0) - back[i];
  double square = 0.0;
  for (int i = 0; i < components; ++i) square += (i < 3 ? 1.0 : 2.0) * xi[i] * xi[i];
  const double length = std::sqrt(square);
  const double q = std::sqrt(1.5) * length;
  double value, slope;
  flow(p, value, slope);
  if (q <= value) return;
  double dp = 0.0;
  for (int k = 0; k < 100; ++k) {
    flow(p + dp, value, slope);
    const double residual = q - (3 * G + H) * dp - value;
    dp += residual / (3 * G + H + slope);
    if (std::abs(residual) < 1e-13 * q) break;
  }
  flow(p + dp, value, slope);
  p += dp;
  double n[6];
  for (int i = 0; i < components; ++i) n[i] = xi[i] / length;
  const double turn = std::sqrt(1.5) * dp;  // length of the plastic strain increment
  for (int i = 0; i < components; ++i) stress[i] -= 2 * G * turn * n[i], back[i] += 2.0 / 3 * H * turn * n[i];
  const double theta = 3 * G * dp / q, bar = 3 * G / (3 * G + H + slope) - theta;
  for (int i = 0; i < components; ++i)
    for (int j = 0; j < components; ++j) {
      const double unit = i == j ? (i < 3 ? 1.0 : 0.5) : 0.0, third = i < 3 && j < 3 ? 1.0 / 3 : 0.0;
      D[i + components * j] -= 2 * G * (theta * (unit - third) + bar * n[i] * n[j]);
    }
}

void neo_hooke(int n, const double* props, const double* F, double* stress, double* D) {
  const double mu = props[1], kappa = props[2];
  const double J =
      F[0] * (F[4] * F[8] - F[5] * F[7]) - F[3] * (F[1] * F[8] - F[2] * F[7]) + F[6] * (F[1] * F[5] - F[2] * F[4]);
  const int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  auto B = [&](int i, int j) { return F[i] * F[j] + F[i + 3] * F[j + 3] + F[i + 6] * F[j + 6]; };
  const double share = mu / std::pow(J, 5.0 / 3), trace = B(0, 0) + B(1, 1) + B(2, 2);
  for (int i = 0; i < n; ++i)
    stress[i] = share * B(at[i][0], at[i][1]) + (i < 3 ? kappa * (J - 1) - share * trace / 3 : 0.0);
  // Jaumann rate of Kirchhoff stress over J: share (1/2)(delta b + b delta) - (2/3) share (b 1 + 1 b) + ...
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const int i = at[r][0], j = at[r][1], k = at[c][0], l = at[c][1];
      auto d = [](int x, int y) { return x == y ? 1.0 : 0.0; };
      D[r + n * c] = share * (0.5 * (d(i, k) * B(j, l) + B(i, k) * d(j, l) + d(i, l) * B(j, k) + B(i, l) * d(j, k)) -
                              2.0 / 3 * (B(i, j) * d(k, l) + d(i, j) * B(k, l)) + 2.0 / 9 * trace * d(i, j) * d(k, l)) +
                     kappa * (2 * J - 1) * d(i, j) * d(k, l);
    }
}

}  // namespace

extern "C" void umat_(double* stress, double* statev, double* ddsdde, double* sse, double*, double*, double*, double*,
                      double*, double*, const double* stran, const double* dstran, const double* time,
                      const double* dtime, const double*, const double*, const double*, const double*,
                      const char* cmname, const int* ndi, const int* nshr, const int* ntens, const int* nstatv,
                      const double* props, const int*, const double* coords, const double* drot, double* pnewdt,
                      const double* celent, const double*, const double* dfgrd1, const int* noel, const int* npt,
                      const int*, const int*, const int* jstep, const int* kinc, std::size_t length) {
  const int law = static_cast<int>(props[0]);
  if (law == 2) return neo_hooke(*ntens, props, dfgrd1, stress, ddsdde);
  const double E = props[1], nu = props[2];
  const int n = std::max(4, *ntens);  // not written for plane stress
  elastic(n, E, nu, ddsdde);
  add(n, ddsdde, dstran, stress);
  if (law == 1) {
    double none[6] = {};
    radial_return(n, E, nu, stress, ddsdde, none, 0.0, statev[0], [&](double p, double& flow, double& slope) {
      flow = props[3] * std::pow(props[4] + p, props[5]);
      slope = props[5] * flow / (props[4] + p);
    });
  } else if (law == 3) {
    const int kind = 1;
    double back[6];
    rotsig_(statev, drot, back, &kind, ndi, nshr);
    radial_return(n, E, nu, stress, ddsdde, back, props[4], statev[n], [&](double, double& flow, double& slope) {
      flow = props[3];
      slope = 0.0;
    });
    std::copy_n(back, n, statev);
    statev[n + 1] = 1.0;
  } else if (law == 4) {
    if (*std::max_element(dstran, dstran + 4) > props[4]) *pnewdt = props[3];
  } else if (law == 5) {
    double mean, mises;
    sinv_(stress, &mean, &mises, ndi, nshr);
    const double told[12] = {time[0],      time[1],          *dtime,        double(*noel),
                             double(*npt), double(jstep[0]), double(*kinc), coords[0],
                             coords[1],    *celent,          mises,         double(*ntens * 1000 + *nstatv)};
    if (length == 80 && cmname[79] == ' ') std::copy_n(told, 12, statev);
    *sse = 1.0;
  } else if (law == 6) {
    if (props[3] < 0.0) xit_();
    if (stran[1] < -props[4]) stress[0] = std::nan("");
  } else if (law == 7) {
    statev[*nstatv] = 1.0;
  }
}
