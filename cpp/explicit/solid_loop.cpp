// SPDX-License-Identifier: Apache-2.0
#include "explicit/solid_loop.hpp"

#include <algorithm>
#include <climits>

#include <omp.h>

#include "explicit/work_shares.hpp"

namespace presswork::explicit_dynamics {

namespace {

constexpr int chunk = 256;             // nodes whose work is summed up in one go: the sums do not depend on the threads
constexpr int serial_elements = 2000;  // fewer are left to one thread: waking a second costs more than it gives

}  // namespace

SolidLoop::SolidLoop(int n_nodes, const double* points, const std::uint8_t* contact, const SolidSection& section)
    : section(section),
      n_nodes(n_nodes),
      nodes(SolidBlock::node_record * padded()),
      velocity(2 * padded()),
      force(2 * padded()),
      internal_force(2 * padded()),
      mass(n_nodes),
      reaction_impulse(2 * std::size_t(n_nodes)),
      contact_(contact, contact + n_nodes),
      fixed_(2 * std::size_t(n_nodes)),
      special_(padded() / 4),
      inverse_mass_(2 * padded()),
      prescribed_(2 * std::size_t(n_nodes)) {
  for (int i = 0; i < n_nodes; ++i)
    std::copy_n(points + 2 * std::size_t(i), 2, nodes.data() + SolidBlock::node_record * std::size_t(i));
}

void SolidLoop::add(std::string_view element, std::vector<int> cells, SolidLawChoice law, double density) {
  std::vector<double> points(2 * std::size_t(n_nodes));
  for (int i = 0; i < n_nodes; ++i)
    std::copy_n(nodes.data() + SolidBlock::node_record * std::size_t(i), 2, points.data() + 2 * std::size_t(i));
  blocks.emplace_back(element, std::move(cells), points.data(), std::move(law), density, section);
  weigh();
  make_tiles();
}

void SolidLoop::make_tiles() {
  std::vector<TiledBlock> views;
  for (const auto& block : blocks)
    views.push_back({block.n(), SolidBlock::lanes, block.nodes_each(), SolidBlock::force_record, block.cells.data()});
  tiles_.cut(n_nodes, views);
}

void SolidLoop::weigh() {
  std::fill(mass.begin(), mass.end(), 0.0);
  for (const auto& block : blocks)
    for (std::size_t i = 0; i < block.cells.size(); ++i)
      mass[block.cells[i]] += block.mass_factor[i / block.nodes_each()] * block.mass[i];
  for (int i = 0; i < n_nodes; ++i)
    for (int k = 0; k < 2; ++k) inverse_mass_.data()[2 * std::size_t(i) + k] = mass[i] > 0.0 ? 1.0 / mass[i] : 0.0;
}

void SolidLoop::add_wall(std::vector<double> segments, double mu) {
  walls.push_back(std::make_unique<RigidWall>(n_nodes, std::move(segments), mu));
  mark_special();
}

void SolidLoop::prescribe(const std::uint8_t* fixed, const double* velocity) {
  std::copy_n(fixed, fixed_.size(), fixed_.begin());
  std::copy_n(velocity, prescribed_.size(), prescribed_.begin());
  mark_special();
}

void SolidLoop::mark_special() {
  std::fill(special_.begin(), special_.end(), 0);
  for (std::size_t i = 0; i < std::size_t(n_nodes); ++i)
    if (fixed_[2 * i] || fixed_[2 * i + 1] || (contact_[i] && !walls.empty())) special_[i / 4] = 1;
}

SolidLoop::Work SolidLoop::step_node(int node, const Step& step, bool whole, double after[2]) const {
  const std::size_t at = 2 * std::size_t(node);
  const double m = mass[node], kept = step.kept, push = m > 0.0 ? step.push / m : 0.0;
  const double *x = nodes.data() + 2 * at, *v = velocity.data() + at, *inner = internal_force.data() + at;
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
  for (const auto& wall : walls) {
    double* kept_force = &wall->force[at];
    if (whole) kept_force[0] = kept_force[1] = 0.0;
    if (!contact_[node] || m == 0.0) continue;
    const double w[2] = {step.velocity_scale * wall->velocity[0], step.velocity_scale * wall->velocity[1]};
    double normal[2], slide[2];
    if (!wall->constrain(x, step.dt, w, free, after, normal, slide)) continue;
    for (int i = 0; i < 2; ++i) {
      pressure[i] += normal[i] / push, by_pressure += w[i] * normal[i] / push;
      friction[i] += slide[i] / push, by_friction += w[i] * slide[i] / push;
      if (whole) kept_force[i] = (normal[i] + slide[i]) / push;
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

void SolidLoop::add_to(Work& sum, const Work& part) {
  sum.external += part.external, sum.damping += part.damping;
  sum.contact += part.contact, sum.friction += part.friction;
}

void SolidLoop::move_one(int node, const Step& step, Work& sum, double* wall_force) {
  const std::size_t at = 2 * std::size_t(node);
  double after[2], *x = nodes.data() + 2 * at;
  add_to(sum, step_node(node, step, true, after));
  for (int i = 0; i < 2; ++i) {
    if (fixed_[at + i])
      reaction_impulse[at + i] +=
          step.mean_dt * (internal_force.data()[at + i] - step.force_scale * force.data()[at + i] +
                          mass[node] * (after[i] - step.kept * velocity.data()[at + i]) / step.push);
    velocity.data()[at + i] = after[i];
    x[2 + i] = step.dt * after[i];
    x[i] += x[2 + i];
  }
  if (!contact_[node]) return;
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (int i = 0; i < 2; ++i) wall_force[2 * w + i] += walls[w]->force[at + i];
}

void SolidLoop::move_four(int first, const Step& step, Record& external, Record& damped) {
  const std::size_t at = 2 * std::size_t(first);
  const Record before = load_record(velocity.data() + at), inverse = load_record(inverse_mass_.data() + at);
  const Record outer = step.force_scale * load_record(force.data() + at);
  const Record after = step.kept * before + step.push * inverse * (outer - load_record(internal_force.data() + at));
  external += outer * (before + after);
  if (step.damping > 0.0) {
    const Record mean = 0.5 * (before + after);
    damped += inverse > 0.0 ? mean * mean / inverse : Record{};
  }
  store_record<8>(after, velocity.data() + at);
  const Record move = step.dt * after, twice[2] = {__builtin_shufflevector(move, move, 0, 1, 0, 1, 2, 3, 2, 3),
                                                   __builtin_shufflevector(move, move, 4, 5, 4, 5, 6, 7, 6, 7)};
  for (int half = 0; half < 2; ++half) {
    double* x = nodes.data() + 2 * at + 8 * half;
    store_record<8>(twice[half] + __builtin_shufflevector(load_record(x), Record{}, 0, 1, 8, 8, 4, 5, 8, 8), x);
  }
}

SolidLoop::Work SolidLoop::move_nodes(int first, int last, const Step& step, double* wall_force) {
  Work sum;
  Record external{}, damped{};
  for (int node = first; node < last; node += 4) {
    if (!special_[node / 4]) {
      move_four(node, step, external, damped);
      continue;
    }
    for (int i = node; i < std::min(node + 4, last); ++i) move_one(i, step, sum, wall_force);
  }
  for (int i = 0; i < 8; ++i) {
    sum.external += 0.5 * step.mean_dt * external[i];
    sum.damping += step.mean_dt * step.damping * damped[i];
  }
  return sum;
}

int SolidLoop::advance_tile(const Tile& tile, double dt, double time, double* scratch) {
  const int failed = blocks[tile.block].advance(nodes.data(), dt, time, tile.first, tile.last, scratch);
  tiles_.sum_tile(tile, scratch, internal_force.data());
  return failed < 0 ? -1 : SolidBlock::reasons * tile.numbered_from + failed;
}

int SolidLoop::advance(int n, double time, double dt, double dt_before, double damping, const double* force_scale,
                       const double* velocity_scale) {
  const int n_chunks = (n_nodes + chunk - 1) / chunk, n_tiles = static_cast<int>(tiles_.tiles().size());
  const int n_rims = tiles_.n_rim_nodes(), rim_chunks = (n_rims + chunk - 1) / chunk;
  int n_elements = 0;
  for (const auto& block : blocks) n_elements += block.n();
  std::vector<Work> sums(n_chunks);
  const std::size_t n_walls = walls.size();
  std::vector<double> wall_sums(n_chunks * 2 * n_walls);
  int failed = INT_MAX;
  const bool shared = n_elements >= serial_elements;
  WorkShares shares(n_tiles, shared ? omp_get_max_threads() : 1);
#pragma omp parallel if (shared)
  {
    const int thread = omp_get_thread_num(), n_threads = omp_get_num_threads();
    AlignedArray<double> scratch = tiles_.make_scratch();
    for (int cycle = 0; cycle < n; ++cycle) {
      shares.deal(thread, n_threads);
      const Step step{dt, cycle == 0 ? 0.5 * (dt_before + dt) : dt, damping, force_scale[cycle], velocity_scale[cycle]};
#pragma omp for schedule(static)
      for (int c = 0; c < n_chunks; ++c) {
        double* wall_force = wall_sums.data() + c * 2 * n_walls;
        std::fill_n(wall_force, 2 * n_walls, 0.0);
        sums[c] = move_nodes(c * chunk, std::min(n_nodes, (c + 1) * chunk), step, wall_force);
      }
#pragma omp master
      {
        for (const auto& s : sums) add_to(work, s);
        for (std::size_t w = 0; w < n_walls; ++w)
          for (int i = 0; i < 2; ++i) {
            walls[w]->offset[i] += dt * step.velocity_scale * walls[w]->velocity[i];
            for (int c = 0; c < n_chunks; ++c)
              walls[w]->impulse[i] += step.mean_dt * wall_sums[(c * n_walls + w) * 2 + i];
          }
      }
      int failed_here = INT_MAX;
      for (int t; (t = shares.take(thread)) >= 0;)
        if (const int cell = advance_tile(tiles_.tiles()[t], dt, time + cycle * dt, scratch.data()); cell >= 0)
          failed_here = std::min(failed_here, cell);
      if (failed_here != INT_MAX) {
#pragma omp critical
        failed = std::min(failed, failed_here);
      }
#pragma omp barrier
      if (failed != INT_MAX) break;  // the same for all threads
#pragma omp for schedule(static)
      for (int c = 0; c < rim_chunks; ++c)
        tiles_.close_rims(c * chunk, std::min(n_rims, (c + 1) * chunk), internal_force.data());
    }
  }
  return failed == INT_MAX ? -1 : failed;
}

SolidEnergies SolidLoop::energies(double dt, double dt_before, double damping, double force_scale,
                                  double velocity_scale) const {
  const Step step{dt, 0.5 * (dt_before + dt), damping, force_scale, velocity_scale};
  Work sum = work;
  SolidEnergies e;
  for (int node = 0; node < n_nodes; ++node) {
    double after[2];
    add_to(sum, step_node(node, step, false, after));
    for (int i = 0; i < 2; ++i) e.kinetic += 0.5 * mass[node] * velocity.data()[2 * std::size_t(node) + i] * after[i];
  }
  e.external = sum.external, e.damping = sum.damping, e.contact = sum.contact, e.friction = sum.friction;
  for (const auto& block : blocks)
    for (int i = 0; i < block.n(); ++i) {
      e.internal += block.value(i, CycleRow::work);
      e.hourglass += block.value(i, CycleRow::hourglass_work);
    }
  return e;
}

}  // namespace presswork::explicit_dynamics
