// SPDX-License-Identifier: Apache-2.0
// Gurson's law of a metal with pores (1977), as Tvergaard and Needleman extended it (1984), at a porosity f that stays
// as it is within the increment: a nonlocal mean of its growth is added afterwards.
//
//   yield        (q/s)^2 + 2 q1 f* cosh(3/2 q2 p/s) - 1 - q3 f*^2 = 0, p the mean stress, q the effective stress,
//                s the flow stress of the matrix, softened by 1 - T*^m, T* = (T - reference)/(melting - reference)
//   coalescence  f* = f up to fc, then fc + (1/q1 - fc)/(ff - fc) (f - fc), at most 0.98/q1
//   flow         associated; the matrix takes the work: (1 - f) s de = p dv + q dq, with dv and dq the plastic
//   increments
//                of volume and shape
//   porosity     growth (1 - f) dv, and where p pulls nucleation A de,
//                A = fN/(sN sqrt(2 pi)) exp(-((e - eN)/sN)^2/2)                         (Chu & Needleman 1980)
//
// The increment is that of Aravas (1987), solved by Newton's method for dv, dq and de; the tangent follows from one
// more iteration in dual numbers. Contract of user_law.hpp; state: e, f, growth and nucleation since f last changed.
#pragma once

#include <algorithm>
#include <cmath>

#include "material/hardening.hpp"
#include "material/user_law.hpp"

namespace presswork {

struct Gtn {
  static constexpr int own = 11, n_parameters = 6, n_properties = own + n_parameters + 3, n_state = 3;
  static constexpr StatePart state_parts[] = {{"plastic_strain", 1}, {"porosity", 1}, {"grown", 1}};
  static constexpr double least = 1e-3;  // of the flow stress, that is left when the matrix melts

  double young, poisson, q1, q2, q3, fc, ff, eN, sN, fN;
  Hardening matrix;
  double softening = 1.0;

  // The first ten in this order, the number of the hardening law (not of a table), its parameters, then reference,
  // melting (0: nothing softens) and exponent of the softening, and behind the properties the temperature.
  explicit Gtn(const double* p)
      : young(p[0]), poisson(p[1]), q1(p[2]), q2(p[3]), q3(p[4]), fc(p[5]), ff(p[6]), eN(p[7]), sN(p[8]), fN(p[9]) {
    const double* values = p + own;
    for_each_alternative<Hardening::Law>([&](std::size_t index, auto law) {
      if (index != static_cast<std::size_t>(p[10])) return;
      if constexpr (!requires { law.rows; }) {
        law.fields([&](const char*, double& value) { value = *values++; });
        matrix.law = law;
      }
    });
    const double *heat = p + own + n_parameters, reference = heat[0], melting = heat[1], temperature = heat[3];
    if (melting > reference) {
      const double share = std::min(std::max((temperature - reference) / (melting - reference), 0.0), 1.0);
      softening = std::max(1.0 - std::pow(share, heat[2]), least);
    }
  }

  template <class T>
  void evaluate_matrix(const T& strain, T& flow, T& slope) const {
    matrix.evaluate(strain, flow, slope);
    flow = flow * T(softening), slope = slope * T(softening);
  }

  double effective_porosity(double f) const {
    const double rise = (1.0 / q1 - fc) / (ff - fc);
    return std::min(f <= fc ? f : fc + rise * (f - fc), 0.98 / q1);
  }

  // Flow rule, yield condition and work of the matrix, over the flow stress; unknowns dv, dq, de.
  template <class T>
  void residual(T p_trial, T q_trial, const T x[3], double e_n, double f, T r[3]) const {
    const double bulk = young / (3.0 * (1.0 - 2.0 * poisson)), shear = young / (2.0 * (1.0 + poisson));
    T flow, slope;
    evaluate_matrix(T(e_n) + x[2], flow, slope);
    const double star = effective_porosity(f);
    const T p = (p_trial - T(bulk) * x[0]) / flow, q = (q_trial - T(3.0 * shear) * x[1]) / flow;
    const T grown = exponential(T(1.5 * q2) * p), shrunk = T(1.0) / grown;
    r[0] = T(2.0) * q * x[0] - T(1.5 * q1 * q2 * star) * (grown - shrunk) * x[1];
    r[1] = q * q + T(q1 * star) * (grown + shrunk) - T(1.0 + q3 * star * star);
    r[2] = T(1.0 - f) * x[2] - p * x[0] - q * x[1];
  }

