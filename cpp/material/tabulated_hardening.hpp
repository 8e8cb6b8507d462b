// SPDX-License-Identifier: Apache-2.0
// A hardening curve from a table, for the explicit loop: no logarithm, no power.
//
// The hardening curve is kept as cubics (Hermite) on intervals whose width grows with p: the interval's number is read
// from the exponent and the first bits of the mantissa of p + shift. The table is refined until it follows the law
// within table_tolerance of the flow stress, and goes on straight beyond p = largest_strain.
#pragma once

#include <bit>
#include <cstdint>

#include "material/law_data.hpp"
#include "tensor/on_device.hpp"
#include "tensor/records.hpp"

namespace presswork {

// The view that a kernel sees; HardeningTable keeps its rows.
struct TabulatedHardening {
  const double* rows = nullptr;       // (last + 1, 4): cubics as in Piece
  const float* float_rows = nullptr;  // the same
  std::int64_t first = 0, last = 0;   // bits of the first interval's lower end; number of the last interval
  int bits = 0;                       // of the mantissa that number the intervals
  double offset = 1.0;                // p + offset is looked up

  // Cubic c[0..3] in the distance from `left`, the interval's lower end (on the axis of p + shift).
  template <class T>
  struct Piece {
    T c[4], left, width;
    PRESSWORK_DEVICE T value(T x) const {
      T t = x - left;
      return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    }
    PRESSWORK_DEVICE T slope(T x) const {
      T t = x - left;
      return c[1] + t * (T(2.0) * c[2] + T(3.0) * t * c[3]);
    }
    PRESSWORK_DEVICE T half_curvature(T x) const { return c[2] + T(3.0) * (x - left) * c[3]; }
  };
  PRESSWORK_DEVICE double shift() const { return offset; }
  // Flow stress and slope at equivalent plastic strain p.
  PRESSWORK_DEVICE void evaluate(double p, double& flow, double& slope) const {
    const double x = larger(p, 0.0) + offset;
    Piece<double> piece;
    find(x, piece);
    flow = piece.value(x);
    slope = piece.slope(x);
  }
  template <class Real>
  void evaluate(PackOf<Real> p, PackOf<Real>& flow, PackOf<Real>& slope) const {
    const PackOf<Real> x = larger(p, PackOf<Real>(Real(0))) + PackOf<Real>(static_cast<Real>(offset));
    Piece<PackOf<Real>> piece;
    find(x, piece);
    flow = piece.value(x);
    slope = piece.slope(x);
  }
  template <class T>
  PRESSWORK_DEVICE void find(T x, Piece<T>& piece) const {
    const std::int64_t row = row_of(value_of(x));
    for (int i = 0; i < 4; ++i) piece.c[i] = rows[4 * row + i];
    piece.left = left_of(row);
    piece.width = left_of(row + 1) - left_of(row);
  }
  PRESSWORK_DEVICE void find(float x, Piece<float>& piece) const {
    const int shift = 23 - bits;
    const auto start = std::bit_cast<std::int32_t>(static_cast<float>(offset)) >> shift;
    const auto end = static_cast<std::int32_t>(last);
    const std::int32_t found = (std::bit_cast<std::int32_t>(x) >> shift) - start, row = found < end ? found : end;
    for (int i = 0; i < 4; ++i) piece.c[i] = float_rows[4 * row + i];
    piece.left = std::bit_cast<float>((row + start) << shift);
    piece.width = std::bit_cast<float>((row + start + 1) << shift) - piece.left;
  }
  template <class Real>
  [[gnu::always_inline]] void find(PackOf<Real> x, Piece<PackOf<Real>>& piece) const {
    using P = PackOf<Real>;
    using Integer = typename P::Integer;
    const int shift = (sizeof(Real) == 8 ? 52 : 23) - bits;
    const auto start = static_cast<Integer>(std::bit_cast<Integer>(static_cast<Real>(offset)) >> shift);
    typename P::Mask row = (std::bit_cast<typename P::Mask>(x.v) >> shift) - start;
    const typename P::Mask end = typename P::Mask{} + static_cast<Integer>(last);
    row = row < end ? row : end;
    const Real* from[P::width];
    for (int lane = 0; lane < P::width; ++lane) from[lane] = cubics<Real>() + 4 * row[lane];
    load_records<4>(from, piece.c);
    piece.left = P(std::bit_cast<typename P::Vector>((row + start) << shift));
    piece.width = P(std::bit_cast<typename P::Vector>((row + start + 1) << shift)) - piece.left;
  }

