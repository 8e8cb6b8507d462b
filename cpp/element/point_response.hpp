// SPDX-License-Identifier: Apache-2.0
// One integration point in one increment: Cauchy stress and spatial tangent modulus from the deformation gradient.
//
// The residual is int sigma_ij d(delta u_i)/dx_j dv over the configuration at t+dt (virtual work, thesis eq. 7). Its
// derivative along a velocity gradient l is int grad(delta u) : a : l dv with
//     a : l = d sigma + sigma tr l - sigma l^T                    (hoop: d sigma_33 + sigma_33 tr l - sigma_33 l_33)
// Gradient order 11, 12, 21, 22, 33. `consistent` takes d sigma from the update as computed, rotation included.
// `thesis` adds the parts of thesis eq. 14, each switchable; with all four and the consistent D the two agree as dt ->
// 0:
//     K_o: D : sym l      K_e: -(sigma d + d sigma)      K_u: l sigma      K_v: sigma tr l
// With small displacements the strain is sym(F - 1), nothing turns, and a = D.
//
// The law is called in axes that turn with the material (law.hpp). Von Mises's closed form asks for no axes of its own:
// it works in those of t. Others keep the direction of their x beside their state, and stress and strain are turned to
// it and back; so their back stresses are never turned, and an anisotropic law knows its rolling direction.
#pragma once

#include "kinematics/increment.hpp"
#include "material/elastic_plastic.hpp"
#include "material/umat.hpp"
#include "material/von_mises.hpp"

