// SPDX-License-Identifier: Apache-2.0
// Contact of explicit shells with rigid tools: penalty, Coulomb friction, the sheet's thickness.
//
// Points of contact are the nodes and, where a tool is sharp, places inside the edges (edge_contact.hpp). A point at
// distance d of the mid-surface from a tool is pressed in by p = t/2 - d > 0 and feels
//
//   N = k p + c p',  k = penalty m/dt^2,  c = 2 damping sqrt(k m),  never below zero, along the tool's normal,
//   T = T_n - k ds (tangential, relative to the tool), shortened to mu N: Coulomb with an elastic stick.
//
// m is the node's mass. As this is made of the mass the step stays stable: w^2 dt^2 <= (0.9 x 2)^2 + 2 penalty < 4 for
// a node between two tools, if penalty < 0.38.
//
// Ironing. Where two tools on opposite faces leave the sheet less room than it is thick, springs of the shells stand
// between its faces and the tools (squeezed_section.hpp): each of the two tools presses with their force,
//   Q = sum of spring (t - room) over the shells round the node,
// and of the penalty above only what centres the sheet is left, p less half of t - room. Tools are on opposite faces
// where the cosine of their normals is below -0.97: in a wider wedge the sheet is not squeezed.
//
// A tool that a force pushes leaves the sheet as much room as it needs. Its faces bear half the yield stress by the
// penalty alone, F on a node, and the springs begin to be compressed there: room is counted from the penetrations F/k
// on. They take that over as they grow, p = F/k - Q/(2k), so that from twice F on the sheet bears all of the force.
//
// Search. Beside the touch a pair of point and tool keeps the tangent plane there, and asks the surface anew after a
// slip s of 0.5 % of the thickness (on a radius R the plane is then off by s^2/2R), or of up to 10 % where it says that
// it is flat as far as that. A point off the tool sleeps until the
// tool's `travel`, the sum of the largest relative speeds times dt, has grown by 0.9 of its gap: before that no point
// can have reached the tool.
//
// Points are taken in packs of SIMD width; sums run over eight lanes whatever the width, chunk by chunk: they depend
// neither on it nor on the number of threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "explicit/contact/edge_contact.hpp"
#include "explicit/contact/node_touch.hpp"
#include "explicit/contact/tools.hpp"
#include "explicit/lane_sums.hpp"
#include "explicit/state_field.hpp"
#include "tensor/records.hpp"

namespace presswork::explicit_dynamics {

// What contact must know of the sheet in a cycle. thickness(cell) [mm], spring(cell) of a node that is squeezed [N/mm];
// dt is 0 where nothing has moved yet.
template <class Real, class Thickness, class Spring>
struct SheetView {
  const double* position;  // (n_nodes, 4)
  const Real* motion;      // (n_nodes, 8), velocity of the step that led here
  Thickness thickness;
  Spring spring;
  double dt;
};

class ToolContact {
 public:
  static constexpr int chunk = 256;         // points whose forces are summed up in one go
  static constexpr int refresh_cycles = 8;  // after which all points learn the thickness anew

  // The nodes of cell i, in turn round it, are cell_node[cell_start[i]] to cell_node[cell_start[i + 1] - 1]. The least
  // thickness, the largest width of a cell and the mean edge [mm] set what is near. bearing (n_cells): force on a node
  // up to which a pushed tool does not squeeze [N]; empty: no tool squeezes the sheet.
  ToolContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node, double thickness,
              double width, double edge, const std::vector<double>& bearing);

  void add(std::shared_ptr<const contact::ToolSurface> surface, const Grip& grip);
  // Leave nodes of another part of the mesh alone (neighbours.hpp), from now on: their thickness and room are set. An
  // edge is counted in the part of its first node. To be called before there are tools.
  // leads: the work and the kinetic energy of tools that forces place are counted here, not in another part.
  void leave_to_others(const std::vector<int>& nodes, const std::vector<char>& is_left, bool leads);
  double& half(int node) { return half_[node]; }
  double& room_at(int node) { return room_[node]; }
  // Take a tool away, with what its springs hold; the others keep their numbers.
  void remove(int tool);
  void place(int tool, const double displacement[3]);
  // Take stiffness from the nodes' and the cells' masses [t] and step; spring_ratio: of the cells' springs to what they
  // were.
  void set_stiffness(const std::vector<double>& node_mass, const std::vector<double>& cell_mass,
                     const std::vector<double>& spring_ratio, double dt);

