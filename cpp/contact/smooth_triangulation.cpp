// SPDX-License-Identifier: Apache-2.0
#include "contact/smooth_triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "contact/vectors.hpp"

namespace presswork::contact {

namespace {

constexpr double crease_cosine = 0.766;  // of 40 degrees
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
      patches_[t].neighbour[k] = Patch::open;
      const int a = flat_.corner(t, k), b = flat_.corner(t, (k + 1) % 3);
      const auto [entry, is_new] = first.try_emplace({std::min(a, b), std::max(a, b)}, t, k);
      if (is_new) continue;
      const auto [other, side] = entry->second;
      const bool is_crease = dot(flat_.normal(t), flat_.normal(other)) < crease_cosine;
      patches_[t].neighbour[k] = is_crease ? Patch::crease : other;
      patches_[other].neighbour[side] = is_crease ? Patch::crease : t;
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

}  // namespace presswork::contact
