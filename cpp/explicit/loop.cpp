// SPDX-License-Identifier: Apache-2.0
#include "explicit/loop.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <omp.h>

#include "explicit/plane/nodes.hpp"
#include "explicit/space/nodes.hpp"

namespace presswork::explicit_dynamics {

template <class Nodes>
struct Loop<Nodes>::Team {
  std::vector<Moved> moved;              // of chunks of nodes
  std::vector<std::vector<double>> led;  // of each interaction's pieces of nodes that follow: largest speed squared
  std::vector<WorkShares> shares;        // of tiles without and with ghosts, then of the rounds of each interaction
  double fastest = 0.0;                  // largest speed of a node
  bool awaits_ghosts;
  int failed = INT_MAX;
  bool stopped = false;  // an element has failed, here or in another part
  bool alone = false;    // the other parts do not know it yet

  Team(const Loop& loop, int most_threads) : moved(count_chunks(loop.nodes.n)), awaits_ghosts(loop.awaits_ghosts()) {
    shares.emplace_back(loop.n_inner_, most_threads);
    shares.emplace_back(static_cast<int>(loop.turn_.size()) - loop.n_inner_, most_threads);
    for (const auto* each : loop.interactions) {
      led.emplace_back(each->n_following());
      for (int round = 0; round < each->n_rounds(); ++round) shares.emplace_back(each->n_pieces(round), most_threads);
    }
  }
};

template <class Nodes>
struct Loop<Nodes>::Thread {
  int number, of;
  AlignedArray<Real> scratch;
  PhaseClock clock;

