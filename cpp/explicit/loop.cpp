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
      internal_force(std::size_t(n_nodes) * 6, 0.0),
      packs_a_tile_(std::clamp(shells.n_packs() / 32, 8, 64)) {
  make_tiles();
  set_masses();
}

// Which tile each node belongs to, and what it adds up there.
void ShellLoop::make_tiles() {
  const auto& cells = shells.connectivity();
  const int per_tile = packs_a_tile_ * pack_width, n_tiles = (shells.n() + per_tile - 1) / per_tile;
  constexpr int none = -1, rim = -2;
  std::vector<int> owner(nodes.n, none);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int tile = static_cast<int>(i / 4) / per_tile;
    int& of = owner[cells[i]];
    of = of == none || of == tile ? tile : rim;
  }
  std::vector<std::vector<int>> rows(nodes.n);  // of partial_
  std::vector<std::pair<int, int>> uses;        // node, offset
  int n_partial = 0;
  entry_start_.push_back(0);
  for (int t = 0; t < n_tiles; ++t) {
    Tile tile{t * packs_a_tile_, std::min(shells.n_packs(), (t + 1) * packs_a_tile_), static_cast<int>(target_.size()),
              0};
    uses.clear();
    for (int e = t * per_tile; e < std::min(shells.n(), (t + 1) * per_tile); ++e)
      for (int a = 0; a < 4; ++a) uses.emplace_back(cells[4 * e + a], (e - t * per_tile) * 24 + 6 * a);
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
    tile.nodes_last = static_cast<int>(target_.size());
    tiles_.push_back(tile);
  }
  partial_.assign(std::size_t(n_partial) * 6, 0.0);
  rim_start_.push_back(0);
  for (int node = 0; node < nodes.n; ++node) {
    if (rows[node].empty()) continue;
    rim_node_.push_back(node);
    rim_partial_.insert(rim_partial_.end(), rows[node].begin(), rows[node].end());
    rim_start_.push_back(static_cast<int>(rim_partial_.size()));
  }
}

void ShellLoop::set_masses() {
  const auto& mass = shells.mass();
  const auto& ratio = shells.inertia_ratio();
  const auto& cells = shells.connectivity();
  std::vector<double> sum(std::size_t(nodes.n) * 2, 0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double share = 0.25 * mass[i / 4];
    sum[2 * cells[i]] += share;
    sum[2 * cells[i] + 1] += share * ratio[i / 4];
  }
  for (int i = 0; i < nodes.n; ++i)
    for (int j = 0; j < 2; ++j) {
      const double m = sum[2 * std::size_t(i) + j];
      nodes.motion.data()[std::size_t(Nodes::motion_stride) * i + 6 + j] = m > 0.0 ? 1.0 / m : 0.0;
    }
}

// scratch: forces of the tile's shells (packs, lanes, 24).
void ShellLoop::advance_tile(const Tile& tile, double dt, double* scratch) {
  shells.advance(nodes, dt, tile.first, tile.last, scratch);
  for (int i = tile.nodes_first; i < tile.nodes_last; ++i) {
    double sum[6] = {0, 0, 0, 0, 0, 0};
    for (int s = entry_start_[i]; s < entry_start_[i + 1]; ++s)
      for (int j = 0; j < 6; ++j) sum[j] += scratch[entry_[s] + j];
    const int to = target_[i];
    double* row = to >= 0 ? &internal_force[std::size_t(6) * to] : &partial_[std::size_t(6) * (-1 - to)];
    for (int j = 0; j < 6; ++j) row[j] = sum[j];
  }
}

void ShellLoop::close_rims(int first, int last) {
  for (int i = first; i < last; ++i) {
    double* to = &internal_force[std::size_t(6) * rim_node_[i]];
    for (int j = 0; j < 6; ++j) to[j] = 0.0;
    for (int s = rim_start_[i]; s < rim_start_[i + 1]; ++s)
      for (int j = 0; j < 6; ++j) to[j] += partial_[std::size_t(6) * rim_partial_[s] + j];
  }
}

void ShellLoop::advance_shells(double dt) {
  std::vector<double> scratch(std::size_t(packs_a_tile_) * pack_width * 24);
  for (const auto& tile : tiles_) advance_tile(tile, dt, scratch.data());
  close_rims(0, static_cast<int>(rim_node_.size()));
}

void ShellLoop::next_velocity(int node, double dt, double damping, double force_scale, double velocity_scale,
                              double after[6], double outer[6]) const {
  const std::size_t at = std::size_t(6) * node;
  const double* internal = &internal_force[at];
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
    double after[6], outer[6];
    next_velocity(node, dt, damping, force_scale, velocity_scale, after, outer);
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
  const int n_chunks = (nodes.n + chunk - 1) / chunk, n_tiles = static_cast<int>(tiles_.size());
  const int n_rims = static_cast<int>(rim_node_.size()), n_rim_chunks = (n_rims + chunk - 1) / chunk;
  std::vector<Sums> sums(n_chunks);
#pragma omp parallel if (shells.n_packs() >= 256)  // waking a second thread costs a small mesh more than it gives
  {
    std::vector<double> scratch(std::size_t(packs_a_tile_) * pack_width * 24 + 8);
    for (int cycle = 0; cycle < n; ++cycle) {
#pragma omp for schedule(static)
      for (int c = 0; c < n_chunks; ++c)
        sums[c] = move_nodes(c * chunk, std::min(nodes.n, (c + 1) * chunk), dt, damping, force_scale[cycle],
                             velocity_scale[cycle]);
#pragma omp master
      for (const auto& s : sums) work[0] += s.external, work[1] += s.damping;
#pragma omp for schedule(static)
      for (int t = 0; t < n_tiles; ++t) advance_tile(tiles_[t], dt, scratch.data());
#pragma omp for schedule(static)
      for (int c = 0; c < n_rim_chunks; ++c) close_rims(c * chunk, std::min(n_rims, (c + 1) * chunk));
    }
  }
}

Energies ShellLoop::energies(double dt, double damping, double force_scale, double velocity_scale) const {
  Energies e;
  e.external = work[0];
  e.damping = work[1];
  for (int node = 0; node < nodes.n; ++node) {
    double after[6], outer[6];
    next_velocity(node, dt, damping, force_scale, velocity_scale, after, outer);
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

}  // namespace presswork::explicit_dynamics
