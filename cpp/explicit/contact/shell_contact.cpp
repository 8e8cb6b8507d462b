// SPDX-License-Identifier: Apache-2.0
// What contact of shells with shells knows of the mesh, its forces on the nodes and its state; the search is in
// shell_search.cpp.
#include "explicit/contact/shell_contact.hpp"

#include <utility>

namespace presswork::explicit_dynamics {

ShellContact::ShellContact(int n_nodes, std::vector<int> cell_start, std::vector<int> cell_node,
                           const double* undeformed, double thickness, const ShellGrip& grip)
    : NearShells(n_nodes, std::move(cell_start), std::move(cell_node), undeformed, thickness),
      grip_(grip),
      base_(n_nodes, 0.0),
      margin_(thickness),
      slots_(std::size_t(n_nodes) * faces),
      works_(chunks()) {}

void ShellContact::set_stiffness(const std::vector<double>& node_mass, double dt) {
  step_ = dt;
  for (int i = 0; i < n_nodes_; ++i) base_[i] = node_mass[i] / (dt * dt);
}

bool ShellContact::are_neighbours(int cell, int other) const {
  for (int a = cell_start_[cell]; a < cell_start_[cell + 1]; ++a)
    for (int b = cell_start_[other]; b < cell_start_[other + 1]; ++b)
      if (cell_node_[a] == cell_node_[b]) return true;
  return false;
}

void ShellContact::gather_node(int node, double force[3]) const {
  for (int f = 0; f < faces; ++f)
    if (const Slot& own = slots_[std::size_t(node) * faces + f]; own.cell >= 0) add_force(own, 1.0, force);
  for (int s = node_start_[node]; s < node_start_[node + 1]; ++s) {
    const int cell = node_cell_[s], corner = node_corner_[s];
    for (int i = of_cell_start_[cell]; i < of_cell_start_[cell + 1]; ++i) {
      const int entry = of_cell_[i], face = active_[entry];
      if (face < 0) continue;
      const Slot& slot = slots_[std::size_t(entries_.node[entry]) * faces + face];
      add_force(slot, -slot.weight[corner], force);
    }
  }
}

void ShellContact::close_cycle() {
  for (const Work& each : works_) {
    total_.elastic += each.elastic;
    total_.friction += each.friction;
    total_.damping += each.damping;
  }
}

void ShellContact::add_forces(double* to) const {
  for (int node = 0; node < n_nodes_; ++node)
    for (int f = 0; f < faces; ++f) {
      const Slot& slot = slots_[std::size_t(node) * faces + f];
      if (slot.cell < 0) continue;
      add_force(slot, 1.0, to + 3 * std::size_t(node));
      for (int a = 0; a < corners(slot.cell); ++a)
        add_force(slot, -slot.weight[a], to + 3 * std::size_t(cell_node_[cell_start_[slot.cell] + a]));
    }
}

void ShellContact::list_state(std::vector<StateField>& fields) {
  fields.push_back({"shell_contact",
                    "touching",
                    {slots_.size(), std::size_t(kept)},
                    [this](double* to) {
                      for (const Slot& s : slots_) {
                        *to++ = s.cell;
                        to = std::copy_n(s.normal, 3, to), to = std::copy_n(s.shear, 3, to);
                        *to++ = s.elastic, *to++ = s.viscous;
                        to = std::copy_n(s.weight, 4, to);
                      }
                    },
                    [this](const double* from) {
                      for (Slot& s : slots_) {
                        s.cell = static_cast<int>(*from++), s.entry = -1;
                        std::copy_n(from, 3, s.normal), from += 3;
                        std::copy_n(from, 3, s.shear), from += 3;
                        s.elastic = *from++, s.viscous = *from++;
                        std::copy_n(from, 4, s.weight), from += 4;
                      }
                      searched_ = false;
                    }});
  fields.push_back(row_field("shell_contact", "work", &total_.elastic, 3));
  fields.push_back(row_field("shell_contact", "step", &step_, 1));
}

}  // namespace presswork::explicit_dynamics
