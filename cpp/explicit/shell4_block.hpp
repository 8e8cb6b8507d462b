// SPDX-License-Identifier: Apache-2.0
// 4-node one-point shells of one section and law in the explicit loop (element/shell4_one_point.hpp,
// shell4_stabilized.hpp).
#pragma once

#include "element/shell4_stabilized.hpp"
#include "explicit/shell_section.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class Shell4Block final : public ElementBlock<Real> {
 public:
  // connectivity (n, 4), thickness (n) [mm], axis (n, 3): direction of the law's x, of any length, projected on the
  // element. Throws std::invalid_argument for an element that has no area or that its axis is normal to.
  Shell4Block(const Nodes<Real>& nodes, ShellSection section, std::vector<int> connectivity, const double* thickness,
              const double* axis);

  void advance(const Nodes<Real>& nodes, double dt, int first, int last, Real* force) override;
  void bound_frequencies(const Nodes<Real>& nodes, double* squared) const override;

 private:
  using P = PackOf<Real>;
  static constexpr int lanes = ElementBlock<Real>::lanes;
  template <Treatment treatment, class Law>
  void advance_packs(const Law& law, const Nodes<Real>& nodes, const ShellControl& control, int first, int last,
                     Real* force);

  ShellSection section_;
};

}  // namespace presswork::explicit_dynamics
