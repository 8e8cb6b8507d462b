// SPDX-License-Identifier: Apache-2.0
// Rigid tools in a cycle with a lane a thread: four passes more.
//
//   start_tools   one lane: tools move, by the largest speed of a node
//   touch_edges   one edge against all tools that are sharp for the mesh: its lowest place, pressure and friction,
//   which
//                 wait at its ends for the nodes
//   touch_tools   one node against all tools, when its shells have their forces: its tangent planes, pressure,
//                 friction and squeeze, taken off its internal force
//   close_tools   one lane: the sheet's forces on the tools, and what is summed up
//
// The arithmetic is that of the CPU's loop (explicit/contact/node_touch.hpp, tools.hpp). Sums over the nodes are taken
// by chunks of 256 nodes, in a fixed order.
#pragma once

#include "contact/sharp_search.hpp"
#include "contact/smooth_search.hpp"
#include "explicit/contact/edge_touch.hpp"
#include "explicit/lane_sums.hpp"

namespace presswork::device {

using explicit_dynamics::ContactSums;
using explicit_dynamics::RigidTool;
using explicit_dynamics::ToolWork;

inline constexpr int chunk = 256;         // nodes whose sums are one
inline constexpr int refresh_cycles = 8;  // as ToolContact's

// Where a tool's surface lies in the memory of the device.
struct Surface {
  bool is_swept;
  contact::SmoothSearch smooth;  // of triangles that are rounded off; without patches they are not
  contact::SweptSearch swept;
  contact::TriangleSearch<contact::eights::OneByOne> triangles;

  [[gnu::noinline]] PRESSWORK_DEVICE bool nearest(const double x[3], double reach, int& hint,
                                                  contact::Touch& touch) const {
    if (is_swept) return swept.nearest(x, reach, hint, touch);
    if (smooth.patches) return smooth.nearest(triangles, x, reach, hint, touch, nullptr);
    return triangles.nearest(x, reach, hint, touch);
  }
};

// A tool that is sharp for the mesh, and edges. `tools` numbers it among all.
struct SharpTool {
  int number;
  contact::SharpSearch sharp;
};

// Edges of the sheet. An end of an edge has a slot; those of a node follow each other.
struct Edges {
  int n = 0, n_sharp = 0;  // no tool is sharp: nothing else is set
  double memory, reach, step;
  const int *node, *end_slot;           // (n, 2)
  const int* first_slot;                // (n_nodes + 1)
  const double* base;                   // (n): mass/dt^2
  const SharpTool* sharp;               // (n_sharp)
  explicit_dynamics::EdgeTouching* at;  // (n_sharp, n)
  double* wake;                         // (n_sharp, n)
  double* force;                        // (2 n, 3): on the sheet at each slot
  std::uint8_t* bears;                  // (2 n): whether there is one
  ContactSums* sums;                    // (chunks, n_sharp)

