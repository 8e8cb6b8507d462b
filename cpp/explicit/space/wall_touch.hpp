// SPDX-License-Identifier: Apache-2.0
// What rigid tools of solids in space do to one node in a step, on the CPU and on a card from one source.
//
// The constraint is kinematic, as that of plane/rigid_wall.hpp: a node that its velocity would take into the tool gets
// the velocity, along the tool's normal, that takes it onto the surface; the impulse is its mass times that change.
// Friction takes away sliding by at most mu times the normal impulse, and by no more than what the metal beneath the
// node can bear, where a limit is given. A node's own momentum towards the tool is
// lost when it strikes, as in a plastic impact. On a curved tool, or in a corner, the surface is asked once more.
//
// A node off the tool sleeps until the way that nodes and tool have gone together has grown by 0.9 of its gap. How the
// tool moves is said in wall_motion.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "contact/touch.hpp"
#include "explicit/space/held_along.hpp"
#include "explicit/space/wall_motion.hpp"

namespace presswork::explicit_dynamics {

// A rigid tool of solids without what its nodes remember.
struct WallBody {
  double mu = 0.0, reach = 0.0;  // friction over pressure, infinite where nothing slides; how far off it is found [mm]
  WallMotion motion;
  double impulse[4] = {0.0, 0.0, 0.0, 0.0};  // given to the nodes since the start [N s], and about the axis [N mm s]
  double travel = 0.0, last = 0.0;           // way of nodes and tool since the start, and in the last step [mm]
  double radius = 0.0;                       // how far nodes are from the centre of a tool that turns [mm]

  // When all nodes have moved. sum: force on them (3) [N] and its moment about the axis [N mm]; fastest: of their
  // speeds [mm/s].
  PRESSWORK_DEVICE void advance(const Step& step, double fastest, const double sum[4]) {
    double on_tool[3];
    last = step.dt * (fastest + motion.fastest(step, radius));
    for (int i = 0; i < 4; ++i) impulse[i] += step.mean_dt * sum[i];
    for (int i = 0; i < 3; ++i) on_tool[i] = -sum[i];
    motion.advance(step, on_tool);
    travel += last;
  }
  // Go to where another has gone, which is moved otherwise.
  void go_where(const WallBody& other) {
    std::copy_n(other.motion.offset, 3, motion.offset), motion.angle = other.motion.angle;
    motion.travel = other.motion.travel, motion.rate = other.motion.rate;
    std::copy_n(other.impulse, 4, impulse), travel = other.travel, last = other.last;
  }
};

// How far nodes come from the centre of a tool that turns in the cycles of a call, which they begin so far off [mm].
PRESSWORK_DEVICE inline double widen_radius(double farthest) { return 1.1 * farthest; }

// What nodes have of a tool.
struct WallNodes {
  double* force;                 // (n_nodes, 3) on them in the last cycle [N]
  double *pressed, *rubbed;      // (n_nodes) impulse of the pressure [N s], work that friction has taken [N mm]
  double* wake;                  // (n_nodes) the travel at which a node may touch
  int* hint;                     // (n_nodes)
  const double* friction_limit;  // (n_nodes) [N]; null: there is none
};

// What a tool does to a node that touches it: its velocity there, and the changes of the node's velocity by its
// pressure and friction [mm/s].
struct WallTouch {
  double w[3], normal[3], slide[3];
};

// A tool as a lane sees it. Surface has nearest(x, reach, hint, touch).
template <class Surface>
struct WallView {
  const WallBody& body;
  WallNodes of;
  const Surface& surface;

  PRESSWORK_DEVICE bool is_awake(int node) const { return of.wake[node] <= body.travel; }

  // Count what a node that moves at v gets in a cycle, with its mass over the time of a change of velocity.
  PRESSWORK_DEVICE void add_to_sums(int node, double mean_dt, double mass, const double v[3],
                                    const WallTouch& touch) const {
    double square = 0.0;
    for (double change : touch.normal) square += change * change;
    of.pressed[node] += mean_dt * mass * std::sqrt(square);
    for (int i = 0; i < 3; ++i) of.rubbed[node] -= mean_dt * mass * touch.slide[i] * (v[i] - touch.w[i]);
  }

