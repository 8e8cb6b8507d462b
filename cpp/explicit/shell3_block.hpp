// SPDX-License-Identifier: Apache-2.0
// 3-node one-point shells of one section and law in the explicit loop (element/shell3_one_point.hpp).
#pragma once

#include "element/shell3_one_point.hpp"
#include "explicit/shell_section.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class Shell3Block final : public ElementBlock<Real> {
 public:
  // connectivity (n, 3), thickness (n) [mm], axis (n, 3): direction of the law's x, of any length, projected on the
  // element. Throws std::invalid_argument for an element that has no area or that its axis is normal to.
  Shell3Block(const Nodes<Real>& nodes, ShellSection section, std::vector<int> connectivity, const double* thickness,
              const double* axis);

  void advance(const Nodes<Real>& nodes, double dt, int first, int last, Real* force) override;
  void bound_frequencies(const Nodes<Real>& nodes, double* squared) const override;

 private:
  using P = PackOf<Real>;
  static constexpr int lanes = ElementBlock<Real>::lanes;
  template <class Law>
  void advance_packs(const Law& law, const Nodes<Real>& nodes, double dt, int first, int last, Real* force);

  ShellSection section_;
};

}  // namespace presswork::explicit_dynamics