namespace presswork {

enum class TangentKind : int { none = 0, consistent = 1, thesis = 2 };

struct PointSettings {
  StrainMeasure measure = StrainMeasure::log;
  TangentKind tangent = TangentKind::consistent;
  bool green_lagrange_matrix = false;  // K_o on B0 + B_L
  bool k_e = true, k_u = true, k_v = false;
  bool small_displacements = false;  // points are undeformed, strain and equilibrium linear in the displacement
};

template <class T>
struct PointResponse {
  T stress[4];
  T modulus[5][5];
};

namespace point {

// a(4 in-plane components as a 2x2 matrix X) -> R X R^T
template <class T>
void turn_gradient(T c, T s, T& x11, T& x12, T& x21, T& x22) {
  T y11 = c * x11 - s * x21, y12 = c * x12 - s * x22, y21 = s * x11 + c * x21, y22 = s * x12 + c * x22;
  x11 = c * y11 - s * y12;
  x12 = s * y11 + c * y12;
  x21 = c * y21 - s * y22;
  x22 = s * y21 + c * y22;
}

// the part of a that is the same for every law: sigma tr l - sigma l^T
template <class T>
void add_geometric(const T s[4], T a[5][5]) {
  const T rows[5] = {s[0], s[3], s[3], s[1], s[2]};
  for (int r = 0; r < 5; ++r)
    for (int c : {0, 3, 4}) a[r][c] += rows[r];
  a[0][0] -= s[0], a[0][1] -= s[3];
  a[1][2] -= s[0], a[1][3] -= s[3];
  a[2][0] -= s[3], a[2][1] -= s[1];
  a[3][2] -= s[3], a[3][3] -= s[1];
  a[4][4] -= s[2];
}

// sym(F - 1): xx, yy, zz, xy (engineering)
template <class T>
void small_strain(const T F[5], T strain[4]) {
  strain[0] = F[0] - T(1.0), strain[1] = F[3] - T(1.0), strain[2] = F[4] - T(1.0), strain[3] = F[1] + F[2];
}

template <class T>
void small_modulus(const T D[4][4], T a[5][5]) {
  constexpr int strain_of[5] = {0, 3, 3, 1, 2};
  for (int r = 0; r < 5; ++r)
    for (int k = 0; k < 5; ++k) a[r][k] = D[strain_of[r]][strain_of[k]];
}

template <class T>
void consistent_modulus(const Increment<T>& inc, const T D[4][4], const T s[4], T a[5][5]) {
  const T turned[4] = {T(-2.0) * s[3], T(2.0) * s[3], T(0.0), s[0] - s[1]};  // J s - s J
  for (int k = 0; k < 5; ++k) {
    T ds[4];
    for (int i = 0; i < 4; ++i) {
      ds[i] = turned[i] * inc.dtheta[k];
      for (int j = 0; j < 4; ++j) ds[i] += D[i][j] * inc.dstrain[j][k];
    }
    a[0][k] = ds[0], a[1][k] = ds[3], a[2][k] = ds[3], a[3][k] = ds[1], a[4][k] = ds[2];
  }
  add_geometric(s, a);
}

template <class T>
void thesis_modulus(const PointSettings& settings, const T F[5], const Increment<T>& inc, const T D[4][4], const T s[4],
                    T a[5][5]) {
  // strain along l*: M = sym, or U sym U for the Green-Lagrange matrix (then over the volume at t: 1/J)
  T M[4][5];
  for (auto& row : M)
    for (auto& x : row) x = T(0.0);
  T weight(1.0);
  if (settings.green_lagrange_matrix) {
    T c = inc.cosine, n = inc.sine;
    T u11 = c * F[0] + n * F[2], u12 = c * F[1] + n * F[3], u22 = c * F[3] - n * F[1];
    M[0][0] = u11 * u11, M[0][1] = M[0][2] = u11 * u12, M[0][3] = u12 * u12;
    M[1][0] = u12 * u12, M[1][1] = M[1][2] = u12 * u22, M[1][3] = u22 * u22;
    M[3][0] = T(2.0) * u11 * u12, M[3][1] = M[3][2] = u11 * u22 + u12 * u12, M[3][3] = T(2.0) * u12 * u22;
    M[2][4] = F[4] * F[4];
    weight = T(1.0) / inc.jacobian;
  } else {
    M[0][0] = M[1][3] = M[2][4] = M[3][1] = M[3][2] = T(1.0);
  }
  for (int r = 0; r < 5; ++r)
    for (int k = 0; k < 5; ++k) {
      T sum(0.0);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum += M[i][r] * D[i][j] * M[j][k];
      a[r][k] = weight * sum;
    }
  const int at[2][2] = {{0, 1}, {2, 3}};
  const T S[2][2] = {{s[0], s[3]}, {s[3], s[1]}};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        if (settings.k_u) a[at[i][j]][at[i][k]] += S[k][j];
        if (settings.k_e) {  // -(s_ik d_kj + d_ik s_kj), d = sym l
          a[at[i][j]][at[k][j]] -= T(0.5) * S[i][k], a[at[i][j]][at[j][k]] -= T(0.5) * S[i][k];
          a[at[i][j]][at[i][k]] -= T(0.5) * S[k][j], a[at[i][j]][at[k][i]] -= T(0.5) * S[k][j];
        }
      }
  if (settings.k_u) a[4][4] += s[2];
  if (settings.k_e) a[4][4] -= T(2.0) * s[2];
  if (settings.k_v) {
    const T rows[5] = {s[0], s[3], s[3], s[1], s[2]};
    for (int r = 0; r < 5; ++r)
      for (int c : {0, 3, 4}) a[r][c] += rows[r];
  }
}

}  // namespace point

// Values of a point in N components: stress in the axes of space and equivalent plastic strain, then what its law
// keeps, the directions of the law's axes at the end: x in the plane (2), x and y in space (6).
template <int N>
inline constexpr int axes_values = N == 6 ? 6 : 2;
template <int N>
inline constexpr int most_point_values = N + most_kept<N> + axes_values<N>;

// How many a law keeps behind the equivalent plastic strain.
PRESSWORK_DEVICE inline int kept_values(const VonMises&) { return 0; }
template <int N>
PRESSWORK_DEVICE int kept_values(const ElasticPlastic<N>& law) {
  return law.history_size() - 1 + axes_values<N>;
}

// Temperature of a point that nobody gives one, and the whole of it at the start of an increment: what is given, and
// the rise that the law makes itself.
PRESSWORK_DEVICE inline double start_temperature(const VonMises&) { return 0.0; }
inline double start_temperature(const Umat&) { return 0.0; }
template <int N>
PRESSWORK_DEVICE double start_temperature(const ElasticPlastic<N>& law) {
  return law.flow.thermal.start;
}
template <class T>
PRESSWORK_DEVICE T point_temperature(const VonMises&, T given, const T*) {
  return given;
}
template <class T, int N>
PRESSWORK_DEVICE T point_temperature(const ElasticPlastic<N>& law, T given, const T* s0) {
  return law.flow.thermal.heats() ? given + s0[N + 1] : given;
}