  // Find the forces of tools that have been added since, at the present place: to be called before the first cycle.
  template <class View, class Real>
  void start(const View& sheet, Real* net);
  // One cycle: tools move (one thread; fastest: the largest speed of a node), then edges, then nodes are visited in
  // chunks, which takes the contact forces off net (n_nodes, 6), internal less external forces; then sums are closed.
  void move_tools(int cycle, double dt, double fastest);
  template <class View>
  void visit_edges(int c, const View& sheet, int first_tool = 0);
  template <class View, class Real>
  void visit_nodes(int c, const View& sheet, Real* net, int first_tool = 0);
  void close_cycle(int first_tool = 0);
  int node_chunks() const { return (n_nodes_ + chunk - 1) / chunk; }
  int edge_chunks() const { return edges_.chunks(); }

  ContactEnergies energies(double dt) const;
  // Where the energies in the springs of contact and of stick are known.
  ContactEnergies energies(double dt, double normal, double stuck) const;
  // Forces of the tools on the nodes (n_nodes, 3) [N], added.
  void add_forces(double* force) const;
  // Those of one tool.
  void add_forces_of(int tool, double* force) const;
  // Depth of the deepest point in a tool, and which it is: a node, or n_nodes + edge.
  template <class View>
  double deepest(int tool, const View& sheet, int& point) const;
  // A point that was pressed into a tool and then found out of its reach: it has gone through. -1: none.
  int lost() const { return total_.lost == std::numeric_limits<int>::max() ? -1 : total_.lost; }

  // Begin, with like tools and the stiffness of that step, as the contact of a sheet some shells of which are split
  // here. Pressure and traction of a node are means of those of its parents (n_nodes, 4).
  void inherit(const ToolContact& from, const int* parents);
  double step() const { return step_; }

  // All that contact remembers. It is to be written once the stiffness is that of its step.
  void list_state(std::vector<StateField>& fields);

  // Room between the tools at the nodes in the next cycle (n_nodes) [mm], infinite where two do not hold the sheet;
  // null without ironing.
  const double* room() const { return ironing_ ? room_.data() : nullptr; }

  int edge_node(int edge, int end) const { return edges_.node(edge, end); }
  int n_edges() const { return edges_.n_edges(); }

  // What a device needs of contact, beside tools and pairs, and what of it changes.
  struct Lent {
    bool ironing;
    double memory, near, reach, step;
    const std::vector<int>&node_start, &node_cell;
    const std::vector<double>&base, &bearing;
    std::vector<double>&half, &room, &held;
    ContactSums& sums;
    ToolWork& work;
    int& cycle;
    EdgeContact& edges;
  };
  Lent lend() {
    return {ironing_, memory_, awake_within_, reach_, step_,  node_start_, node_cell_, base_,
            bearing_, half_,   room_,         held_,  total_, work_,       cycle_,     edges_};
  }
  // What the nodes remember of a tool: rows of Touching (rows, n_nodes), and hints (n_nodes).
  static constexpr int pair_rows = sizeof(explicit_dynamics::Touching<double>) / sizeof(double);
  void copy_pairs(int tool, double* to, int* hint) const;
  void take_pairs(int tool, const double* from, const int* hint);

  std::vector<Tool> tools;

 private:
  static constexpr int width = pack_width, group = LaneSums::group;
  using Mask = Pack::Mask;

  using Touching = explicit_dynamics::Touching<Pack>;
  using Pinch = explicit_dynamics::Pinch<Pack>;
  static constexpr int rows = pair_rows;
  struct Pairs {
    std::vector<Touching> packs;
    std::vector<int> hint;     // of each slot
    std::vector<double> wake;  // of packs: until the tool's travel reaches it no lane is awake
    bool may_be_awake(std::size_t pack, double travel) const { return wake[pack] <= travel; }
    void let_sleep(std::size_t pack) {
      wake[pack] = packs[pack].wake[0];
      for (int lane = 1; lane < width; ++lane) wake[pack] = std::min(wake[pack], packs[pack].wake[lane]);
    }
    void look_again() { std::fill(wake.begin(), wake.end(), 0.0); }
  };
  // Slots: nodes, filled up to whole groups.
  static int fill(int n) { return (n + group - 1) / group * group; }
  double stiffness(int tool, int node) const { return tools[tool].grip.penalty * base_[node]; }
  double value(int tool, int node, const Pack Touching::* row) const {
    return (pairs_[tool].packs[node / width].*row)[node % width];
  }
  double shear_squared(int tool, int node) const;
  static Pack load(const std::vector<double>& from, int slot) {
    Pack x;
    for (int lane = 0; lane < width; ++lane) x.set(lane, from[slot + lane]);
    return x;
  }
  void open_chunk(int c, int first_tool) {
    for (std::size_t t = first_tool; t < tools.size(); ++t) sums_[c * tools.size() + t] = {};
  }

