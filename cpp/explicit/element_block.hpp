// SPDX-License-Identifier: Apache-2.0
// Elements of one kind, section and law, in packs of SIMD width: what the explicit loop knows of them.
//
// The loop holds any number of blocks, of triangles and of quadrilaterals, and calls them tile by tile. A new kind of
// element derives from ElementBlock, fills in the arrays below, and says how a range of packs is advanced.
#pragma once

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "element/umat_point.hpp"
#include "explicit/nodes.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

inline constexpr int serial_elements = 1000;  // fewer are left to one thread: waking a second costs more than it gives

// Where the loop finds what it reports in an element's state; layers start at `layers`, `law` rows each.
struct StateRows {
  int thickness, work, hourglass_work;  // work [N mm]: of the stresses, of the hourglass forces (-1: there are none)
  // points in the plane, points across the thickness, which come first, and rows of each: sum, difference, shear of
  // stress, then the law's history
  int layers, in_plane, across, law;
  int count() const { return layers + in_plane * across * law; }
  // Of a squeezed shell: pressure through the thickness of the first point in the plane, and from it to that of the
  // next; spring of a node [N/mm] (squeezed_section.hpp).
  int pressure, pressure_step = 0, spring;
  // First rows of what the undeformed shape gives (4), of hourglass forces (6); -1 of shells that cannot be split.
  int reference = -1, hourglass = -1;
};

// State is kept as [pack][row][lane]. The last pack is filled up with copies of the last element that take part in no
// assembly.
template <class Real>
class ElementBlock {
 public:
  static constexpr int lanes = PackOf<Real>::width;

  virtual ~ElementBlock() = default;

  // Advance packs [first, last) by dt to the nodes' present positions, at their velocities; force: (packs, lanes,
  // nodes, 6), from the first pack on. Gives the first element whose material law has failed, or -1.
  virtual int advance(const Nodes<Real>& nodes, double dt, int first, int last, Real* force) = 0;
  // Bound of each element's squared frequency [1/s2] (n).
  virtual void bound_frequencies(const Nodes<Real>& nodes, double* squared) const = 0;

  // Worst of what a law has told, since the block was made: no_stress unless it is from a shared library.
  LawStatus told() const { return told_.status == LawStatus::done ? LawStatus::no_stress : told_.status; }

  int n() const { return n_; }
  int n_packs() const { return (n_ + lanes - 1) / lanes; }
  int nodes_each() const { return nodes_each_; }
  const StateRows& rows() const { return rows_; }
  const std::vector<int>& connectivity() const { return connectivity_; }

  // Mass [t] and rotary inertia over mass [mm2]; the loop shares them out to the nodes, to each the same.
  std::vector<double>& mass() { return mass_; }
  const std::vector<double>& mass() const { return mass_; }
  const std::vector<double>& inertia_ratio() const { return inertia_ratio_; }

  // Take the springs of squeezed shells from their masses and a step.
  void set_springs(double dt) {
    for (int e = 0; e < n_; ++e)
      set_value(e, rows_.spring, std::min(stiffest_spring_[e], mass_[e] / (nodes_each_ * dt * dt)));
  }

  double value(int element, int row) const { return state_.data()[index(element, row)]; }
  // Sets the copies in the last pack as well.
  void set_value(int element, int row, double x) {
    state_.data()[index(element, row)] = static_cast<Real>(x);
    if (element == n_ - 1)
      for (int copy = n_; copy < n_packs() * lanes; ++copy) state_.data()[index(copy, row)] = static_cast<Real>(x);
  }

  // Temperatures (n, points in the plane, across) given to the layers [degrees C] from now on.
  void set_temperature(const double* degrees) {
    const int points = rows_.in_plane * rows_.across;
    if (temperature_.size() == 0) temperature_ = AlignedArray<Real>(std::size_t(n_packs()) * points * lanes);
    for (int slot = 0; slot < n_packs() * lanes; ++slot)
      for (int k = 0; k < points; ++k)
        temperature_.data()[(std::size_t(slot / lanes) * points + k) * lanes + slot % lanes] =
            static_cast<Real>(degrees[std::size_t(std::min(slot, n_ - 1)) * points + k]);
  }

  // Take over the state of an element of a like block, or, of a share of it below one, that of the child that it has
  // been split into: work by the share, no hourglass forces, the undeformed shape its own.
  void inherit(int element, const ElementBlock& from, int parent, double share) {
    if (share < 1.0 && rows_.reference < 0) throw std::invalid_argument("shells of this kind cannot be split");
    for (int r = 0; r < rows_.count(); ++r) {
      double x = from.value(parent, r);
      if (share < 1.0) {
        if (r >= rows_.reference && r < rows_.reference + 4) continue;
        if (r >= rows_.hourglass && r < rows_.hourglass + 6) x = 0.0;
        if (r == rows_.work || r == rows_.hourglass_work) x *= share;
      }
      set_value(element, r, x);
    }
  }

 protected:
  ElementBlock(int nodes_each, std::vector<int> connectivity, StateRows rows)
      : n_(static_cast<int>(connectivity.size()) / nodes_each),
        nodes_each_(nodes_each),
        rows_(rows),
        connectivity_(std::move(connectivity)),
        packed_(std::size_t(n_packs()) * nodes_each * lanes),
        mass_(n_),
        inertia_ratio_(n_),
        stiffest_spring_(n_),
        state_(std::size_t(n_packs()) * rows.count() * lanes) {
    for (int slot = 0; slot < n_packs() * lanes; ++slot)
      for (int a = 0; a < nodes_each; ++a)
        packed_[(std::size_t(slot / lanes) * nodes_each + a) * lanes + slot % lanes] =
            connectivity_[std::size_t(nodes_each) * (slot < n_ ? slot : n_ - 1) + a];
  }
  PackOf<Real>* pack_state(int pack) {
    return reinterpret_cast<PackOf<Real>*>(state_.data() + std::size_t(pack) * rows_.count() * lanes);
  }
  const PackOf<Real>* pack_state(int pack) const { return const_cast<ElementBlock*>(this)->pack_state(pack); }
  // Given to the layers of a pack's elements, or null.
  const PackOf<Real>* pack_temperature(int pack) const {
    if (temperature_.size() == 0) return nullptr;
    return reinterpret_cast<const PackOf<Real>*>(temperature_.data()) + pack * rows_.in_plane * rows_.across;
  }
  // The nodes of a pack's elements, [node][lane].
  const int* pack_nodes(int pack) const { return &packed_[std::size_t(pack) * nodes_each_ * lanes]; }

  // By any thread.
  void note(const LawFault& fault) {
    const std::scoped_lock lock(noting_);
    told_.note(fault.status, fault.cell, fault.step_factor);
  }

  int n_, nodes_each_;
  StateRows rows_;
  std::vector<int> connectivity_;  // (n, nodes)
  std::vector<int> packed_;        // [pack][node][lane]
  std::vector<double> mass_, inertia_ratio_, stiffest_spring_;
  AlignedArray<Real> state_;
  AlignedArray<Real> temperature_;  // [pack][layer][lane]; none: that of the law's start

 private:
  LawFault told_ = {};
  std::mutex noting_;

  std::size_t index(int element, int row) const {
    return (std::size_t(element / lanes) * rows_.count() + row) * lanes + element % lanes;
  }
};

}  // namespace presswork::explicit_dynamics
