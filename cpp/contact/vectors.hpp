// SPDX-License-Identifier: Apache-2.0
// Vectors in space, and lanes of vectors of the compiler.
#pragma once

#include "tensor/on_device.hpp"

namespace presswork::contact {

PRESSWORK_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

PRESSWORK_INLINE void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}

template <class V>
V larger(V a, V b) {
  return a > b ? a : b;
}

}  // namespace presswork::contact
