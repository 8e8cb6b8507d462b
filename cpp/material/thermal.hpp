// SPDX-License-Identifier: Apache-2.0
// Temperature [degrees C]: softening of the flow stress, and adiabatic heating by plastic work.
//
//   softening   flow stress times 1 - T*^m, T* = (T - reference)/(melting - reference) between 0 and 1; 1 without a
//               melting temperature                                                          (Johnson & Cook 1983)
//   heating     dT = k q dp, k = fraction of plastic work turned to heat / (density heat capacity), q the flow stress;
//               no conduction                                                                (Taylor & Quinney 1934)
#pragma once

#include "tensor/dual.hpp"
#include "tensor/pack.hpp"

namespace presswork {

struct Softening {
  double reference = 0.0, melting = 0.0, exponent = 1.0;  // [degrees C]; no softening unless melting > reference

  template <class T>
  struct Point {
    T share = T(0.0), loss = T(0.0);    // T*, T*^m
    T factor = T(1.0), slope = T(0.0);  // and d factor/dT
  };

  PRESSWORK_DEVICE bool active() const { return melting > reference; }
  template <class T>
  PRESSWORK_DEVICE Point<T> at(T temperature) const {
    Point<T> point;
    if (!active()) return point;
    point.share = share_at(temperature);
    finish(power(point.share, exponent), point);
    return point;
  }
  // The same at a temperature that may be near that of another point: by the binomial series about it.
  template <class T>
  PRESSWORK_DEVICE Point<T> near(const Point<T>& other, T temperature) const {
    if (!active()) return other;
    Point<T> point;
    point.share = share_at(temperature);
    const T x = point.share / other.share - T(1.0);
    T sum(1.0);
    for (int k = 5; k > 0; --k) sum = T(1.0) + T((exponent - (k - 1)) / k) * x * sum;
    const auto far = either(x > T(2e-3), x < T(-2e-3));
    const T loss = other.loss * sum;
    finish(any(far) ? select(far, power(point.share, exponent), loss) : loss, point);
    return point;
  }

 private:
  template <class T>
  PRESSWORK_DEVICE T share_at(T temperature) const {
    const T share = (temperature - T(reference)) * T(1.0 / (melting - reference));
    return smaller(larger(share, T(1e-12)), T(1.0));  // an exponent below 1 has no slope at 0
  }
  template <class T>
  PRESSWORK_DEVICE void finish(T loss, Point<T>& point) const {
    point.loss = loss;
    point.factor = T(1.0) - loss;
    point.slope = T(-exponent / (melting - reference)) * loss / point.share;
  }
};

struct Thermal {
  Softening softening;
  double start = 0.0;    // temperature of a point that nobody gives one [degrees C]
  double heating = 0.0;  // k above [degree/MPa]

  PRESSWORK_DEVICE bool heats() const { return heating > 0.0; }
};

}  // namespace presswork
