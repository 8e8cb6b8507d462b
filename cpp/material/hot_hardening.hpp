// SPDX-License-Identifier: Apache-2.0
// Flow stress [MPa] of equivalent plastic strain e, its rate r [1/s] and temperature t [degrees C] together.
//
//   hensel_spittel    A exp(m1 t) t^m9 e^m2 exp(m4/e) (1 + e)^(m5 t) exp(m7 e) r^(m3 + m8 t)     Hensel & Spittel 1978
//   norton_hoff       K (e0 + e)^n r^m exp(beta/T)                                                 Norton 1929, Hoff
//   1954 sinh_arrhenius    asinh((Z/A)^(1/n)) / alpha, Z = r exp(Q/(R T))                           Sellars & McTegart
//   1966 johnson_cook      (A + B e^n) (1 + C ln(r/r0)) (1 - t*^m), t* = (t - reference)/(melting - reference) in 0 ...
//   1
//                                                                                                Johnson & Cook 1983
//   hot_table         between measured values: straight in e, in ln r and in t
//
// T is t in K. A law is fitted in a window of strains, rates and temperatures: beyond its ends the flow stress is that
// at the end, and its slope is zero.
#pragma once

#include <cmath>

#include "tensor/choice.hpp"
#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

// Flow stress and its derivatives.
template <class T>
struct HotPoint {
  T stress, by_strain, by_rate, by_temperature;
};

namespace hot_hardening {

inline constexpr double zero_celsius = 273.15;            // [K]
inline constexpr double gas_constant = 8.31446261815324;  // [J/(mol K)], CODATA 2018

struct Window {
  double strain_min, strain_max;            // -
  double rate_min, rate_max;                // [1/s]
  double temperature_min, temperature_max;  // [degrees C]

  template <class F>
  void fields(F&& f) {
    f("strain_min", strain_min), f("strain_max", strain_max), f("rate_min", rate_min), f("rate_max", rate_max);
    f("temperature_min", temperature_min), f("temperature_max", temperature_max);
  }
};

struct HenselSpittel {
  static constexpr const char* name = "hensel_spittel";
  double A, m1, m2, m3, m4, m5, m7, m8, m9;  // [MPa], [1/degree], -, -, -, [1/degree], -, [1/degree], -
  Window window;

  template <class F>
  void fields(F&& f) {
    f("A", A), f("m1", m1), f("m2", m2), f("m3", m3), f("m4", m4), f("m5", m5), f("m7", m7), f("m8", m8), f("m9", m9);
    window.fields(f);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T e, T r, T t, HotPoint<T>& out) const {
    const T ln_rate = logarithm(r), ln_stretch = T(m5) * logarithm(T(1.0) + e);
    T exponent = T(std::log(A)) + T(m1) * t + ln_stretch * t + T(m7) * e + (T(m3) + T(m8) * t) * ln_rate;
    T by_strain = T(m5) * t / (T(1.0) + e) + T(m7), by_temperature = T(m1) + ln_stretch + T(m8) * ln_rate;
    if (m2 != 0.0 || m4 != 0.0) {
      const T over = T(1.0) / e;
      exponent += T(m2) * logarithm(e) + T(m4) * over;
      by_strain += (T(m2) - T(m4) * over) * over;
    }
    if (m9 != 0.0) {
      exponent += T(m9) * logarithm(t);
      by_temperature += T(m9) / t;
    }
    out.stress = exponential(exponent);
    out.by_strain = out.stress * by_strain;
    out.by_rate = out.stress * (T(m3) + T(m8) * t) / r;
    out.by_temperature = out.stress * by_temperature;
  }
};

struct NortonHoff {
  static constexpr const char* name = "norton_hoff";
  double K, e0, n, m, beta;  // [MPa s^m], -, -, -, [K]
  Window window;

