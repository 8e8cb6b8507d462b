// SPDX-License-Identifier: Apache-2.0
// How a rigid tool of solids in space moves: as is prescribed, turning about an axis, and along a direction as a force
// or a spring lets it.
//
// A floating tool has a mass m. Its travel q along a direction follows from the force f of the body on it,
//     m q'' = f + push - k q - m drag q',
// by central differences: the force of a cycle gives the speed of the next. The nodes on the tool move with it, and f
// has their inertia in it; so the scheme is stable where the tool is heavier than they are together.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "explicit/state_field.hpp"
#include "explicit/step.hpp"
#include "tensor/pack.hpp"

namespace presswork::explicit_dynamics {

// What places a tool along a direction.
struct Floating {
  double direction[3] = {0.0, 0.0, 0.0};  // unit vector
  double mass = 0.0, drag = 0.0;          // [t], [1/s]; without a mass it does not float
  double stiffness = 0.0;                 // of its spring, k [N/mm]
  double push = 0.0;                      // along direction; of a spring minus its preload [N]
  bool rests = false;                     // on a stop at q = 0
};

struct WallMotion {
  double origin[3] = {0.0, 0.0, 0.0};                             // of the tool's frame at the start [mm]
  double drawn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};         // rotation from that frame to space at the start
  double centre[3] = {0.0, 0.0, 0.0}, axis[3] = {0.0, 0.0, 1.0};  // of its turning, in space at the start [mm]
  bool turns = false;                                             // it is turned at the start, or later
  double velocity[3] = {0.0, 0.0, 0.0}, spin = 0.0;               // prescribed [mm/s], [1/s]
  Floating floating;
  double offset[3] = {0.0, 0.0, 0.0}, angle = 0.0;  // since the start [mm], [rad]
  double travel = 0.0, rate = 0.0;                  // of the floating tool, q [mm] and q' [mm/s]

  // Of its centre in a step [mm/s].
  PRESSWORK_DEVICE void find_velocity(const Step& step, double w[3]) const {
    for (int i = 0; i < 3; ++i) w[i] = step.velocity_scale * velocity[i] + rate * floating.direction[i];
  }
  // A step is taken; force: of the body on the tool in it (3) [N].
  PRESSWORK_DEVICE void advance(const Step& step, const double force[3]) {
    double w[3];
    find_velocity(step, w);
    for (int i = 0; i < 3; ++i) offset[i] += step.dt * w[i];
    angle += step.dt * step.velocity_scale * spin;
    if (!(floating.mass > 0.0)) return;
    travel += step.dt * rate;
    double total = floating.push - floating.stiffness * travel;
    for (int i = 0; i < 3; ++i) total += force[i] * floating.direction[i];
    const double half = 0.5 * floating.drag * step.dt;
    rate = ((1.0 - half) * rate + step.dt / floating.mass * total) / (1.0 + half);
    if (floating.rests) rate = larger(rate, -travel / step.dt);
  }
  // How fast a place that is so far from the axis at most moves with it [mm/s].
  PRESSWORK_DEVICE double fastest(const Step& step, double radius) const {
    double w[3], square = 0.0;
    find_velocity(step, w);
    for (double each : w) square += each * each;
    return std::sqrt(square) + std::abs(step.velocity_scale * spin) * radius;
  }
  PRESSWORK_DEVICE double distance(const double x[3]) const {
    double square = 0.0;
    for (int i = 0; i < 3; ++i) square += (x[i] - centre[i] - offset[i]) * (x[i] - centre[i] - offset[i]);
    return std::sqrt(square);
  }
  // Moment of a force at x about the axis [N mm].
  PRESSWORK_DEVICE double moment(const double x[3], const double force[3]) const {
    double arm[3], sum = 0.0;
    for (int i = 0; i < 3; ++i) arm[i] = x[i] - centre[i] - offset[i];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      sum += axis[i] * (arm[j] * force[k] - arm[k] * force[j]);
    }
    return sum;
  }
  void list_state(const std::string& name, std::vector<StateField>& fields) {
    fields.push_back(row_field(name, "offset", offset, 3));
    fields.push_back(row_field(name, "angle", &angle, 1));
    fields.push_back(row_field(name, "floating", &travel, 2));
  }
};

// Where a tool stands at the end of a step.
class WallPose {
 public:
  PRESSWORK_DEVICE WallPose(const WallMotion& of, const Step& step) : of_(of), dt_(step.dt) {
    of.find_velocity(step, w_);
    spin_ = step.velocity_scale * of.spin;
    if (of.turns) turn(of.angle + step.dt * spin_);
  }
  // The place in the tool's frame of a node that moves from x at v.
  PRESSWORK_DEVICE void find_place(const double x[3], const double v[3], double place[3]) const {
    if (!of_.turns) {
      for (int i = 0; i < 3; ++i) place[i] = x[i] + dt_ * (v[i] - w_[i]) - of_.origin[i] - of_.offset[i];
      return;
    }
    double arm[3];
    for (int i = 0; i < 3; ++i) arm[i] = x[i] + dt_ * (v[i] - w_[i]) - of_.centre[i] - of_.offset[i];
    for (int i = 0; i < 3; ++i) {
      place[i] = 0.0;
      for (int j = 0; j < 3; ++j)
        place[i] += turned_[j][i] * arm[j] + of_.drawn[j][i] * (of_.centre[j] - of_.origin[j]);
    }
  }
  // A vector of the tool's frame as it points in space.
  PRESSWORK_DEVICE void carry(double vector[3]) const {
    if (!of_.turns) return;
    const double own[3] = {vector[0], vector[1], vector[2]};
    for (int i = 0; i < 3; ++i) vector[i] = turned_[i][0] * own[0] + turned_[i][1] * own[1] + turned_[i][2] * own[2];
  }
  // Velocity of the tool at a place x in space [mm/s].
  PRESSWORK_DEVICE void find_velocity(const double x[3], double w[3]) const {
    for (int i = 0; i < 3; ++i) w[i] = w_[i];
    if (spin_ == 0.0) return;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const double at_j = x[j] - of_.centre[j] - of_.offset[j], at_k = x[k] - of_.centre[k] - of_.offset[k];
      w[i] += spin_ * (of_.axis[j] * at_k - of_.axis[k] * at_j);
    }
  }

 private:
  PRESSWORK_DEVICE void turn(double angle) {
    const double c = std::cos(angle), s = std::sin(angle), *a = of_.axis;
    const double about[3][3] = {
        {c + (1 - c) * a[0] * a[0], (1 - c) * a[0] * a[1] - s * a[2], (1 - c) * a[0] * a[2] + s * a[1]},
        {(1 - c) * a[1] * a[0] + s * a[2], c + (1 - c) * a[1] * a[1], (1 - c) * a[1] * a[2] - s * a[0]},
        {(1 - c) * a[2] * a[0] - s * a[1], (1 - c) * a[2] * a[1] + s * a[0], c + (1 - c) * a[2] * a[2]}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        turned_[i][j] = 0.0;
        for (int k = 0; k < 3; ++k) turned_[i][j] += about[i][k] * of_.drawn[k][j];
      }
  }

  const WallMotion& of_;
  double dt_, w_[3], spin_, turned_[3][3];
};

}  // namespace presswork::explicit_dynamics
