// SPDX-License-Identifier: Apache-2.0
// Rate of strain: the factor on the flow stress and its slope against the equivalent plastic strain rate r [1/s].
//
//   none             1
//   cowper_symonds   1 + (r / D)^(1/q)                   parameters D [1/s], q
//   johnson_cook     1 + C ln(max(r / r0, 1)), rounded   parameters C, r0 [1/s]
//   logarithmic      1 + C ln(1 + r / r0)                parameters C, r0 [1/s]; smooth from rest
#pragma once

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

enum class RateLaw : int { none = 0, cowper_symonds = 1, johnson_cook = 2, logarithmic = 3 };

struct Rate {
  RateLaw law = RateLaw::none;
  double a = 0.0, b = 1.0;  // as listed above

  template <class T>
  void evaluate(T rate, T& factor, T& slope) const {
    factor = T(1.0);
    slope = T(0.0);
    switch (law) {
      case RateLaw::none:
        break;
      case RateLaw::cowper_symonds: {
        // the slope at rest is infinite: below 1e-12 D the factor rises straight from 1
        auto creeping = rate < T(1e-12 * a);
        T base = larger(rate, T(1e-12 * a)), share = larger(rate, T(0.0)) * T(1e12 / a);
        T rise = power(base * T(1.0 / a), 1.0 / b);
        factor = T(1.0) + select(creeping, rise * share, rise);
        slope = select(creeping, T(1.0), T(1.0 / b)) * rise / base;
        break;
      }
      case RateLaw::johnson_cook: {
        // a parabola from 0.762 r0 to 1.2 r0 rounds the kink at r0, by at most 0.054 C
        constexpr double top = 1.2, log_top = 0.18232155679395462, foot = top * (1.0 - 2.0 * log_top);
        T share = rate * T(1.0 / b);
        auto fast = share > T(top);
        T base = select(fast, share, T(top)), above = larger(share - T(foot), T(0.0));
        T bend(0.5 / (top * (top - foot)));
        factor = T(1.0) + T(a) * select(fast, logarithm(base), bend * above * above);
        slope = T(a / b) * select(fast, T(1.0) / base, T(2.0) * bend * above);
        break;
      }
      case RateLaw::logarithmic: {
        T base = T(1.0) + larger(rate, T(0.0)) * T(1.0 / b);
        factor = T(1.0) + T(a) * logarithm(base);
        slope = T(a / b) / base;
        break;
      }
    }
  }
};

}  // namespace presswork