  // Correct the velocity v of a node at x over a step; by_force: change of velocity by a force in this step [1/t s].
  // Returns whether it touches. whole: the step is taken, so that a node far off may sleep.
  PRESSWORK_DEVICE bool constrain(int node, const double x[3], const Step& step, const FreeMotion& free,
                                  double by_force, bool whole, double v[3], WallTouch& done) const {
    const double before[3] = {v[0], v[1], v[2]}, dt = step.dt;
    const WallPose pose(body.motion, step);
    double push = 0.0, out[3];
    int hint = of.hint[node];
    for (int round = 0; round < rounds; ++round) {
      double place[3];
      pose.find_place(x, v, place);
      contact::Touch touch;
      const bool near = surface.nearest(place, body.reach, hint, touch);
      if (round == 0 && whole) {
        const double sleep = 0.9 * touch.gap - 4.0 * body.last;
        of.wake[node] = sleep > 0.0 ? body.travel + sleep : 0.0;
        if (near) of.hint[node] = hint;
      }
      if (!near || !(touch.gap < 0.0)) break;
      pose.carry(touch.normal);
      const double change = push_out(touch.gap, touch.normal, dt, free, v);
      if (round == 0) {
        push = change;
        for (int i = 0; i < 3; ++i) out[i] = touch.normal[i];
      }
    }
    if (push == 0.0) return false;
    pose.find_velocity(x, done.w);
    for (int i = 0; i < 3; ++i) done.normal[i] = v[i] - before[i];
    const double limit = of.friction_limit ? of.friction_limit[node] * by_force : -1.0;
    rub(out, push, limit, free, v, done);
    return true;
  }

 private:
  static constexpr int rounds = 3;

  // Friction on what slides along the tangent plane; limit: of the change of velocity, negative where there is none.
  PRESSWORK_DEVICE void rub(const double out[3], double push, double limit, const FreeMotion& free, double v[3],
                            WallTouch& done) const {
    double along[3], able[3], across = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) done.slide[i] = 0.0, across += (v[i] - done.w[i]) * out[i];
    for (int i = 0; i < 3; ++i) along[i] = v[i] - done.w[i] - across * out[i], size += along[i] * along[i];
    size = std::sqrt(size);
    if (!(size > 0.0)) return;
    double most = body.mu * push < size ? body.mu * push : size;
    if (limit >= 0.0 && limit < most) most = limit;
    const double held = most / size;
    free.project(along, able);
    for (int i = 0; i < 3; ++i) done.slide[i] = -held * able[i], v[i] += done.slide[i];
  }
  // Returns the change of velocity along the normal.
  PRESSWORK_DEVICE static double push_out(double gap, const double normal[3], double dt, const FreeMotion& free,
                                          double v[3]) {
    double n[3], square = 0.0;
    free.project(normal, n);
    for (double each : n) square += each * each;
    if (square < 1e-12) return 0.0;  // cannot move off
    const double change = -gap / (dt * square);
    for (int i = 0; i < 3; ++i) v[i] += change * n[i];
    return change;
  }
};

// Correct the velocity v of a node by n walls, over the whole step, when their forces are kept too, or over its first
// half; wall(i): a WallView. before: its velocity; inverse: of its mass. Gives what forces and walls do meanwhile
// beside the work of the outer force.
template <class WallAt>
PRESSWORK_DEVICE Work meet_walls(int n, const WallAt& wall, int node, const double x[3], const double before[3],
                                 double inverse, const FreeMotion& free, const Step& step, bool whole, double v[3]) {
  double pressure[3] = {0.0, 0.0, 0.0}, friction[3] = {0.0, 0.0, 0.0}, by_pressure = 0.0, by_friction = 0.0;
  const double free_fall[3] = {v[0], v[1], v[2]};
  bool any = false;
  for (int i = 0; i < n; ++i) {
    const auto own = wall(i);
    double* kept = own.of.force + 3 * std::size_t(node);
    if (whole) kept[0] = kept[1] = kept[2] = 0.0;
    if (!(inverse > 0.0) || !own.is_awake(node)) continue;
    WallTouch touch;
    if (!own.constrain(node, x, step, free, step.push * inverse, whole, v, touch)) continue;
    any = true;
    const double mass = 1.0 / (step.push * inverse);
    for (int k = 0; k < 3; ++k) {
      pressure[k] += touch.normal[k] * mass, by_pressure += touch.w[k] * touch.normal[k] * mass;
      friction[k] += touch.slide[k] * mass, by_friction += touch.w[k] * touch.slide[k] * mass;
      if (whole) kept[k] = (touch.normal[k] + touch.slide[k]) * mass;
    }
    if (whole) own.add_to_sums(node, step.mean_dt, mass, v, touch);
  }
  Work done;
  if (!any) {
    for (int k = 0; k < 3; ++k) v[k] = free_fall[k];
    return done;
  }
  const double time = whole ? step.mean_dt : 0.5 * step.mean_dt, by_walls = by_pressure + by_friction;
  done.external = time * by_walls, done.contact = time * by_pressure, done.friction = time * by_friction;
  for (int k = 0; k < 3; ++k) {
    const double by = whole ? 0.5 * (before[k] + v[k]) : before[k];
    done.contact -= time * pressure[k] * by;
    done.friction -= time * friction[k] * by;
  }
  return done;
}

}  // namespace presswork::explicit_dynamics
