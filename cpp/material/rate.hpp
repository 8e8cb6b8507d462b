// SPDX-License-Identifier: Apache-2.0
// Rate of strain: the factor on the flow stress and its slope against the equivalent plastic strain rate r [1/s].
//
//   none             1
//   cowper_symonds   1 + (r / D)^(1/q)
//   johnson_cook     1 + C ln(max(r / r0, 1)), rounded
//   logarithmic      1 + C ln(1 + r / r0); smooth from rest
#pragma once

#include "tensor/choice.hpp"
#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

namespace rate {

struct None {
  static constexpr const char* name = "none";

  template <class F>
  void fields(F&&) {}
  template <class T>
  PRESSWORK_DEVICE void evaluate(T, T& factor, T& slope) const {
    factor = T(1.0), slope = T(0.0);
  }
};

struct CowperSymonds {
  static constexpr const char* name = "cowper_symonds";
  double D, q;  // [1/s], -

  template <class F>
  void fields(F&& f) {
    f("D", D), f("q", q);
  }
  // the slope at rest is infinite: below 1e-12 D the factor rises straight from 1
  template <class T>
  PRESSWORK_DEVICE void evaluate(T rate, T& factor, T& slope) const {
    auto creeping = rate < T(1e-12 * D);
    T base = larger(rate, T(1e-12 * D)), share = larger(rate, T(0.0)) * T(1e12 / D);
    T rise = power(base * T(1.0 / D), 1.0 / q);
    factor = T(1.0) + select(creeping, rise * share, rise);
    slope = select(creeping, T(1.0), T(1.0 / q)) * rise / base;
  }
};

struct JohnsonCook {
  static constexpr const char* name = "johnson_cook";
  double C, reference_rate;  // -, [1/s]

  template <class F>
  void fields(F&& f) {
    f("C", C), f("reference_rate", reference_rate);
  }
  // a parabola from 0.762 r0 to 1.2 r0 rounds the kink at r0, by at most 0.054 C
  template <class T>
  PRESSWORK_DEVICE void evaluate(T rate, T& factor, T& slope) const {
    constexpr double top = 1.2, log_top = 0.18232155679395462, foot = top * (1.0 - 2.0 * log_top);
    T share = rate * T(1.0 / reference_rate);
    auto fast = share > T(top);
    T base = select(fast, share, T(top)), above = larger(share - T(foot), T(0.0));
    T bend(0.5 / (top * (top - foot)));
    factor = T(1.0) + T(C) * select(fast, logarithm(base), bend * above * above);
    slope = T(C / reference_rate) * select(fast, T(1.0) / base, T(2.0) * bend * above);
  }
};

struct Logarithmic {
  static constexpr const char* name = "logarithmic";
  double C, reference_rate;  // -, [1/s]

  template <class F>
  void fields(F&& f) {
    f("C", C), f("reference_rate", reference_rate);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T rate, T& factor, T& slope) const {
    T base = T(1.0) + larger(rate, T(0.0)) * T(1.0 / reference_rate);
    factor = T(1.0) + T(C) * logarithm(base);
    slope = T(C / reference_rate) / base;
  }
};

}  // namespace rate

struct Rate {
  using Law = std::variant<rate::None, rate::CowperSymonds, rate::JohnsonCook, rate::Logarithmic>;
  Law law = rate::None{};

  PRESSWORK_DEVICE bool active() const { return law.index() != 0; }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T rate, T& factor, T& slope) const {
    choose(law, [&](const auto& chosen) { chosen.evaluate(rate, factor, slope); });
  }
};

// Which of Rate::Law; its values are named in the bindings, from the structs.
enum class RateLaw : int {};

}  // namespace presswork
