// SPDX-License-Identifier: Apache-2.0
#include "explicit/contact/tool_contact.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace presswork::explicit_dynamics {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

using touching::dot;

}  // namespace

ToolContact::ToolContact(int n_nodes, const std::vector<int>& cell_start, const std::vector<int>& cell_node,
                         double thickness, double cell_width, double edge, const std::vector<double>& bearing)
    : n_nodes_(n_nodes),
      node_start_(std::size_t(n_nodes) + 1, 0),
      node_cell_(cell_node.size()),
      base_(fill(n_nodes), 0.0),
      half_(base_.size(), 0.0),
      bearing_(base_.size(), 0.0),
      room_(base_.size(), never),
      held_(base_.size(), 0.0),
      ironing_(!bearing.empty()),
      memory_(0.005 * thickness),
      awake_within_(ironing_ ? 0.25 * thickness : memory_),
      reach_(2.0 * std::max(thickness, cell_width)),
      edges_(n_nodes, cell_start, cell_node, edge, 2.0 * memory_, reach_) {
  for (int node : cell_node) ++node_start_[node + 1];
  for (int i = 0; i < n_nodes; ++i) node_start_[i + 1] += node_start_[i];
  std::vector<int> next(node_start_.begin(), node_start_.end() - 1);
  for (int cell = 0; cell + 1 < static_cast<int>(cell_start.size()); ++cell)
    for (int a = cell_start[cell]; a < cell_start[cell + 1]; ++a) {
      node_cell_[next[cell_node[a]]++] = cell;
      if (ironing_) bearing_[cell_node[a]] += bearing[cell];
    }
}

void ToolContact::add(std::shared_ptr<const contact::ToolSurface> surface, const Grip& grip) {
  tools.push_back({});
  tools.back().surface = std::move(surface);
  tools.back().grip = grip;
  const int slots = fill(n_nodes_);
  Touching off;
  std::memset(static_cast<void*>(&off), 0, sizeof off);
  pairs_.push_back({std::vector<Touching>(slots / width, off), std::vector<int>(slots, -1),
                    std::vector<double>(slots / width, 0.0)});
  for (int slot = 0; slot < slots; ++slot)
    if (slot >= n_nodes_ || node_start_[slot] == node_start_[slot + 1])
      pairs_.back().packs[slot / width].wake.set(slot % width, never);
  for (int node : left_) leave(static_cast<int>(pairs_.size()) - 1, node);
  sums_.assign(std::size_t(node_chunks()) * tools.size(), {});
  edges_.add(tools.back());
}

void ToolContact::leave_to_others(const std::vector<int>& nodes, const std::vector<char>& is_left, bool leads) {
  left_ = nodes, leads_ = leads;
  edges_.leave_to_others(is_left);
}

void ToolContact::leave(int tool, int node) {
  auto* row = reinterpret_cast<Pack*>(&pairs_[tool].packs[node / width]);
  for (int r = 0; r < rows; ++r) row[r].set(node % width, 0.0);
  pairs_[tool].packs[node / width].wake.set(node % width, never);
}

void ToolContact::remove(int tool) {
  double normal = 0.0, shear = 0.0;
  edges_.add_stored(tool, tools[tool].grip, normal, shear);
  edges_.forget(tool);
  for (int node = 0; node < n_nodes_; ++node) {
    const double pressed = value(tool, node, &Touching::pressed), k = stiffness(tool, node);
    if (pressed > 0.0) normal += 0.5 * k * pressed * pressed;
    if (value(tool, node, &Touching::squeezed) > 0.0) {
      normal += held_[node];
      room_[node] = never, held_[node] = 0.0;
    }
  }
  if (tools[tool].pushed && leads_) normal += 0.5 * tools[tool].mass * dot(tools[tool].velocity, tools[tool].velocity);
  total_.damping += normal;
  tools[tool].pushed = false, tools[tool].removed = true;
  for (Tool& other : tools)
    if (other.stop == tool) other.stop = -1;
  for (Touching& p : pairs_[tool].packs) {
    for (Pack& s : p.shear) s = Pack(0.0);
    p.pressed = p.viscous = p.squeezed = Pack(0.0), p.wake = Pack(never);
  }
}

