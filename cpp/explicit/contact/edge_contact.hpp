// SPDX-License-Identifier: Apache-2.0
// Contact of the edges' inside with rigid tools, at places where a tool juts out too sharply for nodes alone.
//
// An edge is straight between its nodes, and so touches a convex tool at one place, x = (1 - s) x_a + s x_b, where its
// gap is least: normal.(x_b - x_a) = 0, or at a node. s is looked for when the surface is asked, and kept in between;
// half the thickness is interpolated, and force goes to the nodes in the parts 1 - s and s. Force, friction and damping
// are those of nodes (tool_contact.hpp) with `share` of the stiffness and with the edge's own mass, which is 2/n of the
// mass of each cell of n nodes that it bounds. So an edge that ends in a symmetry plane is as stiff as in the whole
// sheet, and one that lies in the plane is half as stiff.
//
// Step. The masses of the edges that end in a node add up to four times the node's mass, whatever the mesh. If all of
// them rest on a tool there, they add 4 share penalty/dt^2 to the node's own penalty/dt^2: with a second tool on the
// other side w^2 dt^2 <= (0.9 x 2)^2 + 3.6 penalty < 4 if penalty < 0.21.
//
// Search. A tool is sharp where it turns by more than SharpPlaces::turn within half the mean edge: there the edge would
// sink in by an eighth of its length L, be it over a corner of that angle or a radius of L. A tool without such places
// costs nothing. An edge sleeps until the tool's `travel` has grown by 0.9 of what it is off them: no part of it can
// have reached them before. Once pressed it stays awake until it lifts off. What nodes alone let it sink in before it
// came to a sharp place, some 1e-3 mm, is spared: no force starts with a jump.
//
// Those of a chunk that are awake are taken together into packs of SIMD width, in the order of their numbers; sums run
// over eight lanes whatever the width, as those of nodes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "contact/sharp_places.hpp"
#include "explicit/contact/edge_touch.hpp"
#include "explicit/lane_sums.hpp"
#include "explicit/state_field.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

class EdgeContact {
 public:
  static constexpr int chunk = 256;

  // The nodes of cell i, in turn round it, are cell_node[cell_start[i]] to cell_node[cell_start[i + 1] - 1]. length: of
  // the mean edge; memory: slip after which the surface is asked again; reach: how far away it is looked for [mm].
  EdgeContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node, double length,
              double memory, double reach);

  void add(const Tool& tool);
  // Count no edge whose first node is another part's.
  void leave_to_others(const std::vector<char>& is_left);
  // Whether a tool is sharp.
  bool needed() const { return needed_; }
  int n_edges() const { return static_cast<int>(edges_.size()) / 2; }
  int chunks() const { return needed_ ? (n_edges() + chunk - 1) / chunk : 0; }
  int node(int edge, int end) const { return edges_[2 * std::size_t(edge) + end]; }

  // Take the edges' masses from the cells' masses [t], and the step of the stiffness.
  void set_stiffness(const std::vector<double>& cell_mass, double dt);

  // Find the forces of a chunk of edges after a step of dt. half: thickness of the nodes as it is now [mm];
  // locate(node, x, v) gives a node's place and velocity.
  template <class Locate>
  void visit(int c, int first_tool, const std::vector<Tool>& tools, const double* half, double dt, Locate&& locate);
  // Whether an edge of these nodes has a force, and the force of its edges on one node, added.
  bool touches(int first_node, int last_node) const {
    const int from = node_start_[first_node], to = node_start_[last_node];
    return std::memchr(&bears_[from], 1, std::size_t(to - from)) != nullptr;
  }
  void add_to_node(int node, double force[3]) const {
    for (int i = node_start_[node]; i < node_start_[node + 1]; ++i)
      for (int k = 0; bears_[i] && k < 3; ++k) force[k] += force_[3 * std::size_t(i) + k];
  }
  ContactSums sum_up(int tool) const;

  // Energy in the springs of contact and of stick, summed over the edges of a tool.
  void add_stored(int tool, const Grip& grip, double& normal, double& shear) const;
  // All forces on nodes (n_nodes, 3), added.
  void add_forces(int tool, const Grip& grip, double* force) const;
  // Let go, or look again at, whatever a tool touches.
  void forget(int tool);
  void wake(int tool);
  // Depth of the edge deepest in a tool at its sharp places; edge is left alone where none is deeper than `worst`.
  template <class Locate>
  double deepest(int number, const Tool& tool, const double* half, double worst, Locate&& locate, int& edge) const;

  // What a device needs of edges, beside what they remember.
  struct Lent {
    const std::vector<int>&edges, &node_start, &end_slot;
    const std::vector<double>& base;
    double memory, reach, step;
  };
  Lent lend() const { return {edges_, node_start_, end_slot_, base_, memory_, reach_, step_}; }
  // Where a tool is sharp; null: nowhere. Then what the edges remember of it (n_edges), and wake.
  const contact::SharpPlaces* sharp(int tool) const { return pairs_[tool].sharp.get(); }
  const std::vector<EdgeTouching>& at(int tool) const { return pairs_[tool].at; }
  const std::vector<double>& wake_of(int tool) const { return pairs_[tool].wake; }
  void take(int tool, const EdgeTouching* at, const double* wake) {
    std::copy_n(at, n_edges(), pairs_[tool].at.begin());
    std::copy_n(wake, n_edges(), pairs_[tool].wake.begin());
    std::fill(pairs_[tool].wake_group.begin(), pairs_[tool].wake_group.end(), 0.0);
  }

  // What edges remember of a tool, added to the arrays of `owner`.
  void list_state(int tool, const std::string& owner, std::vector<StateField>& fields);

 private:
  static constexpr int width = pack_width, group = LaneSums::group;
  using Touching = EdgeTouching;
  static const double* records_of(const Touching& p) { return reinterpret_cast<const double*>(&p); }
  static double* records_of(Touching& p) { return reinterpret_cast<double*>(&p); }
  static constexpr int before_hints = 7;
  struct Pairs {
    std::unique_ptr<contact::SharpPlaces> sharp;  // none: these are empty
    // The tool's travel at which an edge may touch, filled up to whole groups; a bound of it for each group.
    std::vector<double> wake, wake_group;
    std::vector<Touching> at;
  };
  using Segment = EdgeSegment;
  // n edges for a pack, filled up with the last of them: places and velocities of their ends, their bases, half
  // thicknesses, and where they are kept.
  struct EdgePack {
    alignas(64) double x[2][width][4], v[2][width][4], base[width], half[2][width];
    const int* edge;
    Touching* pair[width];
    int n;
  };

  // The edges of a chunk that are awake; gives how many.
  int find_awake(int c, Pairs& of, double travel, int found[chunk + 1]) const;
  double stiffness(const Grip& grip, int edge) const { return edge_touch::share * grip.penalty * base_[edge]; }
  double half_at(const Grip& grip, const double* half, int edge, double s) const;
  void ask(const Tool& tool, Pairs& of, int edge, const Segment& seen, const double* half, int& lost) const;
  // Forces of a tool on a pack of edges, the first of which has a slot in the sums.
  void touch(const Tool& tool, Pairs& of, EdgePack& edges, const double* half, double dt, int slot, LaneSums& sums,
             std::vector<int>& bearing);
  // Give an edge a force at s.
  void give(int edge, double s, const double force[3], std::vector<int>& bearing);

  int n_nodes_;
  double length_, memory_, reach_;
  bool needed_ = false;
  double step_ = 0.0;
  std::vector<int> edges_;                   // (n_edges, 2)
  std::vector<int> cell_start_, cell_edge_;  // the edges of each cell
  std::vector<double> base_;                 // of edges: mass/dt^2 [N/mm]
  std::vector<int> node_start_,
      end_slot_;                           // of each node its ends of edges; of each end, 2 edge + end, its place there
  std::vector<double> force_;              // (ends, 3), by nodes
  std::vector<std::uint8_t> bears_;        // (ends), by nodes: whether it has a force
  std::vector<std::vector<int>> bearing_;  // of each chunk the edges that have one
  std::vector<Pairs> pairs_;               // of tools
  std::vector<double> counts_;             // of edges, or none: 0 where another part counts what it does
  std::vector<ContactSums> sums_;          // (chunks, tools)
};

