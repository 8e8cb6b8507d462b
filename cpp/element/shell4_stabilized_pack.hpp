// SPDX-License-Identifier: Apache-2.0
// One-point 4-node shell with physical stabilisation in an increment of any size: the implicit form of
// shell4_stabilized.hpp.
//
// The strains are the same (shell4_forms.hpp), taken as the exact change from t to t+dt with the nodes' own directors;
// layers and transverse shear at the centre are those of the other shells (shell_pack.hpp). The hourglass forces are
// contravariant, so that they turn with the material by themselves; they grow with the moduli at t, and where the
// layers flow they are reduced as the layers' trial stress is. The tangent is the complete derivative: rows of the
// strains' derivatives are forces of unit resultants, and since strains are bilinear, their second derivatives are the
// forces on unit configurations.
#pragma once

#include "element/shell4_forms.hpp"
#include "element/shell_pack.hpp"

namespace presswork {

template <class T>
struct StabilizedPack : ShellPack<Quad4, 1, Tying::mitc, T> {
  using Base = ShellPack<Quad4, 1, Tying::mitc, T>;
  using Kernel = typename Base::Kernel;
  using Base::Base, Base::end_d, Base::end_x, Base::find, Base::load, Base::mid_d, Base::mid_x, Base::n, Base::save,
      Base::table, Base::undeformed, Base::view;
  static constexpr int freedoms = 24, internal_values = 8;  // hourglass forces; energy stored, lost
  static constexpr int n_forms = 17;                        // order of shell4::Forms
  static constexpr double taken[3] = {1.0, 1.0, square_share};

  shell4::Patterns<T> mid, end, change;
  T skew[2];

  static T& form(shell4::Forms<T>& f, int i) { return reinterpret_cast<T*>(&f)[i]; }

  ShellFailure evaluate() {
    // 1. directors, configurations half-way and at the end
    T step[4][3], turn[4][3], turned(0.0);
    for (int a = 0; a < 4; ++a) {
      this->turn(a);
      turned = larger(turned, n.turn[a].s);
      this->place(a);
      for (int i = 0; i < 3; ++i) step[a][i] = n.u[a][i], turn[a][i] = n.turn[a].change[i];
    }
    if (auto bad = find(!(turned < T(largest_turn_squared)), ShellFault::turned_too_far); bad.cell >= 0) return bad;
    shell4::to_patterns(mid_x, mid_d, mid);
    shell4::to_patterns(end_x, end_d, end);
    shell4::to_patterns(step, turn, change);

    // 2. strains, layers, transverse shear
    typename Kernel::Surface surface;
    typename Kernel::Strain strain;
    typename Kernel::Resultants sum;
    T a[2][3], b[2][3], shear[2], D[2][2];
    auto folded =
        Kernel::measure_surface(this->forms, 0, n, surface) | Kernel::base_vectors(table, 0, end_x, end_d, a, b);
    if (auto bad = find(folded, ShellFault::inside_out); bad.cell >= 0) return bad;
    shell4::Patterns<T> start;
    shell4::to_patterns(undeformed, start.g[0], start.g[1], start.h);
    const T g11 = dot3(start.g[0], start.g[0]), g22 = dot3(start.g[1], start.g[1]), g12 = dot3(start.g[0], start.g[1]);
    const T over = T(1.0) / (g11 * g22 - g12 * g12);
    const T along[2] = {dot3(start.h, start.g[0]), dot3(start.h, start.g[1])};
    skew[0] = (g22 * along[0] - g12 * along[1]) * over;
    skew[1] = (g11 * along[1] - g12 * along[0]) * over;
    shell4::Forms<T> e;
    shell4::measure<true>(skew, mid, change, e);
    for (int c = 0; c < 3; ++c)
      strain.E[0][c] = e.membrane[c], strain.E[1][c] = e.bending[c], strain.E[2][c] = T(square_share) * e.second[c];
    Base::clear(sum);
    Retained<T> retained;
    if (auto bad = this->run_layers(0, surface, strain, view.stiffness != nullptr, sum, &retained); bad.cell >= 0)
      return bad;
    this->run_shear(0, surface, e.shear, view.penalty, shear, D);

    // 3. hourglass forces, and the derivatives of all resultants
    shell4::Forms<T> r;
    T C[n_forms][n_forms];
    for (auto& row : C)
      for (auto& c : row) c = T(0.0);
    for (int p = 0; p < 3; ++p)
      for (int c = 0; c < 3; ++c) {
        form(r, 3 * p + c) = T(taken[p]) * sum.S[p][c];
        if (view.stiffness)
          for (int o = 0; o < 3; ++o)
            for (int j = 0; j < 3; ++j)
              C[3 * p + c][3 * o + j] =
                  T(taken[p] * taken[o]) * (sum.C[p + o][c][j] + sum.S[p][c] * sum.thickness[o][j]);
      }
    for (int k = 0; k < 2; ++k) {
      r.shear[k] = shear[k];
      for (int j = 0; j < 2; ++j) C[9 + k][9 + j] = D[k][j];
    }
    run_hourglass(surface, e, retained, r, C);

    // 4. to the nodes
    T force[freedoms], matrix[freedoms][freedoms];
    T(*K)[freedoms] = view.stiffness ? matrix : nullptr;
    to_nodes(end, r, force);
    if (K) differentiate(r, C, K);
    Kernel::take_rotations(n, force, K, view.small);
    this->write(force, K);
    return {};
  }

