// SPDX-License-Identifier: Apache-2.0
// What is measured where the state lies: passes over nodes, edges or elements that end in a handful of numbers. Each
// lane finds its own, chunks of 256 lanes are summed up, then the chunks, in a fixed order.
#pragma once

#include <limits>

#include "device/cycle.hpp"

namespace presswork::device {

struct Found {
  double sum[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, most = 0.0;
  int first = std::numeric_limits<int>::max();

  PRESSWORK_DEVICE Found& operator+=(const Found& other) {
    for (int i = 0; i < 5; ++i) sum[i] += other.sum[i];
    most = most > other.most ? most : other.most;
    first = first < other.first ? first : other.first;
    return *this;
  }
};

// After the cycles of a call: work of forces from outside, lost by mass damping, of contact and friction with walls,
// which begins anew; the first node that has a force or a place that is no number.
template <class Real>
struct Settle {
  int n;
  Nodes<Real> nodes;
  double* at_walls;  // (n, 2); null: there are none

  PRESSWORK_INLINE Found operator()(int node) const {
    Found found;
    for (int i = 0; i < 2; ++i) {
      double& work = nodes.work[2 * std::size_t(node) + i];
      found.sum[i] = work, work = 0.0;
      if (!at_walls) continue;
      double& there = at_walls[2 * std::size_t(node) + i];
      found.sum[3 + i] = there, there = 0.0;
    }
    bool finite = true;
    for (int i = 0; i < freedoms; ++i) {
      const double force = nodes.internal_force[std::size_t(freedoms) * node + i];
      finite = finite && force == force;
    }
    for (int i = 0; i < 3; ++i) {
      const double x = nodes.position[4 * std::size_t(node) + i];
      finite = finite && x - x == 0.0;
    }
    if (!finite) found.first = node;
    return found;
  }
};

// Kinetic energy, and the work from outside, of mass damping, of contact and friction with walls in the first half of
// the next step.
template <class Real>
struct HalfStep {
  int n;
  Nodes<Real> nodes;
  Walls walls;
  Step step;

  PRESSWORK_INLINE Found operator()(int node) const {
    Found found;
    const Real* own = nodes.motion + 8 * std::size_t(node);
    double outer[freedoms], before[freedoms], all_after[freedoms];
    next_velocity(nodes, step, node, outer, before, all_after);
    if (walls.n > 0 && walls.touches[node]) {
      const auto done =
          explicit_dynamics::meet_walls(walls.n, see_walls(walls), node, nodes.position + 4 * std::size_t(node), before,
                                        double(own[6]), find_free_motion(nodes, node), step, false, all_after);
      found.sum[1] = done.external, found.sum[3] = done.contact, found.sum[4] = done.friction;
    }
    for (int i = 0; i < freedoms; ++i) {
      const double v = own[i], inverse = own[i < 3 ? 6 : 7], after = all_after[i];
      if (inverse > 0.0) found.sum[0] += 0.5 * v * after / inverse;
      found.sum[1] += 0.5 * step.mean_dt * outer[i] * v;
      if (step.damping > 0.0 && inverse > 0.0)
        found.sum[2] += 0.25 * step.mean_dt * step.damping * v * (v + after) / inverse;
    }
    return found;
  }
};

// Energy in the springs of tools at the nodes: of contact, of stick.
struct Stored {
  int n;
  Tools tools;

  PRESSWORK_INLINE Found operator()(int node) const {
    Found found;
    found.sum[0] = tools.held[node];
    for (int t = 0; t < tools.n; ++t) {
      Pair pair;
      auto* to = reinterpret_cast<double*>(&pair);
      for (int r = 0; r < pair_rows; ++r) to[r] = tools.pairs[(std::size_t(t) * pair_rows + r) * n + node];
      if (!(pair.pressed > 0.0 || pair.squeezed > 0.0)) continue;
      const double k = tools.tool[t].grip.penalty * tools.base[node];
      found.sum[0] += 0.5 * k * pair.pressed * pair.pressed;
      found.sum[1] += 0.5 * contact::dot(pair.shear, pair.shear) / k;
    }
    return found;
  }
};

// The same at the edges.
struct StoredAtEdges {
  int n;
  Tools tools;

  PRESSWORK_INLINE Found operator()(int edge) const {
    Found found;
    const Edges& edges = tools.edges;
    for (int j = 0; j < edges.n_sharp; ++j) {
      const explicit_dynamics::EdgeTouching& p = edges.at[std::size_t(j) * edges.n + edge];
      if (!(p.pressed > 0.0)) continue;
      const explicit_dynamics::Grip& grip = tools.tool[edges.sharp[j].number].grip;
      const double k = explicit_dynamics::edge_touch::share * grip.penalty * edges.base[edge];
      found.sum[0] += 0.5 * k * p.pressed * p.pressed;
      found.sum[1] += 0.5 * contact::dot(p.shear, p.shear) / k;
    }
    return found;
  }
};

// Work of the stresses and of the hourglass forces of a block.
template <class Real>
struct WorkOfElements {
  int n;
  const Real *work, *hourglass;  // (n); null: there are none

  PRESSWORK_INLINE Found operator()(int i) const {
    Found found;
    if (work) found.sum[0] = work[i];
    if (hourglass) found.sum[1] = hourglass[i];
    return found;
  }
};

// How far the farthest node is from the centre of a tool [mm].
template <class Real>
struct Farthest {
  int n;
  Nodes<Real> nodes;
  explicit_dynamics::WallMotion tool;

  PRESSWORK_INLINE Found operator()(int node) const {
    Found found;
    found.most = tool.distance(nodes.position + 4 * std::size_t(node));
    return found;
  }
};

// The largest bound of an element's squared frequency.
template <class Real, class Kind>
struct Bound {
  int n;
  Nodes<Real> nodes;
  Kind block;

  PRESSWORK_INLINE Found operator()(int i) const {
    Found found;
    found.most = block.bound(nodes, i);
    return found;
  }
};

template <class Real, class Blocks>
struct PassesOver;
template <class Real, class... Kinds>
struct PassesOver<Real, std::variant<Kinds...>> {
  using Type = std::variant<Settle<Real>, HalfStep<Real>, Stored, StoredAtEdges, WorkOfElements<Real>, Farthest<Real>,
                            Bound<Real, Kinds>...>;
};
template <class Real>
using Pass = typename PassesOver<Real, Block<Real>>::Type;

}  // namespace presswork::device
