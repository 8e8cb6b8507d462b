// SPDX-License-Identifier: Apache-2.0
// What kernels of solids in space ask of a law in a cycle of the explicit loop. That of a law of our own is its view;
// umat_space_cycle.hpp has the same for a law from a shared library.
//
// A point's values are those of point_response.hpp: s0 at the start, s1 at the end of the cycle, which keep_point takes
// over.
#pragma once

#include "element/space_response.hpp"

namespace presswork {

// Flow stress and slope that hourglass control goes by, at the start of a cycle.
template <class T, class Law>
PRESSWORK_INLINE void find_flow(const Law& law, T given, const T* s0, T& flow, T& slope) {
  law.flow_at_rest(s0[6], point_temperature(law, given, s0), flow, slope);
}

// By the strain of a cycle in the axes of its start, and the rotation R from them; H: F - 1 of the cycle. unturned: the
// stress at the end in these axes. Gives the lanes in which the law failed.
template <class T, class Law>
PRESSWORK_INLINE Mask<T> advance_point(const Law& law, const LawInput<6, T>& in, const T (&)[3][3], const T (&R)[3][3],
                                       const T* s0, T* s1, T (&unturned)[6]) {
  const Mask<T> failed = space::call_law(law, in, s0, s1, static_cast<T(*)[6]>(nullptr));
  for (int i = 0; i < 6; ++i) unturned[i] = s1[i];
  stretch::turn_tensor(R, unturned, s1);
  space::turn_axes(law, R, s0, s1);
  return failed;
}

template <class T, class Law>
PRESSWORK_INLINE void keep_point(const Law& law, const T* s1, T* s0) {
  for (int i = 0; i < 7 + kept_values(law); ++i) s0[i] = s1[i];
}

}  // namespace presswork
