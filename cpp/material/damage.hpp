// SPDX-License-Identifier: Apache-2.0
// Criteria of ductile fracture: damage per equivalent plastic strain, dD/dp, by the stress and what else counts. They
// do not act back on the stress. With s1 the largest principal stress, q the effective stress, x = mean stress/q:
//
// cockcroft_latham: max(s1, 0)/q (Cockcroft & Latham 1968, normalised by Oh et al. 1979).
//
// rice_tracey: factor exp(exponent x) (Rice & Tracey 1969: 0.283, 3/2).
//
// oyane: max(1 + x/A, 0) (Oyane et al. 1980).
//
// freudenthal: q, the plastic work [MPa] (Freudenthal 1950).
//
// The others have 1/ef, ef the equivalent plastic strain at fracture. With the Lode angle t, 0 to pi/3, by cos(3 t) =
// 27 J3/(2 q^3), y = 1 - 6 t/pi (1 in tension, 0 in shear and plane strain, -1 in compression) and z = pi y/6:
//
// johnson_cook: ef = [d1 + d2 exp(d3 x)] [1 + d4 ln max(r/r0, 1)] [1 + d5 T*], at least 0.001, r the plastic strain
// rate, T* from 0 at `reference` to 1 at `melting` (Johnson & Cook 1985).
//
// modified_mohr_coulomb: ef = {A/c2 [c3 + k (1 - c3) (1/cos z - 1)] [cos z sqrt((1 + c1^2)/3) + c1 (x + sin(z)/3)]}^
// (-1/n), k = sqrt(3)/(2 - sqrt(3)) (Bai & Wierzbicki 2010).
//
// hosford_coulomb: ef = b [(1 + c)/g]^(1/n), g = {sum |si - sj|^a/2}^(1/a) + c (s1 + s3) of stresses over q (Mohr &
// Marcadet 2015).
//
// bai_wierzbicki: ef = (e+ + e- - 2 e0) y^2/2 + (e+ - e-) y/2 + e0 with e+ = d1 exp(-d2 x), e0 = d3 exp(-d4 x), e- = d5
// exp(-d6 x), at least 0.001 (Bai & Wierzbicki 2008).
#pragma once

#include "tensor/choice.hpp"
#include "tensor/pack.hpp"

namespace presswork {

namespace damage {

template <class T>
struct Point {
  T largest, mean, effective;  // stresses [MPa]
  T third;                     // invariant J3 of the deviator [MPa^3]
  T rate, temperature;         // equivalent plastic strain rate [1/s], [degrees C]

  PRESSWORK_DEVICE T triaxiality() const { return mean / larger(effective, T(1e-30)); }
};

// Cosine of a third of the angle whose cosine is c, for -1 <= c <= 1: analytic in the cosine of half of that angle, of
// which it is a polynomial to 5e-14.
template <class T>
PRESSWORK_DEVICE T cosine_of_third(T c) {
  constexpr double coefficients[] = {-2.7342637379964194e-05, 0.00023705090085665394, -0.0009702042986949285,
                                     0.0025313574820756907,   -0.004842062905421093,  0.0074920862289824695,
                                     -0.010206770641373928,   0.013174903098903694,   -0.017026846440214172,
                                     0.022861459122533744,    -0.03292110317283641,   0.053458313723983714,
                                     -0.11111110963160911,    0.5773502691701241,     0.5000000000000426};
  const T half = square_root(larger(T(0.5) + T(0.5) * c, T(0.0)));
  T sum(0.0);
  for (double k : coefficients) sum = sum * half + T(k);
  return sum;
}

// Lode angle t of a stress, from 0 in tension to pi/3 in compression.
template <class T>
struct LodeAngle {
  T cosine, sine;

  // cos(pi/3 - t) is that of the stress turned round: so the sine is as exact as the cosine.
  PRESSWORK_DEVICE explicit LodeAngle(const Point<T>& at) {
    const T size = larger(at.effective, T(1e-30));
    const T of_three = smaller(larger(T(13.5) * at.third / size / size / size, T(-1.0)), T(1.0));
    cosine = cosine_of_third(of_three);
    sine = (cosine_of_third(-of_three) - T(0.5) * cosine) * T(2.0 / root3);
  }

