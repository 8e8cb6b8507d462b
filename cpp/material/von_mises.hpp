// SPDX-License-Identifier: Apache-2.0
// Isotropic elasticity with von Mises plasticity and isotropic hardening: six stress integrators.
//
// The contract is that of law.hpp, in 4 or 6 components; the state is stress and equivalent plastic strain. S is the
// deviatoric stress, R_y = sqrt(2/3) flow stress its length on the yield surface.
//
//   backward_euler         S_f = S_t (1 - 3G dp/q_t), q_t - 3G dp = flow(p + dp)       Simo & Taylor 1985; the default
//   radial_return          S_t scaled to flow(p + dp), dp by the slope at the start     Wilkins 1964
//   direct                 S_c + dS of the rate equation at S_c, no correction          thesis 9
//   tangent_radial_return  the direct result scaled to flow(p + dp)                     Marcal 1969
//   secant                 the rate equation at (S_t + S_c)/2, then scaled              Rice & Tracey 1973
//   substepping            tangent_radial_return over equal parts of the increment      the thesis's own
//
// S_c is the stress where the elastic path meets the yield surface, S_t the elastic trial stress. With hardening,
// secant is scaled to the hardened surface; without it Rice & Tracey's point lies there by itself. Tangents: closed
// form for backward_euler, dual numbers for the rest, so that each is the exact derivative of what was computed;
// "continuum" is the rate equation's matrix (Yamada 1968) at the final stress, for all of them.
#pragma once

#include "material/hardening.hpp"
#include "material/law.hpp"

namespace presswork {

enum class Integrator : int {
  backward_euler = 0,
  radial_return = 1,
  direct = 2,
  tangent_radial_return = 3,
  secant = 4,
  substepping = 5
};

enum class Modulus : int { consistent = 0, continuum = 1 };

struct VonMises {
  double young = 0.0;  // [MPa]
  double poisson = 0.0;
  Hardening hardening;
  Integrator integrator = Integrator::backward_euler;
  int substeps = 10;
  Modulus modulus = Modulus::consistent;

  PRESSWORK_DEVICE static constexpr int state_size(int n) { return n + 1; }
  // Flow stress and its slope at equivalent plastic strain p, at rest.
  template <class T>
  PRESSWORK_DEVICE void flow_at_rest(T p, T, T& flow, T& slope) const {
    hardening.evaluate(p, flow, slope);
  }
  PRESSWORK_DEVICE double shear_modulus() const { return young / (2.0 * (1.0 + poisson)); }
  PRESSWORK_DEVICE double bulk_modulus() const { return young / (3.0 * (1.0 - 2.0 * poisson)); }
};

namespace von_mises {

template <class T>
PRESSWORK_DEVICE T mean_of(const T* s) {
  return (s[0] + s[1] + s[2]) * T(1.0 / 3);
}
// double contraction of two symmetric tensors given as tensor components
template <int N, class T>
PRESSWORK_DEVICE T contract(const T a[N], const T b[N]) {
  T sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  for (int i = 3; i < N; ++i) sum = sum + T(2.0) * a[i] * b[i];
  return sum;
}
template <int N, class T>
PRESSWORK_DEVICE T effective_of(const T s[N]) {
  return square_root(T(1.5) * contract<N>(s, s));
}
template <int N, class T>
PRESSWORK_DEVICE void deviator_of(const T a[N], T s[N]) {
  T m = mean_of(a);
  for (int i = 0; i < N; ++i) s[i] = i < 3 ? a[i] - m : a[i];
}

// dp of q_trial - 3G dp = flow(p + dp), by Newton inside a bracket; zero where mask is off.
template <class T, class M>
PRESSWORK_DEVICE T solve_plastic_increment(const VonMises& law, T eqps, T q_trial, T over, M plastic, T& slope) {
  const double g3 = 3.0 * law.shear_modulus();
  T flow;
  law.hardening.evaluate(eqps, flow, slope);
  T dp = select(plastic, over / (T(g3) + slope), T(0.0));
  if (law.hardening.is_linear()) return dp;
  T low(0.0), high = select(plastic, over * T(1.0 / g3), T(0.0));
  for (int iteration = 0; iteration < 60; ++iteration) {
    law.hardening.evaluate(eqps + dp, flow, slope);
    T residual = q_trial - T(g3) * dp - flow;
    T size = larger(residual, -residual);
    auto open = both(plastic, size > T(1e-13) * q_trial);
    if (!any(open)) break;
    low = select(residual > T(0.0), dp, low);
    high = select(residual > T(0.0), high, dp);
    T next = dp + residual / (T(g3) + slope);
    auto inside = both(next > low, next < high);
    next = select(inside, next, T(0.5) * (low + high));
    dp = select(open, next, dp);
  }
  return dp;
}

template <int N, class T>
PRESSWORK_DEVICE void elastic_plastic_matrix(const VonMises& law, const T n[N], T theta, T theta_bar, T (*matrix)[N]) {
  // K 1 x 1 + 2G theta I_dev - 2G theta_bar N x N, N of unit length
  const double G = law.shear_modulus(), K = law.bulk_modulus();
  T g2 = T(2.0 * G) * theta;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) matrix[i][j] = -T(2.0 * G) * theta_bar * n[i] * n[j];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix[i][j] += T(K) - g2 * T(1.0 / 3);
    matrix[i][i] += g2;
  }
  for (int i = 3; i < N; ++i) matrix[i][i] += T(0.5) * g2;
}

