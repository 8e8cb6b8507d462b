// SPDX-License-Identifier: Apache-2.0
// What blocks of shells have in common: section, law, and the frame that the law starts in; and how they are made.
#pragma once

#include <cmath>
#include <memory>

#include "element/shell4_one_point.hpp"
#include "explicit/space/sheet_block.hpp"

namespace presswork::explicit_dynamics {

// How one point is made enough: Belytschko & Tsay's shell, with warping terms, or with physical stabilisation; or 2 x 2
// points, which are.
enum class ShellTreatment { plain, warped, stabilized, mitc };

struct ShellSection {
  std::variant<FastMises, GeneralSheet, UserSheet> law;
  std::vector<std::shared_ptr<const void>> law_data;  // what the law points at
  LayerRule rule;
  double density;            // [t/mm3]
  ShellTreatment treatment;  // of 4-node shells
  ShellControl control;
  double yield_stress = 0.0;     // at rest [MPa]; half of it is borne by the faces under a pushed tool
  std::vector<int> number = {};  // (n) of the shells, from 0, as a law from a shared library is told
};

// Shells of one point: section.treatment says which, of three nodes there is one kind; and fully integrated ones of
// four nodes. connectivity (n, nodes), thickness (n) [mm], axis (n, 3): direction of the law's x, of any length,
// projected on the element. Throws std::invalid_argument for an element that has no area or that its axis is normal to.
template <class Real>
std::unique_ptr<SheetBlock<Real>> make_one_point_shells(int nodes_each, const SpaceNodes<Real>& nodes,
                                                        ShellSection section, std::vector<int> connectivity,
                                                        const double* thickness, const double* axis);

// Inverse of the components of p - q and p + q along the law's x and y; false where that does not exist. area: |p x q|.
inline bool invert_reference(const double p[3], const double q[3], const double axis[3], double inverse[4],
                             double& area) {
  double e1[3], e2[3], e3[3];
  shell4::cross(p, q, e3);
  area = std::sqrt(shell4::dot(e3, e3));
  if (!(area > 1e-12 * (shell4::dot(p, p) + shell4::dot(q, q)))) return false;
  shell4::scale(e3, 1.0 / area);
  const double along = shell4::dot(axis, e3), length = std::sqrt(shell4::dot(axis, axis));
  for (int i = 0; i < 3; ++i) e1[i] = axis[i] - along * e3[i];
  const double plane = std::sqrt(shell4::dot(e1, e1));
  if (!(plane > 1e-6 * length)) return false;
  shell4::scale(e1, 1.0 / plane);
  shell4::cross(e3, e1, e2);
  double g1[3], g2[3];
  for (int i = 0; i < 3; ++i) g1[i] = p[i] - q[i], g2[i] = p[i] + q[i];
  const double a = shell4::dot(g1, e1), b = shell4::dot(g2, e1), c = shell4::dot(g1, e2), d = shell4::dot(g2, e2);
  const double over = 1.0 / (a * d - b * c);
  inverse[0] = d * over, inverse[1] = -b * over, inverse[2] = -c * over, inverse[3] = a * over;
  return true;
}
template <class Real>
std::unique_ptr<SheetBlock<Real>> make_mitc_shells(const SpaceNodes<Real>& nodes, ShellSection section,
                                                   std::vector<int> connectivity, const double* thickness,
                                                   const double* axis);

}  // namespace presswork::explicit_dynamics
