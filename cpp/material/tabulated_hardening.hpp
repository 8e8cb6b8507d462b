// SPDX-License-Identifier: Apache-2.0
// A hardening curve from a table, for the explicit loop: no logarithm, no power.
//
// The hardening curve is kept as cubics (Hermite) on intervals whose width grows with p: the interval's number is read
// from the exponent and the first bits of the mantissa of p + shift. The table is refined until it follows the law
// within table_tolerance of the flow stress, and goes on straight beyond p = largest_strain.
#pragma once

#include <bit>
#include <cstdint>

#include "material/hardening.hpp"
#include "tensor/records.hpp"

namespace presswork {

class TabulatedHardening {
 public:
  static constexpr double table_tolerance = 1e-8;  // of the flow stress
  static constexpr double largest_strain = 8.0;

  TabulatedHardening() = default;
  explicit TabulatedHardening(const Hardening& law) {
    refine(law);
    float_rows_.assign(rows_.begin(), rows_.end());
  }
  double error() const { return error_; }  // largest deviation from the law, of the flow stress
  std::size_t rows() const { return rows_.size() / 4; }

  // Cubic c[0..3] in the distance from `left`, the interval's lower end (on the axis of p + shift).
  template <class T>
  struct Piece {
    T c[4], left, width;
    T value(T x) const {
      T t = x - left;
      return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    }
    T slope(T x) const {
      T t = x - left;
      return c[1] + t * (T(2.0) * c[2] + T(3.0) * t * c[3]);
    }
  };
  double shift() const { return shift_; }
  // Flow stress and slope at equivalent plastic strain p.
  template <class Real>
  void evaluate(PackOf<Real> p, PackOf<Real>& flow, PackOf<Real>& slope) const {
    const PackOf<Real> x = larger(p, PackOf<Real>(Real(0))) + PackOf<Real>(static_cast<Real>(shift_));
    Piece<PackOf<Real>> piece;
    find(x, piece);
    flow = piece.value(x);
    slope = piece.slope(x);
  }
  template <class T>
  void find(T x, Piece<T>& piece) const {
    const std::int64_t row = row_of(value_of(x));
    for (int i = 0; i < 4; ++i) piece.c[i] = rows_[4 * row + i];
    piece.left = left_of(row);
    piece.width = left_of(row + 1) - left_of(row);
  }
  template <class Real>
  void find(PackOf<Real> x, Piece<PackOf<Real>>& piece) const {
    using P = PackOf<Real>;
    using Integer = typename P::Integer;
    const int shift = (sizeof(Real) == 8 ? 52 : 23) - bits_;
    const auto first = static_cast<Integer>(std::bit_cast<Integer>(static_cast<Real>(shift_)) >> shift);
    typename P::Mask row = (std::bit_cast<typename P::Mask>(x.v) >> shift) - first;
    const typename P::Mask last = typename P::Mask{} + static_cast<Integer>(last_);
    row = row < last ? row : last;
    const Real* from[P::width];
    for (int lane = 0; lane < P::width; ++lane) from[lane] = cubics<Real>().data() + 4 * row[lane];
    load_records<4>(from, piece.c);
    piece.left = P(std::bit_cast<typename P::Vector>((row + first) << shift));
    piece.width = P(std::bit_cast<typename P::Vector>((row + first + 1) << shift)) - piece.left;
  }

 private:
  std::int64_t row_of(double x) const {
    const std::int64_t row = (std::bit_cast<std::int64_t>(x) >> (52 - bits_)) - first_;
    return row < last_ ? row : last_;
  }
  double left_of(std::int64_t row) const { return std::bit_cast<double>((row + first_) << (52 - bits_)); }

  template <class Real>
  const std::vector<Real>& cubics() const {
    if constexpr (std::is_same_v<Real, float>)
      return float_rows_;
    else
      return rows_;
  }

  void refine(const Hardening& law) {
    for (int octaves = 4; octaves <= 20; octaves += 4)
      for (int bits = 3; bits <= 6; ++bits)
        if (fill(law, octaves, bits) <= table_tolerance) return;
  }
  double fill(const Hardening& law, int octaves, int bits) {
    bits_ = bits;
    shift_ = std::ldexp(1.0, -octaves);
    first_ = std::bit_cast<std::int64_t>(shift_) >> (52 - bits_);
    last_ = (std::bit_cast<std::int64_t>(shift_ + largest_strain) >> (52 - bits_)) - first_;
    rows_.assign(4 * (last_ + 1), 0.0);
    for (std::int64_t row = 0; row <= last_; ++row) {
      const double left = left_of(row), width = left_of(row + 1) - left;
      double f0, s0, f1, s1;
      law.evaluate(left - shift_, f0, s0);
      law.evaluate(left - shift_ + width, f1, s1);
      const double rise = (f1 - f0) / width;
      if (rise > 0 && s0 > 3 * rise) s0 = 3 * rise;  // Ludwik's infinite slope at p = 0: keep the cubic monotone
      double* c = &rows_[4 * row];
      c[0] = f0, c[1] = s0;
      if (row == last_) break;  // straight on
      c[2] = (3 * rise - 2 * s0 - s1) / width;
      c[3] = (s0 + s1 - 2 * rise) / (width * width);
    }
    error_ = 0.0;
    for (std::int64_t row = 0; row < last_; ++row)
      for (double at : {0.2, 0.5, 0.8}) {
        const double x = left_of(row) + at * (left_of(row + 1) - left_of(row));
        double flow, slope;
        law.evaluate(x - shift_, flow, slope);
        Piece<double> piece;
        find(x, piece);
        error_ = std::fmax(error_, std::fabs(piece.value(x) / flow - 1.0));
      }
    return error_;
  }

  int bits_ = 0;
  std::int64_t first_ = 0, last_ = 0;
  double shift_ = 1.0, error_ = 0.0;
  std::vector<double> rows_;
  std::vector<float> float_rows_;
};

}  // namespace presswork
