// SPDX-License-Identifier: Apache-2.0
// The explicit loop in space: blocks of shells and of solids, and what acts on a sheet: drawbeads, pressure, rigid
// tools, shells that touch shells, hanging nodes, which know the shells alone; and the rigid walls that hold solids
// off.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "explicit/contact/body_contact.hpp"
#include "explicit/contact/drawbeads.hpp"
#include "explicit/contact/sheet_of_parts.hpp"
#include "explicit/contact/sheet_pressure.hpp"
#include "explicit/contact/shell_contact.hpp"
#include "explicit/contact/tool_contact.hpp"
#include "explicit/loop.hpp"
#include "explicit/space/cyclic_ties.hpp"
#include "explicit/space/hanging.hpp"
#include "explicit/space/nodal_tetrahedra.hpp"
#include "explicit/space/sheet_block.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
class SpaceLoop final : public Loop<SpaceNodes<Real>> {
 public:
  using Base = Loop<SpaceNodes<Real>>;
  // points (n, 3) [mm]
  SpaceLoop(int n_nodes, const double* points);
  ~SpaceLoop() override;

  void add_sheet(std::unique_ptr<SheetBlock<Real>> block);
  void add_solids(std::unique_ptr<ElementBlock<SpaceNodes<Real>>> block);
  // Measure the volumes that nodes have of cells (n, 4) after every move, for a block of them.
  const NodalVolumes& add_nodal_volumes(const std::vector<int>& cells);
  // Let a tool hold nodes (n, marked) of the surface of solids off; they are numbered as they come.
  void add_wall(std::shared_ptr<const contact::ToolSurface> surface, const std::uint8_t* touching, double mu,
                double reach, const WallMotion& motion);
  std::vector<std::unique_ptr<SpaceWall>> walls;
  // Let solids touch each other; contacts are numbered as they come.
  void add_contact(TouchingSurfaces surfaces, double reach, double margin);
  std::vector<std::unique_ptr<BodyContact<SpaceNodes<double>>>> contacts;
  // Let the second node of each pair follow the first, turned about z by an angle [rad].
  void tie(std::vector<std::pair<int, int>> pairs, double angle);
  const CyclicTies* ties() const { return ties_.get(); }  // null: there are none
  bool has_nodal_volumes() const { return !nodal_volumes_.empty(); }

  bool is_sheet(int block) const { return sheets_[block] != nullptr; }
  const SheetBlock<Real>& sheet(int block) const { return *sheets_[block]; }
  SheetBlock<Real>& sheet(int block) { return *sheets_[block]; }

  HangingNodes<Real> hanging;
  void set_hanging(std::vector<HangingNode> nodes);

  // Begin, at positions that have been set, with the state of another loop some shells of which are split here: each of
  // its elements has a share (n) of the parent (n); velocities, contact and friction of a node are means of its
  // parents' (n_nodes, 4).
  void inherit(const SpaceLoop& from, const int* node_parents, const int* parent, const double* share);

  // Lie at rest and without stress where a like loop is, with its masses: what is left is elastic.
  void take_shape(const SpaceLoop& from);

  std::unique_ptr<Drawbeads> beads;  // none without beads
  contact::SheetUnder find_cells() const;

  std::unique_ptr<SheetPressures> pressures;  // none without fluids

  bool ironing = true;  // tools squeeze the sheet; to be set before there are any
  // Least thickness, widest shell, mean edge [mm]; those of a part are given to it.
  std::optional<std::array<double, 3>> sheet_sizes;
  std::array<double, 3> measure_sheet() const;
  std::unique_ptr<ToolContact> contact;  // none without tools
  // To be called when there are tools, and after a change of masses.
  std::unique_ptr<ToolContact> make_contact() const;
  // Let shells touch shells. undeformed (n_nodes, 3) [mm].
  void add_shell_contact(const double* undeformed, const ShellGrip& grip);
  // The same in this part of a whole sheet, which outlives it, of whose nodes place has the numbers here, or -1, and
  // cell the numbers of the part's elements.
  void share_shell_contact(const SpaceLoop& whole, const double* undeformed, const ShellGrip& grip,
                           std::vector<int> place, const std::vector<int>& cell);
  std::unique_ptr<ShellContact> shell_contact;  // none: they do not
  bool shares_shell_contact() const { return sheet_of_parts_ != nullptr; }
  // Overlap of the node that is deepest in a shell [mm], and which they are in the whole sheet; 0, -1, -1: none.
  double find_deepest_in_shell(int& node, int& cell);
  void set_contact_stiffness(double dt);
  void join(std::unique_ptr<Neighbours> of) override;
  // What contact with tools must know of the sheet, after a step of dt: the thickness that relieved tools find.
  auto view_of_tools(double dt) const {
    return SheetView{this->nodes.position.data(), this->nodes.motion.data(),
                     [this](int cell) {
                       const auto [block, element] = find_sheet(cell);
                       return block->value(element, block->rows().thickness) + block->relief(element);
                     },
                     [this](int cell) { return value(cell, &StateRows::spring); }, dt};
  }
  // What contact must know of the sheet, after a step of dt.
  auto view(double dt) const {
    return SheetView{this->nodes.position.data(), this->nodes.motion.data(),
                     [this](int cell) { return value(cell, &StateRows::thickness); },
                     [this](int cell) { return value(cell, &StateRows::spring); }, dt};
  }

 protected:
  void tell_neighbours() override;
  void move_ghosts(double dt) override;
  void take_shared() override;
  bool shares_enough() const override;

 private:
  class SheetBeads;
  class SheetFluids;
  class SheetTools;
  class SheetShells;
  double value(int element, const int StateRows::* row) const {
    const auto [block, own] = find_sheet(element);
    return block->value(own, block->rows().*row);
  }
  // The block of an element, and its number there.
  std::pair<const SheetBlock<Real>*, int> find_sheet(int element) const {
    std::size_t b = 0;
    for (; element >= this->blocks[b]->n(); ++b) element -= this->blocks[b]->n();
    return {sheets_[b], element};
  }
  // The shells' corners, cell by cell (start, node), as contact takes them, solids without any; and their largest and
  // least thickness.
  struct Sheet {
    std::vector<int> start{0}, node;
    double thinnest = std::numeric_limits<double>::infinity(), thickest = 0.0;
  };
  Sheet list_cells() const;
  std::unique_ptr<SheetOfParts<Real>> sheet_of_parts_;  // of shell_contact; none: it knows the nodes of this loop
  const SpaceLoop* whole_ = nullptr;
  // Masses without rotary inertia, before hanging nodes give theirs away (n_nodes) [t].
  std::vector<double> plain_masses() const;
  // Springs of squeezed shells (n_elements); 0 of solids.
  std::vector<double> springs() const;

  std::vector<std::unique_ptr<NodalVolumes>> nodal_volumes_;
  std::unique_ptr<CyclicTies> ties_;
  std::vector<SheetBlock<Real>*> sheets_;  // of blocks; null: solids
  std::unique_ptr<SheetBeads> sheet_beads_;
  std::unique_ptr<SheetFluids> sheet_fluids_;
  std::unique_ptr<SheetTools> sheet_tools_;
  std::unique_ptr<SheetShells> sheet_shells_;
};

}  // namespace presswork::explicit_dynamics