  static constexpr double root3 = 1.7320508075688772;

  // Cosine and sine of pi/6 - t.
  PRESSWORK_DEVICE T cosine_from_shear() const { return T(0.5 * root3) * cosine + T(0.5) * sine; }
  PRESSWORK_DEVICE T sine_from_shear() const { return T(0.5) * cosine - T(0.5 * root3) * sine; }

  // 1 - 6 t/pi; the angle from shear has a sine of 1/2 at most.
  PRESSWORK_DEVICE T parameter() const {
    constexpr double coefficients[] = {0.05951458793553791, -0.013147480190302405, 0.033798759849743024,
                                       0.02409863633078782, 0.03349473179496808,   0.04269701454823558,
                                       0.0580268742568397,  0.0852615266583166,    0.14323944954698173,
                                       0.31830988617948414, 1.9098593171027476};
    const T s = sine_from_shear(), s2 = s * s;
    T sum(0.0);
    for (double k : coefficients) sum = sum * s2 + T(k);
    return sum * s;
  }
};

struct CockcroftLatham {
  static constexpr const char* name = "cockcroft_latham";

  template <class F>
  void fields(F&&) {}
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    return larger(at.largest, T(0.0)) / larger(at.effective, T(1e-30));
  }
};

struct RiceTracey {
  static constexpr const char* name = "rice_tracey";
  double factor, exponent;

  template <class F>
  void fields(F&& f) {
    f("factor", factor), f("exponent", exponent);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    return T(factor) * exponential(T(exponent) * at.triaxiality());
  }
};

struct Oyane {
  static constexpr const char* name = "oyane";
  double A;

  template <class F>
  void fields(F&& f) {
    f("A", A);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    return larger(T(1.0) + at.triaxiality() * T(1.0 / A), T(0.0));
  }
};

struct Freudenthal {
  static constexpr const char* name = "freudenthal";

  template <class F>
  void fields(F&&) {}
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    return at.effective;
  }
};

constexpr double least_strain = 1e-3;  // at fracture

struct JohnsonCook {
  static constexpr const char* name = "johnson_cook";
  double d1, d2, d3, d4, d5, reference_rate, reference, melting;  // -, [1/s], [degrees C]

  template <class F>
  void fields(F&& f) {
    f("d1", d1), f("d2", d2), f("d3", d3), f("d4", d4), f("d5", d5);
    f("reference_rate", reference_rate), f("reference", reference), f("melting", melting);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    T strain = T(d1) + T(d2) * exponential(T(d3) * at.triaxiality());
    strain = strain * (T(1.0) + T(d4) * logarithm(larger(at.rate * T(1.0 / reference_rate), T(1.0))));
    T share = (at.temperature - T(reference)) * T(1.0 / (melting - reference));
    strain = strain * (T(1.0) + T(d5) * smaller(larger(share, T(0.0)), T(1.0)));
    return T(1.0) / larger(strain, T(least_strain));
  }
};

struct ModifiedMohrCoulomb {
  static constexpr const char* name = "modified_mohr_coulomb";
  double A, n, c1, c2, c3;  // [MPa], -, -, [MPa], -

  template <class F>
  void fields(F&& f) {
    f("A", A), f("n", n), f("c1", c1), f("c2", c2), f("c3", c3);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    constexpr double root3 = LodeAngle<T>::root3;
    const LodeAngle<T> angle(at);
    const T cosine = angle.cosine_from_shear(), sine = angle.sine_from_shear();
    const T shape = T(c3) + T(root3 / (2.0 - root3) * (1.0 - c3)) * (T(1.0) / cosine - T(1.0));
    const T strength = cosine * T(std::sqrt((1.0 + c1 * c1) / 3.0)) + T(c1) * (at.triaxiality() + sine * T(1.0 / 3.0));
    return power(larger(T(A / c2) * shape * strength, T(1e-30)), 1.0 / n);
  }
};

struct HosfordCoulomb {
  static constexpr const char* name = "hosford_coulomb";
  double a, b, c, n;