  void leave(int tool, int node);
  void list_tool(int tool, std::vector<StateField>& fields);
  void add_stored(double& normal, double& shear) const;
  template <class View>
  double half_thickness(int node, const View& sheet) const;
  // Place and velocity of a node.
  template <class View>
  static void locate(int node, const View& sheet, double x[4], double v[4]);  // the fourth: nothing
  // A pack of nodes from a slot on, against all tools; false where none of them may touch.
  template <class View>
  bool visit_pack(int slot, const View& sheet, int first_tool, int c, Pack on_sheet[3]);
  void set_half(int slot, const Pack& half);
  Pinch find_pinch(int slot, const Pack x[3], const Pack v[3], double dt) const;
  template <class View>
  void squeeze(int slot, int last, const View& sheet, Pinch& pinch);
  void follow(int tool, int slot, Mask awake, const Pack x[3], const Pack dx[3], LaneSums& sums);
  void touch(int tool, int slot, Mask awake, const Pack x[3], const Pack dx[3], double dt, const Pinch& pinch,
             LaneSums& sums, Pack on_sheet[3]);
  void ask(const Tool& tool, Pairs& of, int slot, int lane, const Pack place[3], LaneSums& sums) const;

  int n_nodes_;
  std::vector<int> node_start_, node_cell_;  // cells of each node
  std::vector<double> base_, half_;          // of slots: mass/dt^2 [N/mm], half the thickness [mm]
  std::vector<double> bearing_;              // of slots: force up to which a pushed tool does not squeeze [N]
  std::vector<double> room_, held_;          // of slots: between tools [mm], energy of squeezed shells' springs [N mm]
  std::vector<Pairs> pairs_;
  std::vector<LaneSums> sums_;  // (chunks, tools)
  ContactSums total_;
  bool ironing_;
  double memory_, awake_within_, reach_, step_ = 0.0;
  EdgeContact edges_;
  ToolWork work_;
  int started_ = 0, cycle_ = 0;
  std::vector<int> left_;  // nodes that are left to others
  bool leads_ = true;
};

template <class View>
double ToolContact::half_thickness(int node, const View& sheet) const {
  return explicit_dynamics::half_thickness(node_cell_.data() + node_start_[node],
                                           node_cell_.data() + node_start_[node + 1], sheet);
}

template <class View>
void ToolContact::locate(int node, const View& sheet, double x[4], double v[4]) {
  std::memcpy(x, sheet.position + 4 * std::size_t(node), 4 * sizeof(double));
  const auto* motion = sheet.motion + 8 * std::size_t(node);
  for (int i = 0; i < 4; ++i) v[i] = double(motion[i]);
}

template <class View>
void ToolContact::squeeze(int slot, int last, const View& sheet, Pinch& pinch) {
  pinch.force = Pack(0.0);
  for (int lane = 0; lane < width; ++lane) room_[slot + lane] = pinch.next[lane], held_[slot + lane] = 0.0;
  for (int node = slot; node <= last; ++node) {
    const double room = pinch.room[node - slot];
    if (room == std::numeric_limits<double>::infinity()) continue;
    const Squeeze found =
        squeeze_node(node_cell_.data() + node_start_[node], node_cell_.data() + node_start_[node + 1], room, sheet);
    pinch.force.set(node - slot, found.force), held_[node] = found.energy;
  }
}

