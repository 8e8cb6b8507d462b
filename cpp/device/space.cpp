// SPDX-License-Identifier: Apache-2.0
#include "device/space.hpp"

#include <omp.h>

#include <cmath>
#include <stdexcept>

#include "device/cuda_library.hpp"
#include "device/host.hpp"
#include "explicit/space/shell_section.hpp"

namespace presswork::device {

using explicit_dynamics::ElementBlock;
using explicit_dynamics::ShellSection;
using explicit_dynamics::ShellTreatment;
using explicit_dynamics::SpaceLoop;
using explicit_dynamics::SpaceNodes;
using explicit_dynamics::Tool;
using explicit_dynamics::ToolContact;

namespace {

// Shells of a block as a device takes them, and what it does not change.
template <class Real>
struct Borrowed {
  ElementBlock<SpaceNodes<Real>>* block = nullptr;  // none: no shells of this kind
  std::vector<int> node;
  std::vector<Real> state, temperature;
  Shells<Real> view{};

  void take(ElementBlock<SpaceNodes<Real>>& from, const ShellSection& section, int first_slot) {
    block = &from;
    const std::size_t n = from.n(), corners = from.nodes_each(), rows = from.n_rows();
    node.resize(corners * n), state.resize(rows * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t a = 0; a < corners; ++a) node[a * n + e] = from.connectivity()[corners * e + a];
      for (std::size_t r = 0; r < rows; ++r) state[r * n + e] = static_cast<Real>(from.value(int(e), int(r)));
    }
    const std::size_t points = from.has_temperatures() ? from.n_temperatures() : 0;
    temperature.resize(points * n);
    for (std::size_t e = 0; e < n; ++e)
      for (std::size_t k = 0; k < points; ++k)
        temperature[k * n + e] = static_cast<Real>(from.temperature(int(e), int(k)));
    view = {
        from.n(),   first_slot, node.data(), state.data(), {}, section.rule, points > 0 ? temperature.data() : nullptr,
        from.slower};
    if (const auto* general = std::get_if<GeneralSheet>(&section.law))
      view.law = *general;
    else
      view.law = std::get<FastMises>(section.law);
  }
  void give_back() const {
    if (!block) return;
    const std::size_t n = block->n(), rows = block->n_rows();
    for (std::size_t e = 0; e < n; ++e)
      for (std::size_t r = 0; r < rows; ++r) block->set_value(int(e), int(r), double(state[r * n + e]));
  }
};

// The slots of the corners round each node, the shells in turn.
template <class Real>
void list_corners(const Borrowed<Real> (&kinds)[2], int n_nodes, std::vector<int>& first, std::vector<int>& list) {
  first.assign(n_nodes + 1, 0);
  for (const auto& kind : kinds)
    for (int node : kind.node) ++first[node + 1];
  for (int node = 0; node < n_nodes; ++node) first[node + 1] += first[node];
  list.resize(first[n_nodes]);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (const auto& kind : kinds)
    for (int e = 0; e < kind.view.n; ++e)
      for (std::size_t slot = e; slot < kind.node.size(); slot += kind.view.n)
        list[next[kind.node[slot]]++] = kind.view.first_slot + static_cast<int>(slot);
}

// Tools of a loop as a device takes them, and what it changes.
struct BorrowedTools {
  ToolContact* contact = nullptr;  // none: no tools
  std::vector<RigidTool> tool;
  std::vector<Surface> surface;
  std::vector<double> drive, pairs, fastest;
  std::vector<int> hint, cell;
  std::vector<ContactSums> sums, edge_sums;
  Totals totals;
  std::vector<SharpTool> sharp;
  std::vector<explicit_dynamics::EdgeTouching> at_edges;
  std::vector<double> wake_edges, edge_force;
  std::vector<std::uint8_t> bears;
  Tools view{};

