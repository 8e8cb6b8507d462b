// SPDX-License-Identifier: Apache-2.0
#include "explicit/drawbeads.hpp"

#include <stdexcept>

namespace presswork::explicit_dynamics {

namespace {

constexpr int row = 11;  // numbers of a point in a dump: force, stiffness, direction, cell, inside, weights

}  // namespace

void Drawbeads::add(int n, const double* place, const double* across, const double* length, double force, int tool) {
  const int first = static_cast<int>(points_.size());
  for (int i = 0; i < n; ++i) {
    Point p{};
    std::copy_n(place + 2 * i, 2, p.place), std::copy_n(across + 2 * i, 2, p.across);
    p.length = length[i], p.stiffness = 1.0;
    points_.push_back(p);
  }
  beads.push_back({first, first + n, tool, force, {}});
}

double Drawbeads::stored() const {
  double sum = 0.0;
  for (const Point& p : points_) sum += 0.5 * p.force * p.force / p.stiffness;
  return sum;
}

double Drawbeads::restraint(int bead) const {
  double sum = 0.0;
  for (int i = beads[bead].first; i < beads[bead].last; ++i) sum += std::fabs(points_[i].force);
  return sum;
}

std::vector<double> Drawbeads::dump() const {
  std::vector<double> to;
  for (const Point& p : points_) {
    to.push_back(p.force), to.push_back(p.stiffness);
    to.insert(to.end(), p.direction, p.direction + 3);
    to.push_back(p.beneath.cell), to.push_back(p.beneath.inside);
    to.insert(to.end(), p.beneath.weight, p.beneath.weight + 4);
  }
  to.push_back(work_), to.push_back(cycle_);
  return to;
}

void Drawbeads::restore(const std::vector<double>& from) {
  if (from.size() != points_.size() * row + 2)
    throw std::invalid_argument("the dump's beads are not those of this run");
  const double* at = from.data();
  for (Point& p : points_) {
    p.force = *at++, p.stiffness = *at++;
    for (double& d : p.direction) d = *at++;
    const double cell = *at++;
    if (!(cell >= -1.0 && cell < sheet_.n_cells()))
      throw std::invalid_argument("the dump's beads are not those of this run");
    sheet_.stand_on(static_cast<int>(cell), p.beneath);
    p.beneath.inside = *at++ != 0.0;
    for (double& w : p.beneath.weight) w = *at++;
  }
  work_ = *at++, cycle_ = static_cast<int>(*at++);
}

}  // namespace presswork::explicit_dynamics
