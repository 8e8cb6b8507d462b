// SPDX-License-Identifier: Apache-2.0
#include "explicit/plane/nodes.hpp"

#include <algorithm>

namespace presswork::explicit_dynamics {

PlaneNodes::PlaneNodes(int n, const double* points, const std::uint8_t* contact)
    : n(n),
      position(position_stride * padded()),
      velocity(2 * padded()),
      force(2 * padded()),
      internal_force(2 * padded()),
      mass(n),
      reaction_impulse(2 * std::size_t(n)),
      contact_(contact, contact + n),
      fixed_(2 * std::size_t(n)),
      kind_(padded()),
      apart_(padded() / 4),
      inverse_mass_(2 * padded()),
      prescribed_(2 * std::size_t(n)) {
  for (int i = 0; i < n; ++i)
    std::copy_n(points + 2 * std::size_t(i), 2, position.data() + position_stride * std::size_t(i));
}

void PlaneNodes::set_masses(const std::vector<double>& sum) {
  mass = sum;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k) inverse_mass_.data()[2 * std::size_t(i) + k] = mass[i] > 0.0 ? 1.0 / mass[i] : 0.0;
}

void PlaneNodes::add_wall(RigidWall* wall) {
  walls.push_back(wall);
  find_kinds();
}

void PlaneNodes::prescribe(const std::uint8_t* fixed, const double* velocity) {
  std::copy_n(fixed, fixed_.size(), fixed_.begin());
  std::copy_n(velocity, prescribed_.size(), prescribed_.begin());
  find_kinds();
}

void PlaneNodes::leave(const std::vector<int>& nodes) {
  for (int node : nodes) kind_[node] = led;
  find_kinds();
}

void PlaneNodes::find_kinds() {
  std::fill(apart_.begin(), apart_.end(), 0);
  for (std::size_t i = 0; i < std::size_t(n); ++i) {
    if (kind_[i] != led)
      kind_[i] = fixed_[2 * i] || fixed_[2 * i + 1] || (contact_[i] && !walls.empty()) ? alone : plain;
    if (kind_[i] != plain) apart_[i / 4] = 1;
  }
}

Work PlaneNodes::step_node(int node, const Step& step, bool whole, double after[2]) const {
  const std::size_t at = 2 * std::size_t(node);
  const double m = mass[node], kept = step.kept, push = m > 0.0 ? step.push / m : 0.0;
  const double *x = position.data() + 2 * at, *v = velocity.data() + at, *inner = internal_force.data() + at;
  // 1. forces and prescribed velocities; the outer force of these is the one that gives them
  double outer[2], free[2];
  for (int i = 0; i < 2; ++i) {
    outer[i] = step.force_scale * force.data()[at + i];
    after[i] = kept * v[i] + push * (outer[i] - inner[i]);
    free[i] = !fixed_[at + i];
    if (!fixed_[at + i]) continue;
    after[i] = step.velocity_scale * prescribed_[at + i];
    outer[i] = inner[i] + (m > 0.0 ? (after[i] - kept * v[i]) / push : 0.0);
  }
  // 2. walls: forces of pressure and of friction, and what the walls' own motion does by them
  double pressure[2] = {0.0, 0.0}, friction[2] = {0.0, 0.0}, by_pressure = 0.0, by_friction = 0.0;
  for (RigidWall* wall : walls) {
    double *kept_force = &wall->force[at], *kept_friction = &wall->friction[at];
    if (whole) kept_force[0] = kept_force[1] = kept_friction[0] = kept_friction[1] = 0.0;
    if (!contact_[node] || m == 0.0) continue;
    const double w[2] = {step.velocity_scale * wall->velocity[0], step.velocity_scale * wall->velocity[1]};
    double normal[2], slide[2];
    if (!wall->constrain(x, step.dt, w, free, after, normal, slide)) continue;
    for (int i = 0; i < 2; ++i) {
      pressure[i] += normal[i] / push, by_pressure += w[i] * normal[i] / push;
      friction[i] += slide[i] / push, by_friction += w[i] * slide[i] / push;
      if (whole) kept_force[i] = (normal[i] + slide[i]) / push, kept_friction[i] = slide[i] / push;
    }
  }
  // 3. work, by the mean velocity of the step or that of its first half
  Work done;
  const double time = whole ? step.mean_dt : 0.5 * step.mean_dt;
  done.external = time * (by_pressure + by_friction);
  done.contact = time * by_pressure, done.friction = time * by_friction;
  for (int i = 0; i < 2; ++i) {
    const double mean = 0.5 * (v[i] + after[i]), by = whole ? mean : v[i];
    done.external += time * outer[i] * by;
    done.damping += time * step.damping * m * mean * by;
    done.contact -= time * pressure[i] * by;
    done.friction -= time * friction[i] * by;
  }
  return done;
}