  template <int N, class T>
  bool update(const T* strain, double, T* stress, T* state) const {
    const double bulk = young / (3.0 * (1.0 - 2.0 * poisson)), shear = young / (2.0 * (1.0 + poisson));
    // 1. elastic trial
    const T volume = strain[0] + strain[1] + strain[2];
    T deviator[N], square(0.0);
    T p = (stress[0] + stress[1] + stress[2]) * T(1.0 / 3.0);
    for (int i = 0; i < N; ++i) {
      const double twice = i < 3 ? 1.0 : 2.0;
      deviator[i] = i < 3 ? stress[i] - p + T(2.0 * shear) * (strain[i] - volume * T(1.0 / 3.0))
                          : stress[i] + T(shear) * strain[i];
      square += T(1.5 * twice) * deviator[i] * deviator[i];
    }
    p += T(bulk) * volume;
    const T q = square_root(square + T(1e-20));
    // 2. plastic where the trial is beyond the yield surface
    const double e_n = value_of(state[0]), f = std::max(value_of(state[1]), 0.0);
    double flow, slope;
    evaluate_matrix(e_n, flow, slope);
    const double star = effective_porosity(f), along = 1.5 * q2 * value_of(p) / flow;
    T x[3] = {T(0.0), T(0.0), T(0.0)};
    const double over = value_of(q) * value_of(q) / (flow * flow) +
                        2.0 * q1 * star * std::cosh(std::min(std::fabs(along), 300.0)) - 1.0 - q3 * star * star;
    if (over > 0.0) {
      if (!solve(value_of(p), value_of(q), e_n, f, p, q, x)) return false;
      const double e = value_of(x[2]) + e_n, far = sN > 0.0 ? (e - eN) / sN : 0.0;
      const bool pulls = value_of(p) - bulk * value_of(x[0]) > 0.0;
      const double rate = fN > 0.0 && pulls ? fN / (sN * 2.5066282746310002) * std::exp(-0.5 * far * far) : 0.0;
      state[0] = T(e_n) + x[2];
      state[2] += T(1.0 - f) * x[0] + T(rate) * x[2];
    }
    // 3. stress on the way back
    const T left = (q - T(3.0 * shear) * x[1]) / q;
    for (int i = 0; i < N; ++i) stress[i] = deviator[i] * left + (i < 3 ? p - T(bulk) * x[0] : T(0.0));
    return true;
  }

 private:
  // Newton's method in numbers, from the return of the dense metal; then one iteration in T, which gives derivatives.
  template <class T>
  bool solve(double p, double q, double e_n, double f, const T& p_trial, const T& q_trial, T x[3]) const {
    using D = Dual<double, 3>;
    const double bulk = young / (3.0 * (1.0 - 2.0 * poisson)), shear = young / (2.0 * (1.0 + poisson));
    double flow, slope, y[3], inverse[3][3];
    evaluate_matrix(e_n, flow, slope);
    y[1] = std::max((q - flow) / (3.0 * shear + slope), 0.0), y[0] = 0.0, y[2] = y[1];
    // a pressure far beyond the surface would overflow: begin on the axis where the pores alone would yield
    const double star = std::max(effective_porosity(f), 1e-12);
    const double limit = flow / (1.5 * q2) * std::acosh(std::max((1.0 + q3 * star * star) / (2.0 * q1 * star), 1.0));
    if (std::fabs(p) > limit) y[0] = (p - std::copysign(limit, p)) / bulk;
    for (int iteration = 0; iteration < 80; ++iteration) {
      D at[3], r[3];
      for (int i = 0; i < 3; ++i) at[i] = D::variable(y[i], i);
      residual(D(p), D(q), at, e_n, f, r);
      double size = 0.0, step[3];
      if (!invert(r, inverse)) return false;
      for (int i = 0; i < 3; ++i) {
        step[i] = 0.0;
        for (int j = 0; j < 3; ++j) step[i] -= inverse[i][j] * r[j].value;
      }
      // not beyond the centre of the surface, nor back in strain of the matrix
      double share = 1.0;
      while (share > 1e-4 &&
             (q - 3.0 * shear * (y[1] + share * step[1]) < -1e-9 * flow || y[2] + share * step[2] < -1e-12))
        share *= 0.5;
      for (int i = 0; i < 3; ++i) y[i] += share * step[i], size = std::max(size, std::fabs(step[i]));
      if (!std::isfinite(size)) return false;
      if (share == 1.0 && size < 1e-14 + 1e-12 * (std::fabs(y[0]) + std::fabs(y[1]))) {
        T start[3] = {T(y[0]), T(y[1]), T(y[2])}, rest[3];
        residual(p_trial, q_trial, start, e_n, f, rest);
        for (int i = 0; i < 3; ++i) {
          x[i] = start[i];
          for (int j = 0; j < 3; ++j) x[i] -= T(inverse[i][j]) * rest[j];
        }
        return true;
      }
    }
    return false;
  }

  // Of the slopes of r by the unknowns.
  static bool invert(const Dual<double, 3> r[3], double inverse[3][3]) {
    const auto m = [&](int i, int j) { return r[i % 3].slope[j % 3]; };
    double det = 0.0;
    for (int j = 0; j < 3; ++j) det += m(0, j) * (m(1, j + 1) * m(2, j + 2) - m(1, j + 2) * m(2, j + 1));
    if (!(std::fabs(det) > 0.0)) return false;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        inverse[j][i] = (m(i + 1, j + 1) * m(i + 2, j + 2) - m(i + 1, j + 2) * m(i + 2, j + 1)) / det;
    return true;
  }
};

}  // namespace presswork