  // first_cell: of each block of the loop as the device numbers cells
  void take(ToolContact& from, int n_nodes, int n_cycles, const std::vector<int>& n_of_block,
            const std::vector<int>& first_cell) {
    contact = &from;
    const auto lent = from.lend();
    const std::size_t n = from.tools.size(), nodes = n_nodes, rows = pair_rows;
    drive.assign(3 * n * n_cycles, 0.0), pairs.resize(n * rows * nodes), hint.resize(n * nodes);
    for (std::size_t t = 0; t < n; ++t) {
      const Tool& own = from.tools[t];
      tool.push_back(own);
      surface.push_back(see(*own.surface));
      const std::size_t each = own.pushed ? 1 : 3;
      for (std::size_t i = 0; i < each * n_cycles && !own.removed; ++i)
        drive[3 * (n * (i / each) + t) + i % each] = own.drive[i];
      from.copy_pairs(static_cast<int>(t), &pairs[t * rows * nodes], &hint[t * nodes]);
    }
    // cells as the loop numbers them, block after block
    for (int number : lent.node_cell) {
      std::size_t b = 0;
      for (; number >= n_of_block[b]; ++b) number -= n_of_block[b];
      cell.push_back(first_cell[b] + number);
    }
    const int chunks = (n_nodes + chunk - 1) / chunk;
    fastest.resize(chunks), sums.resize(chunks * n);
    totals = {lent.sums, lent.work};
    view = {static_cast<int>(n),
            lent.cycle,
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
            lent.half.data(),
            lent.room.data(),
            lent.held.data(),
            lent.node_start.data(),
            cell.data(),
            fastest.data(),
            sums.data(),
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
    edge_force.resize(6 * edges), bears.assign(2 * edges, 0);
    Edges seen{from.n_edges(),
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
               edge_force.data(),
               bears.data(),
               nullptr};
    edge_sums.resize(std::size_t(seen.chunks()) * sharp.size());
    seen.sums = edge_sums.data();
    return seen;
  }
  void give_back(int n_nodes, int n_cycles) const {
    if (!contact) return;
    const auto lent = contact->lend();
    lent.sums = totals.sums, lent.work = totals.work, lent.cycle += n_cycles;
    for (std::size_t t = 0; t < tool.size(); ++t) {
      static_cast<RigidTool&>(contact->tools[t]) = tool[t];
      contact->take_pairs(static_cast<int>(t), &pairs[t * pair_rows * n_nodes], &hint[t * n_nodes]);
    }
    for (std::size_t j = 0; j < sharp.size(); ++j) {
      const std::size_t first = j * lent.edges.n_edges();
      lent.edges.take(sharp[j].number, &at_edges[first], &wake_edges[first]);
    }
  }

 private:
  static Surface see(const contact::ToolSurface& surface) {
    Surface seen{};
    seen.is_swept = surface.swept() != nullptr;
    if (seen.is_swept)
      seen.swept = surface.swept()->search();
    else
      static_cast<contact::TriangleTree&>(seen.triangles) = surface.triangles()->tree();
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

  void take(explicit_dynamics::Drawbeads& from, int n_cycles) {
    own = &from;
    const auto lent = from.lend();
    const std::size_t n_beads = from.beads.size();
    point = lent.points, work.assign(point.size(), 0.0), share.resize(n_beads * n_cycles);
    for (std::size_t b = 0; b < n_beads; ++b) {
      const explicit_dynamics::Drawbead& each = from.beads[b];
      tool.push_back(each.tool);
      for (int i = each.first; i < each.last; ++i)
        bead.push_back(static_cast<int>(b)), limit.push_back(each.force * point[i].length);
      for (int cycle = 0; cycle < n_cycles; ++cycle) share[n_beads * cycle + b] = each.share.at(cycle);
    }
    view = {static_cast<int>(point.size()),
            static_cast<int>(n_beads),
            lent.cycle,
            lent.sheet,
            lent.cell_mass.data(),
            bead.data(),
            tool.data(),
            limit.data(),
            share.data(),
            point.data(),
            work.data()};
  }
  void give_back(int n_cycles) const {
    if (!own) return;
    double sum = 0.0;
    for (const double each : work) sum -= each;
    own->take(point, sum, n_cycles);
  }
};

}  // namespace

template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop) {
  const auto& nodes = loop.nodes;
  if (loop.contact)
    for (const Tool& tool : loop.contact->tools)
      if (tool.surface->is_smooth()) return "tools of triangles that are rounded off";
  if (loop.shell_contact) return "shells that touch each other";
  if (!loop.hanging.all().empty()) return "refined sheets";
  for (std::size_t b = 0; b < loop.blocks.size(); ++b)
    if (!loop.is_sheet(static_cast<int>(b))) return "solids";
  int like[2] = {};
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    const auto& block = loop.sheet(static_cast<int>(b));
    if (block.nodes_each() == 4 && block.section().treatment != ShellTreatment::stabilized)
      return "shells other than shell4_1pt with physical hourglass";
    if (std::holds_alternative<UserSheet>(block.section().law)) return "laws of shared libraries (UMAT)";
    if (!block.damage.empty()) return "damage";
    if (like[block.nodes_each() - 3]++ > 0) return "two blocks of like shells";
  }
  if (loop.blocks.empty()) return "nodes without shells";
  if (!nodes.walls.empty() || !nodes.follows.empty()) return "walls and sectors";
  for (auto held : nodes.held())
    if (held >> nodes.askew & 1) return "nodes held along a direction";
  return "";
}