// The default: backward Euler and, if tangent is given, its consistent matrix (or the continuum one).
template <int N, class T>
PRESSWORK_DEVICE void update_backward_euler(const VonMises& law, const T strain[N], const T* s0, T* s1,
                                            T (*tangent)[N]) {
  const double G = law.shear_modulus(), K = law.bulk_modulus();
  const T eqps = s0[N];
  // 1. elastic predictor
  T volume = strain[0] + strain[1] + strain[2];
  T mean = mean_of(s0) + T(K) * volume;
  T s[N];
  deviator_of<N>(s0, s);
  for (int i = 0; i < 3; ++i) s[i] += T(2.0 * G) * (strain[i] - volume * T(1.0 / 3));
  for (int i = 3; i < N; ++i) s[i] += T(G) * strain[i];
  T q = effective_of<N>(s);
  // 2. admissible?
  T flow, slope;
  law.hardening.evaluate(eqps, flow, slope);
  auto plastic = q > flow;
  // 3. return
  T scale(1.0), dp(0.0);
  T safe_q = larger(q, T(1e-300));
  if (any(plastic)) {
    dp = solve_plastic_increment(law, eqps, q, q - flow, plastic, slope);
    scale = T(1.0) - T(3.0 * G) * dp / safe_q;
  }
  for (int i = 0; i < N; ++i) s1[i] = i < 3 ? scale * s[i] + mean : scale * s[i];
  s1[N] = eqps + dp;
  // 4. tangent
  if (!tangent) return;
  T n[N];
  const double unit = 1.2247448713915890491;  // sqrt(3/2)
  for (int i = 0; i < N; ++i) n[i] = T(unit) * s[i] / safe_q;
  T theta = law.modulus == Modulus::consistent ? scale : T(1.0);
  T theta_bar = T(1.0) / (T(1.0) + slope * T(1.0 / (3.0 * G))) - (T(1.0) - theta);
  theta_bar = select(plastic, theta_bar, T(0.0));
  elastic_plastic_matrix<N>(law, n, theta, theta_bar, tangent);
}

// The rate equation over the strain deviator de (tensor components), its direction taken at S_dir; adds to s and eqps.
template <int N, class T>
PRESSWORK_DEVICE void step_rate_equation(const VonMises& law, const T direction[N], const T de[N], T s[N], T& eqps) {
  const double G = law.shear_modulus();
  T flow, slope;
  law.hardening.evaluate(eqps, flow, slope);
  T length = square_root(contract<N>(direction, direction));
  T along = larger(contract<N>(direction, de) / length, T(0.0));
  T dp = T(0.81649658092772603273) * along * T(3.0 * G) / (T(3.0 * G) + slope);  // sqrt(2/3)
  T pull = T(2.0 * G * 1.2247448713915890491) * dp / length;
  for (int i = 0; i < N; ++i) s[i] += T(2.0 * G) * de[i] - pull * direction[i];
  eqps += dp;
}

template <int N, class T>
PRESSWORK_DEVICE void scale_to_surface(const VonMises& law, T eqps, T s[N]) {
  T flow, slope;
  law.hardening.evaluate(eqps, flow, slope);
  T ratio = flow / effective_of<N>(s);
  for (int i = 0; i < N; ++i) s[i] *= ratio;
}

