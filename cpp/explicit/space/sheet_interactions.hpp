// SPDX-License-Identifier: Apache-2.0
// What acts on a sheet, as interactions of its loop (interaction.hpp): drawbeads, pressure, tools, and shells that
// touch shells.
#pragma once

#include <stdexcept>
#include <vector>

#include "explicit/space/loop.hpp"

namespace presswork::explicit_dynamics {

// Drawbeads as an interaction: one thread visits their points.
template <class Real>
class SpaceLoop<Real>::SheetBeads final : public Interaction<SpaceNodes<Real>> {
 public:
  explicit SheetBeads(SpaceLoop& loop) : loop_(loop) {}
  void begin(SpaceNodes<Real>&, int n_cycles) override {
    if (!loop_.beads) return;
    for (const Drawbead& bead : loop_.beads->beads)
      if (bead.share.size() < std::size_t(n_cycles))
        throw std::invalid_argument("a bead is not driven for as many cycles");
  }
  void agree(SpaceNodes<Real>& nodes, Neighbours& parts, const Step&) override {
    if (loop_.beads) loop_.beads->agree(nodes.position.data(), SpaceNodes<Real>::position_stride, parts);
  }
  void move(const Step& step, int, double) override {
    if (loop_.beads) loop_.beads->look(step.dt, loop_.nodes);
  }
  int n_rounds() const override { return loop_.beads ? 1 : 0; }
  int n_pieces(int) const override { return 1; }
  void act(SpaceNodes<Real>& nodes, const Step& step, int cycle, int, int) override {
    loop_.beads->visit(cycle, step.dt, nodes, loop_.contact ? &loop_.contact->tools : nullptr,
                       nodes.internal_force.data());
  }
  void share_masses(std::vector<double>&) override {
    if (loop_.beads) loop_.beads->set_masses(loop_.element_masses());
  }
  void add_energies(double, Energies& e) const override {
    if (loop_.beads) e.contact += loop_.beads->stored(), e.friction += loop_.beads->lost();
  }
  void list_state(std::vector<StateField>& fields) override {
    if (loop_.beads) loop_.beads->list_state(fields);
  }

 private:
  SpaceLoop& loop_;
};

// Pressure as an interaction: shells, then the pressures, then nodes.
template <class Real>
class SpaceLoop<Real>::SheetFluids final : public Interaction<SpaceNodes<Real>> {
 public:
  explicit SheetFluids(SpaceLoop& loop) : loop_(loop) {}
  void begin(SpaceNodes<Real>&, int n_cycles) override {
    if (loop_.pressures && !loop_.pressures->lasts(n_cycles))
      throw std::invalid_argument("a pressure is not given for as many cycles");
  }
  int n_rounds() const override { return loop_.pressures ? 3 : 0; }
  int n_pieces(int round) const override {
    return round == 0 ? loop_.pressures->n_cell_chunks() : round == 1 ? 1 : loop_.pressures->n_node_chunks();
  }
  void act(SpaceNodes<Real>& nodes, const Step& step, int cycle, int round, int piece) override {
    if (round == 0)
      loop_.pressures->visit_cells(piece, nodes, step.dt);
    else if (round == 1)
      loop_.work.external += loop_.pressures->find_pressures(cycle);
    else
      loop_.pressures->gather(piece, nodes.internal_force.data());
  }
  void list_state(std::vector<StateField>& fields) override {
    if (loop_.pressures) loop_.pressures->list_state(fields);
  }

