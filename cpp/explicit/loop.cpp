// SPDX-License-Identifier: Apache-2.0
#include "explicit/loop.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

#include <omp.h>

#include "explicit/work_shares.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr int chunk = 256;  // nodes whose work is summed up in one go: the sums do not depend on the threads
inline Record inverse_masses(const Record& motion) {
  return __builtin_shufflevector(motion, motion, 6, 6, 6, 7, 7, 7, 6, 7);
}

}  // namespace

template <class Real>
ShellLoop<Real>::ShellLoop(int n_nodes, const double* points)
    : nodes(n_nodes),
      force(row_at(n_nodes) + spare),
      held(n_nodes),
      prescribed(row_at(n_nodes)),
      reaction_impulse(row_at(n_nodes)),
      internal_force(row_at(n_nodes) + spare) {
  for (int i = 0; i < n_nodes; ++i)
    std::copy_n(points + 3 * std::size_t(i), 3, nodes.position.data() + std::size_t(nodes.position_stride) * i);
}

template <class Real>
void ShellLoop<Real>::add(std::unique_ptr<ElementBlock<Real>> block) {
  blocks.push_back(std::move(block));
  tiles_.cut(nodes.n, blocks);
  set_masses();
}

template <class Real>
int ShellLoop<Real>::n_elements() const {
  int n = 0;
  for (const auto& block : blocks) n += block->n();
  return n;
}

template <class Real>
std::vector<double> ShellLoop<Real>::element_masses() const {
  std::vector<double> masses;
  for (const auto& block : blocks) masses.insert(masses.end(), block->mass().begin(), block->mass().end());
  return masses;
}

template <class Real>
void ShellLoop<Real>::set_masses() {
  std::vector<double> sum(std::size_t(nodes.n) * 2, 0.0);
  for (const auto& block : blocks) {
    const int each = block->nodes_each();
    for (std::size_t i = 0; i < block->connectivity().size(); ++i) {
      const double share = block->mass()[i / each] / each;
      const auto node = static_cast<std::size_t>(block->connectivity()[i]);
      sum[2 * node] += share;
      sum[2 * node + 1] += share * block->inertia_ratio()[i / each];
    }
  }
  if (beads) beads->set_masses(element_masses());
  own_mass_.resize(nodes.n);
  for (int i = 0; i < nodes.n; ++i) own_mass_[i] = sum[2 * std::size_t(i)];
  hanging.give_masses(sum);
  for (int i = 0; i < nodes.n; ++i)
    for (int j = 0; j < 2; ++j) {
      const double m = sum[2 * std::size_t(i) + j];
      nodes.motion.data()[std::size_t(nodes.motion_stride) * i + 6 + j] = static_cast<Real>(m > 0.0 ? 1.0 / m : 0.0);
    }
}

template <class Real>
void ShellLoop<Real>::set_hanging(std::vector<HangingNode> of) {
  hanging.set(nodes.n, std::move(of));
  set_masses();
}

template <class Real>
void ShellLoop<Real>::give_hanging_forces() {
  hanging.take_forces(nodes, internal_force.data(), 0, hanging.n());
  hanging.give_forces(internal_force.data(), 0, hanging.n_ends());
}

template <class Real>
void ShellLoop<Real>::inherit(const ShellLoop& from, const int* node_parents, const int* parent, const double* share) {
  // 1. nodes
  for (int i = 0; i < nodes.n; ++i)
    for (int k = 0; k < freedoms; ++k) {
      double sum = 0.0;
      for (int a = 0; a < 4; ++a)
        sum += from.nodes.motion.data()[std::size_t(nodes.motion_stride) * node_parents[4 * std::size_t(i) + a] + k];
      nodes.motion.data()[std::size_t(nodes.motion_stride) * i + k] = static_cast<Real>(0.25 * sum);
    }
  for (int k = 0; k < 2; ++k) work[k] = from.work[k];
  // 2. elements
  std::vector<std::pair<const ElementBlock<Real>*, int>> elements;
  for (const auto& block : from.blocks)
    for (int e = 0; e < block->n(); ++e) elements.emplace_back(block.get(), e);
  for (const auto& block : blocks)
    for (int e = 0; e < block->n(); ++e, ++parent, ++share) {
      const auto [own, number] = elements[*parent];
      block->inherit(e, *own, number, *share);
      block->mass()[e] = *share * own->mass()[number];
    }
  set_masses();
  // 3. contact
  if (contact && from.contact) {
    set_contact_stiffness(from.contact->step());
    contact->inherit(*from.contact, node_parents);
  }
}

