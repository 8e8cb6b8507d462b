// SPDX-License-Identifier: Apache-2.0
#include "explicit/solid_loop.hpp"

#include <algorithm>
#include <climits>

namespace presswork::explicit_dynamics {

namespace {

constexpr int chunk = 256;             // nodes whose work is summed up in one go: the sums do not depend on the threads
constexpr int serial_elements = 4000;  // fewer are left to one thread: waking a second costs more than it gives

}  // namespace

SolidLoop::SolidLoop(int n_nodes, const double* points, const std::uint8_t* contact, const SolidSettings& settings)
    : settings(settings),
      n_nodes(n_nodes),
      position(points, points + 2 * std::size_t(n_nodes)),
      velocity(position.size()),
      force(position.size()),
      prescribed(position.size()),
      internal_force(position.size()),
      mass(n_nodes),
      fixed(position.size()),
      contact_(contact, contact + n_nodes),
      increment_(position.size()) {}

void SolidLoop::add(std::string_view element, std::vector<int> cells, const AdiabaticMises& law, double density) {
  blocks.emplace_back(element, std::move(cells), position.data(), law, density, settings);
  weigh();
  find_sources();
}

void SolidLoop::weigh() {
  std::fill(mass.begin(), mass.end(), 0.0);
  for (const auto& block : blocks)
    for (std::size_t i = 0; i < block.cells.size(); ++i)
      mass[block.cells[i]] += block.mass_factor[i / block.nodes_each()] * block.mass[i];
}

void SolidLoop::add_wall(std::vector<double> segments, double mu) {
  walls.push_back(std::make_unique<RigidWall>(n_nodes, std::move(segments), mu));
}

void SolidLoop::find_sources() {
  std::vector<std::vector<std::size_t>> of_node(n_nodes);
  std::size_t start = 0;
  block_start_.clear();
  for (const auto& block : blocks) {
    block_start_.push_back(start);
    const std::size_t nodes = block.nodes_each();
    for (std::size_t i = 0; i < block.cells.size(); ++i) {
      const std::size_t cell = i / nodes, a = i % nodes;
      of_node[block.cells[i]].push_back(start + (cell / pack_width * 2 * nodes + 2 * a) * pack_width +
                                        cell % pack_width);
    }
    start += block.force_size();
  }
  element_force_.assign(start, 0.0);
  source_.clear(), source_start_.assign(1, 0);
  for (const auto& sources : of_node) {
    source_.insert(source_.end(), sources.begin(), sources.end());
    source_start_.push_back(source_.size());
  }
}

SolidLoop::Work SolidLoop::step_node(int node, const Step& step, bool whole, double after[2]) const {
  const std::size_t at = 2 * std::size_t(node);
  const double m = mass[node], half = 0.5 * step.damping * step.mean_dt;
  const double kept = (1.0 - half) / (1.0 + half), push = m > 0.0 ? step.mean_dt / ((1.0 + half) * m) : 0.0;
  const double *v = &velocity[at], *inner = &internal_force[at];
  // 1. forces and prescribed velocities; the outer force of these is the one that gives them
  double outer[2], free[2];
  for (int i = 0; i < 2; ++i) {
    outer[i] = step.force_scale * force[at + i];
    after[i] = kept * v[i] + push * (outer[i] - inner[i]);
    free[i] = !fixed[at + i];
    if (!fixed[at + i]) continue;
    after[i] = step.velocity_scale * prescribed[at + i];
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
    if (!wall->constrain(&position[at], step.dt, w, free, after, normal, slide)) continue;
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

SolidLoop::Work SolidLoop::move_nodes(int first, int last, const Step& step, double* wall_force) {
  Work sum;
  for (int node = first; node < last; ++node) {
    const std::size_t at = 2 * std::size_t(node);
    double after[2];
    add_to(sum, step_node(node, step, true, after));
    for (int i = 0; i < 2; ++i) velocity[at + i] = after[i], increment_[at + i] = step.dt * after[i];
    if (!contact_[node]) continue;
    for (std::size_t w = 0; w < walls.size(); ++w)
      for (int i = 0; i < 2; ++i) wall_force[2 * w + i] += walls[w]->force[at + i];
  }
  return sum;
}

void SolidLoop::close_nodes(int first, int last) {
  for (int node = first; node < last; ++node) {
    double sum[2] = {0.0, 0.0};
    for (std::size_t s = source_start_[node]; s < source_start_[node + 1]; ++s) {
      sum[0] += element_force_[source_[s]];
      sum[1] += element_force_[source_[s] + pack_width];
    }
    for (int i = 0; i < 2; ++i) {
      const std::size_t at = 2 * std::size_t(node) + i;
      position[at] += increment_[at];
      internal_force[at] = sum[i];
    }
  }
}

int SolidLoop::advance(int n, double dt, double dt_before, double damping, const double* force_scale,
                       const double* velocity_scale) {
  const int n_chunks = (n_nodes + chunk - 1) / chunk;
  int n_elements = 0;
  for (const auto& block : blocks) n_elements += block.n();
  std::vector<Work> sums(n_chunks);
  const std::size_t n_walls = walls.size();
  std::vector<double> wall_sums(n_chunks * 2 * n_walls);
  int failed = INT_MAX;
#pragma omp parallel if (n_elements >= serial_elements)
  {
    for (int cycle = 0; cycle < n; ++cycle) {
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
      int first_cell = 0;
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        SolidBlock& block = blocks[k];
#pragma omp for schedule(static) reduction(min : failed)
        for (int pack = 0; pack < block.n_packs(); ++pack) {
          const int cell =
              block.advance(position.data(), increment_.data(), dt, &element_force_[block_start_[k]], pack);
          if (cell >= 0) failed = std::min(failed, first_cell + cell);
        }
        first_cell += block.n();
      }
      if (failed != INT_MAX) break;
#pragma omp for schedule(static)
      for (int c = 0; c < n_chunks; ++c) close_nodes(c * chunk, std::min(n_nodes, (c + 1) * chunk));
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
    for (int i = 0; i < 2; ++i) e.kinetic += 0.5 * mass[node] * velocity[2 * std::size_t(node) + i] * after[i];
  }
  e.external = sum.external, e.damping = sum.damping, e.contact = sum.contact, e.friction = sum.friction;
  for (const auto& block : blocks)
    for (int i = 0; i < block.n(); ++i) e.internal += block.work[2 * i], e.hourglass += block.work[2 * i + 1];
  return e;
}

}  // namespace presswork::explicit_dynamics