 private:
  SpaceLoop& loop_;
};

// Contact with tools as an interaction: edges, then nodes.
template <class Real>
class SpaceLoop<Real>::SheetTools final : public Interaction<SpaceNodes<Real>> {
 public:
  explicit SheetTools(SpaceLoop& loop) : loop_(loop) {}
  void begin(SpaceNodes<Real>& nodes, int n_cycles) override {
    nodes.room = loop_.contact ? loop_.contact->room() : nullptr;
    if (!loop_.contact) return;
    for (const Tool& tool : loop_.contact->tools)
      if (!tool.removed && tool.drive.size() < std::size_t(tool.pushed ? 1 : 3) * n_cycles)
        throw std::invalid_argument("a tool is not driven for as many cycles");
  }
  void move(const Step& step, int cycle, double fastest) override {
    if (loop_.contact) loop_.contact->move_tools(cycle, step.dt, fastest);
  }
  int n_rounds() const override { return loop_.contact ? 2 : 0; }
  int n_pieces(int round) const override {
    return round == 0 ? loop_.contact->edge_chunks() : loop_.contact->node_chunks();
  }
  void act(SpaceNodes<Real>& nodes, const Step& step, int, int round, int piece) override {
    const auto sheet = loop_.view_of_tools(step.dt);
    if (round == 0)
      loop_.contact->visit_edges(piece, sheet);
    else
      loop_.contact->visit_nodes(piece, sheet, nodes.internal_force.data());
  }
  void close() override { loop_.contact->close_cycle(); }
  void add_energies(double dt, Energies& e) const override {
    if (loop_.contact) loop_.contact->energies(dt).add_to(e);
  }
  void list_state(std::vector<StateField>& fields) override {
    if (loop_.contact) loop_.contact->list_state(fields);
  }

 private:
  SpaceLoop& loop_;
};

// Contact of shells with shells as an interaction: forces are found, then gathered.
template <class Real>
class SpaceLoop<Real>::SheetShells final : public Interaction<SpaceNodes<Real>> {
 public:
  explicit SheetShells(SpaceLoop& loop) : loop_(loop) {}
  void agree(SpaceNodes<Real>&, Neighbours& parts, const Step& step) override {
    if (!loop_.shell_contact) return;
    SheetOfParts<Real>& sheet = *loop_.sheet_of_parts_;
    ShellContact& contact = *loop_.shell_contact;
    if (contact.pass(step.dt, parts.shared[0])) {
      sheet.learn_all(loop_.view(step.dt), parts);
    } else {
      contact.list_awake();
      sheet.learn(contact.nodes_awake(), contact.cells_awake(), loop_.view(step.dt), parts);
    }
  }
  void move(const Step& step, int, double fastest) override {
    if (!loop_.shell_contact) return;
    if (!loop_.sheet_of_parts_) loop_.shell_contact->pass(step.dt, fastest);
    with_sheet(step.dt, [this](const auto& sheet) { loop_.shell_contact->follow(sheet); });
  }
  int n_rounds() const override { return loop_.shell_contact ? 2 : 0; }
  int n_pieces(int) const override { return loop_.shell_contact->chunks(); }
  void act(SpaceNodes<Real>& nodes, const Step& step, int, int round, int piece) override {
    const SheetOfParts<Real>* parts = loop_.sheet_of_parts_.get();
    if (round == 0)
      with_sheet(step.dt, [&](const auto& sheet) { loop_.shell_contact->find_forces(piece, sheet); });
    else
      loop_.shell_contact->gather(piece, nodes.internal_force.data(), parts ? parts->place() : nullptr);
  }
  // Call with what contact must know of the sheet, after a step of dt.
  template <class Use>
  void with_sheet(double dt, const Use& use) const {
    if (loop_.sheet_of_parts_)
      use(loop_.sheet_of_parts_->view(dt));
    else
      use(loop_.view(dt));
  }
  void close() override { loop_.shell_contact->close_cycle(); }
  void add_energies(double, Energies& e) const override {
    if (!loop_.shell_contact || (loop_.parts() && !loop_.parts()->leads)) return;
    const ShellContact::Work& work = loop_.shell_contact->work();
    e.contact += work.elastic, e.friction += work.friction, e.damping += work.damping;
  }
  void list_state(std::vector<StateField>& fields) override {
    if (loop_.shell_contact) loop_.shell_contact->list_state(fields);
  }

 private:
  SpaceLoop& loop_;
};

}  // namespace presswork::explicit_dynamics
