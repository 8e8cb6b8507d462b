// SPDX-License-Identifier: Apache-2.0
// Drawbeads of the explicit loop: lines in the plan that hold the sheet back with a force per length.
//
// A line is cut into points. Each holds the material beneath it against its way across the line,
//
//   T = T_n - k ds,  shortened to f w:  Coulomb's return mapping with a given limit, f per length and w the point's
//   length,
//
// with ds = d.(v - v_tool) dt, and d the normal of the line in the plan, laid into the sheet. The force T d goes to the
// corners of the shell beneath by their shape functions. k = penalty m/dt^2 w/l, m half of the shell's mass, as a node
// at a free edge has, and l the root of its area: the points of a line through a shell share what one contact spring of
// such a node has, so the step stays as stable as with contact, and symmetry planes make no difference. The sheet slips
// by f l dt^2/(penalty m), some micrometres, before it is held with all of f.
//
// What lies beneath is looked up every `refresh` cycles, from the shell found last: its cost does not grow.
// Points are visited by one thread in their order, so the bits do not depend on the threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "contact/sheet_under.hpp"
#include "contact/vectors.hpp"
#include "explicit/contact/tools.hpp"
#include "explicit/space/nodes.hpp"
#include "explicit/state_field.hpp"

namespace presswork::explicit_dynamics {

struct Drawbead {
  int first, last;            // its points
  int tool;                   // that it moves with; -1: it stands still
  double force;               // per length [N/mm]
  std::vector<double> share;  // of the force, in the cycles to come
};

class Drawbeads {
 public:
  static constexpr int refresh = 16;      // cycles between two looks beneath
  static constexpr double penalty = 0.1;  // as that of tools by default

  explicit Drawbeads(contact::SheetUnder sheet) : sheet_(std::move(sheet)) {}

  // Add a line of n points: places and unit normals in the plan (n, 2), lengths (n) [mm], force per length [N/mm].
  void add(int n, const double* place, const double* across, const double* length, double force, int tool);
  // One cycle, by one thread: the forces are taken off net (n_nodes, 6), internal less external forces.
  template <class Real>
  void visit(int cycle, double dt, const SpaceNodes<Real>& nodes, const std::vector<Tool>* tools, Real* net);

  // Begin with the forces of like beads on a sheet some shells of which are split here; they are taken off net.
  template <class Real>
  void inherit(const Drawbeads& from, double dt, const SpaceNodes<Real>& nodes, Real* net);

  double stored() const;                            // in the springs [N mm]
  double lost() const { return work_ - stored(); }  // in slip [N mm]
  // Sum of the points' restraining forces of one bead [N].
  double restraint(int bead) const;

  void list_state(std::vector<StateField>& fields);

  // Take the masses of the shells [t]; needed before the first cycle, and after a change.
  void set_masses(std::vector<double> of_cells) { cell_mass_ = std::move(of_cells); }

  std::vector<Drawbead> beads;

 private:
  struct Point {
    double place[2], across[2], length;
    double force = 0.0, stiffness = 1.0;  // T [N], k [N/mm]
    double direction[3] = {};
    contact::Beneath beneath;
  };
  template <class Real>
  void look_beneath(Point& p, double dt, const SpaceNodes<Real>& nodes) const;
  template <class Real>
  static void push(const Point& p, Real* net);

  contact::SheetUnder sheet_;
  std::vector<Point> points_;
  std::vector<double> cell_mass_;
  double work_ = 0.0;  // taken from the sheet [N mm]
  int cycle_ = 0;
};

template <class Real>
void Drawbeads::look_beneath(Point& p, double dt, const SpaceNodes<Real>& nodes) const {
  sheet_.find(p.place, nodes.position.data(), SpaceNodes<Real>::position_stride, p.beneath);
  if (!p.beneath.inside) return;
  const double* n = p.beneath.normal;
  const double size = std::sqrt(contact::dot(n, n)), out = (p.across[0] * n[0] + p.across[1] * n[1]) / (size * size);
  double d[3] = {p.across[0] - out * n[0], p.across[1] - out * n[1], -out * n[2]};
  const double length = std::sqrt(contact::dot(d, d));
  for (int i = 0; i < 3; ++i) p.direction[i] = d[i] / length;
  // |g1 x g2| is a quarter of a quadrilateral's area, and twice a triangle's
  const double area = p.beneath.corners == 4 ? 4.0 * size : 0.5 * size;
  p.stiffness = penalty * 0.5 * cell_mass_[p.beneath.cell] / (dt * dt) * p.length / std::sqrt(area);
}

template <class Real>
void Drawbeads::inherit(const Drawbeads& from, double dt, const SpaceNodes<Real>& nodes, Real* net) {
  if (points_.size() != from.points_.size()) throw std::invalid_argument("the beads are not those of the other sheet");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& p = points_[i];
    look_beneath(p, dt, nodes);
    p.force = p.beneath.inside ? from.points_[i].force : 0.0;
    if (p.beneath.inside) push(p, net);
  }
  cycle_ = from.cycle_;
  work_ = from.lost() + stored();  // what the springs hold changes with their stiffness: no work
}

template <class Real>
void Drawbeads::push(const Point& p, Real* net) {
  for (int a = 0; a < p.beneath.corners; ++a)
    for (int j = 0; j < 3; ++j)
      net[6 * std::size_t(p.beneath.node[a]) + j] -= static_cast<Real>(p.beneath.weight[a] * p.force * p.direction[j]);
}

template <class Real>
void Drawbeads::visit(int cycle, double dt, const SpaceNodes<Real>& nodes, const std::vector<Tool>* tools, Real* net) {
  const bool look = cycle_ % refresh == 0;
  ++cycle_;
  for (const Drawbead& bead : beads) {
    const double* moved = bead.tool >= 0 ? (*tools)[bead.tool].velocity : nullptr;
    for (int i = bead.first; i < bead.last; ++i) {
      Point& p = points_[i];
      if (look || p.beneath.cell < 0) look_beneath(p, dt, nodes);
      if (!p.beneath.inside) {
        p.force = 0.0;
        continue;
      }
      double slip = 0.0;
      for (int a = 0; a < p.beneath.corners; ++a) {
        const Real* v = nodes.motion.data() + std::size_t(SpaceNodes<Real>::motion_stride) * p.beneath.node[a];
        double along = 0.0;
        for (int j = 0; j < 3; ++j) along += p.direction[j] * v[j];
        slip += p.beneath.weight[a] * along;
      }
      if (moved) slip -= contact::dot(p.direction, moved);
      slip *= dt;
      const double limit = bead.share[cycle] * bead.force * p.length;
      const double now = std::clamp(p.force - p.stiffness * slip, -limit, limit);
      work_ -= 0.5 * (p.force + now) * slip;
      p.force = now;
      push(p, net);
    }
  }
}

}  // namespace presswork::explicit_dynamics
