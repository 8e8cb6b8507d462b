// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/nodes.hpp"

namespace presswork::explicit_dynamics {

namespace {

inline Record inverse_masses(const Record& motion) {
  return __builtin_shufflevector(motion, motion, 6, 6, 6, 7, 7, 7, 6, 7);
}

}  // namespace

template <class Real>
SpaceNodes<Real>::SpaceNodes(int n, const double* points)
    : n(n),
      position(std::size_t(n) * position_stride),
      motion(std::size_t(n) * motion_stride),
      force(row_at(n) + spare),
      internal_force(row_at(n) + spare),
      reaction_impulse(row_at(n)),
      held_(n),
      prescribed_(row_at(n)) {
  for (int i = 0; i < n; ++i)
    std::copy_n(points + 3 * std::size_t(i), 3, position.data() + std::size_t(position_stride) * i);
}

template <class Real>
void SpaceNodes<Real>::set_masses(const std::vector<double>& sum) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < masses; ++j) {
      const double m = sum[masses * std::size_t(i) + j];
      motion.data()[std::size_t(motion_stride) * i + 6 + j] = static_cast<Real>(m > 0.0 ? 1.0 / m : 0.0);
    }
}

template <class Real>
void SpaceNodes<Real>::prescribe(const std::uint8_t* fixed, const double* velocity) {
  for (int i = 0; i < n; ++i) {
    held_[i] = 0;
    for (int j = 0; j < freedoms; ++j) {
      held_[i] |= (fixed[row_at(i) + j] != 0) << j;
      prescribed_[row_at(i) + j] = static_cast<Real>(velocity[row_at(i) + j]);
    }
  }
}

template <class Real>
void SpaceNodes<Real>::hold_along(const std::vector<int>& node, std::vector<HeldAlong> held) {
  held_along_ = std::move(held);
  first_along_.assign(n + 1, 0);
  for (int i : node) ++first_along_[i + 1], held_[i] |= 1 << askew;
  for (int i = 0; i < n; ++i) first_along_[i + 1] += first_along_[i];
}

template <class Real>
FreeMotion SpaceNodes<Real>::free_motion(int node) const {
  FreeMotion free{{}, nullptr, 0};
  for (int i = 0; i < 3; ++i) free.axis[i] = !(held_[node] >> i & 1);
  if (held_[node] >> askew & 1) {
    free.held = &held_along_[first_along_[node]];
    free.n_held = first_along_[node + 1] - first_along_[node];
  }
  return free;
}

template <class Real>
template <bool pushed>
[[gnu::always_inline]] inline void SpaceNodes<Real>::next_velocity(int node, const Step& step, Record& after,
                                                                   Record& outer) const {
  constexpr std::int64_t on = -1;
  const Record before = load_record(motion.data() + std::size_t(motion_stride) * node);
  const Record inner = load_record(internal_force.data() + row_at(node));
  outer = Record{};
  if constexpr (pushed) outer = step.force_scale * load_record(force.data() + row_at(node));
  after = step.kept * before + step.push * inverse_masses(before) * (outer - inner);
  after = Freedoms{on, on, on, on, on, on, 0, 0} ? after : before;
  if (held_[node]) hold(node, step, after, outer);
}

template <class Real>
void SpaceNodes<Real>::hold(int node, const Step& step, Record& after, Record& outer) const {
  const Real* own = motion.data() + std::size_t(motion_stride) * node;
  for (int i = 0; i < freedoms; ++i)
    if (held_[node] >> i & 1) {
      const double inverse = own[i < 3 ? 6 : 7], free = after[i];
      after[i] = step.velocity_scale * prescribed_[row_at(node) + i];
      if (inverse > 0.0) outer[i] += (after[i] - free) / (step.push * inverse);
    }
  if (held_[node] >> askew & 1) explicit_dynamics::hold_along(free_motion(node), step, own[6], after, outer);
}

template <class Real>
void SpaceNodes<Real>::add_reaction(int node, const Step& step, const Record& outer) {
  const int held = held_[node] >> askew & 1 ? held_[node] | 7 : held_[node];
  for (int i = 0; i < freedoms; ++i)
    if (held >> i & 1)
      reaction_impulse[row_at(node) + i] +=
          step.mean_dt * (outer[i] - step.force_scale * force.data()[row_at(node) + i]);
}

