// SPDX-License-Identifier: Apache-2.0
#include "contact/smooth_triangulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

constexpr double crease_cosine = 0.766;  // of 40 degrees
constexpr double inside = -1e-9;         // least weight of a corner
constexpr int most_steps = 20, most_hops = 12;

// Exponents of the three corners' weights in the term of each control point, and its binomial factor.
constexpr int exponent[10][3] = {{3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0}, {1, 2, 0},
                                 {0, 2, 1}, {0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {1, 1, 1}};
constexpr double factor[10] = {1, 1, 1, 3, 3, 3, 3, 3, 3, 6};

double power(double a, int n) { return n == 0 ? 1.0 : n == 1 ? a : n == 2 ? a * a : a * a * a; }

// The patch and its derivatives to u and v.
void evaluate(const double (&control)[10][3], double u, double v, double (&p)[3], double (&du)[3], double (&dv)[3]) {
  const double weight[3] = {1.0 - u - v, u, v};
  for (int k = 0; k < 3; ++k) p[k] = du[k] = dv[k] = 0.0;
  for (int i = 0; i < 10; ++i) {
    double value = factor[i], slope[3];
    for (int c = 0; c < 3; ++c) {
      value *= power(weight[c], exponent[i][c]);
      slope[c] = exponent[i][c] == 0 ? 0.0 : factor[i] * exponent[i][c];
      for (int d = 0; d < 3; ++d) slope[c] *= power(weight[d], std::max(0, exponent[i][d] - (d == c ? 1 : 0)));
    }
    for (int k = 0; k < 3; ++k) {
      p[k] += value * control[i][k];
      du[k] += (slope[1] - slope[0]) * control[i][k], dv[k] += (slope[2] - slope[0]) * control[i][k];
    }
  }
}

void make_unit(double (&a)[3]) {
  const double length = std::sqrt(dot(a, a));
  for (double& value : a) value /= length;
}

}  // namespace

SmoothTriangulation::SmoothTriangulation(Triangulation triangles) : flat_(std::move(triangles)) {
  patches_.resize(flat_.size());
  find_neighbours();
  set_normals();
  set_controls();
}

void SmoothTriangulation::find_neighbours() {
  std::map<std::pair<int, int>, std::pair<int, int>> first;  // triangle and side that an edge was seen at
  for (int t = 0; t < flat_.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      patches_[t].neighbour[k] = open;
      const int a = flat_.corner(t, k), b = flat_.corner(t, (k + 1) % 3);
      const auto [entry, is_new] = first.try_emplace({std::min(a, b), std::max(a, b)}, t, k);
      if (is_new) continue;
      const auto [other, side] = entry->second;
      const bool is_crease = dot(flat_.normal(t), flat_.normal(other)) < crease_cosine;
      patches_[t].neighbour[k] = is_crease ? crease : other;
      patches_[other].neighbour[side] = is_crease ? crease : t;
    }
}

void SmoothTriangulation::set_normals() {
  for (int t = 0; t < flat_.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const int here = flat_.corner(t, c);
      double (&normal)[3] = patches_[t].normal[c];
      for (double& value : normal) value = 0.0;
      auto add = [&](int triangle, int k) {
        double a[3], b[3], w[3];
        for (int i = 0; i < 3; ++i) {
          a[i] = flat_.point(triangle, (k + 1) % 3)[i] - flat_.point(triangle, k)[i];
          b[i] = flat_.point(triangle, (k + 2) % 3)[i] - flat_.point(triangle, k)[i];
        }
        cross(a, b, w);
        const double twice_area = std::sqrt(dot(w, w)), weight = twice_area * std::atan2(twice_area, dot(a, b));
        for (int i = 0; i < 3; ++i) normal[i] += weight * w[i];
      };
      auto place_of = [&](int triangle) {
        return flat_.corner(triangle, 0) == here ? 0 : flat_.corner(triangle, 1) == here ? 1 : 2;
      };
      add(t, c);
      // round the corner one way; and, if that does not come back, the other way
      bool closed = false;
      for (const int behind : {2, 0}) {  // the side before the corner, the side after it
        for (int next = patches_[t].neighbour[(c + behind) % 3]; next >= 0 && !closed;) {
          closed = next == t;
          if (closed) break;
          const int k = place_of(next);
          add(next, k);
          next = patches_[next].neighbour[(k + behind) % 3];
        }
        if (closed) break;
      }
      make_unit(normal);
    }
}

void SmoothTriangulation::set_controls() {
  for (int t = 0; t < flat_.size(); ++t) {
    Patch& patch = patches_[t];
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) patch.control[c][i] = flat_.point(t, c)[i];
    double edges[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
      const double *a = flat_.point(t, k), *b = flat_.point(t, (k + 1) % 3);
      const double along[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const bool straight = patch.neighbour[k] < 0;
      const double from_a = straight ? 0.0 : dot(along, patch.normal[k]);
      const double from_b = straight ? 0.0 : -dot(along, patch.normal[(k + 1) % 3]);
      bulge_ = std::max({bulge_, std::abs(from_a) / 3.0, std::abs(from_b) / 3.0});
      double* near_a = patch.control[3 + 2 * k];
      double* near_b = patch.control[4 + 2 * k];
      for (int i = 0; i < 3; ++i) {
        near_a[i] = (2.0 * a[i] + b[i] - from_a * patch.normal[k][i]) / 3.0;
        near_b[i] = (a[i] + 2.0 * b[i] - from_b * patch.normal[(k + 1) % 3][i]) / 3.0;
        edges[i] += (near_a[i] + near_b[i]) / 6.0;
      }
    }
    for (int i = 0; i < 3; ++i) {
      const double middle = (patch.control[0][i] + patch.control[1][i] + patch.control[2][i]) / 3.0;
      patch.control[9][i] = 1.5 * edges[i] - 0.5 * middle;
    }
  }
}

// Newton's method for x = p + g n; false where it finds no place near the triangle.
bool SmoothTriangulation::project(const Patch& patch, const double x[3], Place& place, Touch& touch,
                                  Slopes& slopes) const {
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
    if (std::max(std::abs(change[0]), std::abs(change[1])) < 1e-13 || dot(missing, missing) < 1e-26) {
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

bool SmoothTriangulation::nearest(const double x[3], double reach, int& hint, Touch& touch, Slopes& slopes) const {
  if (!flat_.nearest(x, reach + bulge_, hint, touch)) return false;
  const double gap = touch.gap;
  for (int i = 0; i < 3; ++i) {
    slopes.gap[i] = touch.normal[i];
    for (double& value : slopes.normal[i]) value = 0.0;
  }
  Touch found;
  Slopes found_slopes;
  int t = hint;
  for (int hop = 0; hop < most_hops; ++hop) {
    const Patch& patch = patches_[t];
    Place place = {1.0 / 3.0, 1.0 / 3.0, gap};
    if (!project(patch, x, place, found, found_slopes)) break;
    const double weight[3] = {1.0 - place.u - place.v, place.u, place.v};
    const int least = static_cast<int>(std::min_element(weight, weight + 3) - weight);
    if (weight[least] >= inside || hop == most_hops - 1) {
      if (std::abs(found.gap - gap) <= 2.0 * bulge_ + 1e-9) touch = found, slopes = found_slopes, hint = t;
      break;
    }
    const int next = patch.neighbour[(least + 1) % 3];
    if (next < 0) break;
    t = next;
  }
  return touch.gap < reach && touch.gap >= -depth();
}

}  // namespace presswork::contact
