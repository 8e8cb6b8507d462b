// SPDX-License-Identifier: Apache-2.0
// The explicit loop in the plane or in axisymmetry: blocks of solids between rigid walls.
#pragma once

#include "explicit/contact/body_contact.hpp"
#include "explicit/loop.hpp"
#include "explicit/plane/solids.hpp"

namespace presswork::explicit_dynamics {

class PlaneLoop final : public Loop<PlaneNodes> {
 public:
  // points (n, 2) [mm]: x is the radius in axisymmetry. contact (n): nodes that walls hold.
  PlaneLoop(int n_nodes, const double* points, const std::uint8_t* contact, const SolidSection& section)
      : Loop(PlaneNodes(n_nodes, points, contact)), section(section) {}

  void add_solids(std::string_view element, std::vector<int> cells, const double* points, PlaneSolidLaw law,
                  double density, const std::vector<double>& kept) {
    auto block = make_plane_solids(element, std::move(cells), points, std::move(law), density, section);
    block->start_law(kept);
    add(std::move(block));
  }
  void add_wall(std::vector<double> segments, double mu) {
    walls.push_back(
        std::make_unique<RigidWall>("wall_" + std::to_string(walls.size()), nodes.n, std::move(segments), mu));
    nodes.add_wall(walls.back().get());
    interactions.push_back(walls.back().get());
  }

  // Let solids touch each other; contacts are numbered as they come.
  void add_contact(TouchingSurfaces surfaces, double reach, double margin) {
    const std::string name = "bodies_" + std::to_string(contacts.size());
    contacts.push_back(std::make_unique<BodyContact<PlaneNodes>>(name, nodes.n, std::move(surfaces), reach, margin));
    interactions.push_back(contacts.back().get());
  }

  void join(std::unique_ptr<Neighbours> of) override {
    nodes.leave(of->ghosts);
    Loop::join(std::move(of));
  }

  const SolidSection section;
  std::vector<std::unique_ptr<BodyContact<PlaneNodes>>> contacts;
  std::vector<std::unique_ptr<RigidWall>> walls;

 protected:
  void tell_neighbours() override {
    double* record = neighbours_->out;
    for (int node : neighbours_->sent)
      for (int i = 0; i < 2; ++i) *record++ = nodes.velocity.data()[2 * std::size_t(node) + i];
    double* share = neighbours_->shared + Neighbours::first_force;
    for (const auto& wall : walls) wall->sum_chunks(share), share += 2;
  }
  void move_ghosts(double dt) override {
    const double* record = neighbours_->in;
    for (int node : neighbours_->ghosts) {
      for (int i = 0; i < 2; ++i) nodes.velocity.data()[2 * std::size_t(node) + i] = *record++;
      nodes.step_on(node, dt);
    }
  }
  void take_shared() override {
    const double* share = neighbours_->shared + Neighbours::first_force;
    for (const auto& wall : walls) wall->of_all_parts = share, share += 2;
  }
  bool shares_enough() const override {
    return neighbours_->n_shared >= Neighbours::first_force + 2 * static_cast<int>(walls.size());
  }
};

}  // namespace presswork::explicit_dynamics