void ToolContact::place(int tool, const double displacement[3]) {
  for (int i = 0; i < 3; ++i) tools[tool].displacement[i] = displacement[i];
  for (Touching& p : pairs_[tool].packs) {
    p.left = Pack(0.0);
    p.wake = select(p.wake < Pack(never), Pack(0.0), p.wake);
  }
  pairs_[tool].look_again();
  edges_.wake(tool);
}

double ToolContact::shear_squared(int tool, int node) const {
  const Touching& p = pairs_[tool].packs[node / width];
  double sum = 0.0;
  for (const Pack& s : p.shear) sum += s[node % width] * s[node % width];
  return sum;
}

// Energy in the springs of contact and of stick.
void ToolContact::add_stored(double& normal, double& shear) const {
  for (int t = 0; t < static_cast<int>(tools.size()); ++t) {
    for (int i = 0; i < n_nodes_; ++i) {
      const double pressed = value(t, i, &Touching::pressed), k = stiffness(t, i);
      if (!(pressed > 0.0 || value(t, i, &Touching::squeezed) > 0.0)) continue;
      normal += 0.5 * k * pressed * pressed;
      shear += 0.5 * shear_squared(t, i) / k;
    }
    edges_.add_stored(t, tools[t].grip, normal, shear);
  }
  for (double energy : held_) normal += energy;
}

void ToolContact::set_stiffness(const std::vector<double>& node_mass, const std::vector<double>& cell_mass,
                                const std::vector<double>& spring_ratio, double dt) {
  double normal[2] = {}, shear[2] = {};
  add_stored(normal[0], shear[0]);
  step_ = dt;
  for (int i = 0; i < n_nodes_; ++i) {
    base_[i] = node_mass[i] / (dt * dt);
    double ratio = 0.0;
    const int first = node_start_[i], last = node_start_[i + 1];
    for (int s = first; s < last; ++s) ratio += spring_ratio[node_cell_[s]] / (last - first);
    held_[i] *= ratio;
  }
  edges_.set_stiffness(cell_mass, dt);
  add_stored(normal[1], shear[1]);
  total_.squeeze += normal[1] - normal[0] + shear[1] - shear[0];  // no work was done
  total_.friction += shear[1] - shear[0];
}

// A node that was there keeps its tangent plane; a new one asks the surface in the next cycle. Force is traction times
// mass, so that a node whose shells were split has less of it.
void ToolContact::inherit(const ToolContact& from, const int* parents) {
  double normal[2] = {}, shear[2] = {};
  from.add_stored(normal[0], shear[0]);
  total_ = from.total_, work_ = from.work_, cycle_ = from.cycle_;
  started_ = static_cast<int>(tools.size());
  for (int i = 0; i < n_nodes_; ++i) {
    half_[i] = room_[i] = held_[i] = 0.0;
    for (int a = 0; a < 4; ++a) {
      const int parent = parents[4 * std::size_t(i) + a];
      half_[i] += 0.25 * from.half_[parent], room_[i] += 0.25 * from.room_[parent];
      if (from.base_[parent] > 0.0) held_[i] += 0.25 * from.held_[parent] * base_[i] / from.base_[parent];
    }
  }
  for (std::size_t t = 0; t < tools.size(); ++t) {
    pairs_[t].look_again();
    Tool& tool = tools[t];
    const Tool& other = from.tools[t];
    for (int i = 0; i < 3; ++i) {
      tool.displacement[i] = other.displacement[i];
      tool.velocity[i] = other.velocity[i], tool.force[i] = other.force[i];
    }
    tool.push = other.push, tool.was_pushed = other.was_pushed, tool.travel = other.travel;
    for (int i = 0; i < n_nodes_; ++i) {
      const int* p = parents + 4 * std::size_t(i);
      Touching& to = pairs_[t].packs[i / width];
      const int lane = i % width;
      const bool is_old = p[0] == p[1] && p[0] == p[2] && p[0] == p[3];
      if (!(to.wake[lane] < never)) continue;  // in no shell
      double row[rows] = {};
      for (int a = 0; a < 4; ++a) {
        const auto* own = reinterpret_cast<const Pack*>(&from.pairs_[t].packs[p[a] / width]);
        const double base = from.base_[p[a]];
        for (int r = 0; r < rows; ++r) {
          const Pack* at = &reinterpret_cast<const Pack*>(&to)[r];
          const bool is_force = at == &to.viscous || at == &to.squeezed || (at >= to.shear && at < to.shear + 3);
          row[r] += 0.25 * own[r][p[a] % width] * (is_force && base > 0.0 ? base_[i] / base : 1.0);
        }
      }
      for (int r = 0; r < rows; ++r) reinterpret_cast<Pack*>(&to)[r].set(lane, row[r]);
      pairs_[t].hint[i] = from.pairs_[t].hint[p[0]];
      if (is_old || !(to.wake[lane] < never)) continue;  // of a tool taken away
      const double size = std::sqrt(dot(to.normal, to.normal)[lane]);
      for (Pack& n : to.normal) n.set(lane, size > 0.0 ? n[lane] / size : 0.0);
      to.left.set(lane, 0.0), to.wake.set(lane, 0.0);
    }
  }
  add_stored(normal[1], shear[1]);
  total_.damping += normal[0] - normal[1] + shear[0] - shear[1];  // no work was done: it is lost
  total_.friction += shear[1] - shear[0];
}