template <class Real>
void ShellLoop<Real>::advance_elements(double dt) {
  find_room();
  AlignedArray<Real> scratch = tiles_.make_scratch();
  for (int t = 0; t < tiles_.n(); ++t) tiles_.advance(t, nodes, dt, scratch.data(), internal_force.data());
  tiles_.close_rims(0, tiles_.n_rim_nodes(), internal_force.data());
  give_hanging_forces();
}

template <class Real>
[[gnu::always_inline]] inline void ShellLoop<Real>::next_velocity(int node, const Step& step, Record& after,
                                                                  Record& outer) const {
  constexpr std::int64_t on = -1;
  const Record before = load_record(nodes.motion.data() + std::size_t(nodes.motion_stride) * node);
  const Record inner = load_record(internal_force.data() + row_at(node));
  outer = step.force_scale * load_record(force.data() + row_at(node));
  after = step.kept * before + step.push * inverse_masses(before) * (outer - inner);
  after = Freedoms{on, on, on, on, on, on, 0, 0} ? after : before;
  if (held[node]) hold(node, step, after, outer);
}

template <class Real>
void ShellLoop<Real>::hold(int node, const Step& step, Record& after, Record& outer) const {
  const Real* motion = nodes.motion.data() + std::size_t(nodes.motion_stride) * node;
  for (int i = 0; i < freedoms; ++i)
    if (held[node] >> i & 1) {
      const double inverse = motion[i < 3 ? 6 : 7], free = after[i];
      after[i] = step.velocity_scale * prescribed[row_at(node) + i];
      if (inverse > 0.0) outer[i] += (after[i] - free) / (step.push * inverse);
    }
}

template <class Real>
void ShellLoop<Real>::add_reaction(int node, const Step& step, const Record& outer) {
  for (int i = 0; i < freedoms; ++i)
    if (held[node] >> i & 1)
      reaction_impulse[row_at(node) + i] += step.dt * (outer[i] - step.force_scale * force.data()[row_at(node) + i]);
}

template <class Real>
typename ShellLoop<Real>::Sums ShellLoop<Real>::move_nodes(int first, int last, const Step& step) {
  Record external{}, damped{};
  double fastest = 0.0;
  const double dt = step.dt;
  for (int node = first; node < last; ++node) {
    if (hanging.has(node)) continue;
    Record after, outer;
    next_velocity(node, step, after, outer);
    Real* motion = nodes.motion.data() + std::size_t(nodes.motion_stride) * node;
    double* x = nodes.position.data() + std::size_t(nodes.position_stride) * node;
    const Record before = load_record(motion);
    external += outer * (before + after);
    if (held[node]) add_reaction(node, step, outer);
    if (step.damping > 0.0) {
      const Record mean = 0.5 * (before + after), inverse = inverse_masses(before);
      damped += inverse > 0.0 ? mean * mean / inverse : Record{};
    }
    store_record<8>(after, motion);
    // by the velocity as it is kept: what moves a node is what strains its elements
    const Place velocity = __builtin_shufflevector(load_record(motion), Record{}, 0, 1, 2, 8);
    store_place(load_place(x) + dt * velocity, x);
    const Place squares = velocity * velocity;
    fastest = std::max(fastest, squares[0] + squares[1] + squares[2]);
  }
  Sums sums;
  sums.fastest = fastest;
  for (int i = 0; i < freedoms; ++i) {
    sums.external += 0.5 * step.dt * external[i];
    sums.damping += step.dt * step.damping * damped[i];
  }
  return sums;
}

