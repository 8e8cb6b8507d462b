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
//
// In parts of a mesh each part holds the points whose shell it computes; the part that owns the shell's first node
// answers for the point. Before they look beneath, all parts learn the shell and the force of every point from those
// that know them, so a point may go from one part to another.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "contact/sheet_under.hpp"
#include "contact/vectors.hpp"
#include "explicit/contact/tools.hpp"
#include "explicit/exact_sum.hpp"
#include "explicit/neighbours.hpp"
#include "explicit/space/nodes.hpp"
#include "explicit/state_field.hpp"

namespace presswork::explicit_dynamics {

// A point of a bead and what it holds.
struct BeadPoint {
  double place[2], across[2], length;
  double force = 0.0, stiffness = 1.0;  // T [N], k [N/mm]
  double direction[3] = {};
  contact::Beneath beneath;

  // Finds what lies beneath, by positions of `stride` numbers and the masses of the cells [t].
  PRESSWORK_DEVICE void look_beneath(const contact::SheetSearch& sheet, const double* cell_mass, double dt,
                                     const double* position, int stride);
  // One cycle of dt; motion: records of `stride` numbers, velocity first; moved: velocity of the bead [mm/s], or null;
  // limit of the force [N]. Gives the work of the force along the slip [N mm]: what is taken from the sheet is less it.
  template <class Real>
  PRESSWORK_DEVICE double hold(const Real* motion, int stride, const double* moved, double limit, double dt);
  // What is taken off the net force of corner a of the cell beneath [N].
  PRESSWORK_DEVICE double push(int a, int i) const { return beneath.weight[a] * force * direction[i]; }
};

inline constexpr double bead_penalty = 0.1;  // as that of tools by default

struct Drawbead {
  int first, last;            // its points
  int tool;                   // that it moves with; -1: it stands still
  double force;               // per length [N/mm]
  std::vector<double> share;  // of the force, in the cycles to come
};

class Drawbeads {
 public:
  static constexpr int refresh = 16;  // cycles between two looks beneath

  explicit Drawbeads(contact::SheetUnder sheet) : sheet_(std::move(sheet)) {}

  // Add a line of n points: places and unit normals in the plan (n, 2), lengths (n) [mm], force per length [N/mm].
  void add(int n, const double* place, const double* across, const double* length, double force, int tool);
  // Look beneath the points where it is time to; before `visit`, when nodes have moved.
  template <class Real>
  void look(double dt, const SpaceNodes<Real>& nodes);
  // One cycle, by one thread: the forces are taken off net (n_nodes, 6), internal less external forces.
  template <class Real>
  void visit(int cycle, double dt, const SpaceNodes<Real>& nodes, const std::vector<Tool>* tools, Real* net);

  // Begin with the forces of like beads on a sheet some shells of which are split here; they are taken off net.
  template <class Real>
  void inherit(const Drawbeads& from, double dt, const SpaceNodes<Real>& nodes, Real* net);

  double stored() const;                            // in the springs [N mm]
  double lost() const { return work_ - stored(); }  // in slip [N mm]
  // Sum of the points' restraining forces of one bead [N], of those that this part answers for; rounded, so that the
  // sum over parts is exact.
  double restraint(int bead) const;

  void list_state(std::vector<StateField>& fields);

  // Take the masses of the shells [t], of a part its own; needed before the first cycle, and after a change.
  void set_masses(const std::vector<double>& of_cells);

  // Stand near the shell beneath, where none has been found yet.
  void place(const double* position, int stride);
  // Be the beads of a part of the sheet. place (n_nodes of the sheet): number in the part of each node, or -1; cell:
  // numbers in the sheet of the part's shells; ghost: nodes of the part that others own.
  void be_part(const int* place, std::vector<int> cell, std::vector<char> ghost);
  // Let all parts know what lies beneath each point and what force it has.
  void agree(const double* position, int stride, Neighbours& parts);

  std::vector<Drawbead> beads;

  // For a device, which changes the points, the work and the cycles, and says so by `take`.
  struct Lent {
    contact::SheetSearch sheet;
    const std::vector<BeadPoint>& points;
    const std::vector<double>& cell_mass;
    double& work;
    int& cycle;
  };
  Lent lend() { return {sheet_.search(), points_, cell_mass_, work_, cycle_}; }
  void take(const std::vector<BeadPoint>& points) {
    points_ = points;
    for (Point& p : points_) sheet_.stand_on(p.beneath.cell, p.beneath);
  }

