// SPDX-License-Identifier: Apache-2.0
#include "device/space.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "device/borrowed_blocks.hpp"
#include "device/borrowed_tools.hpp"
#include "device/borrowed_walls.hpp"
#include "device/cuda_library.hpp"
#include "device/host.hpp"

namespace presswork::device {

template <class Real>
std::string find_lack(const SpaceLoop<Real>& loop) {
  if (loop.shell_contact) return "shells that touch each other";
  if (loop.pressures) return "pressure on a sheet";
  if (!loop.hanging.all().empty()) return "refined sheets";
  if (!loop.contacts.empty()) return "contact of bodies";
  int sheets = 0;
  for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
    if (!loop.is_sheet(static_cast<int>(b))) {
      const std::string lack = find_lack_of_solids(dynamic_cast<const SpaceSolids*>(&*loop.blocks[b]));
      if (!lack.empty()) return lack;
      continue;
    }
    const auto& block = loop.sheet(static_cast<int>(b));
    const std::string lack = find_lack_of_shells(block.section(), block.nodes_each());
    if (!lack.empty()) return lack;
    if (++sheets > most_sheets) return "more than two blocks of shells";
  }
  if (loop.blocks.empty()) return "nodes without elements";
  return "";
}

template <class Real>
struct Session<Real>::Own {
  explicit Own(SpaceLoop<Real>& loop) : loop(loop), n(loop.nodes.n), step(most_cycles), work(2 * std::size_t(n), 0.0) {
    int n_slots = 0;
    for (std::size_t b = 0; b < loop.blocks.size(); ++b) {
      blocks.push_back(std::make_unique<BorrowedBlock<Real>>(loop, static_cast<int>(b), n_slots));
      seen.push_back(blocks.back()->view());
      n_slots += static_cast<int>(blocks.back()->node.size());
    }
    list_corners(blocks, n, first, corner);
    if (loop.contact) tools.take(*loop.contact, n);
    if (loop.beads) beads.take(*loop.beads);
    if constexpr (std::is_same_v<Real, double>) {
      if (!loop.walls.empty()) walls.take(loop.walls, loop.nodes);
      if (loop.ties()) ties.take(*loop.ties());
    }
  }
  Problem<Real> see() {
    auto& nodes = loop.nodes;
    return {{n, nodes.position.data(), nodes.motion.data(), nodes.internal_force.data(), nodes.force.data(),
             nodes.held().data(), nodes.prescribed().data(), nodes.reaction_impulse.data(), work.data(), first.data(),
             corner.data(), static_cast<int>(corner.size()), nullptr,
             nodes.first_directions().empty() ? nullptr : nodes.first_directions().data(), nodes.directions().data(),
             stop, nodes.follows.empty() ? nullptr : nodes.follows.data()},
            seen.data(),
            static_cast<int>(seen.size()),
            {},
            step.data(),
            &clock,
            tools.view,
            beads.view,
            walls.view,
            ties.view};
  }
  // What is taken back after every call.
  void give_back_little() {
    if (loop.contact) tools.give_back();
    if (loop.beads) beads.give_back();
    walls.give_back();
  }
  // The first element that has failed, n cycles after a call has begun; of several in a cycle the first in number.
  Failure find_failure(int n_cycles) const {
    Failure failure;
    int longest = 0, number = 0;
    for (const auto& block : blocks) {
      const auto [cell, told] = block->find_failed();
      if (told / reasons > longest) {
        longest = told / reasons;
        failure = {number + cell, told % reasons, n_cycles - longest};
      }
      number += block->n();
    }
    return failure;
  }

  SpaceLoop<Real>& loop;
  int n;
  std::vector<std::unique_ptr<BorrowedBlock<Real>>> blocks;
  std::vector<Block<Real>> seen;
  BorrowedTools tools;
  BorrowedBeads beads;
  BorrowedWalls walls;
  BorrowedTies ties;
  int stop[2] = {0, 0};
  std::vector<int> first, corner;
  std::vector<Step> step;
  std::vector<double> work;
  Clock clock;
  std::unique_ptr<Resident<Real>> there;
  struct {
    explicit_dynamics::Work work;
    double beads = 0.0;
    Clock clock;
  } kept;
};

template <class Real>
Session<Real>::Session(SpaceLoop<Real>& loop, Target target, double memory) : own_(std::make_unique<Own>(loop)) {
  const Problem<Real> problem = own_->see();
  own_->there = target == Target::host ? make_on_host(problem, memory) : make_on_card(problem);
  own_->there->make();
}

template <class Real>
Session<Real>::~Session() = default;

template <class Real>
Failure Session<Real>::advance(const Cycles& cycles) {
  const double start = omp_get_wtime();
  SpaceLoop<Real>& loop = own_->loop;
  find_radii();
  for (int first = 0; first < cycles.n; first += most_cycles) {
    const int n = std::min(most_cycles, cycles.n - first);
    for (int i = 0; i < n; ++i) own_->step[i] = cycles.step(first + i);
    own_->clock = {0, loop.contact ? loop.contact->lend().cycle : 0, loop.beads ? loop.beads->lend().cycle : 0};
    if (loop.contact) own_->tools.drive_in(first, n);
    if (loop.beads) own_->beads.share_in(first, n);
    const Found found = own_->there->advance(n);
    own_->give_back_little();
    if (loop.contact) loop.contact->lend().cycle += n;
    if (loop.beads) loop.beads->lend().cycle += n;
    loop.work.external += found.sum[0], loop.work.damping += found.sum[1];
    loop.work.contact += found.sum[3], loop.work.friction += found.sum[4];
    if (own_->stop[1]) {
      fetch(Part::elements);
      return own_->find_failure(first + n);
    }
    finite_ = found.first == std::numeric_limits<int>::max();
    if (!finite_) break;
  }
  loop.seconds[static_cast<int>(explicit_dynamics::Phase::elements)] += omp_get_wtime() - start;
  return {};
}