template <class Real>
typename ShellLoop<Real>::Failure ShellLoop<Real>::advance(int n, double dt, double damping, const double* force_scale,
                                                           const double* velocity_scale) {
  const auto chunks_of = [](int items) { return (items + chunk - 1) / chunk; };
  const int n_chunks = chunks_of(nodes.n), n_rims = tiles_.n_rim_nodes(), n_hanging = hanging.n();
  std::vector<Sums> sums(n_chunks + chunks_of(n_hanging));
  hanging.measure(nodes, 0, n_hanging);
  find_room();
  int failed = INT_MAX, failed_in = -1;
  const bool shared = n_elements() >= serial_elements;
  const int most_threads = shared ? omp_get_max_threads() : 1;
  WorkShares tiles(tiles_.n(), most_threads), edges(contact ? contact->edge_chunks() : 0, most_threads),
      touching(contact ? contact->node_chunks() : 0, most_threads);
  Real* net = internal_force.data();
  const double start = nodes.time;
#pragma omp parallel if (shared)
  {
    const int thread = omp_get_thread_num(), n_threads = omp_get_num_threads();
    AlignedArray<Real> scratch = tiles_.make_scratch();
    PhaseClock clock;
    const auto finish = [&](Phase phase) {  // a phase; the next needs what all threads did in it
      clock.lap(phase);
#pragma omp barrier
      clock.lap(Phase::waiting);
    };
    for (int cycle = 0; cycle < n; ++cycle) {
#pragma omp master
      nodes.time = start + cycle * dt;
      for (WorkShares* work : {&tiles, &edges, &touching}) work->deal(thread, n_threads);
      const Step step{dt, damping, force_scale[cycle], velocity_scale[cycle]};
#pragma omp for schedule(static) nowait
      for (int c = 0; c < n_chunks; ++c) sums[c] = move_nodes(c * chunk, std::min(nodes.n, (c + 1) * chunk), step);
      finish(Phase::nodes);
      if (n_hanging > 0) {
#pragma omp for schedule(static) nowait
        for (int c = 0; c < chunks_of(n_hanging); ++c)
          sums[n_chunks + c].fastest = hanging.move(nodes, dt, c * chunk, std::min(n_hanging, (c + 1) * chunk));
        finish(Phase::nodes);
      }
#pragma omp master
      {
        double fastest = 0.0;
        for (const auto& s : sums) {
          work[0] += s.external, work[1] += s.damping;
          fastest = std::max(fastest, s.fastest);
        }
        if (contact) contact->move_tools(cycle, dt, std::sqrt(fastest));
      }
      clock.lap(Phase::contact);
      int failed_here = INT_MAX;
      for (int t; (t = tiles.take(thread)) >= 0;)
        if (const int shell = tiles_.advance(t, nodes, dt, scratch.data(), net); shell >= 0)
          failed_here = std::min(failed_here, shell);
      if (failed_here != INT_MAX) {
#pragma omp critical
        failed = std::min(failed, failed_here);
      }
      finish(Phase::elements);
      if (failed != INT_MAX) {  // the same for all threads
#pragma omp master
        failed_in = cycle;
        break;
      }
#pragma omp for schedule(static) nowait
      for (int i = 0; i < n_rims; ++i) tiles_.close_rims(i, i + 1, net);
      finish(Phase::elements);
      if (beads) {
#pragma omp single nowait
        beads->visit(cycle, dt, nodes, contact ? &contact->tools : nullptr, net);
        finish(Phase::contact);
      }
      if (contact) {
        const auto sheet = view(dt);
        for (int c; (c = edges.take(thread)) >= 0;) contact->visit_edges(c, sheet);
        finish(Phase::contact);
        for (int c; (c = touching.take(thread)) >= 0;) contact->visit_nodes(c, sheet, net);
        finish(Phase::contact);
#pragma omp master
        contact->close_cycle();
      }
      if (n_hanging == 0) continue;
#pragma omp for schedule(static) nowait
      for (int c = 0; c < chunks_of(n_hanging); ++c)
        hanging.take_forces(nodes, net, c * chunk, std::min(n_hanging, (c + 1) * chunk));
      finish(Phase::nodes);
#pragma omp for schedule(static) nowait
      for (int i = 0; i < hanging.n_ends(); ++i) hanging.give_forces(net, i, i + 1);
      finish(Phase::nodes);
    }
#pragma omp critical
    for (int p = 0; p < n_phases; ++p) seconds[p] += clock.seconds[p] / n_threads;
  }
  if (failed == INT_MAX) return {};
  int of_block = failed;
  return {failed, failed_in, block_of(of_block).told()};
}

