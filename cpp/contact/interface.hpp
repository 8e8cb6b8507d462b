// SPDX-License-Identifier: Apache-2.0
// Contact of deformable boundaries: search for edges that may touch, and force and tangent of one interface.
//
// A half-edge is an edge of two nodes, or either half of an edge of three; half-edge h of an edge e is e (nodes - 1) +
// h. A slot is a node at the end of a slave edge, which carries a pressure and a shear stress. Loops run in a fixed
// order on one thread: interfaces are small beside the bodies.
#pragma once

#include <cstdint>
#include <vector>

namespace presswork {

struct HalfEdgePair {
  int slave, master;
};

// Edges (n, nodes): first end, last end[, mid-side], the body on the left.
struct EdgeList {
  int n, nodes;
  const int* edges;
  int halves() const { return nodes - 1; }
  // Ends of a half-edge.
  void ends(int half_edge, int& first, int& last) const {
    const int* e = edges + static_cast<std::int64_t>(half_edge / halves()) * nodes;
    if (nodes == 2)
      first = e[0], last = e[1];
    else if (half_edge % 2 == 0)
      first = e[0], last = e[2];
    else
      first = e[2], last = e[1];
  }
};

// Pairs of half-edges whose boxes, grown by half the margin, meet and that may come to face each other, sorted.
// With `self` both lists are the same: the slave comes first in the list, and neighbours do not pair.
std::vector<HalfEdgePair> find_edge_pairs(const EdgeList& slave, const EdgeList& master, const double* x, double margin,
                                          bool self);

// What an iteration has decided of a slot: by_gap, it pushes where its gap is closed; keeps_hold, it keeps contact even
// where it pulls; let_go, as by_gap, but a gap just closed is none: it has pulled in this increment.
enum SlotHold : std::uint8_t { by_gap, keeps_hold, let_go };

struct InterfaceInput {
  EdgeList slave, master;
  const int* slots;  // (slave.n, 2): the slots of each slave edge's ends
  int n_slots, n_points;
  std::vector<HalfEdgePair> pairs;
  const double *x, *x_n;                     // (n_points, 2): now, and when the increment began
  const double *slave_depth, *master_depth;  // (n): how deep the other body may reach behind each edge [mm]
  double reach;                              // gaps larger than this are not looked at [mm]
  double thickness;                          // normal to the plane [mm]; 0 for full rings
  const std::uint8_t* held;                  // (n_slots): SlotHold
  const double *pressure, *shear, *slip;     // (n_slots): multipliers [MPa], slip still to be undone [mm]
  const double* believed;                    // (n_slots): pressure for the tangent and for who sticks [MPa]
  const double* least_weight;                // (n_slots): no mean is taken over less than this [mm2]
  const double* stiffness;                   // (n_slots): normal [MPa/mm]; tangential is a part of it
  double tangential_part;
  const double* shear_limit;  // (n_slots): m k [MPa], infinite without
  double mu;
  double touching;  // gaps below this [mm] count as contact in the tangent, but at slots let go
  bool with_tangent;
};

enum class SlotStatus : std::uint8_t { apart, sticks, slides };

struct InterfaceOutput {
  int too_deep = 0;                      // pairs that have gone through each other in this increment
  std::vector<double> force;             // (n_points, 2), on the nodes [N]
  std::vector<int> block_pairs;          // (n_blocks, 2) nodes
  std::vector<double> blocks;            // (n_blocks, 2, 2): d(-force) / d(position) [N/mm]
  std::vector<double> pressure, shear;   // (n_slots) [MPa]
  std::vector<double> gap, slip;         // (n_slots): weighted means [mm]
  std::vector<int> slope_places;         // (n_slopes, 2): slot and node of what follows
  std::vector<double> pressure_slopes;   // (n_slopes, 2): d pressure / d position [MPa/mm], as if the slot were active
  std::vector<std::uint8_t> status;      // (n_slots)
  std::vector<double> weight;            // surface in contact (n_slots) [mm2]
  std::vector<double> push, drag, area;  // (n_points): of the interface on the master's nodes [N, N, mm2]
  double master_force[2] = {0, 0};       // of the slave on the master [N]
};

InterfaceOutput evaluate_interface(const InterfaceInput& in);

}  // namespace presswork
