// SPDX-License-Identifier: Apache-2.0
// Contact of deformable bodies with each other, or of one with itself, in the explicit loop: mortar, with penalties.
//
// Each node of the slave's faces is a slot. Its mean gap and slip come from a sparse row of weights
// (contact/mortar_rows.hpp), its pressure is p = k max(0, -gap), and its friction a spring of the same stiffness that
// slides at the law's limit (return mapping). Each slot's force goes to the nodes of both bodies by the same weights,
// so that momentum is kept to rounding. Slots write rows of their own and nodes gather them: the bits do not depend on
// the threads. The weights hold until nodes have moved by a hundredth of an edge.
//
// Stable step: a row of the springs' stiffness has the sum 2 k A_b at node b, where A_b sums the sizes of its weights,
// and the element's bound takes 0.81 of 4/dt^2 at nine tenths of its stable step. Bounds of frequencies squared add up
// (Weyl), so k <= 0.38 m_b/(A_b dt^2) keeps the step stable; STIFFNESS is what is taken.
#pragma once

#include <string>
#include <vector>

#include "contact/mortar_rows.hpp"
#include "explicit/interaction.hpp"
#include "explicit/nodes.hpp"

namespace presswork::explicit_dynamics {

// The two surfaces, in the loop's numbers of nodes.
struct TouchingSurfaces {
  int nodes, cell_nodes;                       // of a face: 2 in the plane, 3 or 4; of the cell behind it
  std::vector<int> slave, master;              // (n, nodes), wound outwards; the same list for a body with itself
  std::vector<int> slave_cells, master_cells;  // (n, cell_nodes): the cell behind each face
  bool self;
  double edge;       // mean length of their edges [mm]
  double thickness;  // normal to the plane [mm]; 0 for full rings
  double mu;         // most of friction over pressure
};

template <class Nodes>
class BodyContact final : public Interaction<Nodes> {
 public:
  static constexpr int dimension = Nodes::freedoms == 2 ? 2 : 3;
  // n_nodes: of the loop. reach, margin: parts of the mean edge, as the implicit procedure has them.
  BodyContact(std::string name, int n_nodes, TouchingSurfaces surfaces, double reach, double margin);
  BodyContact(const BodyContact&) = delete;
  BodyContact& operator=(const BodyContact&) = delete;

  void begin(Nodes& nodes, int n_cycles) override;
  void move(const Step& step, int cycle, double fastest) override;
  int n_rounds() const override { return 2; }
  int n_pieces(int round) const override { return count_chunks(round == 0 ? n_slots() : n_nodes()); }
  void act(Nodes& nodes, const Step& step, int cycle, int round, int piece) override;
  void close() override;
  void add_energies(double, Energies& e) const override { e.contact += work_[0], e.friction += work_[1]; }
  void list_state(std::vector<StateField>& fields) override;

  int n_slots() const { return static_cast<int>(slot_node_.size()); }
  int n_nodes() const { return static_cast<int>(node_.size()); }
  const std::vector<int>& node() const { return node_; }            // (n): numbers in the loop
  const std::vector<int>& slot_node() const { return slot_node_; }  // (n_slots): among those
  // (n): sizes of the weights of a node, summed up [mm2]
  const std::vector<double>& node_area() const { return rows_.node_area; }

  // Of each slot's spring, as the next cycle has it (n_slots) [MPa/mm]; 0 where it faces nothing.
  std::vector<double> find_stiffness(Nodes& nodes);

  const double* work() const { return work_; }  // of pressure and of friction [N mm]

  double step = 0.0;                // that the springs must be stable with [s]
  std::vector<double> shear_limit;  // (n_slots), or none [MPa]
  std::vector<double> pressure;     // (n_slots) [MPa]
  std::vector<double> shear;        // (n_slots, 3): on the slave [MPa]
  std::vector<double> push, rub;    // (n, 3): forces on the nodes, of pressure and of friction [N]
  std::vector<double> impulse;      // (3): given to the master since the start [N s]; none of a body with itself
  bool passed = false;              // faces have gone through each other
  const std::string name;

 private:
  void take_positions(const Nodes& nodes);
  void measure_depths(const Nodes& nodes);
  void cut(const double* before);
  double find_fastest() const;
  void set_stiffness(const Nodes& nodes);
  void press_slot(const Nodes& nodes, const Step& step, int slot);
  void load_node(Nodes& nodes, const Step& step, int i, double* sums);

  TouchingSurfaces surfaces_;
  std::vector<int> node_, slot_node_, slots_;
  std::vector<char> is_master_;  // (n)
  MortarRows rows_;              // nodes as in node_
  struct Entry {
    int slot;
    double weight;
  };
  std::vector<int> first_;  // (n + 1): entries of each node, the transpose of the rows
  std::vector<Entry> entries_;
  std::vector<double> stiffness_;                   // (n_slots), times the step squared [MPa s2/mm]
  std::vector<double> cut_position_;                // (n, 3): for which the rows hold [mm]
  std::vector<double> slave_depth_, master_depth_;  // (n_faces) [mm]
  double since_cut_[2] = {0.0, 0.0};                // way of the fastest node since then [mm]; whether there was a cut
  bool stale_ = true;
  double reach_, margin_, work_[2] = {0.0, 0.0};
  std::vector<double> chunk_sums_;  // (chunks, 5): work of pressure and of friction, force on the master
  double step_of_close_ = 0.0;
  const Nodes* nodes_ = nullptr;
};

}  // namespace presswork::explicit_dynamics
