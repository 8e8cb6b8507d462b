// SPDX-License-Identifier: Apache-2.0
// Arrays of the host and their copies on the card.
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "device/cycle.hpp"

namespace presswork::device {

inline void check(cudaError_t told, const char* what) {
  if (told == cudaSuccess) return;
  throw std::runtime_error(std::string("the card failed to ") + what + ": " + cudaGetErrorString(told));
}

// All arrays of a call. They are listed first, so that their size is known before anything is computed.
class Arrays {
 public:
  Arrays() = default;
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;
  ~Arrays() {
    for (const Copy& each : copies_) cudaFree(each.card);
  }
  // A pointer that becomes that of the copy. Those that lie in an array are added before that array.
  template <class Number>
  void add(Number*& array, std::size_t n, bool changes) {
    auto* host = const_cast<std::remove_const_t<Number>*>(array);
    copies_.push_back({host, nullptr, n * sizeof(Number), changes, const_cast<std::remove_const_t<Number>**>(&array)});
  }
  void send() {
    std::size_t needed = 0, free = 0, all = 0;
    for (const Copy& each : copies_) needed += each.bytes;
    check(cudaMemGetInfo(&free, &all), "tell its memory");
    if (needed > free) {
      char told[200];
      std::snprintf(told, sizeof told,
                    "the run needs %.2f GB on the card, which has %.2f GB free of %.2f: take precision = \"single\", "
                    "fewer shells or device = \"cpu\"",
                    needed * 1e-9, free * 1e-9, all * 1e-9);
      throw std::runtime_error(told);
    }
    for (Copy& each : copies_) {
      check(cudaMalloc(&each.card, each.bytes > 0 ? each.bytes : 1), "give memory");
      check(cudaMemcpy(each.card, each.host, each.bytes, cudaMemcpyHostToDevice), "take an array");
      *static_cast<void**>(each.pointer) = each.card;
    }
  }
  void fetch() const {
    for (const Copy& each : copies_)
      if (each.changes) check(cudaMemcpy(each.host, each.card, each.bytes, cudaMemcpyDeviceToHost), "give an array");
  }

 private:
  struct Copy {
    void *host, *card;
    std::size_t bytes;
    bool changes;
    void* pointer;
  };
  std::vector<Copy> copies_;
};

template <class Kind>
void add_elements(Arrays& arrays, Kind& of) {
  const std::size_t n = of.n;
  arrays.add(of.node, Kind::n_corners * n, false), arrays.add(of.state, of.rows * n, true);
  if (of.temperature) arrays.add(of.temperature, of.points * n, false);
  of.for_each_table([&](auto& table, std::size_t size) { arrays.add(table, size, false); });
}

// surfaces: copies of those of the tools, in which the pointers are set.
template <class Real>
void add_tools(Arrays& arrays, Problem<Real>& p, const Cycles& cycles, std::vector<Surface>& surfaces) {
  Tools& tools = p.tools;
  const std::size_t n = tools.n, nodes = p.nodes.n, chunks = p.chunks();
  for (Surface& surface : surfaces) {
    if (surface.is_swept) {
      contact::SweptSearch& swept = surface.swept;
      arrays.add(swept.pieces, swept.n, false), arrays.add(swept.corners, swept.n_corners, false);
      continue;
    }
    contact::TriangleTree& tree = surface.triangles;
    const std::size_t triangles = tree.n;
    arrays.add(tree.triangles, triangles, false), arrays.add(tree.edge_normals, 9 * triangles, false);
    arrays.add(tree.vertex_normals, std::size_t(3) * tree.n_points, false);
    arrays.add(tree.corners, 3 * triangles, false), arrays.add(tree.leaf_of, triangles, false);
    arrays.add(tree.nodes, tree.n_nodes, false), arrays.add(tree.leaves, tree.n_leaves, false);
    arrays.add(tree.around, tree.n_leaves, false);
  }
  tools.surface = surfaces.data();
  arrays.add(tools.surface, n, false), arrays.add(tools.tool, n, true);
  arrays.add(tools.drive, 3 * n * cycles.n, false), arrays.add(tools.totals, 1, true);
  arrays.add(tools.pairs, n * pair_rows * nodes, true), arrays.add(tools.hint, n * nodes, true);
  arrays.add(tools.base, nodes, false), arrays.add(tools.half, nodes, true);
  arrays.add(tools.room, nodes, true), arrays.add(tools.held, nodes, true);
  arrays.add(tools.first_cell, nodes + 1, false);
  arrays.add(tools.cell, tools.first_cell[nodes], false);
  arrays.add(tools.fastest, chunks, false), arrays.add(tools.sums, chunks * n, false);
}

template <class Real>
void add_beads(Arrays& arrays, Problem<Real>& p, const Cycles& cycles) {
  Beads& beads = p.beads;
  const std::size_t n = beads.n, cells = beads.sheet.n, corners = beads.sheet.start[cells];
  arrays.add(beads.sheet.start, cells + 1, false), arrays.add(beads.sheet.corner, corners, false);
  arrays.add(beads.sheet.neighbour, corners, false), arrays.add(beads.cell_mass, cells, false);
  arrays.add(beads.bead, n, false), arrays.add(beads.tool, beads.n_beads, false), arrays.add(beads.limit, n, false);
  arrays.add(beads.share, std::size_t(beads.n_beads) * cycles.n, false);
  arrays.add(beads.point, n, true), arrays.add(beads.work, n, true);
}

// sharp: copies of the sharp tools, in which the pointers are set.
template <class Real>
void add_edges(Arrays& arrays, Problem<Real>& p, std::vector<SharpTool>& sharp) {
  Edges& edges = p.tools.edges;
  const std::size_t n = edges.n, pairs = n * edges.n_sharp;
  for (SharpTool& of : sharp) {
    arrays.add(of.sharp.pieces, of.sharp.n_pieces, false);
    arrays.add(of.sharp.swept.pieces, of.sharp.swept.n, false);
    arrays.add(of.sharp.swept.corners, of.sharp.swept.n_corners, false);
    arrays.add(of.sharp.folds.lines, of.sharp.folds.n_lines, false);
    arrays.add(of.sharp.folds.boxes, of.sharp.folds.n_boxes, false);
  }
  edges.sharp = sharp.data();
  arrays.add(edges.sharp, sharp.size(), false);
  arrays.add(edges.node, 2 * n, false), arrays.add(edges.end_slot, 2 * n, false);
  arrays.add(edges.first_slot, std::size_t(p.nodes.n) + 1, false), arrays.add(edges.base, n, false);
  arrays.add(edges.at, pairs, true), arrays.add(edges.wake, pairs, true);
  arrays.add(edges.force, 6 * n, false), arrays.add(edges.bears, 2 * n, false);
  arrays.add(edges.sums, std::size_t(edges.chunks()) * sharp.size(), false);
}

}  // namespace presswork::device
