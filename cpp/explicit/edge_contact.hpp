// SPDX-License-Identifier: Apache-2.0
// Contact of the edges' inside with rigid tools, at places where a tool juts out too sharply for nodes alone.
//
// An edge is straight between its nodes, and so touches a convex tool at one place, x = (1 - s) x_a + s x_b, where its
// gap is least: normal.(x_b - x_a) = 0, or at a node. s is looked for when the surface is asked, and kept in between;
// half the thickness is interpolated, and force goes to the nodes in the parts 1 - s and s. Force, friction and damping
// are those of nodes (tool_contact.hpp) with the smaller of the nodes' masses and `share` of the stiffness.
//
// Step. Four edges that end in a node and rest on a tool there add 4 share penalty/dt^2 to the node's own penalty/dt^2:
// with a second tool on the other side w^2 dt^2 <= (0.9 x 2)^2 + 3.6 penalty < 4 if penalty < 0.21.
//
// Search. A tool is sharp where it turns by more than `turn` within half the longest edge: there the edge would sink in
// by an eighth of its length L, be it over a corner of that angle or a radius of L. A tool without such places costs
// nothing. An edge sleeps until the tool's `travel` has grown by 0.9 of what it is off them: no part of it can have
// reached them before. Once pressed it stays awake until it lifts off. What nodes alone let it sink in before it came
// to a sharp place, some 1e-3 mm, is spared: no force starts with a jump.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "contact/sharp_places.hpp"
#include "explicit/tools.hpp"

namespace presswork::explicit_dynamics {

class EdgeContact {
 public:
  static constexpr int chunk = 256;
  static constexpr double share = 0.4;                // of a node's stiffness
  static constexpr double turn = 0.5053605102841573;  // 29 degrees: 2 asin(1/4)

  // The nodes of cell i, in turn round it, are cell_node[cell_start[i]] to cell_node[cell_start[i + 1] - 1]. length: of
  // the longest edge; memory: slip after which the surface is asked again; reach: how far away it is looked for [mm].
  EdgeContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node, double length,
              double memory, double reach);

  void add(const Tool& tool);
  bool any() const { return any_; }
  int n_edges() const { return static_cast<int>(edges_.size()) / 2; }
  int chunks() const { return any_ ? (n_edges() + chunk - 1) / chunk : 0; }
  int node(int edge, int end) const { return edges_[2 * std::size_t(edge) + end]; }

  // Nodes as they are now: of node i the half thickness and the base of stiffness, mass/dt^2 with the step dt.
  struct Nodes {
    const double *half, *base;
    double step;
  };
  // Ends of an edge: positions and velocities.
  struct Ends {
    double x[2][4], v[2][4];
  };
  struct Sums {
    double friction = 0.0, damping = 0.0, squeeze = 0.0, force[3] = {};
    int lost = std::numeric_limits<int>::max();
  };

  // Find the forces of a chunk of edges after a step of dt. locate(node, x, v) gives a node's place and velocity.
  template <class Locate>
  void visit(int c, int first_tool, const std::vector<Tool>& tools, const Nodes& nodes, double dt, Locate&& locate);
  // Whether an edge of these nodes may have a force, and the force of its edges on one node, added.
  bool touches(int node_chunk) const;
  void add_to_node(int node, double force[3]) const;
  Sums sum_up(int tool) const;

  // Energy in the springs of contact and of stick, summed over the edges of a tool.
  void add_stored(int tool, const Grip& grip, const Nodes& nodes, double& normal, double& shear) const;
  // All forces on nodes (n_nodes, 3), added.
  void add_forces(int tool, const Grip& grip, const Nodes& nodes, double* force) const;
  // Let go, or look again at, whatever a tool touches.
  void forget(int tool);
  void wake(int tool);
  // Depth of the edge deepest in a tool at its sharp places; edge is left alone where none is deeper than `worst`.
  template <class Locate>
  double deepest(int number, const Tool& tool, const Nodes& nodes, double worst, Locate&& locate, int& edge) const;

  std::size_t dump_size() const;
  void dump(int tool, std::vector<double>& to) const;
  void restore(int tool, const double*& from);