  PRESSWORK_DEVICE int chunks() const { return n_sharp > 0 ? (n + chunk - 1) / chunk : 0; }
};

struct Totals {
  ContactSums sums;
  ToolWork work;
};

using Pair = explicit_dynamics::Touching<double>;
inline constexpr int pair_rows = sizeof(Pair) / sizeof(double);

// All tools and what the nodes remember of them.
struct Tools {
  int n = 0;             // no tools: nothing else is set
  bool ironing = false;  // tools squeeze the sheet
  double memory, near, reach, step;
  RigidTool* tool;               // (n)
  const Surface* surface;        // (n)
  const double* drive;           // (cycles, n, 3): velocity, or force of a pushed one
  double* pairs;                 // (n, pair_rows, n_nodes)
  int* hint;                     // (n, n_nodes)
  const double *base, *bearing;  // (n_nodes): mass/dt^2; force up to which a pushed tool does not squeeze
  double *half, *room, *held;    // (n_nodes)
  const int *first_cell, *cell;  // cells round each node: quadrilaterals are numbered first
  double* fastest;               // (chunks): squares of the largest speeds
  ContactSums* sums;             // (chunks, n)
  Totals* totals;                // one
  Edges edges;
};

// One lane, when the nodes have moved; cycle: of the call.
PRESSWORK_DEVICE inline void start_tools(const Tools& tools, double dt, int cycle, double fastest) {
  explicit_dynamics::move_tools(
      tools.n, [&](int t) -> RigidTool& { return tools.tool[t]; },
      [&](int t) { return tools.drive + 3 * (std::size_t(tools.n) * cycle + t); }, dt, std::sqrt(fastest),
      tools.totals->work, tools.totals->work);
}

// One lane: sum, what all nodes together have of tool t.
PRESSWORK_DEVICE inline void close_tool(const Tools& tools, int t, const ContactSums& sum) {
  for (int i = 0; i < 3; ++i) tools.tool[t].force[i] = -sum.force[i];
  tools.totals->sums += sum;
}

// One edge. take(j, sums) is called once for every sharp tool, whatever the edge does, and with `there` false, of lanes
// beyond the last edge.
template <class Real, class Take>
PRESSWORK_INLINE void touch_edges(const Tools& tools, int n_nodes, const double* position, const Real* motion,
                                  double dt, int edge, bool there, const Take& take) {
  const Edges& edges = tools.edges;
  double force[2][3] = {}, x[2][3] = {}, v[2][3] = {};
  bool bears = false, located = false;
  for (int j = 0; j < edges.n_sharp; ++j) {
    ContactSums sums;
    const int t = edges.sharp[j].number;
    const RigidTool& tool = tools.tool[t];
    const std::size_t pair = std::size_t(j) * edges.n + edge;
    if (there && edges.wake[pair] <= tool.travel) {
      explicit_dynamics::EdgePress<double> p;
      explicit_dynamics::EdgeTouching& kept = edges.at[pair];
      for (int end = 0; end < 2; ++end) {
        const std::size_t node = edges.node[2 * std::size_t(edge) + end];
        for (int k = 0; k < 3; ++k) {
          if (!located) x[end][k] = position[4 * node + k], v[end][k] = motion[8 * node + k];
          p.moved[end][k] = dt * (v[end][k] - tool.velocity[k]);
        }
        p.half[end] = tool.grip.thickness ? tools.half[node] : 0.0;
      }
      located = true;
      p.base = edges.base[edge];
      for (int k = 0; k < 3; ++k) p.start[k] = x[0][k] - tool.displacement[k], p.way[k] = x[1][k] - x[0][k];
      const auto load = [&] {
        const auto* record = reinterpret_cast<const double*>(&kept);
        for (int i = 0; i < 8; ++i) p.asked[i] = i < 7 ? record[i] : 0.0, p.changing[i] = record[8 + i];
      };
      load();
      p.left() -= p.slip();
      bool awake = true;
      if (p.left() <= 0.0 || p.turn() > 0.1 * edges.memory) {
        const explicit_dynamics::EdgeSegment seen(x[0], x[1], tool.displacement);
        if (!explicit_dynamics::ask_edge(tools.surface[t], edges.sharp[j].sharp, {edges.memory, edges.reach},
                                         tool.travel, seen, p.half, kept, edges.wake[pair]))
          sums.lost = n_nodes + edge;
        awake = edges.wake[pair] <= tool.travel;
        load();
      }
      if (awake) {
        double squeeze, depth;
        bool on;
        const auto found = p.press(tool.grip, true, explicit_dynamics::edge_damper(tool.grip, edges.step, dt),
                                   edges.memory, squeeze, on, depth);
        if (depth < -edges.memory)
          edges.wake[pair] = tool.travel - explicit_dynamics::reach_awake * depth, kept.seen = kept.near;
        auto* record = reinterpret_cast<double*>(&kept);
        for (int i = 0; i < 8; ++i) record[8 + i] = p.changing[i];
        sums.squeeze = squeeze, sums.damping = found.damping, sums.friction = found.friction;
        for (int k = 0; k < 3; ++k) sums.force[k] = found.force[k];
        if (on)
          for (int k = 0; k < 3; ++k) {
            force[0][k] += (1.0 - p.asked[0]) * found.force[k];
            force[1][k] += p.asked[0] * found.force[k];
          }
        bears = bears || on;
      }
    }
    take(j, sums);
  }
  if (!there) return;
  for (int end = 0; end < 2; ++end) {
    const int slot = edges.end_slot[2 * std::size_t(edge) + end];
    if (bears)
      for (int k = 0; k < 3; ++k) edges.force[3 * std::size_t(slot) + k] = force[end][k];
    if (bool(edges.bears[slot]) != bears) edges.bears[slot] = bears;
  }
}

// One node; sheet: as SheetView; cycle: of those since contact began. take(t, sums) is called once for every tool,
// whatever the node does, and with `there` false, of lanes beyond the last node.
template <class Real, class Sheet, class Take>
PRESSWORK_INLINE void touch_tools(const Tools& tools, std::size_t n_nodes, const double* position, const Real* motion,
                                  Real* net, const Sheet& sheet, double dt, int cycle, int node, bool there,
                                  const Take& take) {
  constexpr int rows = pair_rows;
  const bool renewed = there && cycle % refresh_cycles == 0;
  const auto load = [&](int t) {
    Pair pair;
    auto* to = reinterpret_cast<double*>(&pair);
    for (int r = 0; r < rows; ++r) to[r] = tools.pairs[(std::size_t(t) * rows + r) * n_nodes + node];
    return pair;
  };
  const auto store = [&](int t, const Pair& pair) {
    const auto* from = reinterpret_cast<const double*>(&pair);
    for (int r = 0; r < rows; ++r) tools.pairs[(std::size_t(t) * rows + r) * n_nodes + node] = from[r];
  };
  const auto is_awake = [&](int t) {
    return there && tools.pairs[(std::size_t(t) * rows + rows - 1) * n_nodes + node] <= tools.tool[t].travel;
  };
  const int *cell = nullptr, *last_cell = nullptr;
  double before = 0.0, half = 0.0, x[3] = {}, v[3] = {};
  if (there) {
    cell = tools.cell + tools.first_cell[node], last_cell = tools.cell + tools.first_cell[node + 1];
    before = half = tools.half[node];
    if (renewed) tools.half[node] = half = explicit_dynamics::half_thickness(cell, last_cell, sheet);
    for (int i = 0; i < 3; ++i) x[i] = position[4 * std::size_t(node) + i], v[i] = motion[8 * std::size_t(node) + i];
  }
  const auto see = [&](int t, double place[3], double dx[3]) {
    for (int i = 0; i < 3; ++i) {
      place[i] = x[i] - tools.tool[t].displacement[i];
      dx[i] = dt * (v[i] - tools.tool[t].velocity[i]);
    }
  };
  double place[3], dx[3];
  // 1. tangent planes, asked for anew where the node has slipped on
  bool located = false;
  int lost = std::numeric_limits<int>::max();
  for (int t = 0; t < tools.n; ++t) {
    if (!is_awake(t)) continue;
    located = true;
    Pair pair = load(t);
    see(t, place, dx);
    pair.left -= explicit_dynamics::measure_slip(pair.normal, dx);
    if (pair.left <= 0.0 &&
        !explicit_dynamics::take_plane(tools.surface[t], place, tools.reach, tools.memory, half,
                                       tools.hint[t * n_nodes + node], pair.normal, pair.offset, pair.left) &&
        pair.pressed > 0.0)
      lost = node;
    store(t, pair);
  }
  // 2. two tools that hold the node from opposite faces
  explicit_dynamics::Pinch<double> pinch{{-1.0, -1.0}, 0.0, 0.0, 0.0, 0.0, 0.0};
  if (tools.ironing && there) {
    explicit_dynamics::Squeeze squeeze;
    double next = std::numeric_limits<double>::infinity();
    if (located) {
      pinch = explicit_dynamics::find_pinch(
          tools.n, [&](int t) -> const RigidTool& { return tools.tool[t]; }, load, x, v, half, tools.base[node],
          tools.bearing[node], dt);
      if (pinch.room < 1e300) squeeze = explicit_dynamics::squeeze_node(cell, last_cell, pinch.room, sheet);
      pinch.force = squeeze.force, next = pinch.next;
    }
    tools.room[node] = next, tools.held[node] = squeeze.energy;
  }
  // 3. forces
  double on_sheet[3] = {0.0, 0.0, 0.0};
  for (int t = 0; t < tools.n; ++t) {
    const explicit_dynamics::Grip& grip = tools.tool[t].grip;
    ContactSums sums;
    const bool awake = is_awake(t);
    if (awake) {
      Pair pair = load(t);
      if (renewed && grip.thickness)
        sums.squeeze = explicit_dynamics::press_thicker(grip.penalty, tools.base[node], pair.pressed,
                                                        pair.pressed > 0.0 && !(pair.squeezed > 0.0), half, before);
      see(t, place, dx);
      const auto found = explicit_dynamics::press(
          tools.tool[t], double(t), true, place, dx, grip.thickness ? half : 0.0, tools.base[node],
          explicit_dynamics::damper(grip, tools.step, dt), tools.near, pinch, pair, on_sheet);
      store(t, pair);
      sums.damping = found.damping, sums.friction = found.friction, sums.squeeze += found.squeeze;
      for (int i = 0; i < 3; ++i) sums.force[i] = found.force[i];
    }
    if (t == tools.n - 1) sums.lost = lost;
    take(t, sums);
  }
  if (there && tools.edges.n_sharp > 0)
    for (int slot = tools.edges.first_slot[node]; slot < tools.edges.first_slot[node + 1]; ++slot) {
      if (!tools.edges.bears[slot]) continue;
      located = true;
      for (int i = 0; i < 3; ++i) on_sheet[i] += tools.edges.force[3 * std::size_t(slot) + i];
    }
  if (!located) return;
  for (int i = 0; i < 3; ++i) net[6 * std::size_t(node) + i] -= static_cast<Real>(on_sheet[i]);
}

}  // namespace presswork::device