template <class Locate>
void EdgeContact::visit(int c, int first_tool, const std::vector<Tool>& tools, const double* half, double dt,
                        Locate&& locate) {
  for (int edge : bearing_[c])
    bears_[end_slot_[2 * std::size_t(edge)]] = bears_[end_slot_[2 * std::size_t(edge) + 1]] = 0;
  bearing_[c].clear();
  for (std::size_t t = first_tool; t < tools.size(); ++t) {
    ContactSums& sum = sums_[std::size_t(c) * tools.size() + t] = {};
    if (!pairs_[t].sharp) continue;
    int awake[chunk + 1];
    const int n = find_awake(c, pairs_[t], tools[t].travel, awake);
    LaneSums sums;
    for (int i = 0; i < n; i += width) {
      EdgePack edges;
      edges.edge = awake + i, edges.n = std::min(width, n - i);
      for (int lane = 0; lane < width; ++lane) {
        const int edge = awake[std::min(i + lane, n - 1)];
        edges.pair[lane] = &pairs_[t].at[edge];
        for (int end = 0; end < 2; ++end) {
          locate(node(edge, end), edges.x[end][lane], edges.v[end][lane]);
          edges.half[end][lane] = half[node(edge, end)];
        }
        edges.base[lane] = base_[edge];
      }
      touch(tools[t], pairs_[t], edges, half, dt, i, sums, bearing_[c]);
    }
    if (n > 0) sum = sums.sum_up();
  }
}

template <class Locate>
double EdgeContact::deepest(int number, const Tool& tool, const double* half, double worst, Locate&& locate,
                            int& edge) const {
  const Pairs& of = pairs_[number];
  if (!of.sharp) return worst;
  for (int e = 0; e < n_edges(); ++e) {
    double a[4], b[4], v[4], s = 0.5;
    locate(node(e, 0), a, v), locate(node(e, 1), b, v);
    const Segment seen(a, b, tool.displacement);
    seen.locate(1.0, b);
    int sharp_hint = -1, hint = -1;
    const double in_middle = half_at(tool.grip, half, e, 0.5);  // it may have gone through
    if (of.sharp->distance(seen.start, b, 0.0, sharp_hint) > 0.5 * seen.length + in_middle + memory_) continue;
    contact::Touch found;
    if (!find_lowest(*tool.surface, EdgeSight{memory_, reach_}, seen, false, s, hint, found)) continue;
    const double depth = half_at(tool.grip, half, e, s) - found.gap;
    if (depth > worst) worst = depth, edge = e;
  }
  return worst;
}

}  // namespace presswork::explicit_dynamics