template <class Real>
contact::SheetUnder ShellLoop<Real>::find_cells() const {
  std::vector<int> start{0}, corner;
  for (const auto& block : blocks) {
    const auto& nodes_of = block->connectivity();
    corner.insert(corner.end(), nodes_of.begin(), nodes_of.end());
    for (int i = 0; i < block->n(); ++i) start.push_back(start.back() + block->nodes_each());
  }
  std::vector<contact::SheetUnder::Hanging> between;
  for (const HangingNode& h : hanging.all()) between.push_back({h.node, {h.end[0], h.end[1]}});
  return {std::move(start), std::move(corner), between};
}

template <class Real>
std::unique_ptr<ToolContact> ShellLoop<Real>::make_contact() const {
  std::vector<int> start{0}, cells;
  double thinnest = thickness(0), widest = 0.0, edge = 0.0;
  for (int e = 0; e < n_elements(); ++e) thinnest = std::min(thinnest, thickness(e));
  const auto apart = [&](int i, int j) {
    const double *a = nodes.position.data() + std::size_t(nodes.position_stride) * i,
                 *b = nodes.position.data() + std::size_t(nodes.position_stride) * j;
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  };
  for (const auto& block : blocks) {
    const auto& connectivity = block->connectivity();
    const int each = block->nodes_each();
    cells.insert(cells.end(), connectivity.begin(), connectivity.end());
    for (std::size_t i = 0; i < connectivity.size(); i += each) {
      start.push_back(start.back() + each);
      widest = std::max(widest, apart(connectivity[i], connectivity[i + 2]));
      for (int a = 0; a < each; ++a)
        edge = std::max(edge, apart(connectivity[i + a], connectivity[i + (a + 1) % each]));
    }
  }
  return std::make_unique<ToolContact>(nodes.n, start, cells, thinnest, widest, edge, ironing);
}

template <class Real>
void ShellLoop<Real>::set_contact_stiffness(double dt) {
  std::vector<double> before(n_elements()), ratio(before.size());
  for (int e = 0; e < n_elements(); ++e) before[e] = value(e, &StateRows::spring);
  for (const auto& block : blocks) block->set_springs(dt);
  for (int e = 0; e < n_elements(); ++e) ratio[e] = before[e] > 0.0 ? value(e, &StateRows::spring) / before[e] : 1.0;
  contact->set_stiffness(own_mass_, element_masses(), ratio, dt);
}

template <class Real>
Energies ShellLoop<Real>::energies(double dt, double damping, double force_scale, double velocity_scale) const {
  Energies e;
  e.external = work[0];
  e.damping = work[1];
  const Step step{dt, damping, force_scale, velocity_scale};
  for (int node = 0; node < nodes.n; ++node) {
    Record after, outer;
    next_velocity(node, step, after, outer);
    const Real* motion = nodes.motion.data() + std::size_t(nodes.motion_stride) * node;
    for (int i = 0; i < freedoms; ++i) {
      const double inverse = motion[i < 3 ? 6 : 7], v = motion[i];
      if (inverse > 0.0) e.kinetic += 0.5 * v * after[i] / inverse;
      // half of this step's work, by the velocity of its first half
      e.external += 0.5 * dt * outer[i] * v;
      if (damping > 0.0 && inverse > 0.0) e.damping += 0.25 * dt * damping * v * (v + after[i]) / inverse;
    }
  }
  for (const auto& block : blocks)
    for (int i = 0; i < block->n(); ++i) {
      e.internal += block->value(i, block->rows().work);
      if (block->rows().hourglass_work >= 0) e.hourglass += block->value(i, block->rows().hourglass_work);
    }
  if (contact) {
    const ContactEnergies c = contact->energies(dt);
    e.kinetic += c.kinetic, e.external += c.external, e.damping += c.damping;
    e.contact = c.penalty, e.friction = c.friction;
  }
  if (beads) e.contact += beads->stored(), e.friction += beads->lost();
  return e;
}

template class ShellLoop<double>;
template class ShellLoop<float>;

}  // namespace presswork::explicit_dynamics