  template <class F>
  void fields(F&& f) {
    f("a", a), f("b", b), f("c", c), f("n", n);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    const LodeAngle<T> angle(at);
    // differences and sum of the principal stresses over the effective stress
    const T spread = T(1.0 / LodeAngle<T>::root3) * angle.sine;
    const T upper = angle.cosine - spread, lower = T(2.0) * spread;
    const auto raised = [&](T of) { return power(larger(of, T(1e-30)), a); };
    const T norm = power(T(0.5) * (raised(upper) + raised(lower) + raised(upper + lower)), 1.0 / a);
    const T ends = T(2.0) * at.triaxiality() + T(1.0 / 3.0) * angle.cosine - spread;
    return power(larger((norm + T(c) * ends) * T(1.0 / (1.0 + c)), T(1e-30)), 1.0 / n) * T(1.0 / b);
  }
};

struct BaiWierzbicki {
  static constexpr const char* name = "bai_wierzbicki";
  double d1, d2, d3, d4, d5, d6;

  template <class F>
  void fields(F&& f) {
    f("d1", d1), f("d2", d2), f("d3", d3), f("d4", d4), f("d5", d5), f("d6", d6);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    const T x = at.triaxiality(), y = LodeAngle<T>(at).parameter();
    const T pulled = T(d1) * exponential(T(-d2) * x), sheared = T(d3) * exponential(T(-d4) * x);
    const T pressed = T(d5) * exponential(T(-d6) * x);
    const T strain = (T(0.5) * (pulled + pressed) - sheared) * y * y + T(0.5) * (pulled - pressed) * y + sheared;
    return T(1.0) / larger(strain, T(least_strain));
  }
};

// Stresses of a tensor: 3 components xx, yy, xy of plane stress, 4 xx, yy, zz, xy, 6 also yz, zx.
template <int N, class T>
PRESSWORK_DEVICE Point<T> measure_stress(const T* s) {
  Point<T> at;
  at.rate = at.temperature = T(0.0);
  const T xy = N == 3 ? s[2] : s[3], zz = N == 3 ? T(0.0) : s[2];
  at.mean = (s[0] + s[1] + zz) * T(1.0 / 3.0);
  const T x = s[0] - at.mean, y = s[1] - at.mean, z = zz - at.mean;
  T second = T(0.5) * (x * x + y * y + z * z) + xy * xy;
  if constexpr (N == 6) second += s[4] * s[4] + s[5] * s[5];
  at.effective = square_root(T(3.0) * second);
  if constexpr (N == 6)
    at.third = x * (y * z - s[4] * s[4]) - xy * (xy * z - s[4] * s[5]) + s[5] * (xy * s[4] - y * s[5]);
  else
    at.third = z * (x * y - xy * xy);
  if constexpr (N == 6) {  // s1 = mean + 2 q/3 cos(angle/3), cos(angle) = 27 J3/(2 q^3)
    const T size = larger(at.effective, T(1e-30));
    const T cosine = smaller(larger(T(13.5) * at.third / size / size / size, T(-1.0)), T(1.0));
    at.largest = at.mean + T(2.0 / 3.0) * at.effective * cosine_of_third(cosine);
  } else {
    const T half = T(0.5) * (s[0] - s[1]);
    at.largest = larger(T(0.5) * (s[0] + s[1]) + square_root(half * half + xy * xy), zz);
  }
  return at;
}

}  // namespace damage

struct Damage {
  using Law =
      std::variant<damage::CockcroftLatham, damage::RiceTracey, damage::Oyane, damage::Freudenthal, damage::JohnsonCook,
                   damage::ModifiedMohrCoulomb, damage::HosfordCoulomb, damage::BaiWierzbicki>;
  Law law;

  template <class T>
  PRESSWORK_DEVICE T per_strain(const damage::Point<T>& at) const {
    return choose(law, [&](const auto& chosen) { return chosen.per_strain(at); });
  }
};

// Which of Damage::Law; its values are named in the bindings, from the structs.
enum class DamageCriterion : int {};

}  // namespace presswork