namespace point {

template <class T>
Mask<T> call_law(const VonMises& law, const LawInput<4, T>& in, const T* s0, T* s1, T (*D)[4]) {
  return update(law, in, s0, s1, D);
}

// In the law's own axes, x along (c, s).
template <class T>
Mask<T> call_law(const PlaneLaw& law, const LawInput<4, T>& in, const T* s0, T* s1, T (*D)[4]) {
  const int size = law.state_size();
  const T c = s0[size], s = s0[size + 1];
  LawInput<4, T> own = in;
  T before[most_point_values<4>], tangent[4][4];
  turn_strain(c, -s, in.strain, own.strain);
  turn_stress(c, -s, s0, before);
  for (int i = 4; i < size; ++i) before[i] = s0[i];
  const Mask<T> failed = update(law, own, before, s1, D ? tangent : nullptr);
  const T stress[4] = {s1[0], s1[1], s1[2], s1[3]};
  turn_stress(c, s, stress, s1);
  if (D) turn_tangent(c, s, tangent, D);
  return failed;
}

// The law's x turns with the material.
template <class T>
void turn_axes(const VonMises&, T, T, const T*, T*) {}
template <class T>
void turn_axes(const PlaneLaw& law, T c, T s, const T* s0, T* s1) {
  const int at = law.state_size();
  const T x = s0[at], y = s0[at + 1];
  s1[at] = c * x - s * y, s1[at + 1] = s * x + c * y;
}

}  // namespace point

// Advance a point by F over the time dt, at a temperature and mixture given from outside, and, unless settings.tangent
// is none, give its spatial modulus. F must have a positive determinant; s0 goes to s1, the stress turned with the
// material. Gives the lanes in which the law failed.
template <class T, class Law>
Mask<T> respond(const PointSettings& settings, const Law& law, const T F[5], double dt, T temperature, const T* s0,
                T* s1, PointResponse<T>& response, const T* mixture = nullptr) {
  const bool with_tangent = settings.tangent != TangentKind::none;
  T D[4][4];
  LawInput<4, T> in;
  in.dt = dt, in.temperature = temperature, in.mixture = mixture;
  if (settings.small_displacements) {
    point::small_strain(F, in.strain);
    const Mask<T> failed = point::call_law(law, in, s0, s1, with_tangent ? D : nullptr);
    point::turn_axes(law, T(1.0), T(0.0), s0, s1);
    for (int i = 0; i < 4; ++i) response.stress[i] = s1[i];
    if (with_tangent) point::small_modulus(D, response.modulus);
    return failed;
  }
  Increment<T> inc;
  measure_increment(F, settings.measure, with_tangent, inc);
  for (int i = 0; i < 4; ++i) in.strain[i] = inc.strain[i];
  const Mask<T> failed = point::call_law(law, in, s0, s1, with_tangent ? D : nullptr);
  const T unturned[4] = {s1[0], s1[1], s1[2], s1[3]};
  turn_stress(inc.cosine, inc.sine, unturned, s1);
  point::turn_axes(law, inc.cosine, inc.sine, s0, s1);
  for (int i = 0; i < 4; ++i) response.stress[i] = s1[i];
  if (!with_tangent) return failed;

  auto& a = response.modulus;
  if (settings.tangent == TangentKind::consistent)
    point::consistent_modulus(inc, D, unturned, a);
  else
    point::thesis_modulus(settings, F, inc, D, unturned, a);
  for (auto& row : a) point::turn_gradient(inc.cosine, inc.sine, row[0], row[1], row[2], row[3]);
  for (int k = 0; k < 5; ++k) point::turn_gradient(inc.cosine, inc.sine, a[0][k], a[1][k], a[2][k], a[3][k]);
  return failed;
}

}  // namespace presswork