  // The same, called.
  template <class T>
  PRESSWORK_CALLED void find_anew(T x, Piece<T>& piece) const {
    find(x, piece);
  }

  PRESSWORK_DEVICE std::int64_t row_of(double x) const {
    const std::int64_t row = (std::bit_cast<std::int64_t>(x) >> (52 - bits)) - first;
    return row < last ? row : last;
  }
  PRESSWORK_DEVICE double left_of(std::int64_t row) const {
    return std::bit_cast<double>((row + first) << (52 - bits));
  }

 private:
  template <class Real>
  const Real* cubics() const {
    if constexpr (std::is_same_v<Real, float>)
      return float_rows;
    else
      return rows;
  }
};

// The rows of a table; its view is good for as long as it lives.
class HardeningTable {
 public:
  static constexpr double tolerance = 1e-8;  // of the flow stress
  static constexpr double largest_strain = 8.0;

  explicit HardeningTable(const Hardening& law) {
    refine(law);
    float_rows_.assign(rows_.begin(), rows_.end());
    view_.float_rows = float_rows_.data();
  }
  HardeningTable(const HardeningTable&) = delete;
  HardeningTable& operator=(const HardeningTable&) = delete;

  const TabulatedHardening& view() const { return view_; }
  double error() const { return error_; }  // largest deviation from the law, of the flow stress

 private:
  void refine(const Hardening& law) {
    for (int octaves = 4; octaves <= 20; octaves += 4)
      for (int bits = 3; bits <= 6; ++bits)
        if (fill(law, octaves, bits) <= tolerance) return;
  }
  double fill(const Hardening& law, int octaves, int bits) {
    TabulatedHardening& v = view_;
    v.bits = bits;
    v.offset = std::ldexp(1.0, -octaves);
    v.first = std::bit_cast<std::int64_t>(v.offset) >> (52 - bits);
    v.last = (std::bit_cast<std::int64_t>(v.offset + largest_strain) >> (52 - bits)) - v.first;
    rows_.assign(4 * (v.last + 1), 0.0);
    v.rows = rows_.data();
    for (std::int64_t row = 0; row <= v.last; ++row) {
      const double left = v.left_of(row), width = v.left_of(row + 1) - left;
      double f0, s0, f1, s1;
      law.evaluate(left - v.offset, f0, s0);
      law.evaluate(left - v.offset + width, f1, s1);
      const double rise = (f1 - f0) / width;
      if (rise > 0 && s0 > 3 * rise) s0 = 3 * rise;  // Ludwik's infinite slope at p = 0: keep the cubic monotone
      double* c = &rows_[4 * row];
      c[0] = f0, c[1] = s0;
      if (row == v.last) break;  // straight on
      c[2] = (3 * rise - 2 * s0 - s1) / width;
      c[3] = (s0 + s1 - 2 * rise) / (width * width);
    }
    error_ = 0.0;
    for (std::int64_t row = 0; row < v.last; ++row)
      for (double at : {0.2, 0.5, 0.8}) {
        const double x = v.left_of(row) + at * (v.left_of(row + 1) - v.left_of(row));
        double flow, slope;
        law.evaluate(x - v.offset, flow, slope);
        TabulatedHardening::Piece<double> piece;
        v.find(x, piece);
        error_ = std::fmax(error_, std::fabs(piece.value(x) / flow - 1.0));
      }
    return error_;
  }

  TabulatedHardening view_;
  double error_ = 0.0;
  std::vector<double> rows_;
  std::vector<float> float_rows_;
};

}  // namespace presswork