// The points' half thickness changes, and so does what contact holds.
void ToolContact::set_half(int slot, const Pack& half) {
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (!tools[t].grip.thickness) continue;
    const Pack then = pairs_[t].packs[slot / width].pressed, zero(0.0);
    // springs of squeezed shells follow their thickness, and centring does not ask for it
    const Mask on = both(then > zero, invert(pairs_[t].packs[slot / width].squeezed > zero));
    if (!any(on)) continue;
    sums_[slot / chunk * tools.size() + t].add(
        LaneSums::squeeze, slot,
        press_thicker(tools[t].grip.penalty, load(base_, slot), then, on, half, load(half_, slot)));
  }
  for (int lane = 0; lane < width; ++lane) half_[slot + lane] = half[lane];
}

// Ask the surface about one point. Where nothing is near the plane has no normal, and the bound of the distance.
void ToolContact::ask(const Tool& tool, Pairs& of, int slot, int lane, const Pack place[3], LaneSums& sums) const {
  Touching& p = of.packs[slot / width];
  const double x[3] = {place[0][lane], place[1][lane], place[2][lane]};
  double normal[3], offset, left;
  if (!take_plane(*tool.surface, x, reach_, memory_, half_[slot + lane], of.hint[slot + lane], normal, offset, left) &&
      p.pressed[lane] > 0.0)
    sums.lost = std::min(sums.lost, slot + lane);
  for (int i = 0; i < 3; ++i) p.normal[i].set(lane, normal[i]);
  p.offset.set(lane, offset), p.left.set(lane, left);
}

// The tangent plane, asked for anew where the point has slipped on.
void ToolContact::follow(int number, int slot, Mask awake, const Pack x[3], const Pack dx[3], LaneSums& sums) {
  const Tool& tool = tools[number];
  Touching& p = pairs_[number].packs[slot / width];
  const Pack zero(0.0), way = measure_slip(p.normal, dx);
  Pack place[3];
  for (int i = 0; i < 3; ++i) place[i] = x[i] - Pack(tool.displacement[i]);
  p.left = select(awake, p.left - way, p.left);
  const Mask asking = both(awake, p.left.v <= zero.v);
  if (any(asking))
    for (int lane = 0; lane < width; ++lane)
      if (asking[lane]) ask(tool, pairs_[number], slot, lane, place, sums);
}

