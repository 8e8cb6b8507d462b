// SPDX-License-Identifier: Apache-2.0
// One layer of a shell at one point of its surface, in one increment.
//
// In: the Green-Lagrange strain E of the increment in the lamina frame at t, which turns with the material. With
// C = 1 + 2E = U^2 the law sees ln U and gives the Cauchy stress s in the turned frame; the stress that does work on E
// per area at t is S = det U U^-1 s U^-1, times the change of thickness, which is that of all layers (shell_pack.hpp).
// Order xx, yy, xy, shear strain engineering. The derivative dS/dE is that of this program, by dual numbers, so it is
// exact. With small displacements E is the strain itself, S the stress, and nothing turns.
#pragma once

#include "element/umat_layer.hpp"
#include "kinematics/increment.hpp"
#include "tensor/dual.hpp"

namespace presswork {

inline constexpr int most_history = most_kept<3>;  // values a layer point may keep behind its stress

template <class T>
struct Layer {
  T state[3 + most_history];  // of the law: Cauchy stress in the lamina frame, equivalent plastic strain, ...
  T direction[2];             // unit vector of the covariant base vector g_1 in the lamina frame
};

template <class T>
struct LayerResponse {
  T force[3];       // S
  T modulus[3][3];  // dS/dE
  T thickness_strain, thickness_slope[3];
};

// Squares of von Mises' stress, of the elastic trial and of the stress itself, with derivatives by E
template <class T>
struct StressSquares {
  Dual<T, 3> trial, found;
};

namespace layer {

template <class V>
V mises_square(const V s[3]) {
  return s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + V(3.0) * s[2] * s[2];
}

template <class V>
struct Stretch {
  V strain[3];    // ln U
  V inverse[3];   // U^-1: 11, 22, 12
  V determinant;  // of U
};

template <class V>
void stretch_from(const V E[3], Stretch<V>& out) {
  V c11 = V(1.0) + V(2.0) * E[0], c22 = V(1.0) + V(2.0) * E[1], c12 = E[2];
  V mean = V(0.5) * (c11 + c22), half = V(0.5) * (c11 - c22), g, g_s;
  divided_atanh(mean, half * half + c12 * c12, g, g_s);
  V excess = V(2.0) * (E[0] + E[1]) + V(4.0) * E[0] * E[1] - c12 * c12;  // det C - 1
  V quarter = V(0.25) * logarithm_one_plus(excess);
  out.strain[0] = quarter + V(0.5) * g * half;
  out.strain[1] = quarter - V(0.5) * g * half;
  out.strain[2] = g * c12;
  // U = (C + det U)/sqrt(tr C + 2 det U)
  out.determinant = square_root(V(1.0) + excess);
  V scale = V(1.0) / (out.determinant * square_root(c11 + c22 + V(2.0) * out.determinant));
  out.inverse[0] = (c22 + out.determinant) * scale;
  out.inverse[1] = (c11 + out.determinant) * scale;
  out.inverse[2] = -c12 * scale;
}

// J U^-1 s U^-1, J = det U
template <class V>
void pull_back(const Stretch<V>& u, const V s[3], V S[3]) {
  const V *w = u.inverse, J = u.determinant;
  V a11 = w[0] * s[0] + w[2] * s[2], a12 = w[0] * s[2] + w[2] * s[1];
  V a21 = w[2] * s[0] + w[1] * s[2], a22 = w[2] * s[2] + w[1] * s[1];
  S[0] = J * (a11 * w[0] + a12 * w[2]);
  S[1] = J * (a21 * w[2] + a22 * w[1]);
  S[2] = J * (a11 * w[2] + a12 * w[1]);
}

// d(thickness strain)/d(strain): the elastic part follows the stress, the plastic part keeps the volume
template <class T>
void thickness_slope(T young, T poisson, const T D[3][3], T slope[3]) {
  for (int j = 0; j < 3; ++j) {
    T across = (T(1.0) - poisson) / young * (D[0][j] + D[1][j]);
    slope[j] = across * (-poisson / (T(1.0) - poisson)) - (T(j < 2 ? 1.0 : 0.0) - across);
  }
}

}  // namespace layer

// Advance a layer by the strain of small displacements; otherwise as respond_layer.
template <class T>
Mask<T> respond_layer_linearly(const LayerLaw& layer_law, double dt, T temperature, const T strain[3],
                               bool with_modulus, const Layer<T>& at, Layer<T>& end, LayerResponse<T>& out,
                               StressSquares<T>* squares = nullptr) {
  using V = Dual<T, 3>;
  const ShellLaw& law = layer_law.law;
  T D[3][3], trial[3], before[3];
  const Elasticity<3, T> moduli = law.elasticity(at.state, temperature, before);
  const T plane = moduli.plane, shear = moduli.shear;
  const T elastic[3][3] = {
      {plane, moduli.poisson * plane, T(0.0)}, {moduli.poisson * plane, plane, T(0.0)}, {T(0.0), T(0.0), shear}};
  for (int i = 0; i < 3; ++i) {
    trial[i] = before[i];
    for (int j = 0; j < 3; ++j) trial[i] += elastic[i][j] * strain[j];
  }
  const LawInput<3, T> in{{strain[0], strain[1], strain[2]}, dt, temperature};
  const Mask<T> failed = layer_law.update(in, at.state, end.state, out.thickness_strain, with_modulus ? D : nullptr);
  for (int i = 0; i < 2; ++i) end.direction[i] = at.direction[i];
  V tried[3], found[3];
  for (int i = 0; i < 3; ++i) {
    out.force[i] = end.state[i];
    tried[i] = V(trial[i]), found[i] = V(end.state[i]);
    for (int j = 0; with_modulus && j < 3; ++j)
      out.modulus[i][j] = found[i].slope[j] = D[i][j], tried[i].slope[j] = elastic[i][j];
  }
  if (squares) squares->trial = layer::mises_square(tried), squares->found = layer::mises_square(found);
  return failed;
}

// Advance a layer by E over dt at a given temperature, from `at` to `end`; gives the lanes in which the law failed.
template <class T>
Mask<T> respond_layer(const LayerLaw& layer_law, double dt, T temperature, const T E[3], bool with_modulus,
                      const Layer<T>& at, Layer<T>& end, LayerResponse<T>& out, StressSquares<T>* squares = nullptr) {
  using V = Dual<T, 3>;
  const ShellLaw& law = layer_law.law;
  T D[3][3], before[3];
  const Elasticity<3, T> moduli = law.elasticity(at.state, temperature, before);
  layer::Stretch<T> u;
  layer::stretch_from(E, u);
  const LawInput<3, T> in{{u.strain[0], u.strain[1], u.strain[2]}, dt, temperature};
  Mask<T> failed = layer_law.update(in, at.state, end.state, out.thickness_strain, with_modulus ? D : nullptr);
  // the frame turns with the material: g_1 goes to U g_1, seen from the turned frame
  T c = at.direction[0], s = at.direction[1];
  T x = u.inverse[1] * c - u.inverse[2] * s, y = u.inverse[0] * s - u.inverse[2] * c;  // U = adj(U^-1) det U
  T length = T(1.0) / square_root(x * x + y * y);
  end.direction[0] = x * length, end.direction[1] = y * length;
  // trial stress: plane stress elasticity from `before`
  auto try_elastic = [&](const auto* strain, auto* trial) {
    using S = std::remove_cvref_t<decltype(*trial)>;
    const S plane(moduli.plane), shear(moduli.shear), poisson(moduli.poisson);
    trial[0] = S(before[0]) + plane * (strain[0] + poisson * strain[1]);
    trial[1] = S(before[1]) + plane * (strain[1] + poisson * strain[0]);
    trial[2] = S(before[2]) + shear * strain[2];
  };
  if (!with_modulus) {
    if (squares) {
      T trial[3];
      try_elastic(u.strain, trial);
      squares->trial = V(layer::mises_square(trial)), squares->found = V(layer::mises_square(end.state));
    }
    layer::pull_back(u, end.state, out.force);
    return failed;
  }
  V E_dual[3], stress[3], S[3];
  for (int i = 0; i < 3; ++i) E_dual[i] = V::variable(E[i], i);
  layer::Stretch<V> v;
  layer::stretch_from(E_dual, v);
  T slope[3];
  layer::thickness_slope(moduli.young, moduli.poisson, D, slope);
  for (int k = 0; k < 3; ++k) {
    out.thickness_slope[k] = T(0.0);
    for (int j = 0; j < 3; ++j) out.thickness_slope[k] += slope[j] * v.strain[j].slope[k];
    for (int i = 0; i < 3; ++i) {
      if (k == 0) stress[i] = V(end.state[i]);
      for (int j = 0; j < 3; ++j) stress[i].slope[k] += D[i][j] * v.strain[j].slope[k];
    }
  }
  if (squares) {
    V trial[3];
    try_elastic(v.strain, trial);
    squares->trial = layer::mises_square(trial), squares->found = layer::mises_square(stress);
  }
  layer::pull_back(v, stress, S);
  for (int i = 0; i < 3; ++i) {
    out.force[i] = S[i].value;
    for (int k = 0; k < 3; ++k) out.modulus[i][k] = S[i].slope[k];
  }
  return failed;
}

}  // namespace presswork