template <class Real>
void Session<Real>::fetch(Part part) {
  own_->there->arrays.fetch(part);
  for (const auto& block : own_->blocks) {
    if (part == Part::elements) block->give_back();
    if (part == Part::damage) block->give_back_damage();
  }
  if (part == Part::contact && own_->loop.contact) own_->tools.give_back_pairs(own_->n);
}

template <class Real>
void Session<Real>::fetch_measures() {
  Resident<Real>& there = *own_->there;
  for (std::size_t b = 0; b < own_->blocks.size(); ++b) {
    BorrowedBlock<Real>& block = *own_->blocks[b];
    std::visit(
        [&](const auto& of) {
          const int first = of.first_measure, end = std::min(of.rows, first + of.n_measures);
          there.arrays.fetch(block.row(first), of.state + std::size_t(first) * of.n,
                             sizeof(Real) * of.n * (end - first));
          for (int row = first; row < end; ++row) block.give_back_row(row);
        },
        there.problem.block[b]);
  }
}

template <class Real>
void Session<Real>::clear_reaction() {
  own_->there->arrays.clear(Part::reaction);
}

template <class Real>
void Session<Real>::send_walls() {
  own_->walls.follow();
  own_->there->arrays.send(Part::little);
}

template <class Real>
bool Session<Real>::send_given() {
  for (const auto& block : own_->blocks)
    if (!block->take_temperatures()) return false;
  if (!own_->walls.knows_limits()) return false;
  own_->there->arrays.send(Part::given);
  return true;
}

template <class Real>
void Session<Real>::send_sums() {
  own_->there->arrays.send(Part::sums);
}

// Of tools that turn, as before cycles of the loop.
template <class Real>
void Session<Real>::find_radii() {
  BorrowedWalls& walls = own_->walls;
  const auto& nodes = own_->there->problem.nodes;
  bool turns = false;
  for (WallBody& body : walls.body) {
    body.radius = 0.0;
    if (body.motion.spin == 0.0) continue;
    turns = true;
    const Found found = own_->there->sum_up(Farthest<Real>{nodes.n, nodes, body.motion});
    body.radius = explicit_dynamics::widen_radius(found.most);
  }
  if (turns) own_->there->arrays.send(Part::little);
}

template <class Real>
Energies Session<Real>::energies(const Step& step) {
  const SpaceLoop<Real>& loop = own_->loop;
  Resident<Real>& there = *own_->there;
  const auto& problem = there.problem;
  Energies e;
  e.external = loop.work.external, e.damping = loop.work.damping;
  e.contact = loop.work.contact, e.friction = loop.work.friction;
  const Found half = there.sum_up(HalfStep<Real>{problem.nodes.n, problem.nodes, problem.walls, step});
  e.kinetic = half.sum[0], e.external += half.sum[1], e.damping += half.sum[2];
  e.contact += half.sum[3], e.friction += half.sum[4];
  for (int b = 0; b < problem.n_blocks; ++b) {
    const auto row = [](const auto& of, int r) { return r < 0 ? nullptr : of.state + std::size_t(r) * of.n; };
    const Found work = std::visit(
        [&](const auto& of) {
          return there.sum_up(WorkOfElements<Real>{of.n, row(of, of.work_row), row(of, of.hourglass_row)});
        },
        problem.block[b]);
    e.internal += work.sum[0], e.hourglass += work.sum[1];
  }
  if (loop.contact) {
    Found stored = there.sum_up(Stored{problem.nodes.n, problem.tools});
    if (problem.tools.edges.n_sharp > 0) stored += there.sum_up(StoredAtEdges{problem.tools.edges.n, problem.tools});
    loop.contact->energies(step.dt, stored.sum[0], stored.sum[1]).add_to(e);
  }
  if (loop.beads) e.contact += loop.beads->stored(), e.friction += loop.beads->lost();
  return e;
}

template <class Real>
double Session<Real>::bound_frequency() {
  Resident<Real>& there = *own_->there;
  Found found;
  for (int b = 0; b < there.problem.n_blocks; ++b)
    std::visit(
        [&]<class Kind>(const Kind& of) { found += there.sum_up(Bound<Real, Kind>{of.n, there.problem.nodes, of}); },
        there.problem.block[b]);
  return found.most;
}

template <class Real>
void Session<Real>::keep() {
  SpaceLoop<Real>& loop = own_->loop;
  own_->there->arrays.keep();
  own_->kept.work = loop.work;
  own_->kept.clock = {0, loop.contact ? loop.contact->lend().cycle : 0, loop.beads ? loop.beads->lend().cycle : 0};
  own_->kept.beads = loop.beads ? loop.beads->lend().work : 0.0;
}

template <class Real>
void Session<Real>::put_back() {
  SpaceLoop<Real>& loop = own_->loop;
  own_->there->arrays.put_back();
  own_->there->arrays.fetch(Part::little);
  own_->give_back_little();
  loop.work = own_->kept.work;
  if (loop.contact) loop.contact->lend().cycle = own_->kept.clock.contact;
  if (loop.beads) loop.beads->lend().cycle = own_->kept.clock.beads, loop.beads->lend().work = own_->kept.beads;
  finite_ = true;
}

template <class Real>
double Session<Real>::needed() const {
  return own_->there->arrays.needed();
}
template <class Real>
const Traffic& Session<Real>::traffic() const {
  return own_->there->arrays.traffic;
}

template std::string find_lack(const SpaceLoop<double>&);
template std::string find_lack(const SpaceLoop<float>&);
template class Session<double>;
template class Session<float>;

}  // namespace presswork::device
