// SPDX-License-Identifier: Apache-2.0
// Cells of one kind and law, in packs of SIMD width: what the explicit loop knows of them.
//
// The loop holds any number of blocks, of cells of any kind that its nodes can have, and calls them tile by tile. A new
// kind of element derives from ElementBlock, fills in the arrays below, and says how a range of packs is advanced.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "explicit/nodes.hpp"
#include "explicit/point_damage.hpp"
#include "explicit/state_field.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

// State is kept as [pack][row][lane]. The last pack is filled up with copies of the last element that take part in no
// assembly.
template <class Nodes>
class ElementBlock {
 public:
  using Real = typename Nodes::Real;
  static constexpr int lanes = PackOf<Real>::width;

  virtual ~ElementBlock() = default;

  // Advance packs [first, last) by a cycle of dt that began at `time` [s] and has taken the nodes to where they are, at
  // their velocities; force: records of their elements, from the first pack on. Gives the first element that has
  // failed, as above, or -1.
  virtual int advance(const Nodes& nodes, double dt, double time, int first, int last, Real* force) = 0;
  // Bound of each element's squared frequency [1/s2] (n), elastic, at the present positions.
  virtual void bound_frequencies(const Nodes& nodes, double* squared) const = 0;

  int n() const { return n_; }
  int n_packs() const { return (n_ + lanes - 1) / lanes; }
  int nodes_each() const { return nodes_each_; }
  const std::vector<int>& connectivity() const { return connectivity_; }

  // Add the masses of the elements to those of the nodes (n_nodes, Nodes::masses).
  virtual void add_masses(std::vector<double>& sum) const = 0;
  // Masses of an element [t]: as it is, without what scaling has added, and that.
  virtual double mass(int element) const = 0;
  virtual double true_mass(int element) const = 0;
  virtual double added_mass(int element) const = 0;
  virtual void scale_mass(int element, double factor) = 0;

  // Work of the stresses and of the hourglass forces [N mm].
  double work(int element) const { return value(element, work_row_); }
  double hourglass_work(int element) const { return hourglass_row_ < 0 ? 0.0 : value(element, hourglass_row_); }

  int work_row() const { return work_row_; }
  int hourglass_row() const { return hourglass_row_; }  // -1: there are none

  // Rows of an element's state.
  int n_rows() const { return n_rows_; }
  double value(int element, int row) const { return state_.data()[index(element, row)]; }
  // Sets the copies in the last pack as well.
  void set_value(int element, int row, double x) {
    for (int copy = element; copy < (element == n_ - 1 ? n_packs() * lanes : element + 1); ++copy)
      state_.data()[index(copy, row)] = static_cast<Real>(x);
  }
  // Temperatures (n, n_temperatures) given to the points [degrees C] from now on; else they have that of the law's
  // start.
  int n_temperatures() const { return n_temperatures_; }
  bool has_temperatures() const { return temperature_.size() > 0; }
  double temperature(int element, int k) const {
    return temperature_.data()[(std::size_t(element / lanes) * n_temperatures_ + k) * lanes + element % lanes];
  }
  void set_temperature(const double* degrees) {
    const std::size_t points = n_temperatures_;
    if (temperature_.size() == 0) temperature_ = AlignedArray<Real>(n_packs() * points * lanes);
    for (int slot = 0; slot < n_packs() * lanes; ++slot)
      for (std::size_t k = 0; k < points; ++k)
        temperature_.data()[(std::size_t(slot / lanes) * points + k) * lanes + slot % lanes] =
            static_cast<Real>(degrees[std::size_t(std::min(slot, n_ - 1)) * points + k]);
  }

  // Where its points are in the state.
  virtual PointLayout layout() const = 0;
  void add_damage(const Criterion& criterion) { damage.add(criterion, layout(), n_, n_packs()); }
  // Count damage from the present state on, and that of packs [first, last) after a cycle of dt.
  void begin_damage() {
    for (int pack = 0; pack < n_packs() && !damage.empty(); ++pack) damage.begin(pack, pack_state(pack));
  }
  void advance_damage(int first, int last, double dt) {
    for (int pack = first; pack < last && !damage.empty(); ++pack)
      damage.advance(pack, pack_state(pack), pack_temperature(pack), slower * dt);
  }
  PointDamage<Real> damage;
  // By how much the process takes longer than it is computed: laws take their rates by its time.
  double slower = 1.0;

