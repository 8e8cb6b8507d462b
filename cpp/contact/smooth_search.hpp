// SPDX-License-Identifier: Apache-2.0
// The nearest place of triangles that are rounded off (smooth_triangulation.hpp), on the CPU and on a card.
#pragma once

#include <cmath>

#include "contact/touch.hpp"
#include "contact/vectors.hpp"
#include "tensor/on_device.hpp"

namespace presswork::contact {

struct SmoothPatch {
  static constexpr int open = -1, crease = -2;  // instead of a neighbour
  double control[10][3];                        // of the cubic; numbered as `exponent` below
  double normal[3][3];                          // unit, at the corners
  int neighbour[3];                             // behind the edge from corner k
};

struct SmoothSearch {
  const SmoothPatch* patches = nullptr;  // (n)
  int n = 0;
  double bulge = 0.0, depth = 0.0;  // how far patches leave their triangles at most; of a penetration [mm]

  // As ToolSurface::nearest; hint becomes the triangle. flat: the search of the triangles; slopes: null where nobody
  // asks.
  template <class Flat>
  PRESSWORK_DEVICE bool nearest(const Flat& flat, const double x[3], double reach, int& hint, Touch& touch,
                                Slopes* slopes) const {
    if (!flat.nearest(x, reach + bulge, hint, touch)) return false;
    const double gap = touch.gap;
    if (slopes)
      for (int i = 0; i < 3; ++i) {
        slopes->gap[i] = touch.normal[i];
        for (double& value : slopes->normal[i]) value = 0.0;
      }
    Touch found;
    Slopes found_slopes;
    int t = hint;
    for (int hop = 0; hop < most_hops; ++hop) {
      const SmoothPatch& patch = patches[t];
      Place place = {1.0 / 3.0, 1.0 / 3.0, gap};
      if (!project(patch, x, place, found, found_slopes)) break;
      const double weight[3] = {1.0 - place.u - place.v, place.u, place.v};
      const int of_first_two = weight[1] < weight[0] ? 1 : 0,
                least = weight[2] < weight[of_first_two] ? 2 : of_first_two;
      if (weight[least] >= inside || hop == most_hops - 1) {
        if (std::abs(found.gap - gap) <= 2.0 * bulge + 1e-9) {
          touch = found, hint = t;
          if (slopes) *slopes = found_slopes;
        }
        break;
      }
      const int next = patch.neighbour[(least + 1) % 3];
      if (next < 0) break;
      t = next;
    }
    return touch.gap < reach && touch.gap >= -depth;
  }

 private:
  static constexpr double inside = -1e-9;  // least weight of a corner
  static constexpr int most_steps = 20, most_hops = 12;

  struct Place {
    double u, v, gap;  // weights of the second and third corner
  };

  PRESSWORK_DEVICE static double raise(double a, int n) {
    return n == 0 ? 1.0 : n == 1 ? a : n == 2 ? a * a : a * a * a;
  }

  // The patch and its derivatives to u and v.
  PRESSWORK_DEVICE static void evaluate(const double (&control)[10][3], double u, double v, double (&p)[3],
                                        double (&du)[3], double (&dv)[3]) {
    // exponents of the three corners' weights in the term of each control point, and its binomial factor
    constexpr int exponent[10][3] = {{3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0}, {1, 2, 0},
                                     {0, 2, 1}, {0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {1, 1, 1}};
    constexpr double factor[10] = {1, 1, 1, 3, 3, 3, 3, 3, 3, 6};
    const double weight[3] = {1.0 - u - v, u, v};
    for (int k = 0; k < 3; ++k) p[k] = du[k] = dv[k] = 0.0;
    for (int i = 0; i < 10; ++i) {
      double value = factor[i], slope[3];
      for (int c = 0; c < 3; ++c) {
        value *= raise(weight[c], exponent[i][c]);
        slope[c] = exponent[i][c] == 0 ? 0.0 : factor[i] * exponent[i][c];
        for (int d = 0; d < 3; ++d) {
          const int lower = exponent[i][d] - (d == c ? 1 : 0);
          slope[c] *= raise(weight[d], lower > 0 ? lower : 0);
        }
      }
      for (int k = 0; k < 3; ++k) {
        p[k] += value * control[i][k];
        du[k] += (slope[1] - slope[0]) * control[i][k], dv[k] += (slope[2] - slope[0]) * control[i][k];
      }
    }
  }

  // Newton's method for x = p + g n; false where it finds no place near the triangle.
  PRESSWORK_DEVICE static bool project(const SmoothPatch& patch, const double x[3], Place& place, Touch& touch,
                                       Slopes& slopes) {
    for (int step = 0; step < most_steps; ++step) {
      double p[3], base[3][3], n[3], turn[2][3];  // base: derivatives of p + g n to u, v, g
      evaluate(patch.control, place.u, place.v, p, base[0], base[1]);
      for (int i = 0; i < 3; ++i) {
        turn[0][i] = patch.normal[1][i] - patch.normal[0][i], turn[1][i] = patch.normal[2][i] - patch.normal[0][i];
        n[i] = patch.normal[0][i] + place.u * turn[0][i] + place.v * turn[1][i];
      }
      const double length = std::sqrt(dot(n, n));
      for (double& value : n) value /= length;
      for (double (&of)[3] : turn) {
        const double out = dot(of, n);
        for (int i = 0; i < 3; ++i) of[i] = (of[i] - out * n[i]) / length;
      }
      double missing[3], inverse[3][3];  // rows: gradients of u, v, g
      for (int i = 0; i < 3; ++i) {
        base[0][i] += place.gap * turn[0][i], base[1][i] += place.gap * turn[1][i], base[2][i] = n[i];
        missing[i] = x[i] - p[i] - place.gap * n[i];
      }
      for (int r = 0; r < 3; ++r) cross(base[(r + 1) % 3], base[(r + 2) % 3], inverse[r]);
      const double volume = dot(base[2], inverse[2]);
      if (!(volume > 0.0)) return false;  // beyond the centre of the curve
      for (double (&row)[3] : inverse)
        for (double& value : row) value /= volume;
      const double change[3] = {dot(inverse[0], missing), dot(inverse[1], missing), dot(inverse[2], missing)};
      const bool stays = std::abs(change[0]) < 1e-13 && std::abs(change[1]) < 1e-13;
      if (stays || dot(missing, missing) < 1e-26) {
        touch.gap = place.gap, touch.flat = 0.0;
        for (int i = 0; i < 3; ++i) {
          touch.normal[i] = n[i], touch.point[i] = p[i], slopes.gap[i] = inverse[2][i];
          for (int j = 0; j < 3; ++j) slopes.normal[i][j] = turn[0][i] * inverse[0][j] + turn[1][i] * inverse[1][j];
        }
        return true;
      }
      place.u += change[0], place.v += change[1], place.gap += change[2];
      if (!(std::abs(place.u) + std::abs(place.v) < 10.0)) return false;
    }
    return false;
  }
};

}  // namespace presswork::contact