template <class View>
bool ToolContact::visit_pack(int slot, const View& sheet, int first_tool, int c, Pack on_sheet[3]) {
  const int last = std::min(slot + width, n_nodes_) - 1;
  if (cycle_ % refresh_cycles == 0) {  // all at once: nothing may depend on the nodes' numbers
    Pack half(0.0);
    for (int s = slot; s <= last; ++s) half.set(s - slot, half_thickness(s, sheet));
    set_half(slot, half);
  }
  for (int i = 0; i < 3; ++i) on_sheet[i] = Pack(0.0);
  bool located = false;
  int n_awake = 0;
  Pack x[4], v[4];
  Pinch pinch;
  pinch.excess = pinch.force = pinch.borne = Pack(0.0), pinch.tool[0] = pinch.tool[1] = Pack(-1.0);
  pinch.room = pinch.next = Pack(std::numeric_limits<double>::infinity());
  const std::size_t pack = slot / width, ahead = std::min<std::size_t>(pack + 2, (n_nodes_ - 1) / width);
  const auto is_awake = [&](std::size_t t) { return pairs_[t].packs[pack].wake.v <= Pack(tools[t].travel).v; };
  const auto way_on = [&](std::size_t t, Pack dx[3]) {
    for (int i = 0; i < 3; ++i) dx[i] = Pack(sheet.dt) * (v[i] - Pack(tools[t].velocity[i]));
  };
  Pack dx[3];
  for (std::size_t t = first_tool; t < tools.size(); ++t) {
    Pairs& of = pairs_[t];
    if (of.may_be_awake(ahead, tools[t].travel))
      for (int line = 0; line < static_cast<int>(sizeof(Touching) / 64); ++line)
        __builtin_prefetch(reinterpret_cast<const char*>(&of.packs[ahead]) + 64 * line, 1);
    if (!of.may_be_awake(pack, tools[t].travel)) continue;
    const Mask awake = is_awake(t);
    if (!any(awake)) {
      of.let_sleep(pack);
      continue;
    }
    if (!located) {
      alignas(64) double at[2][width][4];
      const double *places[width], *speeds[width];
      for (int lane = 0; lane < width; ++lane) {
        const int node = std::min(slot + lane, last);
        if constexpr (std::is_same_v<decltype(sheet.motion), const double*>) {
          places[lane] = sheet.position + 4 * std::size_t(node);
          speeds[lane] = sheet.motion + 8 * std::size_t(node);
        } else {
          locate(node, sheet, at[0][lane], at[1][lane]);
          places[lane] = at[0][lane], speeds[lane] = at[1][lane];
        }
      }
      load_records<4>(places, x), load_records<4>(speeds, v);
      located = true;
    }
    ++n_awake;
    way_on(t, dx);
    follow(static_cast<int>(t), slot, awake, x, dx, sums_[c * tools.size() + t]);
  }
  if (located) {
    if (ironing_ && n_awake + first_tool > 1) pinch = find_pinch(slot, x, v, sheet.dt);
    if (ironing_) squeeze(slot, last, sheet, pinch);
    for (std::size_t t = first_tool; t < tools.size(); ++t) {
      if (!pairs_[t].may_be_awake(pack, tools[t].travel)) continue;
      const Mask awake = is_awake(t);
      if (!any(awake)) continue;
      way_on(t, dx);
      touch(static_cast<int>(t), slot, awake, x, dx, sheet.dt, pinch, sums_[c * tools.size() + t], on_sheet);
    }
  }
  if (ironing_ && !located)
    for (int lane = 0; lane < width; ++lane)
      room_[slot + lane] = std::numeric_limits<double>::infinity(), held_[slot + lane] = 0.0;
  return located;
}

template <class View>
void ToolContact::visit_edges(int c, const View& sheet, int first_tool) {
  edges_.visit(c, first_tool, tools, half_.data(), sheet.dt,
               [&](int node, double x[4], double v[4]) { locate(node, sheet, x, v); });
}

template <class View, class Real>
void ToolContact::visit_nodes(int c, const View& sheet, Real* net, int first_tool) {
  open_chunk(c, first_tool);
  for (int first = c * chunk; first < std::min(n_nodes_, (c + 1) * chunk); first += width) {
    Pack on_sheet[3];
    const int last = std::min(n_nodes_, first + width);
    const bool touches = visit_pack(first, sheet, first_tool, c, on_sheet);
    const bool edges_touch = edges_.needed() && edges_.touches(first, last);
    if (!touches && !edges_touch) continue;
    for (int node = first; node < last; ++node) {
      double force[3];
      for (int i = 0; i < 3; ++i) force[i] = on_sheet[i][node - first];
      if (edges_touch) edges_.add_to_node(node, force);
      for (int i = 0; i < 3; ++i) net[6 * std::size_t(node) + i] -= static_cast<Real>(force[i]);
    }
  }
}

template <class View, class Real>
void ToolContact::start(const View& sheet, Real* net) {
  const int first = started_;
  if (first == static_cast<int>(tools.size())) return;
  if (first == 0)
    for (int node = 0; node < n_nodes_; ++node) half_[node] = half_thickness(node, sheet);
  started_ = static_cast<int>(tools.size());
  for (int c = 0; c < edge_chunks(); ++c) visit_edges(c, sheet, first);
  for (int c = 0; c < node_chunks(); ++c) visit_nodes(c, sheet, net, first);
  close_cycle(first);
}

template <class View>
double ToolContact::deepest(int tool, const View& sheet, int& point) const {
  double worst = 0.0;
  std::vector<double> half(n_nodes_);
  for (int i = 0; i < n_nodes_; ++i) {
    half[i] = half_thickness(i, sheet);
    if (!(base_[i] > 0.0)) continue;
    double x[4], v[4];
    locate(i, sheet, x, v);
    for (int k = 0; k < 3; ++k) x[k] -= tools[tool].displacement[k];
    int hint = -1;
    contact::Touch found;
    if (!tools[tool].surface->nearest(x, reach_, hint, found)) continue;
    const double depth = (tools[tool].grip.thickness ? half[i] : 0.0) - found.gap;
    if (depth > worst) worst = depth, point = i;
  }
  int edge = -1;
  worst = edges_.deepest(
      tool, tools[tool], half.data(), worst, [&](int node, double x[4], double v[4]) { locate(node, sheet, x, v); },
      edge);
  if (edge >= 0) point = n_nodes_ + edge;
  return worst;
}

}  // namespace presswork::explicit_dynamics