  // Masses first: they are part of it. owner: a name for the block.
  virtual void list_state(const std::string& owner, std::vector<StateField>& fields) = 0;

 protected:
  // hourglass_row: -1 where there are no hourglass forces; n_temperatures: points that have one.
  ElementBlock(int nodes_each, std::vector<int> connectivity, int n_rows, int work_row, int hourglass_row,
               int n_temperatures)
      : n_(static_cast<int>(connectivity.size()) / nodes_each),
        nodes_each_(nodes_each),
        n_rows_(n_rows),
        work_row_(work_row),
        hourglass_row_(hourglass_row),
        n_temperatures_(n_temperatures),
        connectivity_(std::move(connectivity)),
        packed_(std::size_t(n_packs()) * nodes_each * lanes),
        state_(std::size_t(n_packs()) * n_rows * lanes) {
    for (int slot = 0; slot < n_packs() * lanes; ++slot)
      for (int a = 0; a < nodes_each; ++a)
        packed_[(std::size_t(slot / lanes) * nodes_each + a) * lanes + slot % lanes] =
            connectivity_[std::size_t(nodes_each) * (slot < n_ ? slot : n_ - 1) + a];
  }
  PackOf<Real>* pack_state(int pack) {
    return reinterpret_cast<PackOf<Real>*>(state_.data() + std::size_t(pack) * n_rows_ * lanes);
  }
  const PackOf<Real>* pack_state(int pack) const { return const_cast<ElementBlock*>(this)->pack_state(pack); }
  // Ask memory for the state of a pack, if there is one, while the one before it is computed: that takes longer than
  // the CPU looks ahead. Inlined always: GCC takes a function that only prefetches for one that does nothing.
  [[gnu::always_inline]] inline void expect_pack(int pack) const {
    constexpr std::size_t line = 64 / sizeof(Real);
    if (pack >= n_packs()) return;
    const std::size_t size = std::size_t(n_rows_) * lanes;
    const Real* first = state_.data() + pack * size;
    for (std::size_t i = 0; i < size; i += line) __builtin_prefetch(first + i, 1, 2);
  }
  // Given to the points of a pack's elements, or null.
  const PackOf<Real>* pack_temperature(int pack) const {
    if (temperature_.size() == 0) return nullptr;
    return reinterpret_cast<const PackOf<Real>*>(temperature_.data()) + pack * n_temperatures_;
  }
  // The nodes of a pack's elements, [node][lane].
  const int* pack_nodes(int pack) const { return &packed_[std::size_t(pack) * nodes_each_ * lanes]; }
  // Rows [first, first + width) of the state (n, width), and then those from `behind` to the last.
  StateField rows_field(const std::string& owner, std::string name, int first, int width, int behind = -1) {
    const int end = first + width, more = behind < 0 ? n_rows_ : behind;
    return {owner,
            std::move(name),
            {std::size_t(n_), std::size_t(width + n_rows_ - more)},
            [=, this](double* to) {
              for (int e = 0; e < n_; ++e) {
                for (int r = first; r < end; ++r) *to++ = value(e, r);
                for (int r = more; r < n_rows_; ++r) *to++ = value(e, r);
              }
            },
            [=, this](const double* from) {
              for (int e = 0; e < n_; ++e) {
                for (int r = first; r < end; ++r) set_value(e, r, *from++);
                for (int r = more; r < n_rows_; ++r) set_value(e, r, *from++);
              }
            }};
  }

  int n_, nodes_each_, n_rows_, work_row_, hourglass_row_, n_temperatures_;
  std::vector<int> connectivity_;  // (n, nodes)
  std::vector<int> packed_;        // [pack][node][lane]
  AlignedArray<Real> state_;
  AlignedArray<Real> temperature_;  // [pack][point][lane]; none: that of the law's start

 private:
  std::size_t index(int element, int row) const {
    return (std::size_t(element / lanes) * n_rows_ + row) * lanes + element % lanes;
  }
};

}  // namespace presswork::explicit_dynamics
