// SPDX-License-Identifier: Apache-2.0
#include "contact/swept_surface.hpp"

#include <stdexcept>

#include "contact/profile.hpp"

namespace presswork::contact {

SweptSurface::SweptSurface(const Plan& plan, int n, const double* segments, double depth) : plan_(plan) {
  search_.depth = depth;
  check_plan();
  const double narrow = std::min(plan.half_width[0], plan.half_width[1]);
  if (std::isinf(std::max(plan.half_width[0], plan.half_width[1]))) plan_.corner_radius = narrow;  // a strip has none
  search_.corner_radius = plan_.corner_radius;
  if (n < 1) throw std::invalid_argument("a profile needs a segment");
  double size = 0.0;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) size = std::max(size, std::abs(segments[7 * i + k]));
  if (!(size > 0.0 && std::isfinite(size))) throw std::invalid_argument("the profile's points must be finite");
  search_.tolerance = 1e-10 * size;
  const double* last = segments + 7 * (n - 1);
  const bool closed = std::hypot(last[2] - segments[0], last[3] - segments[1]) < 1e-9 * size;
  for (int k = 0; k < 2; ++k) {
    search_.core[k] = plan.half_width[k] - plan_.corner_radius;
    search_.low[k] = std::numeric_limits<double>::infinity(), search_.high[k] = -search_.low[k];
  }
  for (int i = 0; i < n; ++i) {
    const double* next = i + 1 < n ? segments + 7 * (i + 1) : closed ? segments : nullptr;
    if (next && std::hypot(next[0] - segments[7 * i + 2], next[1] - segments[7 * i + 3]) > 1e-9 * size)
      throw std::invalid_argument("each segment of a profile must start where the one before it ends");
    add_piece(segments + 7 * i, next);
  }
  search_.n_ends = 0;
  if (!closed) {
    add_end(segments[0], segments[1], segments, 0);
    add_end(last[2], last[3], last, 1);
  }
  check_inside();
  search_.pieces = pieces_.data(), search_.corners = corners_.data();
  search_.n = static_cast<int>(pieces_.size()), search_.n_corners = static_cast<int>(corners_.size());
}

// An end of the profile, beyond which there is no tool; at the middle of a round plan it goes on as its mirror image.
void SweptSurface::add_end(double s, double z, const double* segment, int side) {
  if (search_.core[0] > 0.0 || search_.core[1] > 0.0 || s > -plan_.corner_radius + slack()) {
    search_.ends[search_.n_ends][0] = s, search_.ends[search_.n_ends++][1] = z;
    return;
  }
  double normal[2];  // to the left of the way
  profile::normal_at(segment, side, normal);
  const double turn = (side == 0 ? -2.0 : 2.0) * normal[0] * normal[1];
  if (std::abs(turn) < 1e-12) return;
  const double angle = 2.0 * std::atan2(std::abs(normal[0]), std::abs(normal[1]));
  corners_.push_back({{s, z}, {0.0, std::copysign(1.0, normal[1])}, turn < 0.0 ? 1.0 : -1.0, angle});
}

void SweptSurface::check_plan() const {
  const auto [a, b] = plan_.half_width;
  if (!(a >= 0.0 && b >= 0.0)) throw std::invalid_argument("half widths of a plan must not be negative");
  if (std::isinf(a) && std::isinf(b)) throw std::invalid_argument("only one half width of a plan may be infinite");
  if (!(plan_.corner_radius >= 0.0 && plan_.corner_radius <= std::min(a, b)))
    throw std::invalid_argument("the corner radius of a plan must lie between 0 and its smaller half width");
  if (!(search_.depth > 0.0)) throw std::invalid_argument("depth must be positive");
}

void SweptSurface::add_piece(const double* s, const double* next) {
  const double chord = std::hypot(s[2] - s[0], s[3] - s[1]);
  if (!(chord > 0.0)) throw std::invalid_argument("a segment of the profile has no length");
  profile::Prepared p{};
  profile::prepare(s, next, p);
  const bool line = profile::is_line(s);
  Piece piece{};
  piece.length = chord, piece.radius = p.radius, piece.cosine = p.cosine, piece.turn = s[6];
  double low[2];
  for (int k = 0; k < 2; ++k) {
    piece.start[k] = s[k], piece.tangent[k] = (s[2 + k] - s[k]) / chord, piece.normal[k] = p.normal[0][k];
    piece.centre[k] = s[4 + k], piece.bisector[k] = p.bisector[k];
    // its box: the ends, and an arc's farthest points along the axes where they belong to it
    low[k] = !line && -p.bisector[k] >= p.cosine ? s[4 + k] - p.radius : std::min(s[k], s[2 + k]);
    const double high = !line && p.bisector[k] >= p.cosine ? s[4 + k] + p.radius : std::max(s[k], s[2 + k]);
    search_.low[k] = std::min(search_.low[k], low[k]), search_.high[k] = std::max(search_.high[k], high);
  }
  const bool flat = line && std::abs(s[3] - s[1]) <= 1e-9 * chord;
  if (!flat && low[0] < -plan_.corner_radius - slack())
    throw std::invalid_argument(
        "the profile bends inside the plan by more than its corner radius; give the plan a larger corner radius or the "
        "profile a smaller edge radius");
  pieces_.push_back(piece);
  if (!next || std::abs(p.turn) < 1e-12) return;
  double after[2];
  profile::normal_at(next, 0, after);
  const double mean[2] = {p.normal[1][0] + after[0], p.normal[1][1] + after[1]}, length = std::hypot(mean[0], mean[1]);
  const double cosine = p.normal[1][0] * after[0] + p.normal[1][1] * after[1];
  corners_.push_back({{s[2], s[3]},
                      {mean[0] / length, mean[1] / length},
                      p.turn < 0.0 ? 1.0 : -1.0,
                      std::atan2(std::abs(p.turn), cosine)});
}

void SweptSurface::check_inside() const {
  const double middle = -std::min(plan_.half_width[0], plan_.half_width[1]);
  if (search_.low[0] < middle - slack())
    throw std::invalid_argument("the profile reaches inwards past the middle of the plan");
  for (int i = 0; i < search_.n_ends; ++i)
    if (search_.ends[i][0] < -plan_.corner_radius - slack() && search_.ends[i][0] > middle + slack())
      throw std::invalid_argument(
          "the profile ends inside the plan by more than its corner radius, short of the middle; go on to the middle");
}

std::vector<int> SweptSurface::find_sharp(double length, double angle) const {
  std::vector<int> found;
  const int n = static_cast<int>(pieces_.size());
  bool faces_outwards = false;
  for (int i = 0; i < n; ++i) {
    const Piece& p = pieces_[i];
    const double sweep = 2.0 * std::acos(std::clamp(p.cosine, -1.0, 1.0));
    if (p.turn < 0.0 && std::min(sweep, length / p.radius) > angle) found.push_back(i);
    faces_outwards = faces_outwards || p.tangent[1] < -1e-9;  // normal: the tangent, turned to the left
  }
  for (int i = 0; i < static_cast<int>(corners_.size()); ++i)
    if (corners_[i].sign > 0.0 && corners_[i].angle > angle) found.push_back(n + i);
  const bool has_corners = std::isfinite(plan_.half_width[0]) && std::isfinite(plan_.half_width[1]);
  constexpr double right_angle = 1.5707963267948966;
  if (has_corners && faces_outwards && right_angle > angle && length > angle * plan_.corner_radius) found.push_back(-1);
  return found;
}

}  // namespace presswork::contact
