// SPDX-License-Identifier: Apache-2.0
// One lane or several: the same code reads and writes the lanes of a double and of a pack.
#pragma once

#include "tensor/pack.hpp"

namespace presswork::lanes {

inline int count(double) { return 1; }
inline int count(Pack) { return pack_width; }
inline double get(double v, int) { return v; }
inline double get(const Pack& v, int lane) { return v[lane]; }
inline void set(double& v, int, double x) { v = x; }
inline void set(Pack& v, int lane, double x) { v.set(lane, x); }
inline bool is(bool m, int) { return m; }
inline bool is(Pack::Mask m, int lane) { return m[lane] != 0; }

}  // namespace presswork::lanes
