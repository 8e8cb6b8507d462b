// SPDX-License-Identifier: Apache-2.0
// Isotropic hardening: flow stress [MPa] and its slope against equivalent plastic strain p.
//
//   linear            s0 + H p
//   swift             K (e0 + p)^n
//   ludwik            s0 + K p^n
//   voce              ss - (ss - s0) exp(-b p)
//   hockett_sherby    ss - (ss - s0) exp(-b p^n)
//   table             straight lines between points; the last slope goes on beyond the last point
#pragma once

#include <vector>

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

enum class HardeningLaw : int { linear = 0, swift = 1, ludwik = 2, voce = 3, hockett_sherby = 4, table = 5 };

struct Hardening {
  HardeningLaw law = HardeningLaw::linear;
  std::vector<double> parameters;  // as listed above; table: p0, s0, p1, s1, ...

  void look_up(double p, double& flow, double& slope) const {
    const std::size_t n = parameters.size() / 2;
    std::size_t i = 1;
    while (i + 1 < n && p > parameters[2 * i]) ++i;
    const double *a = &parameters[2 * (i - 1)], *b = a + 2;
    slope = (b[1] - a[1]) / (b[0] - a[0]);
    flow = a[1] + slope * (p - a[0]);
  }
  void look_up(Pack p, Pack& flow, Pack& slope) const {
    for (int lane = 0; lane < pack_width; ++lane) {
      double f, s;
      look_up(p[lane], f, s);
      flow.set(lane, f);
      slope.set(lane, s);
    }
  }
  template <class S, int N>
  void look_up(const Dual<S, N>& p, Dual<S, N>& flow, Dual<S, N>& slope) const {
    S f, s;
    look_up(p.value, f, s);
    flow = p.chain(f, s);
    slope = Dual<S, N>(s);
  }

  template <class T>
  void evaluate(T p, T& flow, T& slope) const {
    const double* c = parameters.data();
    switch (law) {
      case HardeningLaw::linear:
        flow = T(c[0]) + T(c[1]) * p;
        slope = T(c[1]);
        break;
      case HardeningLaw::swift: {
        T base = T(c[1]) + p;
        flow = T(c[0]) * power(base, c[2]);
        slope = T(c[2]) * flow / base;
        break;
      }
      case HardeningLaw::ludwik: {
        T base = larger(p, T(1e-12));  // the slope at p = 0 is infinite; it is cut at p = 1e-12
        T rise = T(c[1]) * power(base, c[2]);
        flow = T(c[0]) + rise;
        slope = T(c[2]) * rise / base;
        break;
      }
      case HardeningLaw::voce: {
        T gap = T(c[1] - c[0]) * exponential(T(-c[2]) * p);
        flow = T(c[1]) - gap;
        slope = T(c[2]) * gap;
        break;
      }
      case HardeningLaw::hockett_sherby: {
        T base = larger(p, T(1e-12));
        T exponent = T(c[2]) * power(base, c[3]);
        T gap = T(c[1] - c[0]) * exponential(-exponent);
        flow = T(c[1]) - gap;
        slope = T(c[3]) * gap * exponent / base;
        break;
      }
      case HardeningLaw::table:
        look_up(p, flow, slope);
        break;
    }
  }
};

}  // namespace presswork
