/* SPDX-License-Identifier: Apache-2.0
   Von Mises, perfectly plastic, softer by 1 - (T - T0)/(TM - T0), radial return, in the form of an Abaqus UMAT.
   PROPS: E, nu, yield stress at T0, T0, TM, and what it tells of its heat: 0 nothing, 1 SPD, 2 RPL of nine tenths.
   STATEV(1): equivalent plastic strain. */
#include <math.h>
#include <stddef.h>

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd, double* rpl,
           double* ddsddt, double* drplde, double* drpldt, const double* stran, const double* dstran,
           const double* time, const double* dtime, const double* temp, const double* dtemp, const double* predef,
           const double* dpred, const char* cmname, const int* ndi, const int* nshr, const int* ntens,
           const int* nstatv, const double* props, const int* nprops, const double* coords, const double* drot,
           double* pnewdt, const double* celent, const double* dfgrd0, const double* dfgrd1, const int* noel,
           const int* npt, const int* layer, const int* kspt, const int* jstep, const int* kinc, size_t length) {
  const int n = *ntens, normal = *ndi;
  const double shear = props[0] / (2 * (1 + props[1])), lame = props[0] * props[1] / ((1 + props[1]) * (1 - 2 * props[1]));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      ddsdde[i + n * j] = (i < normal && j < normal ? lame : 0.0) + (i != j ? 0.0 : i < normal ? 2 * shear : shear);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) stress[i] += ddsdde[i + n * j] * dstran[j];
  double mean = 0.0, square = 0.0, direction[6];
  for (int i = 0; i < normal; ++i) mean += stress[i] / 3;
  for (int i = 0; i < n; ++i) direction[i] = stress[i] - (i < normal ? mean : 0.0);
  for (int i = 0; i < n; ++i) square += (i < normal ? 1.5 : 3.0) * direction[i] * direction[i];
  const double q = sqrt(square), flow = props[2] * (props[4] - *temp - *dtemp) / (props[4] - props[3]);
  if (q <= flow) return;
  const double strain = (q - flow) / (3 * shear), theta = 3 * shear * strain / q;
  statev[0] += strain;
  if (props[5] == 1.0) *spd += flow * strain;
  if (props[5] == 2.0) *rpl = 0.9 * flow * strain / *dtime;
  for (int i = 0; i < n; ++i) direction[i] /= q, stress[i] -= 3 * shear * strain * direction[i];
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double deviator = (i != j ? 0.0 : i < normal ? 1.0 : 0.5) - (i < normal && j < normal ? 1.0 / 3 : 0.0);
      ddsdde[i + n * j] -= 2 * shear * (theta * deviator + 1.5 * (1 - theta) * direction[i] * direction[j]);
    }
}
