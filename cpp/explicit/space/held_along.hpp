// SPDX-License-Identifier: Apache-2.0
// Directions that are no axes of space, along which nodes are held: those of symmetry planes that stand askew.
#pragma once

#include "explicit/step.hpp"
#include "tensor/on_device.hpp"

namespace presswork::explicit_dynamics {

// A unit vector, normal to the axes and other directions that hold the same node, and the velocity along it [mm/s].
struct HeldAlong {
  double along[3], velocity;
};

// What a node is free to do.
struct FreeMotion {
  double axis[3];  // 1 or 0
  const HeldAlong* held;
  int n_held;

  // The part of a vector that it can follow.
  PRESSWORK_DEVICE void project(const double vector[3], double out[3]) const {
    for (int i = 0; i < 3; ++i) out[i] = axis[i] * vector[i];
    for (int h = 0; h < n_held; ++h) {
      double part = 0.0;
      for (int i = 0; i < 3; ++i) part += held[h].along[i] * out[i];
      for (int i = 0; i < 3; ++i) out[i] -= part * held[h].along[i];
    }
  }
};

// Give a node its velocities along directions, and the outer force that gives them to it.
template <class Six>
PRESSWORK_DEVICE void hold_along(const FreeMotion& free, const Step& step, double inverse, Six& after, Six& outer) {
  for (int h = 0; h < free.n_held; ++h) {
    const double* along = free.held[h].along;
    double change = step.velocity_scale * free.held[h].velocity;
    for (int i = 0; i < 3; ++i) change -= along[i] * after[i];
    for (int i = 0; i < 3; ++i) {
      after[i] += change * along[i];
      if (inverse > 0.0) outer[i] += change * along[i] / (step.push * inverse);
    }
  }
}

}  // namespace presswork::explicit_dynamics
