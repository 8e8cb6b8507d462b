// SPDX-License-Identifier: Apache-2.0
#include "contact/sharp_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

namespace presswork::contact {

namespace {

constexpr double least_fold = 0.01;  // [rad] between triangles that are flat together

// The sides between two triangles, and what is needed to walk over them.
class Folds {
 public:
  explicit Folds(const Triangulation& surface)
      : points_(surface.points().data()),
        corners_(surface.corners()),
        normals_(corners_.size()),
        neighbour_(corners_.size(), -1) {
    const int n = static_cast<int>(corners_.size()) / 3;
    struct Side {
      int low, high, slot;
    };
    std::vector<Side> sides;
    for (int t = 0; t < n; ++t) {
      double u[3], v[3];
      for (int k = 0; k < 3; ++k) u[k] = at(t, 1)[k] - at(t, 0)[k], v[k] = at(t, 2)[k] - at(t, 0)[k];
      double* normal = &normals_[3 * std::size_t(t)];
      cross(u, v, normal);
      const double length = std::sqrt(dot(normal, normal));
      for (int k = 0; k < 3; ++k) {
        normal[k] /= length;
        const auto [low, high] = std::minmax(corners_[3 * t + k], corners_[3 * t + (k + 1) % 3]);
        sides.push_back({low, high, 3 * t + k});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.slot) < std::tie(b.low, b.high, b.slot);
    });
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i].low == sides[i - 1].low && sides[i].high == sides[i - 1].high)
        neighbour_[sides[i].slot] = sides[i - 1].slot, neighbour_[sides[i - 1].slot] = sides[i].slot;
  }

  // Ends of the sharp ones.
  std::vector<FoldTree::Fold> find_sharp(double length, double angle) const {
    std::vector<FoldTree::Fold> found;
    for (int slot = 0; slot < static_cast<int>(neighbour_.size()); ++slot) {
      const int other = neighbour_[slot];
      if (other < slot) continue;  // open, or seen from the other side
      const double turn = fold(slot / 3, other / 3);
      if (turn < least_fold) continue;
      const double width = 0.5 * (height(slot) + height(other));  // over which it turns by so much
      if (turn > angle || (turn * length > 0.5 * angle * width && turns_within(slot, length, angle)))
        found.push_back({at(slot / 3, slot % 3), at(slot / 3, (slot + 1) % 3)});
    }
    return found;
  }

 private:
  const double* at(int t, int k) const { return points_ + 3 * std::size_t(corners_[3 * t + k % 3]); }
  const double* normal(int t) const { return &normals_[3 * std::size_t(t)]; }

  // Angle between two triangles where the metal juts out; 0 where it is hollow.
  double fold(int t, int u) const {
    double aside[3], apart[3], product[3];
    for (int k = 0; k < 3; ++k) {
      aside[k] = at(u, 0)[k] + at(u, 1)[k] + at(u, 2)[k] - at(t, 0)[k] - at(t, 1)[k] - at(t, 2)[k];
      apart[k] = normal(u)[k] - normal(t)[k];
    }
    if (dot(aside, apart) <= 0.0) return 0.0;
    cross(normal(t), normal(u), product);
    return std::atan2(std::sqrt(dot(product, product)), dot(normal(t), normal(u)));
  }

  // Of a triangle over its side.
  double height(int slot) const { return distance_to_side(slot, at(slot / 3, slot + 2)); }

  double distance_to_side(int slot, const double* x) const {
    const double *a = at(slot / 3, slot), *b = at(slot / 3, slot + 1);
    double along[3], from[3];
    for (int k = 0; k < 3; ++k) along[k] = b[k] - a[k], from[k] = x[k] - a[k];
    const double f = std::clamp(dot(from, along) / dot(along, along), 0.0, 1.0);
    for (int k = 0; k < 3; ++k) from[k] -= f * along[k];
    return std::sqrt(dot(from, from));
  }

  // Whether the surface turns by the angle within the length of a side.
  bool turns_within(int slot, double length, double angle) const {
    std::vector<int> reached{slot / 3, neighbour_[slot] / 3};
    std::unordered_set<int> seen(reached.begin(), reached.end());
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const int t = reached[i];
      if (std::max(fold(slot / 3, t), fold(neighbour_[slot] / 3, t)) > angle) return true;
      for (int k = 0; k < 3; ++k) {
        const int next = neighbour_[3 * t + k] < 0 ? -1 : neighbour_[3 * t + k] / 3;
        if (next < 0 || !seen.insert(next).second) continue;
        // as far as the side by which it is reached
        if (std::min(distance_to_side(slot, at(t, k)), distance_to_side(slot, at(t, k + 1))) <= length)
          reached.push_back(next);
      }
    }
    return false;
  }

  const double* points_;
  const std::vector<std::int32_t>& corners_;
  std::vector<double> normals_;  // (n, 3)
  std::vector<int> neighbour_;   // (n, 3): the same side as one of its other triangle, 3 triangle + k; -1 an open one
};

}  // namespace

SharpPlaces::SharpPlaces(std::shared_ptr<const ToolSurface> surface, double length, double angle)
    : surface_(std::move(surface)) {
  if (const SweptSurface* swept = surface_->swept()) {
    pieces_ = swept->find_sharp(length, angle);
    search_ = make_search();
    return;
  }
  const auto folds = Folds(*surface_->triangles()).find_sharp(length, angle);
  if (!folds.empty()) folds_ = std::make_unique<FoldTree>(folds);
  search_ = make_search();
}

SharpSearch SharpPlaces::make_search() const {
  SharpSearch made;
  if (folds_) made.folds = folds_->search();
  if (const SweptSurface* swept = surface_->swept()) made.swept = swept->search();
  made.pieces = pieces_.data(), made.n_pieces = static_cast<int>(pieces_.size());
  return made;
}

}  // namespace presswork::contact