void PlaneNodes::move_one(int node, const Step& step, Work& sum) {
  const std::size_t at = 2 * std::size_t(node);
  double after[2];
  sum.add(step_node(node, step, true, after));
  const double mean[2] = {0.5 * (velocity.data()[at] + after[0]), 0.5 * (velocity.data()[at + 1] + after[1])};
  for (int i = 0; i < 2; ++i) {
    if (fixed_[at + i])
      reaction_impulse[at + i] +=
          step.mean_dt * (internal_force.data()[at + i] - step.force_scale * force.data()[at + i] +
                          mass[node] * (after[i] - step.kept * velocity.data()[at + i]) / step.push);
    velocity.data()[at + i] = after[i];
  }
  step_on(node, step.dt);
  if (!contact_[node]) return;
  for (RigidWall* wall : walls) {
    const double w[2] = {step.velocity_scale * wall->velocity[0], step.velocity_scale * wall->velocity[1]};
    wall->add_to_chunk(node);
    wall->add_to_sums(node, step.mean_dt, mean, w);
  }
}

void PlaneNodes::move_four(int first, const Step& step, Record& external, Record& damped, Work& sum) {
  const std::size_t at = 2 * std::size_t(first);
  const Record before = load_record(velocity.data() + at), inverse = load_record(inverse_mass_.data() + at);
  const Record outer = step.force_scale * load_record(force.data() + at);
  const Record after = step.kept * before + step.push * inverse * (outer - load_record(internal_force.data() + at));
  Freedoms counts = {-1, -1, -1, -1, -1, -1, -1, -1};
  const bool apart = apart_[first / 4];
  for (int i = 0; apart && i < 8; ++i) counts[i] = kind_[first + i / 2] == plain ? -1 : 0;
  external += counts ? outer * (before + after) : Record{};
  if (step.damping > 0.0) {
    const Record mean = 0.5 * (before + after);
    damped += (inverse > 0.0) & counts ? mean * mean / inverse : Record{};
  }
  const Record move = step.dt * after, twice[2] = {__builtin_shufflevector(move, move, 0, 1, 0, 1, 2, 3, 2, 3),
                                                   __builtin_shufflevector(move, move, 4, 5, 4, 5, 6, 7, 6, 7)};
  Record next[2];
  for (int half = 0; half < 2; ++half) {
    const Record now = load_record(position.data() + 2 * at + 8 * half);
    next[half] = twice[half] + __builtin_shufflevector(now, Record{}, 0, 1, 8, 8, 4, 5, 8, 8);
  }
  if (!apart) {
    store_record<8>(after, velocity.data() + at);
    for (int half = 0; half < 2; ++half) store_record<8>(next[half], position.data() + 2 * at + 8 * half);
    return;
  }
  for (int i = 0; i < 4; ++i) {
    if (kind_[first + i] == alone) move_one(first + i, step, sum);
    if (kind_[first + i] != plain) continue;
    for (int k = 0; k < 2; ++k) velocity.data()[at + 2 * i + k] = after[2 * i + k];
    for (int k = 0; k < 4; ++k) position.data()[2 * at + 4 * i + k] = next[i / 2][4 * (i % 2) + k];
  }
}

Moved PlaneNodes::move(int first, int last, const Step& step) {
  for (RigidWall* wall : walls) wall->open_chunk(first);
  Work sum;
  Record external{}, damped{};
  for (int node = first; node < last; node += 4) move_four(node, step, external, damped, sum);
  for (int i = 0; i < 8; ++i) {
    sum.external += 0.5 * step.mean_dt * external[i];
    sum.damping += step.mean_dt * step.damping * damped[i];
  }
  return {sum, 0.0};
}

void PlaneNodes::add_half_step(const Step& step, Energies& e) const {
  for (int node = 0; node < n; ++node) {
    if (kind_[node] == led) continue;  // counted in another part
    double after[2];
    const Work done = step_node(node, step, false, after);
    e.external += done.external, e.damping += done.damping;
    e.contact += done.contact, e.friction += done.friction;
    for (int i = 0; i < 2; ++i) e.kinetic += 0.5 * mass[node] * velocity.data()[2 * std::size_t(node) + i] * after[i];
  }
}

void PlaneNodes::list_state(std::vector<StateField>& fields) {
  const auto count = static_cast<std::size_t>(n);
  fields.push_back(column_field("nodes", "position", position.data(), count, position_stride, 2));
  fields.push_back(column_field("nodes", "velocity", velocity.data(), count, 2, 2));
  fields.push_back(column_field("nodes", "internal_force", internal_force.data(), count, 2, 2));
}

}  // namespace presswork::explicit_dynamics
