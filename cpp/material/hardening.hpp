// SPDX-License-Identifier: Apache-2.0
// Isotropic hardening: flow stress [MPa] and its slope against equivalent plastic strain p.
//
//   linear            s0 + H p
//   swift             K (e0 + p)^n
//   ludwik            s0 + K p^n
//   voce              ss - (ss - s0) exp(-b p)
//   linear_voce       s0 + H p + (ss - s0) (1 - exp(-b p))
//   hockett_sherby    ss - (ss - s0) exp(-b p^n)
//   swift_voce        (1 - w) K (e0 + p)^n + w [ss - (ss - s0) exp(-b p)]
//   table             straight lines between points; the last slope goes on beyond the last point
//   monotone_table    cubics between points with given slopes; straight on beyond the last point
//
// A law is a struct with its name, its parameters by name (`fields`, in the order in which they are given), and
// `evaluate`; it is added by naming it in Hardening::Law. The rows of a table are not the struct's own: LawData keeps
// them (law_data.hpp).
#pragma once

#include "tensor/choice.hpp"
#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

namespace hardening {

struct Linear {
  static constexpr const char* name = "linear";
  double yield_stress, modulus;  // [MPa]

  template <class F>
  void fields(F&& f) {
    f("yield_stress", yield_stress), f("modulus", modulus);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    flow = T(yield_stress) + T(modulus) * p;
    slope = T(modulus);
  }
};

struct Swift {
  static constexpr const char* name = "swift";
  double K, e0, n;  // [MPa], -, -

  template <class F>
  void fields(F&& f) {
    f("K", K), f("e0", e0), f("n", n);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T base = T(e0) + p;
    flow = T(K) * power(base, n);
    slope = T(n) * flow / base;
  }
};

struct Ludwik {
  static constexpr const char* name = "ludwik";
  double yield_stress, K, n;  // [MPa], [MPa], -

  template <class F>
  void fields(F&& f) {
    f("yield_stress", yield_stress), f("K", K), f("n", n);
  }
  // the slope at p = 0 is infinite: below 1e-12 the curve rises straight from the yield stress
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T base = larger(p, T(1e-12)), rise = T(K) * power(base, n);
    auto straight = p < T(1e-12);
    flow = T(yield_stress) + select(straight, rise * (p * T(1e12)), rise);
    slope = select(straight, T(1.0), T(n)) * rise / base;
  }
};

struct Voce {
  static constexpr const char* name = "voce";
  double yield_stress, saturation_stress, rate;  // [MPa], [MPa], -

  template <class F>
  void fields(F&& f) {
    f("yield_stress", yield_stress), f("saturation_stress", saturation_stress), f("rate", rate);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T gap = T(saturation_stress - yield_stress) * exponential(T(-rate) * p);
    flow = T(saturation_stress) - gap;
    slope = T(rate) * gap;
  }
};

struct LinearVoce {
  static constexpr const char* name = "linear_voce";
  double yield_stress, saturation_stress, rate, modulus;  // [MPa], [MPa], -, [MPa]

  template <class F>
  void fields(F&& f) {
    f("yield_stress", yield_stress), f("saturation_stress", saturation_stress), f("rate", rate), f("modulus", modulus);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T gap = T(saturation_stress - yield_stress) * exponential(T(-rate) * p);
    flow = T(saturation_stress) - gap + T(modulus) * p;
    slope = T(rate) * gap + T(modulus);
  }
};

struct HockettSherby {
  static constexpr const char* name = "hockett_sherby";
  double yield_stress, saturation_stress, rate, exponent;  // [MPa], [MPa], -, -

  template <class F>
  void fields(F&& f) {
    f("yield_stress", yield_stress), f("saturation_stress", saturation_stress), f("rate", rate);
    f("exponent", exponent);
  }
  // straight below 1e-12, as Ludwik's
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T base = larger(p, T(1e-12)), argument = T(rate) * power(base, exponent);
    T gap = T(saturation_stress - yield_stress) * exponential(-argument);
    T rise = T(saturation_stress - yield_stress) - gap;
    auto straight = p < T(1e-12);
    flow = T(yield_stress) + select(straight, rise * (p * T(1e12)), rise);
    slope = select(straight, rise, T(exponent) * gap * argument) / base;
  }
};

struct SwiftVoce {
  static constexpr const char* name = "swift_voce";
  double voce_share, K, e0, n, yield_stress, saturation_stress, rate;  // -, [MPa], -, -, [MPa], [MPa], -

  template <class F>
  void fields(F&& f) {
    f("voce_share", voce_share), f("K", K), f("e0", e0), f("n", n), f("yield_stress", yield_stress);
    f("saturation_stress", saturation_stress), f("rate", rate);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T base = T(e0) + p;
    T rise = T((1.0 - voce_share) * K) * power(base, n);
    T gap = T(voce_share * (saturation_stress - yield_stress)) * exponential(T(-rate) * p);
    flow = rise + T(voce_share * saturation_stress) - gap;
    slope = T(n) * rise / base + T(rate) * gap;
  }
};

// Looks a law that knows doubles up lane by lane, its curvature being the derivative of the slope.
template <class Rows>
struct LookedUp {
  const double* rows;  // (n_rows, Rows::columns), of LawData
  int n_rows;

  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    T curvature;
    look_up(p, flow, slope, curvature);
  }
  PRESSWORK_DEVICE void look_up(double p, double& flow, double& slope, double& curvature) const {
    static_cast<const Rows*>(this)->at(p, flow, slope, curvature);
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
};

// rows: p, flow stress
struct Table : LookedUp<Table> {
  static constexpr const char* name = "table";
  static constexpr int columns = 2;

  PRESSWORK_DEVICE void at(double p, double& flow, double& slope, double& curvature) const {
    int i = 1;
    while (i + 1 < n_rows && p > rows[2 * i]) ++i;
    const double *a = rows + 2 * (i - 1), *b = n_rows > 1 ? a + 2 : a;
    slope = n_rows > 1 ? (b[1] - a[1]) / (b[0] - a[0]) : 0.0;
    flow = a[1] + slope * (p - a[0]);
    curvature = 0.0;
  }
};

// rows: p, flow stress, slope; Hermite's cubic on the interval that holds p
struct MonotoneTable : LookedUp<MonotoneTable> {
  static constexpr const char* name = "monotone_table";
  static constexpr int columns = 3;

  PRESSWORK_DEVICE void at(double p, double& flow, double& slope, double& curvature) const {
    int i = 1;
    while (i + 1 < n_rows && p > rows[3 * i]) ++i;
    const double *a = rows + 3 * (i - 1), *b = a + 3;
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
};

}  // namespace hardening

struct Hardening {
  using Law =
      std::variant<hardening::Linear, hardening::Swift, hardening::Ludwik, hardening::Voce, hardening::LinearVoce,
                   hardening::HockettSherby, hardening::Table, hardening::SwiftVoce, hardening::MonotoneTable>;
  Law law = hardening::Linear{};

  template <class T>
  PRESSWORK_DEVICE void evaluate(T p, T& flow, T& slope) const {
    choose(law, [&](const auto& chosen) { chosen.evaluate(p, flow, slope); });
  }
  PRESSWORK_DEVICE bool is_linear() const { return std::holds_alternative<hardening::Linear>(law); }
};

// Which of Hardening::Law; its values are named in the bindings, from the structs.
enum class HardeningLaw : int {};

}  // namespace presswork
