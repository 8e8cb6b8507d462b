// SPDX-License-Identifier: Apache-2.0
// A loop that lives in the memory of the machine that computes its cycles: its arrays are taken there once, and back
// where they are asked for. A machine (the host build, a card) derives from it.
#pragma once

#include <list>

#include "device/arrays.hpp"
#include "device/passes.hpp"

namespace presswork::device {

template <class Real>
class Resident {
 public:
  // host: with pointers to arrays of the host, which stay where they are.
  Resident(const Problem<Real>& host, std::unique_ptr<Memory> memory)
      : problem(host), memory_(std::move(memory)), arrays(*memory_), blocks_(host.block, host.block + host.n_blocks) {
    list();
  }
  virtual ~Resident() = default;
  Resident(const Resident&) = delete;
  Resident& operator=(const Resident&) = delete;

  // Take all there.
  void make() {
    arrays.make();
    problem.block = blocks_.data();
    problem.find_sheets();
    begin();
  }
  // Compute cycles, whose tables are those of the host; gives what Settle does.
  Found advance(int n_cycles) {
    arrays.send(Part::clock), arrays.send_rows(n_cycles, most_cycles);
    compute(n_cycles);
    arrays.fetch(Part::little);
    return sum_up(Settle<Real>{problem.nodes.n, problem.nodes, problem.walls.n > 0 ? problem.walls.work : nullptr});
  }
  virtual Found sum_up(const Pass<Real>& pass) = 0;

  Problem<Real> problem;  // with pointers to arrays of the machine

 private:
  std::unique_ptr<Memory> memory_;

 public:
  Arrays arrays;

 protected:
  virtual void compute(int n_cycles) = 0;
  virtual void begin() = 0;  // volumes of cells and nodes, by the machine that follows them
  Found* found_ = nullptr;   // (chunks of the longest pass, and one)

 private:
  void list();
  template <class Kind>
  void list_elements(Kind& of);
  void list_surfaces(std::vector<Surface>& surfaces);
  void list_tools();
  void list_walls();
  void list_edges();
  void list_beads();