  void run_hourglass(const typename Kernel::Surface& surface, const shell4::Forms<T>& e, const Retained<T>& retained,
                     shell4::Forms<T>& r, T (*C)[n_forms]) const {
    T h, Q[internal_values], k[6], kept[2], slope[2][3][3];
    load(view.thickness_n, 1, 0, 1, &h);
    load(view.internal_n, 1, 0, internal_values, Q);
    const T squares[2] = {surface.a[0][0], surface.a[0][1]};
    const double shear_modulus = shear_factor * 0.5 / (1.0 + this->law.poisson) * this->law.young;
    shell4::hourglass_stiffness(T(this->law.young), T(shear_modulus), T(4.0) * surface.area, h, squares, k);
    for (int m = 0; m < 2; ++m) kept[m] = retained.evaluate(m, slope[m]);
    const T stored = Q[6];
    T work(0.0);
    Q[6] = T(0.0);
    for (int i = 0; i < 6; ++i) {
      const bool in_plane = i < 4;
      T trial = Q[i] + k[i] * e.hourglass[i], scale = in_plane ? kept[i / 2] : T(1.0);
      work += T(0.5) * (Q[i] + scale * trial) * e.hourglass[i];
      r.hourglass[i] = Q[i] = scale * trial;
      Q[6] += T(0.5) * Q[i] * Q[i] / k[i];
      C[11 + i][11 + i] = scale * k[i] * T(in_plane ? 1.0 : 1.0 + view.penalty);
      if (in_plane)
        for (int p = 0; p < 3; ++p)
          for (int c = 0; c < 3; ++c) C[11 + i][3 * p + c] = T(taken[p]) * trial * slope[i / 2][p][c];
    }
    Q[7] += work - (Q[6] - stored);
    save(Q, 1, 0, internal_values, view.internal);
  }

  // Forces by positions and directors, row = 6 node + (x | d) component
  void to_nodes(const shell4::Patterns<T>& at, const shell4::Forms<T>& r, T force[freedoms]) const {
    shell4::Patterns<T> f;
    const T none[3] = {T(0.0), T(0.0), T(0.0)};
    T x[4][3], d[4][3];
    shell4::spread<true>(skew, at, r, f);
    shell4::from_patterns(none, f.g[0], f.g[1], f.h, x);
    shell4::from_patterns(f.d0, f.d[0], f.d[1], f.e, d);
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) force[6 * a + i] = x[a][i], force[6 * a + 3 + i] = d[a][i];
  }

  void differentiate(const shell4::Forms<T>& r, const T (*C)[n_forms], T (*K)[freedoms]) const {
    // 1. law: derivatives of the strains are forces of unit resultants
    T B[n_forms][freedoms];
    shell4::Forms<T> unit;
    for (int i = 0; i < n_forms; ++i) form(unit, i) = T(0.0);
    for (int i = 0; i < n_forms; ++i) {
      form(unit, i) = T(1.0);
      to_nodes(end, unit, B[i]);
      form(unit, i) = T(0.0);
    }
    for (auto* row = K; row != K + freedoms; ++row)
      for (auto& k : *row) k = T(0.0);
    for (int i = 0; i < n_forms; ++i) {
      T CB[freedoms];
      for (int j = 0; j < freedoms; ++j) {
        CB[j] = T(0.0);
        for (int m = 0; m < n_forms; ++m) CB[j] += C[i][m] * B[m][j];
      }
      for (int p = 0; p < freedoms; ++p)
        for (int j = 0; j < freedoms; ++j) K[p][j] += B[i][p] * CB[j];
    }
    if (view.small) return;
    // 2. stress on second derivatives: forces on unit configurations, the same for each direction in space
    for (int b = 0; b < 4; ++b)
      for (int of_director = 0; of_director < 2; ++of_director) {
        T x[4][3], d[4][3], column[freedoms];
        for (int a = 0; a < 4; ++a)
          for (int i = 0; i < 3; ++i) x[a][i] = d[a][i] = T(0.0);
        (of_director ? d : x)[b][0] = T(1.0);
        shell4::Patterns<T> at;
        shell4::to_patterns(x, d, at);
        to_nodes(at, r, column);
        for (int a = 0; a < 4; ++a)
          for (int half = 0; half < 2; ++half)
            for (int i = 0; i < 3; ++i)
              K[6 * a + 3 * half + i][6 * b + 3 * of_director + i] += column[6 * a + 3 * half];
      }
  }

  static ShellFailure evaluate_pack(const ShellView& view, const ShellLaw& law, int pack) {
    return StabilizedPack(view, law, pack).evaluate();
  }
};

}  // namespace presswork
