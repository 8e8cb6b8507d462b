// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "explicit/space/sheet_interactions.hpp"
#include "explicit/space/shell_section.hpp"

namespace presswork::explicit_dynamics {

template <class Real>
SpaceLoop<Real>::SpaceLoop(int n_nodes, const double* points)
    : Base(SpaceNodes<Real>(n_nodes, points)),
      sheet_beads_(std::make_unique<SheetBeads>(*this)),
      sheet_fluids_(std::make_unique<SheetFluids>(*this)),
      sheet_tools_(std::make_unique<SheetTools>(*this)),
      sheet_shells_(std::make_unique<SheetShells>(*this)) {
  this->interactions = {sheet_beads_.get(), sheet_fluids_.get(), sheet_tools_.get(), sheet_shells_.get(), &hanging};
}

template <class Real>
SpaceLoop<Real>::~SpaceLoop() = default;

template <class Real>
void SpaceLoop<Real>::join(std::unique_ptr<Neighbours> of) {
  if (contact) throw std::invalid_argument("a part joins the others before it has tools");
  auto& follows = this->nodes.follows;
  follows.resize(this->nodes.n, 0);
  for (int node : of->ghosts) follows[node] = 1;
  Base::join(std::move(of));
}

template <class Real>
void SpaceLoop<Real>::tell_neighbours() {
  Neighbours& to = *this->neighbours_;
  double* record = to.out;
  for (int node : to.sent) {
    const Real* motion = this->nodes.motion.data() + std::size_t(this->nodes.motion_stride) * node;
    for (int i = 0; i < std::min(to.record, freedoms); ++i) record[i] = motion[i];
    if (to.record > Neighbours::room) {
      record[Neighbours::half] = contact ? contact->half(node) : 0.0;
      record[Neighbours::room] = contact ? contact->room_at(node) : 0.0;
    }
    record += to.record;
  }
  double* share = to.shared + Neighbours::first_force;
  if (contact)
    for (const Tool& tool : contact->tools)
      for (int i = 0; i < 3; ++i) *share++ = tool.pushed ? tool.force[i] : 0.0;
  for (const auto& wall : walls) wall->sum_chunks(share), share += 4;
}

template <class Real>
void SpaceLoop<Real>::move_ghosts(double dt) {
  const Neighbours& from = *this->neighbours_;
  const double* record = from.in;
  for (int node : from.ghosts) {
    Real* motion = this->nodes.motion.data() + std::size_t(this->nodes.motion_stride) * node;
    for (int i = 0; i < std::min(from.record, freedoms); ++i) motion[i] = static_cast<Real>(record[i]);
    if (!hanging.hangs(node)) this->nodes.step_on(node, dt);
    if (contact) contact->half(node) = record[Neighbours::half], contact->room_at(node) = record[Neighbours::room];
    record += from.record;
  }
}

template <class Real>
void SpaceLoop<Real>::take_shared() {
  const double* share = this->neighbours_->shared + Neighbours::first_force;
  if (contact)
    for (Tool& tool : contact->tools) {
      if (tool.pushed) std::copy_n(share, 3, tool.force);
      share += 3;
    }
  for (const auto& wall : walls) wall->of_all_parts = share, share += 4;
}

template <class Real>
bool SpaceLoop<Real>::shares_enough() const {
  const std::size_t forces = 3 * (contact ? contact->tools.size() : 0) + 4 * walls.size();
  return this->neighbours_->n_shared >= Neighbours::first_force + static_cast<int>(forces);
}

template <class Real>
void SpaceLoop<Real>::add_sheet(std::unique_ptr<SheetBlock<Real>> block) {
  sheets_.push_back(block.get());
  this->add(std::move(block));
}

template <class Real>
void SpaceLoop<Real>::add_solids(std::unique_ptr<ElementBlock<SpaceNodes<Real>>> block) {
  sheets_.push_back(nullptr);
  this->add(std::move(block));
}

template <class Real>
const NodalVolumes& SpaceLoop<Real>::add_nodal_volumes(const std::vector<int>& cells) {
  nodal_volumes_.push_back(std::make_unique<NodalVolumes>(this->nodes.n, cells));
  if constexpr (std::is_same_v<Real, double>) {
    this->interactions.push_back(&nodal_volumes_.back()->of_cells);
    this->interactions.push_back(&nodal_volumes_.back()->of_nodes);
  }
  return *nodal_volumes_.back();
}

template <class Real>
void SpaceLoop<Real>::add_wall(std::shared_ptr<const contact::ToolSurface> surface, const std::uint8_t* touching,
                               double mu, double reach, const WallMotion& motion) {
  if constexpr (std::is_same_v<Real, double>) {
    WallBody body;
    body.mu = mu, body.reach = reach, body.motion = motion;
    walls.push_back(
        std::make_unique<SpaceWall>("wall_" + std::to_string(walls.size()), this->nodes.n, std::move(surface), body));
    this->nodes.walls.push_back(walls.back().get());
    this->nodes.touches_walls.assign(touching, touching + this->nodes.n);
    this->interactions.push_back(walls.back().get());
  }
}

template <class Real>
void SpaceLoop<Real>::add_contact(TouchingSurfaces surfaces, double reach, double margin) {
  if constexpr (std::is_same_v<Real, double>) {
    const std::string name = "bodies_" + std::to_string(contacts.size());
    contacts.push_back(
        std::make_unique<BodyContact<SpaceNodes<double>>>(name, this->nodes.n, std::move(surfaces), reach, margin));
    this->interactions.insert(this->interactions.begin(), contacts.back().get());  // before nodes give forces away
  }
}

template <class Real>
void SpaceLoop<Real>::tie(std::vector<std::pair<int, int>> pairs, double angle) {
  if constexpr (std::is_same_v<Real, double>) {
    auto& follows = this->nodes.follows;
    follows.assign(this->nodes.n, 0);
    if (this->neighbours_) std::copy_n(this->neighbours_->is_ghost.begin(), this->nodes.n, follows.begin());
    for (const auto& pair : pairs) follows[pair.second] = 1;
    ties_ = std::make_unique<CyclicTies>(std::move(pairs), angle);
    // before what measures volumes, behind what pushes nodes
    this->interactions.insert(this->interactions.begin() + static_cast<std::ptrdiff_t>(contacts.size()), ties_.get());
    this->set_masses();
  }
}

template <class Real>
void SpaceLoop<Real>::set_hanging(std::vector<HangingNode> of) {
  hanging.set(this->nodes, std::move(of));
  this->set_masses();
}

template <class Real>
void SpaceLoop<Real>::inherit(const SpaceLoop& from, const int* node_parents, const int* parent, const double* share) {
  // 1. nodes
  auto& nodes = this->nodes;
  for (int i = 0; i < nodes.n; ++i)
    for (int k = 0; k < freedoms; ++k) {
      double sum = 0.0;
      for (int a = 0; a < 4; ++a)
        sum += from.nodes.motion.data()[std::size_t(nodes.motion_stride) * node_parents[4 * std::size_t(i) + a] + k];
      nodes.motion.data()[std::size_t(nodes.motion_stride) * i + k] = static_cast<Real>(0.25 * sum);
    }
  this->work = from.work;
  // 2. elements
  std::vector<std::pair<const SheetBlock<Real>*, int>> elements;
  for (const auto* sheet : from.sheets_) {
    if (!sheet) throw std::invalid_argument("solids cannot be split");
    for (int e = 0; e < sheet->n(); ++e) elements.emplace_back(sheet, e);
  }
  for (auto* sheet : sheets_) {
    if (!sheet) throw std::invalid_argument("solids cannot be split");
    for (int e = 0; e < sheet->n(); ++e, ++parent, ++share) {
      const auto [own, number] = elements[*parent];
      sheet->inherit(e, *own, number, *share);
    }
  }
  this->set_masses();
  // 3. contact
  if (shell_contact || from.shell_contact) throw std::invalid_argument("shells that touch each other cannot be split");
  if (contact && from.contact) {
    set_contact_stiffness(from.contact->step());
    contact->inherit(*from.contact, node_parents);
  }
}

template <class Real>
void SpaceLoop<Real>::take_shape(const SpaceLoop& from) {
  auto& nodes = this->nodes;
  std::copy_n(from.nodes.position.data(), nodes.position.size(), nodes.position.data());
  std::fill_n(nodes.internal_force.data(), nodes.internal_force.size(), Real(0));
  for (int i = 0; i < nodes.n; ++i)
    std::fill_n(nodes.motion.data() + std::size_t(nodes.motion_stride) * i, freedoms, Real(0));
  for (std::size_t b = 0; b < sheets_.size(); ++b) {
    if (!sheets_[b] || !from.sheets_[b]) throw std::invalid_argument("solids have no shape to take");
    sheets_[b]->take_shape(*from.sheets_[b]);
  }
  this->set_masses();
}

template <class Real>
contact::SheetUnder SpaceLoop<Real>::find_cells() const {
  std::vector<int> start{0}, corner;
  for (std::size_t b = 0; b < sheets_.size(); ++b) {
    if (sheets_[b]) corner.insert(corner.end(), sheets_[b]->connectivity().begin(), sheets_[b]->connectivity().end());
    for (int i = 0; i < this->blocks[b]->n(); ++i)
      start.push_back(start.back() + (sheets_[b] ? sheets_[b]->nodes_each() : 0));
  }
  std::vector<contact::SheetUnder::Hanging> between;
  for (const HangingNode& h : hanging.all()) between.push_back({h.node, {h.end[0], h.end[1]}});
  return {std::move(start), std::move(corner), between};
}

template <class Real>
std::array<double, 3> SpaceLoop<Real>::measure_sheet() const {
  if (sheet_sizes) return *sheet_sizes;
  const auto& nodes = this->nodes;
  const Sheet sheet = list_cells();
  double widest = 0.0, round = 0.0;
  const auto apart = [&](int i, int j) {
    const double *a = nodes.position.data() + std::size_t(nodes.position_stride) * i,
                 *b = nodes.position.data() + std::size_t(nodes.position_stride) * j;
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  };
  for (std::size_t c = 0; c + 1 < sheet.start.size(); ++c) {
    const int* corner = &sheet.node[sheet.start[c]];
    const int each = sheet.start[c + 1] - sheet.start[c];
    if (each > 0) widest = std::max(widest, apart(corner[0], corner[2]));
    for (int a = 0; a < each; ++a) round += apart(corner[a], corner[(a + 1) % each]);
  }
  return {sheet.thinnest, widest, sheet.node.empty() ? 0.0 : round / static_cast<double>(sheet.node.size())};
}

template <class Real>
std::unique_ptr<ToolContact> SpaceLoop<Real>::make_contact() const {
  const Sheet sheet = list_cells();
  if (sheet.node.empty()) throw std::invalid_argument("tools touch shells, and there are none");
  const auto [thinnest, widest, edge] = measure_sheet();
  std::vector<double> bearing;
  for (std::size_t b = 0; ironing && b < sheets_.size(); ++b)
    for (int e = 0; e < this->blocks[b]->n(); ++e)
      bearing.push_back(sheets_[b] ? squeezed::borne * sheets_[b]->section().yield_stress * sheets_[b]->area(e) /
                                         sheets_[b]->nodes_each()
                                   : 0.0);
  auto made = std::make_unique<ToolContact>(this->nodes.n, sheet.start, sheet.node, thinnest, widest, edge, bearing);
  if (const Neighbours* parts = this->parts()) made->leave_to_others(parts->ghosts, parts->is_ghost, parts->leads);
  return made;
}

template <class Real>
typename SpaceLoop<Real>::Sheet SpaceLoop<Real>::list_cells() const {
  Sheet all;
  for (std::size_t b = 0; b < sheets_.size(); ++b) {
    const int each = sheets_[b] ? sheets_[b]->nodes_each() : 0;
    for (int e = 0; e < this->blocks[b]->n(); ++e) all.start.push_back(all.start.back() + each);
    if (!sheets_[b]) continue;
    all.node.insert(all.node.end(), sheets_[b]->connectivity().begin(), sheets_[b]->connectivity().end());
    for (int e = 0; e < sheets_[b]->n(); ++e) {
      const double thickness = sheets_[b]->value(e, sheets_[b]->rows().thickness);
      all.thinnest = std::min(all.thinnest, thickness), all.thickest = std::max(all.thickest, thickness);
    }
  }
  return all;
}

template <class Real>
void SpaceLoop<Real>::add_shell_contact(const double* undeformed, const ShellGrip& grip) {
  Sheet sheet = list_cells();
  if (sheet.node.empty()) throw std::invalid_argument("there are no shells that could touch each other");
  shell_contact = std::make_unique<ShellContact>(this->nodes.n, std::move(sheet.start), std::move(sheet.node),
                                                 undeformed, sheet.thickest, grip);
}

template <class Real>
void SpaceLoop<Real>::share_shell_contact(const SpaceLoop& whole, const double* undeformed, const ShellGrip& grip,
                                          std::vector<int> place, const std::vector<int>& cell) {
  Sheet sheet = whole.list_cells();
  sheet_of_parts_ = std::make_unique<SheetOfParts<Real>>(std::move(place), cell, whole.n_elements());
  whole_ = &whole;
  shell_contact = std::make_unique<ShellContact>(whole.nodes.n, std::move(sheet.start), std::move(sheet.node),
                                                 undeformed, sheet.thickest, grip);
}

template <class Real>
double SpaceLoop<Real>::find_deepest_in_shell(int& node, int& cell) {
  double depth = 0.0;
  sheet_shells_->with_sheet(0.0, [&](const auto& sheet) { depth = shell_contact->deepest(sheet, node, cell); });
  return depth;
}

template <class Real>
std::vector<double> SpaceLoop<Real>::plain_masses() const {
  const std::vector<double> sum = this->sum_masses();
  std::vector<double> masses;
  for (int i = 0; i < this->nodes.n; ++i) masses.push_back(sum[2 * std::size_t(i)]);
  return masses;
}

template <class Real>
std::vector<double> SpaceLoop<Real>::springs() const {
  std::vector<double> all;
  for (std::size_t b = 0; b < sheets_.size(); ++b)
    for (int e = 0; e < this->blocks[b]->n(); ++e)
      all.push_back(sheets_[b] ? sheets_[b]->value(e, sheets_[b]->rows().spring) : 0.0);
  return all;
}

template <class Real>
void SpaceLoop<Real>::set_contact_stiffness(double dt) {
  const std::vector<double> before = springs();
  for (auto* sheet : sheets_)
    if (sheet) sheet->set_springs(dt);
  std::vector<double> ratio = springs();
  for (std::size_t e = 0; e < ratio.size(); ++e) ratio[e] = before[e] > 0.0 ? ratio[e] / before[e] : 1.0;
  if (contact) contact->set_stiffness(plain_masses(), this->element_masses(), ratio, dt);
  if (shell_contact) shell_contact->set_stiffness(whole_ ? whole_->plain_masses() : plain_masses(), dt);
}

template class SpaceLoop<double>;
template class SpaceLoop<float>;

}  // namespace presswork::explicit_dynamics
