// SPDX-License-Identifier: Apache-2.0
// A cycle of the explicit loop with a lane a thread: blocks of elements of several kinds, their nodes, drawbeads and
// rigid tools. The same functions are compiled for the CPU (host.cpp) and for a GPU (cuda.cu), and take the same
// Problem.
//
// A cycle is passes over lanes that know nothing of each other; tools make three more (tools.hpp), walls one
// (walls.hpp), sectors two (ties.hpp), beads two (beads.hpp):
//   move_node      a = (f_ext - f_int)/m, v += a h, x += v dt of one node (nodes.hpp)
//   advance        of a block: one element over the move, its state, and its forces at its corners (shells.hpp and
//                  others)
//   gather_forces  f_int of one node: the sum over a list of corners of elements, always in the same order
// So nothing is added by atomics, and the bits depend neither on the number of threads nor on the run.
//
// Arithmetic is that of nodes.cpp and of the kernels in element/: results differ from those of the CPU's loop by
// round-off, since a node adds up its forces in another order.
#pragma once

#include <variant>

#include "device/beads.hpp"
#include "device/shells.hpp"
#include "device/solids.hpp"
#include "device/ties.hpp"
#include "device/tools.hpp"
#include "device/walls.hpp"

namespace presswork::device {

// A block of elements of one kind and law; a kind is added here and by a pass of space.cpp. Solids are in double
// precision alone.
template <class Real, class... Solids>
using BlockWith = std::variant<OnePointShells<Real, 4, FastMises>, OnePointShells<Real, 4, GeneralSheet>,
                               OnePointShells<Real, 3, FastMises>, OnePointShells<Real, 3, GeneralSheet>,
                               MitcShells<Real, FastMises>, MitcShells<Real, GeneralSheet>, Solids...>;
template <class Real>
struct BlockOf {
  using Type = BlockWith<Real>;
};
template <>
struct BlockOf<double> {
  using Type = BlockWith<double, OnePointHexahedra<VonMises>, OnePointHexahedra<SolidLaw>, NodalTetrahedra<VonMises>,
                         NodalTetrahedra<SolidLaw>>;
};
template <class Real>
using Block = typename BlockOf<Real>::Type;

// Cells of a block of shells, as the loop numbers them, and what tools ask of them.
template <class Real>
struct Sheet {
  int first = 0, n = 0;
  const Real *thickness = nullptr, *spring = nullptr;  // (n)
};
inline constexpr int most_sheets = 2;

inline constexpr int most_cycles = 256;  // of a call

// The cycle of a call that is being computed, and those that contact and beads have seen before the call.
struct Clock {
  int cycle = 0, contact = 0, beads = 0;
};
// A cycle as its passes see it.
struct Moment {
  double dt;
  int cycle;           // of the call
  int contact, beads;  // since they began
};

// A loop's nodes and elements, in the memory of the host or of the device. Nothing in it but what the pointers mean
// changes from cycle to cycle, so cycles can be launched at once.
template <class Real>
struct Problem {
  Nodes<Real> nodes;
  const Block<Real>* block;  // (n_blocks), in the memory of the host
  int n_blocks;
  Sheet<Real> sheet[most_sheets];
  const Step* step;  // (most_cycles)
  Clock* clock;      // one
  Tools tools;
  Beads beads{};
  Walls walls{};
  Ties ties{};

  PRESSWORK_DEVICE Moment now() const {
    const Clock at = *clock;
    return {step[at.cycle].dt, at.cycle, at.contact + at.cycle, at.beads + at.cycle};
  }

  int chunks() const { return (nodes.n + chunk - 1) / chunk; }
  // Where the largest speeds of chunks are kept, their squares; null where nobody asks.
  PRESSWORK_DEVICE double* fastest() const {
    return tools.n > 0 ? tools.fastest : walls.n > 0 ? walls.fastest : nullptr;
  }
  // Thickness [mm], and spring of a node [N/mm], of a cell as the loop numbers it.
  PRESSWORK_DEVICE double thickness(int cell) const {
    const Sheet<Real>& of = sheet_of(cell);
    return of.thickness[cell - of.first];
  }
  PRESSWORK_DEVICE double spring(int cell) const {
    const Sheet<Real>& of = sheet_of(cell);
    return of.spring[cell - of.first];
  }
  // To be called when the blocks' states lie where they are to be read.
  void find_sheets() {
    int first = 0, sheets = 0;
    for (int b = 0; b < n_blocks; ++b)
      std::visit(
          [&]<class Kind>(const Kind& of) {
            if constexpr (requires { Kind::thickness_row; })
              sheet[sheets++] = {first, of.n, of.state + std::size_t(Kind::thickness_row) * of.n,
                                 of.state + std::size_t(Kind::spring_row) * of.n};
            first += of.n;
          },
          block[b]);
  }

 private:
  PRESSWORK_DEVICE const Sheet<Real>& sheet_of(int cell) const {
    return sheet[sheet[1].n > 0 && cell >= sheet[1].first ? 1 : 0];
  }
};

// Moves a node between walls, and gives the square of its speed; take: as push_walls has it. Lanes beyond the last node
// take part.
template <class Take>
PRESSWORK_INLINE double move_node_between_walls(const Problem<double>& p, int node, const Take& take) {
  const bool there = node < p.nodes.n;
  const Step& step = p.step[p.clock->cycle];
  double x[3] = {}, speed2 = 0.0;
  if (there) {
    for (int i = 0; i < 3; ++i) x[i] = p.nodes.position[4 * std::size_t(node) + i];
    speed2 = move_node(p.nodes, step, node, [&](const double* before, double inverse, double* after) {
      return meet_walls(p.walls, step, node, x, before, inverse, find_free_motion(p.nodes, node), after);
    });
  }
  push_walls(p.walls, node, there, x, take);
  return speed2;
}

// As tools.hpp has it.
template <class Real, class Take>
PRESSWORK_INLINE void touch_tools(const Problem<Real>& p, int node, const Take& take) {
  const bool there = node < p.nodes.n;
  const Moment now = p.now();
  touch_tools(p.tools, p.nodes.n, p.nodes.position, p.nodes.motion, p.nodes.internal_force, p, now.dt, now.contact,
              node, there, take);
}

template <class Real, class Take>
PRESSWORK_INLINE void touch_edges(const Problem<Real>& p, int edge, const Take& take) {
  touch_edges(p.tools, p.nodes.n, p.nodes.position, p.nodes.motion, p.step[p.clock->cycle].dt, edge,
              edge < p.tools.edges.n, take);
}

}  // namespace presswork::device
