// SPDX-License-Identifier: Apache-2.0
// The search for the nearest of triangles (triangulation.hpp), on a tree that lies in any memory: that of the CPU, or
// of a card.
#pragma once

#if defined(__AVX__) && !defined(__CUDACC__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "contact/touch.hpp"
#include "contact/vectors.hpp"

namespace presswork::contact {

namespace eights {

// Eight floats one by one, for a card.
struct OneByOne {
  float lane[8];
  PRESSWORK_DEVICE float operator[](int i) const { return lane[i]; }
#define PRESSWORK_LANES(expression)                     \
  OneByOne out;                                         \
  for (int i = 0; i < 8; ++i) out.lane[i] = expression; \
  return out
  friend PRESSWORK_DEVICE OneByOne operator+(const OneByOne& a, const OneByOne& b) {
    PRESSWORK_LANES(a.lane[i] + b.lane[i]);
  }
  friend PRESSWORK_DEVICE OneByOne operator*(const OneByOne& a, const OneByOne& b) {
    PRESSWORK_LANES(a.lane[i] * b.lane[i]);
  }
  friend PRESSWORK_DEVICE OneByOne operator*(const OneByOne& a, float b) { PRESSWORK_LANES(a.lane[i] * b); }
  friend PRESSWORK_DEVICE OneByOne operator-(const OneByOne& a, float b) { PRESSWORK_LANES(a.lane[i] - b); }
  friend PRESSWORK_DEVICE OneByOne operator-(float a, const OneByOne& b) { PRESSWORK_LANES(a - b.lane[i]); }
#undef PRESSWORK_LANES
};

PRESSWORK_DEVICE inline OneByOne larger(const OneByOne& a, const OneByOne& b) {
  OneByOne out;
  for (int i = 0; i < 8; ++i) out.lane[i] = a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i];
  return out;
}

// Bits of the lanes below the bound; empty lanes are infinite.
PRESSWORK_DEVICE inline unsigned within(const OneByOne& values, float bound) {
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (values.lane[i] < bound ? 1u : 0u) << i;
  return bits;
}

#if defined(__CUDACC__)
using AtOnce = OneByOne;
#else
typedef float AtOnce __attribute__((vector_size(8 * sizeof(float))));

inline AtOnce larger(AtOnce a, AtOnce b) { return a > b ? a : b; }

inline unsigned within(AtOnce values, float bound) {
  const auto mask = values < bound;
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (mask[i] != 0 ? 1u : 0u) << i;
  return bits;
#endif
}
#endif

// The number of the lowest bit that is set; there is one. For a card std::countr_zero compiles, and says 32.
PRESSWORK_INLINE int lowest(unsigned bits) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

template <class Floats>
PRESSWORK_INLINE Floats load(const float from[8]) {
  Floats loaded;
  std::memcpy(&loaded, from, sizeof loaded);
  return loaded;
}

}  // namespace eights

// What the search needs of the triangles.
struct TriangleTree {
  static constexpr int width = 8;
  static constexpr int none = std::numeric_limits<int>::max();  // triangle
  struct Triangle {
    double at[3], normal[3];  // first corner, unit normal
    double slope[2][3];       // of the barycentric coordinates of the second and third corner
    double edge[2][3];        // to the second and third corner
  };
  struct Node {
    alignas(32) float low[3][width], high[3][width];  // relative to origin
    std::int32_t child[width];                        // node, or -1 - leaf
  };
  // Planes of its triangles: their own, and the three through their sides at right angles to it, outside positive. The
  // root of the squares of the distance from the first and from the farthest of the others is a lower bound.
  struct Leaf {
    alignas(32) float plane[4][4][width];  // unit normal, offset
    std::int32_t triangle[width];
  };
  // The leaves around a leaf, nearest boxes first, and how far the first box of each pack is, and the first left out.
  struct Around {
    static constexpr int packs = 4;
    Node pack[packs];
    float distance2[packs + 1];
  };
  // The nearest place: distance squared, triangle, and feature: 0 inside, 1 + k edge from corner k, 4 + k corner k.
  struct Near {
    double distance2;
    int triangle, feature;
    double point[3];
  };

  // Squared distances of a node's boxes from the box between low and high.
  template <class Floats>
  PRESSWORK_DEVICE static Floats distance2_to(const Node& node, const float low[3], const float high[3]) {
    Floats distance2{};
    for (int k = 0; k < 3; ++k) {
      const Floats off =
          larger_of(larger_of(eights::load<Floats>(node.low[k]) - high[k], low[k] - eights::load<Floats>(node.high[k])),
                    Floats{});
      distance2 = distance2 + off * off;
    }
    return distance2;
  }
  template <class Floats>
  PRESSWORK_DEVICE static Floats larger_of(const Floats& a, const Floats& b) {
    using eights::larger;
    return larger(a, b);
  }

