// SPDX-License-Identifier: Apache-2.0
#include "explicit/loop.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

#include <omp.h>

#include "explicit/work_shares.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr int chunk = 256;             // nodes whose work is summed up in one go: the sums do not depend on the threads
constexpr int serial_elements = 1000;  // fewer are left to one thread: waking a second costs more than it gives
constexpr int freedoms = 6, spare = 2;  // numbers after the last row of six, which a record takes in

inline Record inverse_masses(const Record& motion) {
  return __builtin_shufflevector(motion, motion, 6, 6, 6, 7, 7, 7, 6, 7);
}

constexpr std::size_t row(int i) { return std::size_t(freedoms) * i; }

}  // namespace

template <class Real>
ShellLoop<Real>::ShellLoop(int n_nodes, const double* points)
    : nodes(n_nodes),
      force(row(n_nodes) + spare),
      held(n_nodes),
      prescribed(row(n_nodes)),
      internal_force(row(n_nodes) + spare) {
  for (int i = 0; i < n_nodes; ++i)
    std::copy_n(points + 3 * std::size_t(i), 3, nodes.position.data() + std::size_t(nodes.position_stride) * i);
}

template <class Real>
void ShellLoop<Real>::add(std::unique_ptr<ElementBlock<Real>> block) {
  blocks.push_back(std::move(block));
  make_tiles();
  set_masses();
}

template <class Real>
int ShellLoop<Real>::n_elements() const {
  int n = 0;
  for (const auto& block : blocks) n += block->n();
  return n;
}

// Cuts the blocks into tiles: 64 to 512 elements, as equal as can be and their number even for any usual number of
// threads. They begin at multiples of the widest pack there is, whatever the pack compiled for.
template <class Real>
void ShellLoop<Real>::cut_blocks() {
  constexpr int group = 16, group_packs = group / ElementBlock<Real>::lanes, even = 32;
  tiles_.clear();
  scratch_size_ = 0;
  int numbered_from = 0;
  for (const auto& block : blocks) {
    const int groups = (block->n() + group - 1) / group;
    int n_tiles = (block->n() + 511) / 512;
    n_tiles = groups >= 4 * even ? (n_tiles + even - 1) / even * even : (groups + 3) / 4;
    for (int t = 0; t < n_tiles; ++t) {
      const auto bound = [&](std::int64_t i) {
        return std::min(block->n_packs(), static_cast<int>(i * groups / n_tiles) * group_packs);
      };
      tiles_.push_back({block.get(), bound(t), bound(t + 1), numbered_from, 0, 0});
      const auto packs = static_cast<std::size_t>(tiles_.back().last - tiles_.back().first);
      scratch_size_ =
          std::max(scratch_size_, packs * ElementBlock<Real>::lanes * block->nodes_each() * freedoms + spare);
    }
    numbered_from += block->n();
  }
}

// Which tile each node belongs to, and what it adds up there.
template <class Real>
void ShellLoop<Real>::make_tiles() {
  constexpr int none = -1, rim = -2, lanes = ElementBlock<Real>::lanes;
  cut_blocks();
  const auto for_each_use = [&](int t, auto&& use) {  // of a node by an element of tile t: node, offset of its force
    const Tile& tile = tiles_[t];
    const int each = tile.block->nodes_each(), first = tile.first * lanes;
    for (int e = first; e < std::min(tile.block->n(), tile.last * lanes); ++e)
      for (int a = 0; a < each; ++a)
        use(tile.block->connectivity()[std::size_t(each) * e + a], ((e - first) * each + a) * freedoms);
  };
  const int n_tiles = static_cast<int>(tiles_.size());
  std::vector<int> owner(nodes.n, none);
  for (int t = 0; t < n_tiles; ++t)
    for_each_use(t, [&](int node, int) { owner[node] = owner[node] == none || owner[node] == t ? t : rim; });

  std::vector<std::vector<int>> rows(nodes.n);  // of partial_
  std::vector<std::pair<int, int>> uses;        // node, offset
  int n_partial = 0;
  target_.clear(), entry_.clear(), entry_start_.assign(1, 0);
  for (int t = 0; t < n_tiles; ++t) {
    tiles_[t].nodes_first = static_cast<int>(target_.size());
    uses.clear();
    for_each_use(t, [&](int node, int offset) { uses.emplace_back(node, offset); });
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const int node = uses[i].first;
      if (i == 0 || uses[i - 1].first != node) {
        if (i > 0) entry_start_.push_back(static_cast<int>(entry_.size()));
        if (owner[node] == rim) rows[node].push_back(n_partial);
        target_.push_back(owner[node] == rim ? -1 - n_partial++ : node);
      }
      entry_.push_back(uses[i].second);
    }
    entry_start_.push_back(static_cast<int>(entry_.size()));
    tiles_[t].nodes_last = static_cast<int>(target_.size());
  }
  partial_ = AlignedArray<Real>(row(n_partial) + spare);
  rim_node_.clear(), rim_partial_.clear(), rim_start_.assign(1, 0);
  for (int node = 0; node < nodes.n; ++node) {
    if (rows[node].empty()) continue;
    rim_node_.push_back(node);
    rim_partial_.insert(rim_partial_.end(), rows[node].begin(), rows[node].end());
    rim_start_.push_back(static_cast<int>(rim_partial_.size()));
  }
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

