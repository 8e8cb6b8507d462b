// SPDX-License-Identifier: Apache-2.0
// Mortar contact of two surfaces as sparse rows: what a slot takes of positions and velocities, and what its traction
// gives to nodes, while points of the surfaces stay opposite each other.
//
// A slot A is a node of the slave's faces (edges in the plane). With phi_A its shape function and N_b those of all
// nodes, its row has the weights
//
//     w_Ab = int phi_A N_b dA on nodes of the slave, -int phi_A N_b dA on those of the master,
//
// so that sum_b w_Ab x_b / a_A is the mean way from the master to the slave, and w_Ab t_A the force of a traction t_A
// on node b. The weights of a row sum to zero: such forces keep the momentum. Puso & Laursen 2004, Computer Methods in
// Applied Mechanics and Engineering 193; the integrals are those of mortar.hpp and face_mortar.hpp.
#pragma once

#include <vector>

#include "contact/face_interface.hpp"

namespace presswork {

struct MortarRows {
  std::vector<int> start;         // (n_slots + 1): where the entries of each slot begin
  std::vector<int> node;          // (entries)
  std::vector<double> weight;     // (entries) [mm2]
  std::vector<double> area;       // (n_slots): a_A = int phi_A dA [mm2], 0 where nothing faces the slot
  std::vector<double> normal;     // (n_slots, 3): mean of the slave's, outwards
  std::vector<double> node_area;  // (n_points): sum of the sizes of a node's weights [mm2]
  bool passed = false;            // faces have gone through each other since `before`
};

// Faces of two nodes are edges in the plane, with the body on the left; positions have three coordinates throughout.
struct MortarSurfaces {
  FaceList slave, master;
  const int* slots;  // (slave.n, nodes): the slots of each slave face's nodes
  int n_slots, n_points;
  bool self;                                 // both lists are the same
  double margin, reach;                      // of the search, and the widest gap that counts [mm]
  double thickness;                          // normal to the plane [mm]; 0 for full rings
  const double *slave_depth, *master_depth;  // (n): how deep the other body may reach behind each face [mm]
};

// Rows with the nodes at x (n_points, 3); before: where they were at the last call, or null.
MortarRows cut_mortar_rows(const MortarSurfaces& surfaces, const double* x, const double* before);

}  // namespace presswork
