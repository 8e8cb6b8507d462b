// SPDX-License-Identifier: Apache-2.0
// Contact of deformable boundaries in space: search for faces that may touch, and force and tangent of one interface.
//
// It is what interface.hpp is in the plane, with the same laws: a slot is a node of the slave's faces, which carries a
// pressure and a shear stress, here a vector; both follow from means weighted by its shape function. Loops over pairs
// and slots are shared by threads; sums run in a fixed order.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/interface.hpp"

namespace presswork {

struct FacePair {
  int slave, master;
};

// Faces (n, nodes) of three or four nodes, wound outwards.
struct FaceList {
  int n, nodes;
  const int* faces;
  const int* at(int face) const { return faces + static_cast<std::int64_t>(face) * nodes; }
};

// Pairs of faces whose boxes, grown by half the margin, meet and that may come to face each other, sorted. With `self`
// both lists are the same: the slave comes first in the list, and faces with a common node do not pair.
std::vector<FacePair> find_face_pairs(const FaceList& slave, const FaceList& master, const double* x, double margin,
                                      bool self);

// As InterfaceInput, (n, 3) where that is (n, 2).
struct FaceInterfaceInput {
  FaceList slave, master;
  const int* slots;  // (slave.n, nodes): the slots of each slave face's nodes
  int n_slots, n_points;
  std::vector<FacePair> pairs;
  const double *x, *x_n;
  const double *slave_depth, *master_depth;
  double reach;
  const std::uint8_t* held;
  const double* pressure;      // (n_slots)
  const double *shear, *slip;  // (n_slots, 3), on the slave [MPa]; still to be undone [mm]
  const double* believed;
  const double* least_weight;
  const double* stiffness;
  double tangential_part;
  const double* shear_limit;
  double mu;
  double touching;
  bool with_tangent;
};

struct FaceInterfaceOutput {
  int too_deep = 0;
  std::vector<double> force;            // (n_points, 3), on the nodes [N]
  std::vector<int> block_pairs;         // (n_blocks, 2) nodes
  std::vector<double> blocks;           // (n_blocks, 3, 3): d(-force) / d(position) [N/mm]
  std::vector<double> pressure, shear;  // (n_slots), (n_slots, 3) [MPa]
  std::vector<double> gap, slip;        // (n_slots), (n_slots, 3) [mm]
  std::vector<double> normal;           // (n_slots, 3), out of the slave; zero where nothing faces it
  std::vector<int> slope_places;        // (n_slopes, 2): slot and node of what follows
  std::vector<double> pressure_slopes;  // (n_slopes, 3) [MPa/mm]
  std::vector<std::uint8_t> status;     // (n_slots)
  std::vector<double> weight;           // surface in contact (n_slots) [mm2]
  std::vector<double> push, area;       // (n_points): of the interface on the master's nodes [N, mm2]
  std::vector<double> drag;             // (n_points, 3) [N]
  double master_force[3] = {0, 0, 0};   // of the slave on the master [N]
};

FaceInterfaceOutput evaluate_face_interface(const FaceInterfaceInput& in);

}  // namespace presswork