ToolContact::Pinch ToolContact::find_pinch(int slot, const Pack x[3], const Pack v[3], double dt) const {
  return explicit_dynamics::find_pinch(
      static_cast<int>(tools.size()), [&](int t) -> const RigidTool& { return tools[t]; },
      [&](int t) -> const Touching& { return pairs_[t].packs[slot / width]; }, x, v, load(half_, slot),
      load(base_, slot), load(bearing_, slot), dt);
}

void ToolContact::touch(int number, int slot, Mask awake, const Pack x[3], const Pack dx[3], double dt,
                        const Pinch& pinch, LaneSums& sums, Pack on_sheet[3]) {
  const Tool& tool = tools[number];
  const Pack half = tool.grip.thickness ? load(half_, slot) : Pack(0.0);
  Pack place[3];
  for (int i = 0; i < 3; ++i) place[i] = x[i] - Pack(tool.displacement[i]);
  const auto found = press(tool, number, awake, place, dx, half, load(base_, slot), damper(tool.grip, step_, dt),
                           awake_within_, pinch, pairs_[number].packs[slot / width], on_sheet);
  sums.add(LaneSums::damping, slot, found.damping);
  sums.add(LaneSums::squeeze, slot, found.squeeze);
  sums.add_force(found.force, slot);
  sums.add(LaneSums::friction, slot, found.friction);
}

void ToolContact::move_tools(int cycle, double dt, double fastest) {
  ToolWork counted_by_others;
  explicit_dynamics::move_tools(
      static_cast<int>(tools.size()), [&](int t) -> RigidTool& { return tools[t]; },
      [&](int t) { return &tools[t].drive[std::size_t(tools[t].pushed ? 1 : 3) * cycle]; }, dt, fastest, work_,
      leads_ ? work_ : counted_by_others);
}

void ToolContact::close_cycle(int first_tool) {
  ++cycle_;
  for (std::size_t t = first_tool; t < tools.size(); ++t) {
    ContactSums sum = edges_.sum_up(static_cast<int>(t));
    for (int c = 0; c < node_chunks(); ++c) sum += sums_[c * tools.size() + t].sum_up();
    for (int i = 0; i < 3; ++i) tools[t].force[i] = -sum.force[i];
    total_ += sum;
  }
}

ContactEnergies ToolContact::energies(double dt) const {
  double normal = 0.0, stuck = 0.0;
  add_stored(normal, stuck);
  return energies(dt, normal, stuck);
}

ContactEnergies ToolContact::energies(double dt, double normal, double stuck) const {
  ContactEnergies e;
  e.penalty = normal + (stuck - total_.squeeze);
  e.friction = total_.friction - stuck;
  e.damping = total_.damping + work_.drag;
  e.external = work_.external;
  for (const Tool& tool : tools) {  // half a step on, as for nodes
    if (tool.pushed) {
      if (!leads_) continue;
      const double before = dot(tool.velocity, tool.direction), after = next_speed(tool, tool.push, dt);
      e.kinetic += 0.5 * tool.mass * before * after;
      e.external += 0.5 * dt * tool.push * before;
      e.damping += 0.25 * dt * tool.drag * tool.mass * before * (before + after);
    } else {
      e.external -= 0.5 * dt * dot(tool.force, tool.velocity);
    }
  }
  return e;
}

void ToolContact::add_forces(double* to) const {
  for (int t = 0; t < static_cast<int>(tools.size()); ++t) add_forces_of(t, to);
}

void ToolContact::add_forces_of(int t, double* to) const {
  for (int node = 0; node < n_nodes_; ++node) {
    const double pressed = value(t, node, &Touching::pressed), squeezed = value(t, node, &Touching::squeezed);
    if (!(pressed > 0.0 || squeezed > 0.0)) continue;
    const Touching& p = pairs_[t].packs[node / width];
    const int lane = node % width;
    const double normal = stiffness(t, node) * pressed + squeezed + p.viscous[lane];
    for (int i = 0; i < 3; ++i) to[3 * std::size_t(node) + i] += normal * p.normal[i][lane] + p.shear[i][lane];
  }
  edges_.add_forces(t, tools[t].grip, to);
}

}  // namespace presswork::explicit_dynamics