  // End a phase; the next needs what all threads did in it.
  void finish(Phase phase) {
    clock.lap(phase);
#pragma omp barrier
    clock.lap(Phase::waiting);
  }
};

template <class Nodes>
void Loop<Nodes>::add(std::unique_ptr<ElementBlock<Nodes>> block) {
  blocks.push_back(std::move(block));
  std::vector<TiledBlock> views;
  for (const auto& b : blocks)
    views.push_back({b->n(), b->lanes, b->nodes_each(), Nodes::record(b->nodes_each()), b->connectivity().data()});
  tiles_.cut(nodes.n, views);
  order_tiles();
  set_masses();
}

template <class Nodes>
void Loop<Nodes>::order_tiles() {
  std::vector<int> outer;
  turn_.clear();
  for (int t = 0; t < static_cast<int>(tiles_.tiles().size()); ++t) {
    const Tile& tile = tiles_.tiles()[t];
    const auto& block = *blocks[tile.block];
    const std::size_t each = block.nodes_each(), first = each * tile.first * block.lanes;
    const auto last = std::min(each * tile.last * block.lanes, block.connectivity().size());
    bool touches = false;
    for (std::size_t i = first; neighbours_ && i < last; ++i)
      touches = touches || neighbours_->is_ghost[block.connectivity()[i]];
    (touches ? outer : turn_).push_back(t);
  }
  n_inner_ = static_cast<int>(turn_.size());
  turn_.insert(turn_.end(), outer.begin(), outer.end());
}

template <class Nodes>
void Loop<Nodes>::join(std::unique_ptr<Neighbours> of) {
  neighbours_ = std::move(of);
  order_tiles();
}

template <class Nodes>
void Loop<Nodes>::propose(double fastest) {
  neighbours_->shared[0] = fastest;
  neighbours_->propose();
}

template <class Nodes>
bool Loop<Nodes>::awaits_ghosts() const {
  if (!neighbours_) return false;
  return std::any_of(interactions.begin(), interactions.end(), [](auto* each) { return each->n_following() > 0; });
}

template <class Nodes>
bool Loop<Nodes>::agree(Team& team, const Step& step, int cycle) {
  if (neighbours_) {
    neighbours_->agree();
    team.fastest = neighbours_->shared[0];
    if (std::isinf(team.fastest)) return false;
    take_shared();
    for (auto* each : interactions)
      each->agree(nodes, *neighbours_, step);  // in a part that has failed, too: others wait
  }
  team.alone = team.failed != INT_MAX;
  if (team.alone) return false;
  for (auto* each : interactions) each->move(step, cycle, team.fastest);
  return true;
}

template <class Nodes>
int Loop<Nodes>::n_elements() const {
  int n = 0;
  for (const auto& block : blocks) n += block->n();
  return n;
}

template <class Nodes>
std::vector<double> Loop<Nodes>::element_masses() const {
  std::vector<double> masses;
  for (const auto& block : blocks)
    for (int e = 0; e < block->n(); ++e) masses.push_back(block->mass(e));
  return masses;
}

template <class Nodes>
std::vector<double> Loop<Nodes>::sum_masses() const {
  std::vector<double> sum(std::size_t(nodes.n) * Nodes::masses, 0.0);
  for (const auto& block : blocks) block->add_masses(sum);
  return sum;
}

template <class Nodes>
std::vector<double> Loop<Nodes>::sum_all_masses() {
  std::vector<double> sum = sum_masses();
  for (auto* each : interactions) each->share_masses(sum);
  return sum;
}

template <class Nodes>
void Loop<Nodes>::set_masses() {
  std::vector<double> sum = sum_all_masses();
  for (std::size_t i = 0; i < ghost_masses_.size(); ++i)
    if (neighbours_->is_ghost[i / Nodes::masses]) sum[i] = ghost_masses_[i];
  nodes.set_masses(sum);
}

template <class Nodes>
void Loop<Nodes>::set_ghost_masses(std::vector<double> of) {
  ghost_masses_ = std::move(of);
  set_masses();
}

template <class Nodes>
int Loop<Nodes>::advance_tile(const Tile& tile, double dt, double time, Real* scratch) {
  const int failed = blocks[tile.block]->advance(nodes, dt, time, tile.first, tile.last, scratch);
  tiles_.sum_tile(tile, scratch, nodes.internal_force.data());
  return failed < 0 ? -1 : reasons * tile.numbered_from + failed;
}

template <class Nodes>
void Loop<Nodes>::advance_elements(double dt) {
  for (auto* each : interactions) each->begin(nodes, 0);
  AlignedArray<Real> scratch = tiles_.make_scratch();
  for (const Tile& tile : tiles_.tiles()) advance_tile(tile, dt, 0.0, scratch.data());
  tiles_.close_rims(0, tiles_.n_rim_nodes(), nodes.internal_force.data());
}

template <class Nodes>
void Loop<Nodes>::move_nodes(Team& team, Thread& own, const Step& step) {
  const int n_chunks = static_cast<int>(team.moved.size());
#pragma omp for schedule(static) nowait
  for (int c = 0; c < n_chunks; ++c) team.moved[c] = nodes.move(c * chunk, std::min(nodes.n, (c + 1) * chunk), step);
  own.finish(Phase::nodes);
  if (neighbours_) {
#pragma omp master
    {
      tell_neighbours();
      neighbours_->send();
      if (team.awaits_ghosts) {
        neighbours_->receive();
        move_ghosts(step.dt);
      }
    }
    if (team.awaits_ghosts) own.finish(Phase::waiting);
  }
  for (std::size_t i = 0; i < interactions.size(); ++i) {
    const int n_pieces = static_cast<int>(team.led[i].size());
    if (n_pieces == 0) continue;
#pragma omp for schedule(static) nowait
    for (int piece = 0; piece < n_pieces; ++piece) team.led[i][piece] = interactions[i]->follow(nodes, step, piece);
    own.finish(Phase::nodes);
  }
#pragma omp master
  {
    double fastest = 0.0;
    for (const Moved& each : team.moved) {
      work.add(each.work);
      fastest = std::max(fastest, each.fastest);
    }
    for (const auto& pieces : team.led)
      for (double speed : pieces) fastest = std::max(fastest, speed);
    team.fastest = std::sqrt(fastest);
    if (neighbours_) propose(team.fastest);
  }
  own.clock.lap(Phase::nodes);
}

template <class Nodes>
void Loop<Nodes>::take_tiles(Team& team, Thread& own, int share, double dt, double time) {
  int failed = INT_MAX;
  for (int i; (i = team.shares[share].take(own.number)) >= 0;) {
    const Tile& tile = tiles_.tiles()[turn_[share == 0 ? i : n_inner_ + i]];
    if (const int element = advance_tile(tile, dt, time, own.scratch.data()); element >= 0)
      failed = std::min(failed, element);
    else
      blocks[tile.block]->advance_damage(tile.first, tile.last, dt);
  }
  if (failed != INT_MAX) {
#pragma omp critical
    team.failed = std::min(team.failed, failed);
  }
  own.finish(Phase::elements);
}

template <class Nodes>
bool Loop<Nodes>::advance_tiles(Team& team, Thread& own, const Step& step, int cycle, double time) {
  take_tiles(team, own, 0, step.dt, time);
  if (neighbours_) {
    if (!team.awaits_ghosts) {
#pragma omp master
      {
        neighbours_->receive();
        move_ghosts(step.dt);
      }
      own.finish(Phase::waiting);
    }
    take_tiles(team, own, 1, step.dt, time);
  }
#pragma omp master
  team.stopped = !agree(team, step, cycle);
  own.clock.lap(Phase::contact);
  if (neighbours_) own.finish(Phase::waiting);
  if (neighbours_ ? team.stopped : team.failed != INT_MAX) return false;  // the same for all threads
  const int n_rims = tiles_.n_rim_nodes();
#pragma omp for schedule(static) nowait
  for (int c = 0; c < count_chunks(n_rims); ++c)
    tiles_.close_rims(c * chunk, std::min(n_rims, (c + 1) * chunk), nodes.internal_force.data());
  own.finish(Phase::elements);
  return true;
}

template <class Nodes>
void Loop<Nodes>::let_interactions_act(Team& team, Thread& own, const Step& step, int cycle) {
  std::size_t share = 1;  // behind those of tiles
  for (auto* each : interactions) {
    const int n_rounds = each->n_rounds();
    for (int round = 0; round < n_rounds; ++round) {
      WorkShares& pieces = team.shares[++share];
      for (int piece; (piece = pieces.take(own.number)) >= 0;) each->act(nodes, step, cycle, round, piece);
      own.finish(each->phase());
    }
    if (n_rounds == 0) continue;
#pragma omp master
    each->close();
  }
}

template <class Nodes>
typename Loop<Nodes>::Failure Loop<Nodes>::advance(const Cycles& of) {
  if (neighbours_ && !shares_enough()) throw std::invalid_argument("the parts share the forces on fewer tools");
  nodes.note_forces();
  for (auto* each : interactions) each->begin(nodes, of.n);
  for (const auto& block : blocks) block->begin_damage();
  const bool shared = n_elements() >= Nodes::serial_elements;
  Team team(*this, shared ? omp_get_max_threads() : 1);
  int failed_in = -1;
#pragma omp parallel if (shared)
  {
    Thread own{omp_get_thread_num(), omp_get_num_threads(), tiles_.make_scratch(), {}};
    for (int cycle = 0; cycle < of.n; ++cycle) {
      for (WorkShares& each : team.shares) each.deal(own.number, own.of);
      const Step step{of.dt, cycle == 0 ? 0.5 * (of.dt_before + of.dt) : of.dt, of.damping, of.force_scale[cycle],
                      of.velocity_scale[cycle]};
      move_nodes(team, own, step);
      if (!advance_tiles(team, own, step, cycle, of.time + cycle * of.dt)) {
#pragma omp master
        failed_in = cycle;
        break;
      }
      let_interactions_act(team, own, step, cycle);
    }
#pragma omp critical
    for (int p = 0; p < n_phases; ++p) seconds[p] += own.clock.seconds[p] / own.of;
  }
  if (team.failed == INT_MAX) return {};
  if (neighbours_ && team.alone && failed_in + 1 < of.n) {  // the others learn it in their next cycle
    tell_neighbours();
    neighbours_->send();
    propose(std::numeric_limits<double>::infinity());
    neighbours_->receive();
    neighbours_->agree();
  }
  return {team.failed / reasons, team.failed % reasons, failed_in};
}

template <class Nodes>
Energies Loop<Nodes>::energies(const Step& step) const {
  Energies e;
  e.external = work.external, e.damping = work.damping, e.contact = work.contact, e.friction = work.friction;
  nodes.add_half_step(step, e);
  for (const auto& block : blocks)
    for (int i = 0; i < block->n(); ++i) {
      const int first = block->connectivity()[std::size_t(block->nodes_each()) * i];
      if (neighbours_ && neighbours_->is_ghost[first]) continue;
      e.internal += block->work(i), e.hourglass += block->hourglass_work(i);
    }
  for (const auto* each : interactions) each->add_energies(step.dt, e);
  return e;
}

template <class Nodes>
std::vector<StateField> Loop<Nodes>::body_state() {
  std::vector<StateField> fields;
  fields.push_back(row_field("loop", "work", &work.external, 4));
  nodes.list_state(fields);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::string owner = "block_" + std::to_string(b);
    blocks[b]->list_state(owner, fields);
    for (std::size_t c = 0; c < blocks[b]->damage.count(); ++c) fields.push_back(blocks[b]->damage.field(owner, c));
  }
  return fields;
}

template <class Nodes>
std::vector<StateField> Loop<Nodes>::state() {
  std::vector<StateField> fields = body_state();
  for (auto* each : interactions) each->list_state(fields);
  return fields;
}

template class Loop<SpaceNodes<double>>;
template class Loop<SpaceNodes<float>>;
template class Loop<PlaneNodes>;

}  // namespace presswork::explicit_dynamics
