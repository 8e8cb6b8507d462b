// SPDX-License-Identifier: Apache-2.0
// Damage at the points of a block of elements in the explicit loop: criteria of material/damage.hpp, by the stress at
// the end of each cycle. It is kept in double precision, whatever the elements are computed in: a cycle adds little.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "explicit/nodes.hpp"
#include "explicit/state_field.hpp"
#include "material/damage.hpp"

namespace presswork::explicit_dynamics {

// Where the state of an element has its points: of point k the stress begins in row first + k rows. components: 3 as
// sum and difference of the normal stresses, and shear; 4; 6. eqps: row of the equivalent plastic strain behind the
// first of the stress.
struct PointLayout {
  int first, rows, count, components, eqps;
};

struct Criterion {
  std::string name;
  Damage law;
  double temperature;  // where none is given [degrees C]
  int rise;            // row of the rise of temperature behind the first of the stress; -1: there is none
};

template <class Real>
class PointDamage {
  using P = PackOf<Real>;
  static constexpr int lanes = P::width, halves = lanes / pack_width;

 public:
  bool empty() const { return criteria_.empty(); }
  void add(const Criterion& criterion, const PointLayout& layout, int n, int n_packs) {
    layout_ = layout, n_ = n;
    const std::size_t size = std::size_t(n_packs) * layout.count * lanes;
    if (empty()) flowed_ = AlignedArray<double>(size);
    criteria_.push_back(criterion);
    values_.emplace_back(size);
  }

  // Count plastic strain from what the state has now.
  void begin(int pack, const P* state) {
    for (int k = 0; k < layout_.count; ++k)
      for (int half = 0; half < halves; ++half) *at(flowed_, pack, k, half) = wide(row(state, k)[layout_.eqps], half);
  }

  // After a cycle of dt [s]; temperature: given to the points, or null.
  void advance(int pack, const P* state, const P* temperature, double dt) {
    for (int k = 0; k < layout_.count; ++k)
      for (int half = 0; half < halves; ++half) {
        const P* values = row(state, k);
        Pack* before = at(flowed_, pack, k, half);
        const Pack now = wide(values[layout_.eqps], half), strain = now - *before;
        if (!any(strain > Pack(0.0))) continue;
        *before = now;
        damage::Point<Pack> point = measure(values, half);
        point.rate = strain * Pack(1.0 / dt);
        for (std::size_t c = 0; c < criteria_.size(); ++c) {
          const Criterion& criterion = criteria_[c];
          point.temperature = temperature ? wide(temperature[k], half) : Pack(criterion.temperature);
          if (criterion.rise >= 0) point.temperature += wide(values[criterion.rise], half);
          *at(values_[c], pack, k, half) += criterion.law.per_strain(point) * larger(strain, Pack(0.0));
        }
      }
  }

  // Of a criterion (n, points).
  StateField field(const std::string& owner, std::size_t c) {
    return {owner,
            "damage_" + criteria_[c].name,
            {std::size_t(n_), std::size_t(layout_.count)},
            [this, c](double* to) { read(c, to); },
            [this, c](const double* from) {
              for (int e = 0; e < n_; ++e)
                for (int k = 0; k < layout_.count; ++k) values_[c].data()[index(e, k)] = *from++;
            }};
  }
  std::size_t count() const { return criteria_.size(); }
  const std::vector<Criterion>& criteria() const { return criteria_; }
  const PointLayout& layout() const { return layout_; }
  // Damage by a criterion at a point of an element.
  double& value(std::size_t c, int e, int k) { return values_[c].data()[index(e, k)]; }
  int points() const { return layout_.count; }
  // The criterion of a name, or as many as there are.
  std::size_t find(const std::string& name) const {
    return std::find_if(criteria_.begin(), criteria_.end(), [&](const auto& c) { return c.name == name; }) -
           criteria_.begin();
  }
  void read(std::size_t c, double* to) const {
    for (int e = 0; e < n_; ++e)
      for (int k = 0; k < layout_.count; ++k) *to++ = values_[c].data()[index(e, k)];
  }
  void inherit(int element, const PointDamage& from, int parent) {
    for (std::size_t c = 0; c < criteria_.size(); ++c)
      for (int k = 0; k < layout_.count; ++k)
        values_[c].data()[index(element, k)] = from.values_[c].data()[from.index(parent, k)];
  }

 private:
  static Pack wide(P a, int half) {
    if constexpr (halves == 1)
      return a;
    else
      return widen(a, half);
  }
  const P* row(const P* state, int k) const { return state + layout_.first + k * layout_.rows; }
  Pack* at(AlignedArray<double>& values, int pack, int k, int half) const {
    return reinterpret_cast<Pack*>(values.data()) + (std::size_t(pack) * layout_.count + k) * halves + half;
  }
  std::size_t index(int element, int k) const {
    return (std::size_t(element / lanes) * layout_.count + k) * lanes + element % lanes;
  }
  damage::Point<Pack> measure(const P* values, int half) const {
    Pack s[6];
    for (int i = 0; i < layout_.components; ++i) s[i] = wide(values[i], half);
    if (layout_.components == 6) return damage::measure_stress<6>(s);
    if (layout_.components == 4) return damage::measure_stress<4>(s);
    const Pack plane[3] = {Pack(0.5) * (s[0] + s[1]), Pack(0.5) * (s[0] - s[1]), s[2]};
    return damage::measure_stress<3>(plane);
  }

  PointLayout layout_{};
  int n_ = 0;
  std::vector<Criterion> criteria_;
  std::vector<AlignedArray<double>> values_;  // of each criterion [pack][point][lane]
  AlignedArray<double> flowed_;               // equivalent plastic strain up to which damage is counted
};

}  // namespace presswork::explicit_dynamics