template <class Real>
[[gnu::noinline]] Work SpaceNodes<Real>::meet_walls(int node, const Step& step, bool whole, Record& after) const {
  const double* x = position.data() + std::size_t(position_stride) * node;
  const Real* own = motion.data() + std::size_t(motion_stride) * node;
  double before[3], v[3];
  for (int i = 0; i < 3; ++i) before[i] = own[i], v[i] = after[i];
  const auto wall = [&](int i) {
    return WallView<contact::ToolSurface>{*walls[i], walls[i]->lend(), walls[i]->surface()};
  };
  const Work done = explicit_dynamics::meet_walls(static_cast<int>(walls.size()), wall, node, x, before, own[6],
                                                  free_motion(node), step, whole, v);
  if (whole)
    for (SpaceWall* each : walls) each->add_to_chunk(node, x);
  for (int i = 0; i < 3; ++i) after[i] = v[i];
  return done;
}

template <class Real>
Moved SpaceNodes<Real>::move(int first, int last, const Step& step) {
  return is_pushed_ ? move_nodes<true>(first, last, step) : move_nodes<false>(first, last, step);
}

template <class Real>
template <bool pushed>
Moved SpaceNodes<Real>::move_nodes(int first, int last, const Step& step) {
  Record external{}, damped{};
  Moved sums;
  double fastest = 0.0;
  for (SpaceWall* wall : walls) wall->open_chunk(first);
  for (int node = first; node < last; ++node) {
    if (!follows.empty() && follows[node]) continue;
    Record after, outer;
    next_velocity<pushed>(node, step, after, outer);
    if (!touches_walls.empty() && touches_walls[node]) sums.work.add(meet_walls(node, step, true, after));
    Real* own = motion.data() + std::size_t(motion_stride) * node;
    const Record before = load_record(own);
    if (pushed || held_[node]) external += outer * (before + after);
    if (held_[node]) add_reaction(node, step, outer);
    if (step.damping > 0.0) {
      const Record mean = 0.5 * (before + after), inverse = inverse_masses(before);
      damped += inverse > 0.0 ? mean * mean / inverse : Record{};
    }
    store_record<8>(after, own);
    const Place velocity = step_on(node, step.dt);
    const Place squares = velocity * velocity;
    fastest = std::max(fastest, squares[0] + squares[1] + squares[2]);
  }
  sums.fastest = fastest;
  for (int i = 0; i < freedoms; ++i) {
    sums.work.external += 0.5 * step.mean_dt * external[i];
    sums.work.damping += step.mean_dt * step.damping * damped[i];
  }
  return sums;
}

template <class Real>
void SpaceNodes<Real>::add_half_step(const Step& step, Energies& e) const {
  for (int node = 0; node < n; ++node) {
    if (!follows.empty() && follows[node]) continue;  // without mass, or counted in another part
    Record after, outer;
    next_velocity<true>(node, step, after, outer);
    if (!touches_walls.empty() && touches_walls[node]) {
      const Work done = meet_walls(node, step, false, after);
      e.external += done.external, e.contact += done.contact, e.friction += done.friction;
    }
    const Real* own = motion.data() + std::size_t(motion_stride) * node;
    for (int i = 0; i < freedoms; ++i) {
      const double inverse = own[i < 3 ? 6 : 7], v = own[i];
      if (inverse > 0.0) e.kinetic += 0.5 * v * after[i] / inverse;
      // half of this step's work, by the velocity of its first half
      e.external += 0.5 * step.mean_dt * outer[i] * v;
      if (step.damping > 0.0 && inverse > 0.0)
        e.damping += 0.25 * step.mean_dt * step.damping * v * (v + after[i]) / inverse;
    }
  }
}

template <class Real>
void SpaceNodes<Real>::list_state(std::vector<StateField>& fields) {
  const auto count = static_cast<std::size_t>(n);
  fields.push_back(column_field("nodes", "position", position.data(), count, position_stride, 3));
  fields.push_back(column_field("nodes", "velocity", motion.data(), count, motion_stride, freedoms));
  fields.push_back(column_field("nodes", "internal_force", internal_force.data(), count, freedoms, freedoms));
}

double SpaceWall::measure_radius(const SpaceNodes<double>& nodes) const {
  if (motion.spin == 0.0) return -1.0;
  double most = 0.0;
  for (int node = 0; node < nodes.n; ++node)
    most = std::max(most, motion.distance(nodes.position.data() + 4 * std::size_t(node)));
  return most;
}

void SpaceWall::begin(SpaceNodes<double>& nodes, int) {
  const double now = measure_radius(nodes);
  radius = now < 0.0 ? 0.0 : widen_radius(std::max(now, radius_of_others));
}

template class SpaceNodes<double>;
template class SpaceNodes<float>;

}  // namespace presswork::explicit_dynamics