  template <class F>
  void fields(F&& f) {
    f("K", K), f("e0", e0), f("n", n), f("m", m), f("beta", beta);
    window.fields(f);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T e, T r, T t, HotPoint<T>& out) const {
    const T over = T(1.0) / (t + T(zero_celsius));
    T exponent = T(std::log(K)) + T(m) * logarithm(r) + T(beta) * over, by_strain(0.0);
    if (n != 0.0) {
      exponent += T(n) * logarithm(T(e0) + e);
      by_strain = T(n) / (T(e0) + e);
    }
    out.stress = exponential(exponent);
    out.by_strain = out.stress * by_strain;
    out.by_rate = out.stress * T(m) / r;
    out.by_temperature = out.stress * T(-beta) * over * over;
  }
};

struct SinhArrhenius {
  static constexpr const char* name = "sinh_arrhenius";
  double A, alpha, n, Q;  // [1/s], [1/MPa], -, [J/mol]
  Window window;

  template <class F>
  void fields(F&& f) {
    f("A", A), f("alpha", alpha), f("n", n), f("Q", Q);
    window.fields(f);
  }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T, T r, T t, HotPoint<T>& out) const {
    const T over = T(1.0) / (t + T(zero_celsius));
    const T x = exponential(T(1.0 / n) * (logarithm(r) + T(Q / gas_constant) * over - T(std::log(A))));
    const T root = square_root(T(1.0) + x * x);
    out.stress = T(1.0 / alpha) * logarithm_one_plus(x + x * x / (T(1.0) + root));  // asinh x
    const T steepness = T(1.0 / (alpha * n)) * x / root;
    out.by_strain = T(0.0);
    out.by_rate = steepness / r;
    out.by_temperature = steepness * T(-Q / gas_constant) * over * over;
  }
};

struct JohnsonCook {
  static constexpr const char* name = "johnson_cook";
  double A, B, n, C, reference_rate, m, reference, melting;  // [MPa], [MPa], -, -, [1/s], -, 2 [degrees C]
  Window window;

  template <class F>
  void fields(F&& f) {
    f("A", A), f("B", B), f("n", n), f("C", C), f("reference_rate", reference_rate), f("m", m);
    f("reference", reference), f("melting", melting);
    window.fields(f);
  }
  // the slope at e = 0 may be infinite: below 1e-12 the curve rises straight from A
  template <class T>
  PRESSWORK_DEVICE void evaluate(T e, T r, T t, HotPoint<T>& out) const {
    const T base = larger(e, T(1e-12)), rise = T(B) * power(base, n);
    const auto straight = e < T(1e-12);
    const T hard = T(A) + select(straight, rise * (e * T(1e12)), rise);
    const T slope = select(straight, T(1.0), T(n)) * rise / base;
    const T rate = T(1.0) + T(C) * logarithm(r * T(1.0 / reference_rate));
    const T share = (t - T(reference)) * T(1.0 / (melting - reference));
    const auto softens = both(share > T(0.0), share < T(1.0));
    const T within = smaller(larger(share, T(1e-12)), T(1.0)), loss = power(within, m);
    const T soft = select(share > T(0.0), T(1.0) - loss, T(1.0));
    out.stress = hard * rate * soft;
    out.by_strain = slope * rate * soft;
    out.by_rate = hard * T(C) / r * soft;
    out.by_temperature = select(softens, hard * rate * T(-m / (melting - reference)) * loss / within, T(0.0));
  }
};

// Axes and values stand one after another: numbers of strains, rates and temperatures, these themselves, then the flow
// stress, temperature running first, then rate.
struct Table {
  static constexpr const char* name = "hot_table";
  Window window;  // the ends of the axes
  const double* rows;
  int n[3];

