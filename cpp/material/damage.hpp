// SPDX-License-Identifier: Apache-2.0
// Criteria of ductile fracture: damage per equivalent plastic strain, dD/dp, by the stress and what else counts. They
// do not act back on the stress. With s1 the largest principal stress, q the effective stress, x = mean stress/q:
//
//   cockcroft_latham  max(s1, 0)/q                                   (Cockcroft & Latham 1968, normalised: Oh et al.
//   1979) rice_tracey       factor exp(exponent x)                         (Rice & Tracey 1969: 0.283, 3/2) oyane max(1
//   + x/A, 0)                                (Oyane et al. 1980) freudenthal       q, the plastic work [MPa]
//   (Freudenthal 1950) johnson_cook      1/ef, ef = [d1 + d2 exp(d3 min(x, 3/2))] [1 + d4 ln max(r/r0, 1)] [1 + d5 T*],
//   at least 0.001, r the
//                     plastic strain rate, T* from 0 at `reference` to 1 at `melting`  (Johnson & Cook 1985)
#pragma once

#include "tensor/choice.hpp"
#include "tensor/pack.hpp"

namespace presswork {

namespace damage {

template <class T>
struct Point {
  T largest, mean, effective;  // stresses [MPa]
  T rate, temperature;         // equivalent plastic strain rate [1/s], [degrees C]

  PRESSWORK_DEVICE T triaxiality() const { return mean / larger(effective, T(1e-30)); }
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

struct JohnsonCook {
  static constexpr const char* name = "johnson_cook";
  double d1, d2, d3, d4, d5, reference_rate, reference, melting;  // -, [1/s], [degrees C]
  static constexpr double least = 1e-3, highest = 1.5;

  template <class F>
  void fields(F&& f) {
    f("d1", d1), f("d2", d2), f("d3", d3), f("d4", d4), f("d5", d5);
    f("reference_rate", reference_rate), f("reference", reference), f("melting", melting);
  }
  template <class T>
  PRESSWORK_DEVICE T per_strain(const Point<T>& at) const {
    T strain = T(d1) + T(d2) * exponential(T(d3) * smaller(at.triaxiality(), T(highest)));
    strain = strain * (T(1.0) + T(d4) * logarithm(larger(at.rate * T(1.0 / reference_rate), T(1.0))));
    T share = (at.temperature - T(reference)) * T(1.0 / (melting - reference));
    strain = strain * (T(1.0) + T(d5) * smaller(larger(share, T(0.0)), T(1.0)));
    return T(1.0) / larger(strain, T(least));
  }
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
  if constexpr (N == 6) {  // s1 = mean + 2 q/3 cos(angle/3), cos(angle) = 27 det/(2 q^3)
    const T det = x * (y * z - s[4] * s[4]) - xy * (xy * z - s[4] * s[5]) + s[5] * (xy * s[4] - y * s[5]);
    const T size = larger(at.effective, T(1e-30));
    const T cosine = smaller(larger(T(13.5) * det / size / size / size, T(-1.0)), T(1.0));
    at.largest = at.mean + T(2.0 / 3.0) * at.effective * cosine_of_third(cosine);
  } else {
    const T half = T(0.5) * (s[0] - s[1]);
    at.largest = larger(T(0.5) * (s[0] + s[1]) + square_root(half * half + xy * xy), zz);
  }
  return at;
}

}  // namespace damage

struct Damage {
  using Law = std::variant<damage::CockcroftLatham, damage::RiceTracey, damage::Oyane, damage::Freudenthal,
                           damage::JohnsonCook>;
  Law law;

  template <class T>
  PRESSWORK_DEVICE T per_strain(const damage::Point<T>& at) const {
    return choose(law, [&](const auto& chosen) { return chosen.per_strain(at); });
  }
};

// Which of Damage::Law; its values are named in the bindings, from the structs.
enum class DamageCriterion : int {};

}  // namespace presswork
