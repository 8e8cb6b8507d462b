// SPDX-License-Identifier: Apache-2.0
#include "explicit/loop.hpp"

#include <algorithm>

namespace presswork::explicit_dynamics {

namespace {

constexpr int chunk = 1024;  // nodes whose work is summed up in one go: the sums do not depend on the threads

}  // namespace

ShellLoop::ShellLoop(int n_nodes, const double* points, ShellSection section, std::vector<int> connectivity,
                     const double* thickness, const double* axis)
    : nodes([&] {
        Nodes made(n_nodes);
        for (int i = 0; i < n_nodes; ++i)
          for (int j = 0; j < 3; ++j)
            made.position.data()[Nodes::position_stride * std::size_t(i) + j] = points[3 * i + j];
        return made;
      }()),
      shells(nodes, std::move(section), std::move(connectivity), thickness, axis),
      force(std::size_t(n_nodes) * 6, 0.0),
      fixed(std::size_t(n_nodes) * 6, 0),
      prescribed(std::size_t(n_nodes) * 6, 0.0),
      start_(n_nodes + 1, 0),
      element_force_(std::size_t(shells.n_packs()) * pack_width * 24, 0.0) {
  const auto& cells = shells.connectivity();
  for (int node : cells) ++start_[node + 1];
  for (int i = 0; i < n_nodes; ++i) start_[i + 1] += start_[i];
  source_.resize(cells.size());
  auto fill = start_;
  for (std::size_t i = 0; i < cells.size(); ++i) source_[fill[cells[i]]++] = static_cast<int>(i);
  set_masses();
}

void ShellLoop::set_masses() {
  const auto& mass = shells.mass();
  const auto& ratio = shells.inertia_ratio();
  for (int i = 0; i < nodes.n; ++i) {
    double m = 0.0, inertia = 0.0;
    for (int s = start_[i]; s < start_[i + 1]; ++s) {
      const double share = 0.25 * mass[source_[s] / 4];
      m += share;
      inertia += share * ratio[source_[s] / 4];
    }
    double* motion = nodes.motion.data() + std::size_t(Nodes::motion_stride) * i;
    motion[6] = m > 0.0 ? 1.0 / m : 0.0;
    motion[7] = inertia > 0.0 ? 1.0 / inertia : 0.0;
  }
}

void ShellLoop::gather(int node, double sum[6]) const {
  for (int i = 0; i < 6; ++i) sum[i] = 0.0;
  for (int s = start_[node]; s < start_[node + 1]; ++s) {
    const double* from = &element_force_[std::size_t(6) * source_[s]];
    for (int i = 0; i < 6; ++i) sum[i] += from[i];
  }
}

void ShellLoop::next_velocity(int node, const double internal[6], double dt, double damping, double force_scale,
                              double velocity_scale, double after[6], double outer[6]) const {
  const std::size_t at = std::size_t(6) * node;
  const double* motion = nodes.motion.data() + std::size_t(Nodes::motion_stride) * node;
  const double kept = (1.0 - 0.5 * damping * dt) / (1.0 + 0.5 * damping * dt), push = dt / (1.0 + 0.5 * damping * dt);
  for (int i = 0; i < 6; ++i) {
    const double inverse = motion[i < 3 ? 6 : 7], v = motion[i];
    outer[i] = force_scale * force[at + i];
    after[i] = kept * v + push * inverse * (outer[i] - internal[i]);
    if (fixed[at + i]) {  // the outer force is the one that gives the prescribed velocity
      after[i] = velocity_scale * prescribed[at + i];
      outer[i] = internal[i] + (inverse > 0.0 ? (after[i] - kept * v) / (push * inverse) : 0.0);
    }
  }
}

ShellLoop::Sums ShellLoop::move_nodes(int first, int last, double dt, double damping, double force_scale,
                                      double velocity_scale) {
  Sums sums;
  for (int node = first; node < last; ++node) {
    double internal[6], after[6], outer[6];
    gather(node, internal);
    next_velocity(node, internal, dt, damping, force_scale, velocity_scale, after, outer);
    double* motion = nodes.motion.data() + std::size_t(Nodes::motion_stride) * node;
    double* x = nodes.position.data() + std::size_t(Nodes::position_stride) * node;
    for (int i = 0; i < 6; ++i) {
      const double mean = 0.5 * (motion[i] + after[i]), inverse = motion[i < 3 ? 6 : 7];
      sums.external += outer[i] * mean;
      if (damping > 0.0 && inverse > 0.0) sums.damping += mean * mean / inverse;
      motion[i] = after[i];
    }
    for (int i = 0; i < 3; ++i) x[i] += dt * after[i];
  }
  sums.external *= dt;
  sums.damping *= dt * damping;
  return sums;
}

void ShellLoop::advance(int n, double dt, double damping, const double* force_scale, const double* velocity_scale) {
  const int n_chunks = (nodes.n + chunk - 1) / chunk, n_packs = shells.n_packs();
  constexpr int packs_a_task = 16;
  const int n_tasks = (n_packs + packs_a_task - 1) / packs_a_task;
  std::vector<Sums> sums(n_chunks);
#pragma omp parallel if (n_packs >= 256)  // waking a second thread costs a small mesh more than it gives
  for (int cycle = 0; cycle < n; ++cycle) {
#pragma omp for schedule(static)
    for (int c = 0; c < n_chunks; ++c)
      sums[c] = move_nodes(c * chunk, std::min(nodes.n, (c + 1) * chunk), dt, damping, force_scale[cycle],
                           velocity_scale[cycle]);
#pragma omp master
    for (const auto& s : sums) work[0] += s.external, work[1] += s.damping;
#pragma omp for schedule(static)
    for (int task = 0; task < n_tasks; ++task)
      shells.advance(nodes, dt, task * packs_a_task, std::min(n_packs, (task + 1) * packs_a_task),
                     element_force_.data());
  }
}

Energies ShellLoop::energies(double dt, double damping, double force_scale, double velocity_scale) const {
  Energies e;
  e.external = work[0];
  e.damping = work[1];
  for (int node = 0; node < nodes.n; ++node) {
    double internal[6], after[6], outer[6];
    gather(node, internal);
    next_velocity(node, internal, dt, damping, force_scale, velocity_scale, after, outer);
    const double* motion = nodes.motion.data() + std::size_t(Nodes::motion_stride) * node;
    for (int i = 0; i < 6; ++i) {
      const double inverse = motion[i < 3 ? 6 : 7];
      if (inverse > 0.0) e.kinetic += 0.5 * motion[i] * after[i] / inverse;
      // half of this step's work, by the velocity of its first half
      e.external += 0.5 * dt * outer[i] * motion[i];
      if (damping > 0.0 && inverse > 0.0)
        e.damping += 0.25 * dt * damping * motion[i] * (motion[i] + after[i]) / inverse;
    }
  }
  for (int i = 0; i < shells.n(); ++i) {
    e.internal += shells.value(i, shell4::work);
    e.hourglass += shells.value(i, shell4::hourglass_work);
  }
  return e;
}

void ShellLoop::internal_force(double* out) const {
  for (int node = 0; node < nodes.n; ++node) gather(node, out + 6 * std::size_t(node));
}

}  // namespace presswork::explicit_dynamics