// The five integrators that are there to be compared.
template <int N, class T>
PRESSWORK_CALLED void update_by_rate(const VonMises& law, const T strain[N], const T* s0, T* s1) {
  const double G = law.shear_modulus(), K = law.bulk_modulus();
  T volume = strain[0] + strain[1] + strain[2];
  T mean = mean_of(s0) + T(K) * volume;
  T s[N], de[N], trial[N], contact[N];
  deviator_of<N>(s0, s);
  for (int i = 0; i < 3; ++i) de[i] = strain[i] - volume * T(1.0 / 3);
  for (int i = 3; i < N; ++i) de[i] = T(0.5) * strain[i];
  for (int i = 0; i < N; ++i) trial[i] = s[i] + T(2.0 * G) * de[i];
  T flow, slope;
  law.hardening.evaluate(s0[N], flow, slope);
  T q = effective_of<N>(trial);
  auto plastic = value_of(q) > value_of(flow);

  // 1. the part of the increment that is elastic: |s + f 2G de| = R_y; all of it where the trial stress is admissible
  T a = T(4.0 * G * G) * contract<N>(de, de), b = T(2.0 * G) * contract<N>(s, de);
  // A stress that rounding alone keeps off the surface lies on it: where the increment runs along the surface, b = 0,
  // an error e of c would become sqrt(e) of the fraction.
  T surface = T(2.0 / 3) * flow * flow, c = contract<N>(s, s) - surface;
  c = select(value_of(larger(c, -c)) < value_of(T(1e-14) * surface), T(0.0), c);
  T root = square_root(larger(b * b - a * c, T(0.0)));
  T fraction = (root - b) / larger(a, T(1e-300));
  fraction = smaller(larger(fraction, T(0.0)), T(1.0));
  fraction = select(plastic, fraction, T(1.0));
  T rest[N];
  for (int i = 0; i < N; ++i) {
    contact[i] = s[i] + fraction * T(2.0 * G) * de[i];
    rest[i] = (T(1.0) - fraction) * de[i];
  }

  // 2. the plastic part
  T result[N], eqps = s0[N];
  for (int i = 0; i < N; ++i) result[i] = contact[i];
  switch (law.integrator) {
    case Integrator::radial_return: {
      eqps += (q - flow) / (T(3.0 * G) + slope);
      for (int i = 0; i < N; ++i) result[i] = trial[i];
      scale_to_surface<N>(law, eqps, result);
      break;
    }
    case Integrator::secant: {
      T middle[N];
      for (int i = 0; i < N; ++i) middle[i] = T(0.5) * (trial[i] + contact[i]);
      step_rate_equation<N>(law, middle, rest, result, eqps);
      scale_to_surface<N>(law, eqps, result);
      break;
    }
    case Integrator::substepping: {
      T part[N];
      for (int i = 0; i < N; ++i) part[i] = rest[i] * T(1.0 / law.substeps);
      for (int k = 0; k < law.substeps; ++k) {
        T direction[N];
        for (int i = 0; i < N; ++i) direction[i] = result[i];
        step_rate_equation<N>(law, direction, part, result, eqps);
        scale_to_surface<N>(law, eqps, result);
      }
      break;
    }
    default:
      step_rate_equation<N>(law, contact, rest, result, eqps);
      if (law.integrator == Integrator::tangent_radial_return) scale_to_surface<N>(law, eqps, result);
  }

  // 3. elastic points keep the trial stress
  for (int i = 0; i < N; ++i) {
    T final_deviator = select(plastic, result[i], trial[i]);
    s1[i] = i < 3 ? final_deviator + mean : final_deviator;
  }
  s1[N] = select(plastic, eqps, s0[N]);
}

}  // namespace von_mises

// The update without a tangent, which a card computes, too.
template <int N, class T>
PRESSWORK_DEVICE void advance_stress(const VonMises& law, const T strain[N], const T* s0, T* s1) {
  if (law.integrator == Integrator::backward_euler)
    von_mises::update_backward_euler<N>(law, strain, s0, s1, static_cast<T(*)[N]>(nullptr));
  else
    von_mises::update_by_rate<N>(law, strain, s0, s1);
}

template <int N, class T>
Mask<T> update(const VonMises& law, const LawInput<N, T>& in, const T* s0, T* s1, T (*tangent)[N]) {
  const auto none = T(1.0) < T(0.0);
  if (law.integrator == Integrator::backward_euler) {
    von_mises::update_backward_euler<N>(law, in.strain, s0, s1, tangent);
    return none;
  }
  if (!tangent) {
    advance_stress<N>(law, in.strain, s0, s1);
    return none;
  }
  if (law.modulus == Modulus::continuum) {
    const T eqps_n = s0[N];
    von_mises::update_by_rate<N>(law, in.strain, s0, s1);
    T s[N], flow, slope;
    von_mises::deviator_of<N>(s1, s);
    law.hardening.evaluate(s1[N], flow, slope);
    T length = larger(square_root(von_mises::contract<N>(s, s)), T(1e-300));
    for (auto& x : s) x = x / length;
    T theta_bar = T(1.0) / (T(1.0) + slope * T(1.0 / (3.0 * law.shear_modulus())));
    theta_bar = select(s1[N] > eqps_n, theta_bar, T(0.0));
    von_mises::elastic_plastic_matrix<N>(law, s, T(1.0), theta_bar, tangent);
    return none;
  }
  using D = Dual<T, N>;
  D strain[N], before[N + 1], after[N + 1];
  for (int i = 0; i < N; ++i) {
    strain[i] = D::variable(in.strain[i], i);
    before[i] = D(s0[i]);
  }
  before[N] = D(s0[N]);
  von_mises::update_by_rate<N>(law, strain, before, after);
  for (int i = 0; i < N; ++i) {
    s1[i] = after[i].value;
    for (int j = 0; j < N; ++j) tangent[i][j] = after[i].slope[j];
  }
  s1[N] = after[N].value;
  return none;
}

}  // namespace presswork
