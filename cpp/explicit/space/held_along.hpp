// SPDX-License-Identifier: Apache-2.0
// Directions that are no axes of space, along which nodes are held: those of symmetry planes that stand askew.
#pragma once

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
  void project(const double vector[3], double out[3]) const {
    for (int i = 0; i < 3; ++i) out[i] = axis[i] * vector[i];
    for (int h = 0; h < n_held; ++h) {
      double part = 0.0;
      for (int i = 0; i < 3; ++i) part += held[h].along[i] * out[i];
      for (int i = 0; i < 3; ++i) out[i] -= part * held[h].along[i];
    }
  }
};

}  // namespace presswork::explicit_dynamics