 private:
  using Point = BeadPoint;
  template <class Real>
  void look_beneath(Point& p, double dt, const SpaceNodes<Real>& nodes) const;
  template <class Real>
  static void push(const Point& p, Real* net);
  bool looks() const { return cycle_ % refresh == 0; }
  bool is_here(const Point& p) const { return p.beneath.cell >= 0 && sheet_.has(p.beneath.cell); }
  bool answers_for(const Point& p) const { return ghost_.empty() || (is_here(p) && !ghost_[p.beneath.node[0]]); }

  contact::SheetUnder sheet_;
  std::vector<Point> points_;
  std::vector<double> cell_mass_;
  std::vector<int> own_cell_;  // of a part: numbers in the sheet of its shells
  std::vector<char> ghost_;    // of a part; empty: it is the whole sheet
  double work_ = 0.0;          // taken from the sheet [N mm]
  int cycle_ = 0;
};

PRESSWORK_DEVICE inline void BeadPoint::look_beneath(const contact::SheetSearch& sheet, const double* cell_mass,
                                                     double dt, const double* position, int stride) {
  sheet.find(place, position, stride, beneath);
  if (!beneath.inside) {
    stiffness = 1.0;
    for (double& each : beneath.weight) each = 0.0;
    for (double& each : direction) each = 0.0;
    return;
  }
  const double* n = beneath.normal;
  const double size = std::sqrt(contact::dot(n, n)), out = (across[0] * n[0] + across[1] * n[1]) / (size * size);
  const double d[3] = {across[0] - out * n[0], across[1] - out * n[1], -out * n[2]};
  const double whole = std::sqrt(contact::dot(d, d));
  for (int i = 0; i < 3; ++i) direction[i] = d[i] / whole;
  // |g1 x g2| is a quarter of a quadrilateral's area, and twice a triangle's
  const double area = beneath.corners == 4 ? 4.0 * size : 0.5 * size;
  stiffness = bead_penalty * 0.5 * cell_mass[beneath.cell] / (dt * dt) * length / std::sqrt(area);
}

template <class Real>
PRESSWORK_DEVICE double BeadPoint::hold(const Real* motion, int stride, const double* moved, double limit, double dt) {
  double slip = 0.0;
  for (int a = 0; a < beneath.corners; ++a) {
    const Real* v = motion + std::size_t(stride) * beneath.node[a];
    double along = 0.0;
    for (int i = 0; i < 3; ++i) along += direction[i] * v[i];
    slip += beneath.weight[a] * along;
  }
  if (moved) slip -= contact::dot(direction, moved);
  slip *= dt;
  const double now = smaller(larger(force - stiffness * slip, -limit), limit);
  const double work = 0.5 * (force + now) * slip;
  force = now;
  return work;
}

template <class Real>
void Drawbeads::look_beneath(Point& p, double dt, const SpaceNodes<Real>& nodes) const {
  p.look_beneath(sheet_.search(), cell_mass_.data(), dt, nodes.position.data(), SpaceNodes<Real>::position_stride);
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
    for (int j = 0; j < 3; ++j) net[6 * std::size_t(p.beneath.node[a]) + j] -= static_cast<Real>(p.push(a, j));
}

template <class Real>
void Drawbeads::look(double dt, const SpaceNodes<Real>& nodes) {
  for (Point& p : points_)
    if (looks() || p.beneath.cell < 0) look_beneath(p, dt, nodes);
}

template <class Real>
void Drawbeads::visit(int cycle, double dt, const SpaceNodes<Real>& nodes, const std::vector<Tool>* tools, Real* net) {
  ++cycle_;
  for (const Drawbead& bead : beads) {
    const double* moved = bead.tool >= 0 ? (*tools)[bead.tool].velocity : nullptr;
    for (int i = bead.first; i < bead.last; ++i) {
      Point& p = points_[i];
      if (!p.beneath.inside) {
        p.force = 0.0;
        continue;
      }
      const double limit = bead.share[cycle] * bead.force * p.length;
      const double work = p.hold(nodes.motion.data(), SpaceNodes<Real>::motion_stride, moved, limit, dt);
      if (answers_for(p)) work_ -= work;
      push(p, net);
    }
  }
}

}  // namespace presswork::explicit_dynamics