  struct Place {
    int at;
    double share, width;
  };
  PRESSWORK_DEVICE static Place find(const double* axis, int n, double x) {
    if (n == 1) return {0, 0.0, 1.0};
    int i = 0;
    while (i + 2 < n && x > axis[i + 1]) ++i;
    const double width = axis[i + 1] - axis[i];
    return {i, (x - axis[i]) / width, width};
  }
  PRESSWORK_DEVICE void at(double e, double r, double t, HotPoint<double>& out) const {
    const double *strains = rows, *rates = strains + n[0], *degrees = rates + n[1], *stress = degrees + n[2];
    const Place a = find(strains, n[0], e), c = find(degrees, n[2], t);
    Place b = find(rates, n[1], r);
    if (n[1] > 1) {
      b.width = std::log(rates[b.at + 1] / rates[b.at]);
      b.share = std::log(r / rates[b.at]) / b.width;
    }
    const int steps[3] = {n[0] > 1, n[1] > 1, n[2] > 1};
    double v[2][2][2];
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        for (int k = 0; k < 2; ++k)
          v[i][j][k] = stress[((a.at + i * steps[0]) * n[1] + b.at + j * steps[1]) * n[2] + c.at + k * steps[2]];
    const auto mix = [](double x, double y, double share) { return x + share * (y - x); };
    double plane[2][2], slope[2][2];
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        plane[i][j] = mix(v[i][j][0], v[i][j][1], c.share);
        slope[i][j] = (v[i][j][1] - v[i][j][0]) / c.width;
      }
    const double low = mix(plane[0][0], plane[0][1], b.share), high = mix(plane[1][0], plane[1][1], b.share);
    out.stress = mix(low, high, a.share);
    out.by_strain = (high - low) / a.width;
    out.by_rate = mix(plane[0][1] - plane[0][0], plane[1][1] - plane[1][0], a.share) / (b.width * r);
    out.by_temperature = mix(mix(slope[0][0], slope[0][1], b.share), mix(slope[1][0], slope[1][1], b.share), a.share);
  }
  PRESSWORK_DEVICE void evaluate(double e, double r, double t, HotPoint<double>& out) const { at(e, r, t, out); }
  void evaluate(Pack e, Pack r, Pack t, HotPoint<Pack>& out) const {
    for (int lane = 0; lane < pack_width; ++lane) {
      HotPoint<double> one;
      at(e[lane], r[lane], t[lane], one);
      out.stress.set(lane, one.stress), out.by_strain.set(lane, one.by_strain);
      out.by_rate.set(lane, one.by_rate), out.by_temperature.set(lane, one.by_temperature);
    }
  }
  // the slopes as constants: a law that asks for their derivatives asks at a residual of zero
  template <class S, int N>
  void evaluate(const Dual<S, N>& e, const Dual<S, N>& r, const Dual<S, N>& t, HotPoint<Dual<S, N>>& out) const {
    HotPoint<S> one;
    evaluate(e.value, r.value, t.value, one);
    out.stress =
        e.chain(one.stress, one.by_strain) + r.chain(S(0.0), one.by_rate) + t.chain(S(0.0), one.by_temperature);
    out.by_strain = Dual<S, N>(one.by_strain), out.by_rate = Dual<S, N>(one.by_rate);
    out.by_temperature = Dual<S, N>(one.by_temperature);
  }
};

}  // namespace hot_hardening

struct HotHardening {
  using Law = std::variant<hot_hardening::HenselSpittel, hot_hardening::NortonHoff, hot_hardening::SinhArrhenius,
                           hot_hardening::JohnsonCook, hot_hardening::Table>;
  Law law = hot_hardening::HenselSpittel{};
  bool chosen = false;

  PRESSWORK_DEVICE bool active() const { return chosen; }
  template <class T>
  PRESSWORK_DEVICE void evaluate(T strain, T rate, T temperature, HotPoint<T>& out) const {
    choose(law, [&](const auto& own) {
      const auto& w = own.window;
      const auto clamp = [](T x, double low, double high) { return smaller(larger(x, T(low)), T(high)); };
      own.evaluate(clamp(strain, w.strain_min, w.strain_max), clamp(rate, w.rate_min, w.rate_max),
                   clamp(temperature, w.temperature_min, w.temperature_max), out);
      const auto keep = [](T slope, T x, double low, double high) {
        return select(either(x<T(low), x> T(high)), T(0.0), slope);
      };
      out.by_strain = keep(out.by_strain, strain, w.strain_min, w.strain_max);
      out.by_rate = keep(out.by_rate, rate, w.rate_min, w.rate_max);
      out.by_temperature = keep(out.by_temperature, temperature, w.temperature_min, w.temperature_max);
    });
  }
};

}  // namespace presswork