  std::vector<Block<Real>> blocks_;
  std::list<std::vector<Criterion>> criteria_;  // of each block
  std::vector<Surface> surfaces_, wall_surfaces_;
  std::vector<WallNodes> wall_nodes_;
  std::vector<SharpTool> sharp_;
};

template <class Real>
void Resident<Real>::list() {
  Problem<Real>& p = problem;
  Nodes<Real>& nodes = p.nodes;
  const std::size_t n = nodes.n, slots = nodes.n_slots;
  arrays.add(nodes.position, 4 * n, Part::places), arrays.add(nodes.motion, 8 * n, Part::nodes);
  arrays.add(nodes.internal_force, freedoms * n, Part::nodes), arrays.add(nodes.force, freedoms * n, Part::fixed);
  arrays.add(nodes.held, n, Part::fixed), arrays.add(nodes.prescribed, freedoms * n, Part::fixed);
  arrays.add(nodes.reaction_impulse, freedoms * n, Part::reaction), arrays.add(nodes.work, 2 * n, Part::fixed);
  arrays.add(nodes.first_corner, n + 1, Part::fixed), arrays.add(nodes.corner, slots, Part::fixed);
  arrays.add(nodes.corner_force, freedoms * slots, Part::scratch);
  if (nodes.first_along) {
    arrays.add(nodes.along, nodes.first_along[n], Part::fixed), arrays.add(nodes.first_along, n + 1, Part::fixed);
  }
  if (nodes.follows) arrays.add(nodes.follows, n, Part::fixed);
  arrays.add(nodes.stop, 2, Part::little);
  int longest = nodes.n;
  for (auto& block : blocks_)
    std::visit([&](auto& of) { list_elements(of), longest = std::max(longest, of.n); }, block);
  arrays.add(p.step, most_cycles, Part::table), arrays.add(p.clock, 1, Part::clock);
  if (p.tools.n > 0) list_tools();
  if (p.walls.n > 0) list_walls();
  if (Ties& ties = p.ties; ties.n > 0) {
    arrays.add(ties.pair, 2 * std::size_t(ties.n), Part::fixed);
    arrays.add(ties.fastest, ties.chunks(), Part::scratch);
  }
  if (p.tools.edges.n_sharp > 0) list_edges(), longest = std::max(longest, p.tools.edges.n);
  if (p.beads.n > 0) list_beads();
  arrays.add(found_, std::size_t(longest + chunk - 1) / chunk + 1, Part::scratch);
}

template <class Real>
template <class Kind>
void Resident<Real>::list_elements(Kind& of) {
  const std::size_t n = of.n;
  arrays.add(of.node, Kind::n_corners * n, Part::fixed), arrays.add(of.state, of.rows * n, Part::elements);
  if (of.temperature) arrays.add(of.temperature, of.points * n, Part::given);
  if (of.mass) arrays.add(of.mass, n, Part::fixed), arrays.add(of.inertia_ratio, n, Part::fixed);
  if (of.damage.n_criteria > 0) {
    DamageOfBlock& damage = of.damage;
    auto& criteria = criteria_.emplace_back(damage.criterion, damage.criterion + damage.n_criteria);
    for (Criterion& each : criteria) arrays.add(each.value, damage.points * n, Part::damage);
    damage.criterion = criteria.data();
    arrays.add(damage.criterion, criteria.size(), Part::fixed),
        arrays.add(damage.flowed, damage.points * n, Part::elements);
  }
  if (of.failed) arrays.add(of.failed, n, Part::elements);
  if constexpr (requires { of.nodal_mass; }) arrays.add(of.nodal_mass, Kind::n_corners * n, Part::fixed);
  if constexpr (requires { of.volumes; }) {
    NodalVolumes& volumes = of.volumes;
    const std::size_t nodes = problem.nodes.n;
    arrays.add(volumes.cell, Kind::n_corners * n, Part::fixed), arrays.add(volumes.first, nodes + 1, Part::fixed);
    arrays.add(volumes.volume, n, Part::scratch), arrays.add(volumes.nodal, nodes, Part::elements);
    arrays.add(volumes.change, nodes, Part::scratch);
  }
  of.for_each_table([&](auto& table, std::size_t size) { arrays.add(table, size, Part::fixed); });
}

template <class Real>
void Resident<Real>::list_surfaces(std::vector<Surface>& surfaces) {
  for (Surface& surface : surfaces) {
    if (surface.is_swept) {
      contact::SweptSearch& swept = surface.swept;
      arrays.add(swept.pieces, swept.n, Part::fixed), arrays.add(swept.corners, swept.n_corners, Part::fixed);
      continue;
    }
    if (surface.smooth.patches) arrays.add(surface.smooth.patches, surface.smooth.n, Part::fixed);
    contact::TriangleTree& tree = surface.triangles;
    const std::size_t triangles = tree.n;
    arrays.add(tree.triangles, triangles, Part::fixed), arrays.add(tree.edge_normals, 9 * triangles, Part::fixed);
    arrays.add(tree.vertex_normals, std::size_t(3) * tree.n_points, Part::fixed);
    arrays.add(tree.corners, 3 * triangles, Part::fixed), arrays.add(tree.leaf_of, triangles, Part::fixed);
    arrays.add(tree.nodes, tree.n_nodes, Part::fixed), arrays.add(tree.leaves, tree.n_leaves, Part::fixed);
    arrays.add(tree.around, tree.n_leaves, Part::fixed);
  }
}

template <class Real>
void Resident<Real>::list_walls() {
  Walls& walls = problem.walls;
  const std::size_t n = walls.n, nodes = problem.nodes.n, chunks = problem.chunks();
  wall_surfaces_.assign(walls.surface, walls.surface + n), wall_nodes_.assign(walls.node, walls.node + n);
  list_surfaces(wall_surfaces_);
  for (WallNodes& of : wall_nodes_) {
    arrays.add(of.force, 3 * nodes, Part::contact), arrays.add(of.wake, nodes, Part::contact);
    arrays.add(of.hint, nodes, Part::contact);
    arrays.add(of.pressed, nodes, Part::sums), arrays.add(of.rubbed, nodes, Part::sums);
    if (of.friction_limit) arrays.add(of.friction_limit, nodes, Part::given);
  }
  walls.surface = wall_surfaces_.data(), walls.node = wall_nodes_.data();
  arrays.add(walls.surface, n, Part::fixed), arrays.add(walls.node, n, Part::fixed);
  arrays.add(walls.wall, n, Part::little), arrays.add(walls.touches, nodes, Part::fixed);
  arrays.add(walls.work, 2 * nodes, Part::fixed);
  arrays.add(walls.fastest, chunks, Part::scratch), arrays.add(walls.sums, chunks * n, Part::scratch);
}

template <class Real>
void Resident<Real>::list_tools() {
  Tools& tools = problem.tools;
  const std::size_t n = tools.n, nodes = problem.nodes.n, chunks = problem.chunks();
  surfaces_.assign(tools.surface, tools.surface + n);
  list_surfaces(surfaces_);
  tools.surface = surfaces_.data();
  arrays.add(tools.surface, n, Part::fixed), arrays.add(tools.tool, n, Part::little);
  arrays.add(tools.drive, 3 * n * most_cycles, Part::table), arrays.add(tools.totals, 1, Part::little);
  arrays.add(tools.pairs, n * pair_rows * nodes, Part::contact), arrays.add(tools.hint, n * nodes, Part::contact);
  arrays.add(tools.base, nodes, Part::fixed), arrays.add(tools.bearing, nodes, Part::fixed);
  arrays.add(tools.half, nodes, Part::contact), arrays.add(tools.room, nodes, Part::contact);
  arrays.add(tools.held, nodes, Part::contact);
  arrays.add(tools.cell, tools.first_cell[nodes], Part::fixed), arrays.add(tools.first_cell, nodes + 1, Part::fixed);
  arrays.add(tools.fastest, chunks, Part::scratch), arrays.add(tools.sums, chunks * n, Part::scratch);
}

template <class Real>
void Resident<Real>::list_edges() {
  Edges& edges = problem.tools.edges;
  const std::size_t n = edges.n, pairs = n * edges.n_sharp;
  sharp_.assign(edges.sharp, edges.sharp + edges.n_sharp);
  for (SharpTool& of : sharp_) {
    arrays.add(of.sharp.pieces, of.sharp.n_pieces, Part::fixed);
    arrays.add(of.sharp.swept.pieces, of.sharp.swept.n, Part::fixed);
    arrays.add(of.sharp.swept.corners, of.sharp.swept.n_corners, Part::fixed);
    arrays.add(of.sharp.folds.lines, of.sharp.folds.n_lines, Part::fixed);
    arrays.add(of.sharp.folds.boxes, of.sharp.folds.n_boxes, Part::fixed);
  }
  edges.sharp = sharp_.data();
  arrays.add(edges.sharp, sharp_.size(), Part::fixed);
  arrays.add(edges.node, 2 * n, Part::fixed), arrays.add(edges.end_slot, 2 * n, Part::fixed);
  arrays.add(edges.first_slot, std::size_t(problem.nodes.n) + 1, Part::fixed);
  arrays.add(edges.base, n, Part::fixed);
  arrays.add(edges.at, pairs, Part::contact), arrays.add(edges.wake, pairs, Part::contact);
  arrays.add(edges.force, 6 * n, Part::scratch), arrays.add(edges.bears, 2 * n, Part::fixed);
  arrays.add(edges.sums, std::size_t(edges.chunks()) * sharp_.size(), Part::scratch);
}

template <class Real>
void Resident<Real>::list_beads() {
  Beads& beads = problem.beads;
  const std::size_t n = beads.n, cells = beads.sheet.n, corners = beads.sheet.start[cells];
  arrays.add(beads.sheet.corner, corners, Part::fixed), arrays.add(beads.sheet.neighbour, corners, Part::fixed);
  arrays.add(beads.sheet.start, cells + 1, Part::fixed), arrays.add(beads.cell_mass, cells, Part::fixed);
  arrays.add(beads.bead, n, Part::fixed), arrays.add(beads.tool, beads.n_beads, Part::fixed);
  arrays.add(beads.limit, n, Part::fixed);
  arrays.add(beads.share, std::size_t(beads.n_beads) * most_cycles, Part::table);
  arrays.add(beads.point, n, Part::little), arrays.add(beads.work, n, Part::little);
}

}  // namespace presswork::device