// scratch: forces of the tile's elements (packs, lanes, nodes, 6).
template <class Real>
int ShellLoop<Real>::advance_tile(const Tile& tile, double dt, Real* scratch) {
  const int failed = tile.block->advance(nodes, dt, tile.first, tile.last, scratch);
  for (int i = tile.nodes_first; i < tile.nodes_last; ++i) {
    Record sum{};
    for (int s = entry_start_[i]; s < entry_start_[i + 1]; ++s) sum += load_record(scratch + entry_[s]);
    const int to = target_[i];
    store_record<freedoms>(sum, to >= 0 ? internal_force.data() + row(to) : partial_.data() + row(-1 - to));
  }
  return failed < 0 ? -1 : tile.numbered_from + failed;
}

template <class Real>
void ShellLoop<Real>::close_rims(int first, int last) {
  for (int i = first; i < last; ++i) {
    Record sum{};
    for (int s = rim_start_[i]; s < rim_start_[i + 1]; ++s) sum += load_record(partial_.data() + row(rim_partial_[s]));
    store_record<freedoms>(sum, internal_force.data() + row(rim_node_[i]));
  }
}

template <class Real>
void ShellLoop<Real>::advance_elements(double dt) {
  AlignedArray<Real> scratch(scratch_size_);
  for (const auto& tile : tiles_) advance_tile(tile, dt, scratch.data());
  close_rims(0, static_cast<int>(rim_node_.size()));
  give_hanging_forces();
}

template <class Real>
[[gnu::always_inline]] inline void ShellLoop<Real>::next_velocity(int node, const Step& step, Record& after,
                                                                  Record& outer) const {
  constexpr std::int64_t on = -1;
  const Record before = load_record(nodes.motion.data() + std::size_t(nodes.motion_stride) * node);
  const Record inner = load_record(internal_force.data() + row(node));
  outer = step.force_scale * load_record(force.data() + row(node));
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
      after[i] = step.velocity_scale * prescribed[row(node) + i];
      if (inverse > 0.0) outer[i] += (after[i] - free) / (step.push * inverse);
    }
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
  const int n_chunks = (nodes.n + chunk - 1) / chunk, n_tiles = static_cast<int>(tiles_.size());
  const int n_rims = static_cast<int>(rim_node_.size()), n_hanging = hanging.n(), n_ends = hanging.n_ends();
  const int hanging_chunks = (n_hanging + chunk - 1) / chunk;
  std::vector<Sums> sums(n_chunks + hanging_chunks);
  hanging.measure(nodes, 0, n_hanging);
  int failed = INT_MAX, failed_in = -1;
  const bool shared = n_elements() >= serial_elements;
  const int most_threads = shared ? omp_get_max_threads() : 1;
  WorkShares tiles(n_tiles, most_threads), edges(contact ? contact->edge_chunks() : 0, most_threads),
      touching(contact ? contact->node_chunks() : 0, most_threads);
#pragma omp parallel if (shared)
  {
    const int thread = omp_get_thread_num(), n_threads = omp_get_num_threads();
    AlignedArray<Real> scratch(scratch_size_);
    for (int cycle = 0; cycle < n; ++cycle) {
      for (WorkShares* work : {&tiles, &edges, &touching}) work->deal(thread, n_threads);
      const Step step{dt, damping, force_scale[cycle], velocity_scale[cycle]};
#pragma omp for schedule(static)
      for (int c = 0; c < n_chunks; ++c) sums[c] = move_nodes(c * chunk, std::min(nodes.n, (c + 1) * chunk), step);
      if (n_hanging > 0) {
#pragma omp for schedule(static)
        for (int c = 0; c < hanging_chunks; ++c)
          sums[n_chunks + c].fastest = hanging.move(nodes, dt, c * chunk, std::min(n_hanging, (c + 1) * chunk));
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
      int failed_here = INT_MAX;
      for (int t; (t = tiles.take(thread)) >= 0;)
        if (const int shell = advance_tile(tiles_[t], dt, scratch.data()); shell >= 0)
          failed_here = std::min(failed_here, shell);
      if (failed_here != INT_MAX) {
#pragma omp critical
        failed = std::min(failed, failed_here);
      }
#pragma omp barrier
      if (failed != INT_MAX) {  // the same for all threads
#pragma omp master
        failed_in = cycle;
        break;
      }
#pragma omp for schedule(static)
      for (int i = 0; i < n_rims; ++i) close_rims(i, i + 1);
      if (beads) {
#pragma omp single
        beads->visit(cycle, dt, nodes, contact ? &contact->tools : nullptr, internal_force.data());
      }
      if (contact) {
        const auto sheet = view(dt);
        for (int c; (c = edges.take(thread)) >= 0;) contact->visit_edges(c, sheet);
#pragma omp barrier
        for (int c; (c = touching.take(thread)) >= 0;) contact->visit_nodes(c, sheet, internal_force.data());
#pragma omp barrier
#pragma omp master
        contact->close_cycle();
      }
      if (n_hanging == 0) continue;
#pragma omp for schedule(static)
      for (int c = 0; c < hanging_chunks; ++c)
        hanging.take_forces(nodes, internal_force.data(), c * chunk, std::min(n_hanging, (c + 1) * chunk));
#pragma omp for schedule(static)
      for (int i = 0; i < n_ends; ++i) hanging.give_forces(internal_force.data(), i, i + 1);
    }
  }
  return failed == INT_MAX ? Failure{} : Failure{failed, failed_in};
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
  return std::make_unique<ToolContact>(nodes.n, start, cells, thinnest, widest, edge);
}

template <class Real>
void ShellLoop<Real>::set_contact_stiffness(double dt) {
  contact->set_stiffness(own_mass_, dt);
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