 private:
  struct Touching {
    double s, normal[3], offset, shear[3];
    double tilt;     // normal.(x_b - x_a) then
    double left;     // slip until the surface is asked again [mm]
    double pressed;  // [mm]; 0 off the tool
    double viscous;  // [N]
    double half;     // thickness at s when it was pressed [mm]
    double spared;   // depth at which it came to them [mm]
    double seen;     // what is known of it, see below
  };
  // Off the sharp places; near them, but off the tool; awake, s followed from ask to ask.
  static constexpr double off = 0.0, near = 1.0, followed = 2.0;
  static constexpr int rows = sizeof(Touching) / sizeof(double);
  struct Pairs {
    std::unique_ptr<contact::SharpPlaces> sharp;  // none: these are empty
    std::vector<double> wake;                     // the tool's travel at which the edge may touch
    std::vector<Touching> at;
    std::vector<int> hint, sharp_hint;
  };
  // An edge in a tool's frame.
  struct Segment {
    double start[3], way[3], length;
  };

  static Segment see(const Tool& tool, const Ends& ends);
  double stiffness(const Grip& grip, const Nodes& nodes, int edge) const;
  double half_at(const Grip& grip, const Nodes& nodes, int edge, double s) const;
  bool find_lowest(const contact::ToolSurface& surface, const Segment& edge, bool known, double& s, int& hint,
                   contact::Touch& found) const;
  void ask(const Tool& tool, Pairs& of, int edge, const Segment& seen, const Nodes& nodes, Sums& sums) const;
  void touch(const Tool& tool, Pairs& of, int edge, const Ends& ends, const Nodes& nodes, double dt, Sums& sums,
             double force[3]);

  int n_nodes_;
  double length_, memory_, reach_;
  bool any_ = false;
  std::vector<int> edges_;                  // (n_edges, 2)
  std::vector<int> node_start_, node_end_;  // of each node: 2 edge + end
  std::vector<int> near_start_, near_;      // chunks of edges that share nodes with a chunk of nodes
  std::vector<double> force_;               // (n_edges, 2, 3)
  std::vector<std::uint8_t> touches_;       // of chunks
  std::vector<Pairs> pairs_;                // of tools
  std::vector<Sums> sums_;                  // (chunks, tools)
};

template <class Locate>
void EdgeContact::visit(int c, int first_tool, const std::vector<Tool>& tools, const Nodes& nodes, double dt,
                        Locate&& locate) {
  const int first = c * chunk, last = std::min(n_edges(), first + chunk);
  if (touches_[c])
    std::fill(force_.begin() + 6 * std::ptrdiff_t(first), force_.begin() + 6 * std::ptrdiff_t(last), 0.0);
  touches_[c] = 0;
  for (std::size_t t = first_tool; t < tools.size(); ++t) {
    Pairs& of = pairs_[t];
    Sums& sums = sums_[std::size_t(c) * tools.size() + t] = {};
    if (!of.sharp) continue;
    for (int e = first; e < last; ++e) {
      if (of.wake[e] > tools[t].travel) continue;
      Ends ends;
      for (int i = 0; i < 2; ++i) locate(node(e, i), ends.x[i], ends.v[i]);
      double force[3] = {};
      touch(tools[t], of, e, ends, nodes, dt, sums, force);
      if (!(of.at[e].pressed > 0.0)) continue;
      touches_[c] = 1;
      for (int k = 0; k < 3; ++k) {
        force_[6 * std::size_t(e) + k] += (1.0 - of.at[e].s) * force[k];
        force_[6 * std::size_t(e) + 3 + k] += of.at[e].s * force[k];
      }
    }
  }
}

template <class Locate>
double EdgeContact::deepest(int number, const Tool& tool, const Nodes& nodes, double worst, Locate&& locate,
                            int& edge) const {
  const Pairs& of = pairs_[number];
  if (!of.sharp) return worst;
  for (int e = 0; e < n_edges(); ++e) {
    Ends ends;
    for (int i = 0; i < 2; ++i) locate(node(e, i), ends.x[i], ends.v[i]);
    const Segment seen = see(tool, ends);
    double middle[3], s = 0.5;
    for (int k = 0; k < 3; ++k) middle[k] = seen.start[k] + 0.5 * seen.way[k];
    int sharp_hint = -1, hint = -1;
    const double half = half_at(tool.grip, nodes, e, 0.5);
    if (of.sharp->distance(middle, sharp_hint) > 0.5 * seen.length + half + memory_) continue;
    contact::Touch found;
    if (!find_lowest(*tool.surface, seen, false, s, hint, found)) continue;
    const double depth = half_at(tool.grip, nodes, e, s) - found.gap;
    if (depth > worst) worst = depth, edge = e;
  }
  return worst;
}

}  // namespace presswork::explicit_dynamics