  const Triangle* triangles = nullptr;
  const double* edge_normals = nullptr;    // (n, 3, 3): of the edge from corner k; zero on an open edge
  const double* vertex_normals = nullptr;  // (n_points, 3); zero on an open edge
  const std::int32_t* corners = nullptr;   // (n, 3)
  const Node* nodes = nullptr;
  const Leaf* leaves = nullptr;
  const Around* around = nullptr;         // (n_leaves)
  const std::int32_t* leaf_of = nullptr;  // (n): the leaf of each triangle
  int n = 0, n_points = 0, n_nodes = 0, n_leaves = 0;
  std::int32_t root = 0;
  double origin[3], depth;
  float padding;  // of boxes for single precision
};

// Floats: eights::AtOnce, or OneByOne.
template <class Floats>
struct TriangleSearch : TriangleTree {
  // A bound of squared distances for single precision, which takes less than p, the boxes' padding, from a distance d:
  // (d + p)^2 < (1 + e) d^2 + (1 + 1/e) p^2.
  PRESSWORK_DEVICE float widen(double distance2) const {
    return static_cast<float>(distance2) * 1.001f + 1001.0f * padding * padding;
  }

  // Take the triangle if it is nearer than what is known, or as near with a lower number.
  PRESSWORK_DEVICE void measure(int t, const double x[3], Near& near) const {
    const Triangle& tri = triangles[t];
    const double d[3] = {x[0] - tri.at[0], x[1] - tri.at[1], x[2] - tri.at[2]};
    const double height = dot(d, tri.normal);
    if (height * height > near.distance2) return;
    double v = dot(d, tri.slope[0]), w = dot(d, tri.slope[1]);
    int feature = 0;
    if (v < 0.0 || w < 0.0 || v + w > 1.0) {
      // the nearest place of the sides beyond which the point lies; side k goes from corner k to the next
      const double *a = tri.edge[0], *b = tri.edge[1];
      const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), along_a = dot(d, a), along_b = dot(d, b);
      double least = std::numeric_limits<double>::infinity(), foot[2] = {0.0, 0.0};
      auto take_side = [&](int k, double along, double v0, double w0, double dv, double dw) {
        const double f = std::min(std::max(along, 0.0), 1.0);
        const double p = v0 + f * dv, q = w0 + f * dw;
        const double size = (p - v) * (p - v) * aa + 2.0 * (p - v) * (q - w) * ab + (q - w) * (q - w) * bb;
        if (size >= least) return;
        least = size, foot[0] = p, foot[1] = q, feature = f == 0.0 ? 4 + k : f == 1.0 ? 4 + (k + 1) % 3 : 1 + k;
      };
      if (w < 0.0) take_side(0, along_a / aa, 0.0, 0.0, 1.0, 0.0);
      if (v + w > 1.0) take_side(1, (along_b - along_a - ab + aa) / (aa - 2.0 * ab + bb), 1.0, 0.0, -1.0, 1.0);
      if (v < 0.0) take_side(2, 1.0 - along_b / bb, 0.0, 1.0, 0.0, -1.0);
      v = foot[0], w = foot[1];
    }
    double point[3], off2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      point[k] = v * tri.edge[0][k] + w * tri.edge[1][k];
      off2 += (d[k] - point[k]) * (d[k] - point[k]);
    }
    off2 = feature == 0 ? height * height : std::max(off2, height * height);  // as above: no order may matter
    if (off2 > near.distance2 || (off2 == near.distance2 && t > near.triangle)) return;
    near.distance2 = off2, near.triangle = t, near.feature = feature;
    for (int k = 0; k < 3; ++k) near.point[k] = tri.at[k] + point[k];
  }

  PRESSWORK_DEVICE void measure_leaf(int index, const float at[3], const double x[3], Near& near, float& bound) const {
    const Leaf& leaf = leaves[index];
    Floats off[4];
    for (int p = 0; p < 4; ++p)
      off[p] = eights::load<Floats>(leaf.plane[p][0]) * at[0] + eights::load<Floats>(leaf.plane[p][1]) * at[1] +
               eights::load<Floats>(leaf.plane[p][2]) * at[2] + eights::load<Floats>(leaf.plane[p][3]);
    const Floats beyond = larger_of(larger_of(off[1], off[2]), larger_of(off[3], Floats{}));
    unsigned within = eights::within(off[0] * off[0] + beyond * beyond, bound);
    for (; within != 0; within &= within - 1) measure(leaf.triangle[eights::lowest(within)], x, near);
    bound = widen(near.distance2);
  }

  PRESSWORK_DEVICE void search(const double x[3], int hint, Near& near) const {
    float at[3];
    for (int k = 0; k < 3; ++k) at[k] = static_cast<float>(x[k] - origin[k]);
    float bound = widen(near.distance2);
    if (hint >= 0 && hint < n) {
      const int home = leaf_of[hint];
      measure(hint, x, near);
      bound = widen(near.distance2);
      measure_leaf(home, at, x, near, bound);
      const Around& near_home = around[home];
      const float around2 = near.triangle == none ? std::numeric_limits<float>::infinity() : 4.0f * bound;
      if (around2 < near_home.distance2[Around::packs]) {
        for (int p = 0; p < Around::packs && near_home.distance2[p] <= around2; ++p) {
          const Node& pack = near_home.pack[p];
          for (unsigned within = eights::within(distance2_to<Floats>(pack, at, at), bound); within != 0;
               within &= within - 1)
            measure_leaf(-1 - pack.child[eights::lowest(within)], at, x, near, bound);
        }
        return;
      }
    }
    descend(at, x, near, bound);
  }

  PRESSWORK_DEVICE void descend(const float at[3], const double x[3], Near& near, float& bound) const {
    struct Entry {
      std::int32_t node;
      float distance2;
    } stack[128];
    int count = 0;
    stack[count++] = {root, 0.0f};
    while (count > 0) {
      const Entry entry = stack[--count];
      if (entry.distance2 > bound) continue;
      if (entry.node < 0) {
        measure_leaf(-1 - entry.node, at, x, near, bound);
        continue;
      }
      const Node& node = nodes[entry.node];
      const Floats distance2 = distance2_to<Floats>(node, at, at);
      // the nearest child goes on top of the stack
      const int from = count;
      for (unsigned within = eights::within(distance2, bound); within != 0; within &= within - 1) {
        const int c = eights::lowest(within);
        const float d2 = distance2[c];
        int i = count++;
        for (; i > from && stack[i - 1].distance2 < d2; --i) stack[i] = stack[i - 1];
        stack[i] = {node.child[c], d2};
      }
    }
  }

  PRESSWORK_DEVICE bool nearest(const double x[3], double reach, int& hint, Touch& touch) const {
    const double bound = std::max(reach, depth);
    Near near{bound * bound, none, 0, {}};
    search(x, hint, near);
    touch.gap = std::sqrt(near.distance2), touch.past_rim = false;
    if (near.triangle == none) return false;
    hint = near.triangle;
    // the normal of the feature gives the sign, and the normal of the touch when the point lies on it
    const Triangle& tri = triangles[near.triangle];
    const int k = near.feature == 0 ? 0 : (near.feature - 1) % 3;
    const double* normal = near.feature == 0  ? tri.normal
                           : near.feature < 4 ? &edge_normals[9 * near.triangle + 3 * k]
                                              : &vertex_normals[3 * corners[3 * near.triangle + k]];
    const double from[3] = {x[0] - near.point[0], x[1] - near.point[1], x[2] - near.point[2]};
    double height = dot(from, tri.normal);
    double length2 = dot(normal, normal);
    const double distance = touch.gap, tolerance = 1e-3 * padding;
    if (length2 == 0.0) {  // an open edge: straight above it counts as inside
      touch.past_rim = near.distance2 - height * height > tolerance * tolerance + 1e-14 * near.distance2;
      if (touch.past_rim) return false;
      normal = tri.normal, length2 = 1.0;
    } else if (near.feature != 0) {
      height = std::copysign(distance, dot(from, normal));
    }
    if (height >= reach || height < -depth) {
      touch.gap = height > 0.0 ? distance : distance - depth;
      return false;
    }
    touch.gap = height;
    const bool on_it = near.feature == 0 || distance < tolerance;
    const double scale = on_it ? 1.0 / std::sqrt(length2) : 1.0 / height;
    for (int i = 0; i < 3; ++i) touch.normal[i] = scale * (on_it ? normal[i] : from[i]), touch.point[i] = near.point[i];
    touch.flat = near.feature == 0 ? distance_to_sides(near.triangle, near.point, distance) : 0.0;
    return true;
  }

  // How far a point at this distance above a place inside the triangle may move along it until it is as near to the
  // neighbour behind one of the sides, should that one rise.
  PRESSWORK_DEVICE double distance_to_sides(int t, const double place[3], double distance) const {
    const Triangle& tri = triangles[t];
    double d[3], both[3];
    for (int k = 0; k < 3; ++k) d[k] = place[k] - tri.at[k], both[k] = tri.slope[0][k] + tri.slope[1][k];
    const double v = dot(d, tri.slope[0]), w = dot(d, tri.slope[1]);
    const double to_side[3] = {w / std::sqrt(dot(tri.slope[1], tri.slope[1])),
                               (1.0 - v - w) / std::sqrt(dot(both, both)),
                               v / std::sqrt(dot(tri.slope[0], tri.slope[0]))};
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double* sum =
          &edge_normals[9 * t + 3 * k];  // of the two unit normals: 2 cos of half the angle between them
      const double length2 = dot(sum, sum), tangent2 = length2 > 0.0 ? std::max(0.0, 4.0 / length2 - 1.0) : 0.0;
      least = std::min(least, to_side[k] - distance * std::sqrt(tangent2));
    }
    return least;
  }
};

}  // namespace presswork::contact
