// SPDX-License-Identifier: Apache-2.0
// Isotropic hardening: flow stress [MPa] and its slope against equivalent plastic strain p.
//
//   linear            s0 + H p
//   swift             K (e0 + p)^n
//   ludwik            s0 + K p^n
//   voce              ss - (ss - s0) exp(-b p)
//   linear_voce       s0 + H p + (ss - s0) (1 - exp(-b p))
//   hockett_sherby    ss - (ss - s0) exp(-b p^n)
//   table             straight lines between points; the last slope goes on beyond the last point
//   swift_voce        (1 - w) K (e0 + p)^n + w [ss - (ss - s0) exp(-b p)]
//   monotone_table    cubics between points with given slopes; straight on beyond the last point
#pragma once

#include <vector>

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

enum class HardeningLaw : int {
  linear = 0,
  swift = 1,
  ludwik = 2,
  voce = 3,
  hockett_sherby = 4,
  table = 5,
  swift_voce = 6,
  monotone_table = 7,
  linear_voce = 8
};

struct Hardening {
  HardeningLaw law = HardeningLaw::linear;
  std::vector<double> parameters;  // as listed; linear_voce: s0, ss, b, H; swift_voce: w, K, e0, n, s0, ss, b;
                                   // table: p0, s0, p1, s1, ...;
                                   // monotone_table: p0, s0, slope0, p1, s1, slope1, ...

  // Hermite's cubic on the interval that holds p
  void look_up_cubic(double p, double& flow, double& slope, double& curvature) const {
    const std::size_t n = parameters.size() / 3;
    std::size_t i = 1;
    while (i + 1 < n && p > parameters[3 * i]) ++i;
    const double *a = &parameters[3 * (i - 1)], *b = a + 3;
    if (p >= b[0]) {
      flow = b[1] + b[2] * (p - b[0]);
      slope = b[2];
      curvature = 0.0;
      return;
    }
    const double width = b[0] - a[0], t = (p - a[0]) / width, rise = (b[1] - a[1]) / width;
    const double c2 = 3 * rise - 2 * a[2] - b[2], c3 = a[2] + b[2] - 2 * rise;
    flow = a[1] + width * t * (a[2] + t * (c2 + t * c3));
    slope = a[2] + t * (2 * c2 + 3 * t * c3);
    curvature = (2 * c2 + 6 * t * c3) / width;
  }
  void look_up(double p, double& flow, double& slope, double& curvature) const {
    if (law == HardeningLaw::monotone_table) return look_up_cubic(p, flow, slope, curvature);
    const std::size_t n = parameters.size() / 2;
    std::size_t i = 1;
    while (i + 1 < n && p > parameters[2 * i]) ++i;
    const double *a = &parameters[2 * (i - 1)], *b = a + 2;
    slope = (b[1] - a[1]) / (b[0] - a[0]);
    flow = a[1] + slope * (p - a[0]);
    curvature = 0.0;
  }
  void look_up(Pack p, Pack& flow, Pack& slope, Pack& curvature) const {
    for (int lane = 0; lane < pack_width; ++lane) {
      double f, s, c;
      look_up(p[lane], f, s, c);
      flow.set(lane, f);
      slope.set(lane, s);
      curvature.set(lane, c);
    }
  }
  template <class S, int N>
  void look_up(const Dual<S, N>& p, Dual<S, N>& flow, Dual<S, N>& slope, Dual<S, N>& curvature) const {
    S f, s, c;
    look_up(p.value, f, s, c);
    flow = p.chain(f, s);
    slope = p.chain(s, c);
    curvature = Dual<S, N>(c);
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
        // the slope at p = 0 is infinite: below 1e-12 the curve rises straight from s0
        T base = larger(p, T(1e-12)), rise = T(c[1]) * power(base, c[2]);
        auto straight = p < T(1e-12);
        flow = T(c[0]) + select(straight, rise * (p * T(1e12)), rise);
        slope = select(straight, T(1.0), T(c[2])) * rise / base;
        break;
      }
      case HardeningLaw::voce: {
        T gap = T(c[1] - c[0]) * exponential(T(-c[2]) * p);
        flow = T(c[1]) - gap;
        slope = T(c[2]) * gap;
        break;
      }
      case HardeningLaw::linear_voce: {
        T gap = T(c[1] - c[0]) * exponential(T(-c[2]) * p);
        flow = T(c[1]) - gap + T(c[3]) * p;
        slope = T(c[2]) * gap + T(c[3]);
        break;
      }
      case HardeningLaw::hockett_sherby: {
        T base = larger(p, T(1e-12)), exponent = T(c[2]) * power(base, c[3]);  // straight below 1e-12, as above
        T gap = T(c[1] - c[0]) * exponential(-exponent), rise = T(c[1] - c[0]) - gap;
        auto straight = p < T(1e-12);
        flow = T(c[0]) + select(straight, rise * (p * T(1e12)), rise);
        slope = select(straight, rise, T(c[3]) * gap * exponent) / base;
        break;
      }
      case HardeningLaw::swift_voce: {
        T base = T(c[2]) + p;
        T rise = T((1.0 - c[0]) * c[1]) * power(base, c[3]);
        T gap = T(c[0] * (c[5] - c[4])) * exponential(T(-c[6]) * p);
        flow = rise + T(c[0] * c[5]) - gap;
        slope = T(c[3]) * rise / base + T(c[6]) * gap;
        break;
      }
      case HardeningLaw::table:
      case HardeningLaw::monotone_table: {
        T curvature;
        look_up(p, flow, slope, curvature);
        break;
      }
    }
  }
};

}  // namespace presswork
