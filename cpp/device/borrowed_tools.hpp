// SPDX-License-Identifier: Apache-2.0
// Rigid tools and drawbeads of a loop as a device takes them, and what goes back into the loop.
#pragma once

#include "device/cycle.hpp"
#include "explicit/contact/tool_contact.hpp"

namespace presswork::device {

using explicit_dynamics::Tool;
using explicit_dynamics::ToolContact;

// Tools of a loop as a device takes them, and what it changes.
struct BorrowedTools {
  ToolContact* contact = nullptr;  // none: no tools
  std::vector<RigidTool> tool;
  std::vector<Surface> surface;
  std::vector<double> drive, pairs;
  std::vector<int> hint;
  Totals totals;
  std::vector<SharpTool> sharp;
  std::vector<explicit_dynamics::EdgeTouching> at_edges;
  std::vector<double> wake_edges;
  std::vector<std::uint8_t> bears;
  Tools view{};

  void take(ToolContact& from, int n_nodes) {
    contact = &from;
    const auto lent = from.lend();
    const std::size_t n = from.tools.size(), nodes = n_nodes, rows = pair_rows;
    drive.assign(3 * n * most_cycles, 0.0), pairs.resize(n * rows * nodes), hint.resize(n * nodes);
    for (std::size_t t = 0; t < n; ++t) {
      const Tool& own = from.tools[t];
      tool.push_back(own);
      surface.push_back(see(*own.surface));
      from.copy_pairs(static_cast<int>(t), &pairs[t * rows * nodes], &hint[t * nodes]);
    }
    totals = {lent.sums, lent.work};
    view = {static_cast<int>(n),
            lent.ironing,
            lent.memory,
            lent.near,
            lent.reach,
            lent.step,
            tool.data(),
            surface.data(),
            drive.data(),
            pairs.data(),
            hint.data(),
            lent.base.data(),
            lent.bearing.data(),
            lent.half.data(),
            lent.room.data(),
            lent.held.data(),
            lent.node_start.data(),
            lent.node_cell.data(),
            nullptr,
            nullptr,
            &totals,
            see_edges(lent.edges, n)};
  }
  Edges see_edges(const explicit_dynamics::EdgeContact& from, std::size_t n_tools) {
    for (std::size_t t = 0; t < n_tools; ++t) {
      const int number = static_cast<int>(t);
      if (!from.sharp(number)) continue;
      sharp.push_back({number, from.sharp(number)->search()});
      at_edges.insert(at_edges.end(), from.at(number).begin(), from.at(number).end());
      wake_edges.insert(wake_edges.end(), from.wake_of(number).begin(), from.wake_of(number).begin() + from.n_edges());
    }
    if (sharp.empty()) return {};
    const auto lent = from.lend();
    const std::size_t edges = from.n_edges();
    bears.assign(2 * edges, 0);
    return {from.n_edges(),
            static_cast<int>(sharp.size()),
            lent.memory,
            lent.reach,
            lent.step,
            lent.edges.data(),
            lent.end_slot.data(),
            lent.node_start.data(),
            lent.base.data(),
            sharp.data(),
            at_edges.data(),
            wake_edges.data(),
            nullptr,
            bears.data(),
            nullptr};
  }
  // What drives them in cycles [first, first + n) of a call.
  void drive_in(int first, int n) {
    const std::size_t n_tools = tool.size();
    for (std::size_t t = 0; t < n_tools; ++t) {
      const Tool& own = contact->tools[t];
      const std::size_t each = own.pushed ? 1 : 3;
      for (std::size_t i = 0; i < each * n && !own.removed; ++i)
        drive[3 * (n_tools * (i / each) + t) + i % each] = own.drive[each * first + i];
    }
  }
  // Of each tool and in all.
  void give_back() const {
    const auto lent = contact->lend();
    lent.sums = totals.sums, lent.work = totals.work;
    for (std::size_t t = 0; t < tool.size(); ++t) static_cast<RigidTool&>(contact->tools[t]) = tool[t];
  }
  // What nodes and edges remember.
  void give_back_pairs(int n_nodes) const {
    const auto lent = contact->lend();
    for (std::size_t t = 0; t < tool.size(); ++t)
      contact->take_pairs(static_cast<int>(t), &pairs[t * pair_rows * n_nodes], &hint[t * n_nodes]);
    for (std::size_t j = 0; j < sharp.size(); ++j) {
      const std::size_t first = j * lent.edges.n_edges();
      lent.edges.take(sharp[j].number, &at_edges[first], &wake_edges[first]);
    }
  }

  static Surface see(const contact::ToolSurface& surface) {
    Surface seen{};
    seen.is_swept = surface.swept() != nullptr;
    if (seen.is_swept)
      seen.swept = surface.swept()->search();
    else
      static_cast<contact::TriangleTree&>(seen.triangles) = surface.triangles()->tree();
    if (surface.smooth()) seen.smooth = surface.smooth()->search();
    return seen;
  }
};

// Drawbeads of a loop as a device takes them.
struct BorrowedBeads {
  explicit_dynamics::Drawbeads* own = nullptr;  // none: no beads
  std::vector<int> bead, tool;
  std::vector<double> limit, share, work;
  std::vector<BeadPoint> point;
  Beads view{};

  void take(explicit_dynamics::Drawbeads& from) {
    own = &from;
    const auto lent = from.lend();
    const std::size_t n_beads = from.beads.size();
    point = lent.points, work.assign(point.size(), 0.0), share.resize(n_beads * most_cycles);
    for (std::size_t b = 0; b < n_beads; ++b) {
      const explicit_dynamics::Drawbead& each = from.beads[b];
      tool.push_back(each.tool);
      for (int i = each.first; i < each.last; ++i)
        bead.push_back(static_cast<int>(b)), limit.push_back(each.force * point[i].length);
    }
    view = {static_cast<int>(point.size()),
            static_cast<int>(n_beads),
            lent.sheet,
            lent.cell_mass.data(),
            bead.data(),
            tool.data(),
            limit.data(),
            share.data(),
            point.data(),
            work.data()};
  }
  // Their shares in cycles [first, first + n) of a call.
  void share_in(int first, int n) {
    const std::size_t n_beads = own->beads.size();
    for (std::size_t b = 0; b < n_beads; ++b)
      for (int cycle = 0; cycle < n; ++cycle) share[n_beads * cycle + b] = own->beads[b].share.at(first + cycle);
  }
  void give_back() const {
    double sum = 0.0;
    for (const double each : work) sum -= each;
    own->take(point), own->lend().work += sum;
  }
};

}  // namespace presswork::device