template <class Real>
void advance(SpaceLoop<Real>& loop, Target target, const Cycles& cycles) {
  const double start = omp_get_wtime();
  auto& nodes = loop.nodes;
  const std::size_t n_nodes = nodes.n;
  // 1. what is kept otherwise in the loop
  Borrowed<Real> kinds[2];  // of four nodes, of three
  int n_slots = 0;
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    auto& block = *loop.blocks[b];
    kinds[block.nodes_each() == 4 ? 0 : 1].take(block, loop.sheet(static_cast<int>(b)).section(), n_slots);
    n_slots += block.n() * block.nodes_each();
  }
  BorrowedTools tools;
  if (loop.contact) {
    std::vector<int> n_of_block, first_cell;
    for (const auto& block : loop.blocks) {
      n_of_block.push_back(block->n());
      first_cell.push_back(block->nodes_each() == 4 ? 0 : kinds[0].view.n);
    }
    tools.take(*loop.contact, nodes.n, cycles.n, n_of_block, first_cell);
  }
  BorrowedBeads beads;
  if (loop.beads) beads.take(*loop.beads, cycles.n);
  std::vector<int> first, corner;
  list_corners(kinds, nodes.n, first, corner);
  std::vector<Real> corner_force(std::size_t(freedoms) * n_slots);
  std::vector<double> work(2 * n_nodes, 0.0);
  const Problem<Real> problem{
      {nodes.n, nodes.position.data(), nodes.motion.data(), nodes.internal_force.data(), nodes.force.data(),
       nodes.held().data(), nodes.prescribed().data(), nodes.reaction_impulse.data(), work.data(), first.data(),
       corner.data(), n_slots, corner_force.data()},
      kinds[0].view,
      kinds[1].view,
      loop.blocks[0]->n_rows(),
      tools.view,
      beads.view};
  // 2. the cycles
  if (target == Target::host)
    advance_on_host(problem, cycles);
  else
    advance_on_cuda(problem, cycles);
  for (std::size_t i = 0; i < freedoms * n_nodes; ++i)
    if (std::isnan(nodes.internal_force.data()[i]))
      throw std::runtime_error(
          "a force is no number any more: a material law has found no stress for the strain of a step, the step is too "
          "long, or a shell has collapsed");
  // 3. back into the loop
  for (const auto& kind : kinds) kind.give_back();
  tools.give_back(nodes.n, cycles.n);
  beads.give_back(cycles.n);
  for (std::size_t i = 0; i < n_nodes; ++i) loop.work.external += work[2 * i], loop.work.damping += work[2 * i + 1];
  loop.seconds[static_cast<int>(explicit_dynamics::Phase::elements)] += omp_get_wtime() - start;
}

template std::string find_lack(const SpaceLoop<double>&);
template std::string find_lack(const SpaceLoop<float>&);
template void advance(SpaceLoop<double>&, Target, const Cycles&);
template void advance(SpaceLoop<float>&, Target, const Cycles&);

}  // namespace presswork::device
