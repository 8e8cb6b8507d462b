// SPDX-License-Identifier: Apache-2.0
// The place of a facet of 3 or 4 corners that is closest to a point.
//
// A facet of 4 corners is taken as four triangles round its centre: the same surface whichever corner comes first,
// without gaps to its neighbours, and plane where its corners are. The search in a triangle goes by the regions of its
// corners, sides and inside (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
#pragma once

#include <algorithm>
#include <limits>

#include "contact/vectors.hpp"

namespace presswork::contact {

template <class S>
S dot(const S a[3], const S b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class S>
struct PlaceOnCell {
  S weight[4];  // of the corners; their sum is 1
  S away[3];    // from the place to the point [mm]
  S squared;    // its length squared
};
using OnCell = PlaceOnCell<double>;

// Weights of the corners a, b, c of a triangle at the place closest to x.
template <class S>
void find_closest_on_triangle(const S x[3], const S a[3], const S b[3], const S c[3], S w[3]) {
  S ab[3], ac[3], ax[3], bx[3], cx[3];
  for (int i = 0; i < 3; ++i)
    ab[i] = b[i] - a[i], ac[i] = c[i] - a[i], ax[i] = x[i] - a[i], bx[i] = x[i] - b[i], cx[i] = x[i] - c[i];
  const auto take = [w](S of_a, S of_b, S of_c) { w[0] = of_a, w[1] = of_b, w[2] = of_c; };
  const S d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0.0 && d2 <= 0.0) return take(1.0, 0.0, 0.0);
  const S d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0.0 && d4 <= d3) return take(0.0, 1.0, 0.0);
  const S d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0.0 && d5 <= d6) return take(0.0, 0.0, 1.0);
  const S of_c = d1 * d4 - d3 * d2, of_b = d5 * d2 - d1 * d6, of_a = d3 * d6 - d5 * d4;
  if (of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return take(1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0);
  if (of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return take(1.0 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6));
  if (of_a <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const S along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return take(0.0, 1.0 - along, along);
  }
  const S sum = of_a + of_b + of_c;
  take(1.0 - (of_b + of_c) / sum, of_b / sum, of_c / sum);
}

// corner: of a facet of n corners, 3 or 4, in turn round it.
template <class S>
PlaceOnCell<S> find_closest_on_cell(const S x[3], int n, const S corner[4][3]) {
  PlaceOnCell<S> found;
  const auto measure = [&](PlaceOnCell<S>& at) {
    at.squared = 0.0;
    for (int i = 0; i < 3; ++i) {
      at.away[i] = x[i];
      for (int a = 0; a < n; ++a) at.away[i] -= at.weight[a] * corner[a][i];
      at.squared += at.away[i] * at.away[i];
    }
  };
  if (n == 3) {
    find_closest_on_triangle(x, corner[0], corner[1], corner[2], found.weight);
    found.weight[3] = 0.0;
    measure(found);
    return found;
  }
  S centre[3];
  for (int i = 0; i < 3; ++i) centre[i] = 0.25 * ((corner[0][i] + corner[2][i]) + (corner[1][i] + corner[3][i]));
  found.squared = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 4; ++a) {
    const int b = (a + 1) % 4;
    S w[3];
    find_closest_on_triangle(x, corner[a], corner[b], centre, w);
    PlaceOnCell<S> at;
    std::fill_n(at.weight, 4, 0.25 * w[2]);
    at.weight[a] += w[0], at.weight[b] += w[1];
    measure(at);
    if (at.squared < found.squared) found = at;
  }
  return found;
}

}  // namespace presswork::contact
