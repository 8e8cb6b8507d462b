// SPDX-License-Identifier: Apache-2.0
#include "explicit/contact/drawbeads.hpp"

#include <limits>
#include <stdexcept>

namespace presswork::explicit_dynamics {

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
  for (const Point& p : points_)
    if (answers_for(p)) sum += 0.5 * p.force * p.force / p.stiffness;
  return sum;
}

double Drawbeads::restraint(int bead) const {
  double sum = 0.0;
  for (int i = beads[bead].first; i < beads[bead].last; ++i)
    if (answers_for(points_[i])) sum += round_force(std::fabs(points_[i].force));
  return sum;
}

void Drawbeads::set_masses(const std::vector<double>& of_cells) {
  if (own_cell_.empty()) {
    cell_mass_ = of_cells;
    return;
  }
  for (std::size_t i = 0; i < own_cell_.size(); ++i) cell_mass_[own_cell_[i]] = of_cells[i];
}

void Drawbeads::place(const double* position, int stride) {
  for (Point& p : points_)
    if (p.beneath.cell < 0) sheet_.stand_on(sheet_.search().nearest_cell(p.place, position, stride), p.beneath);
}

void Drawbeads::be_part(const int* place, std::vector<int> cell, std::vector<char> ghost) {
  sheet_ = sheet_.in_part(place);
  cell_mass_.assign(sheet_.n_cells(), 0.0);
  own_cell_ = std::move(cell), ghost_ = std::move(ghost);
}

void Drawbeads::agree(const double* position, int stride, Neighbours& parts) {
  if (!looks()) return;
  const int n_cells = sheet_.n_cells();
  const auto n = points_.size();
  std::vector<double> told(2 * n);
  for (bool settled = false; !settled;) {
    // 1. Parts that have the shell found last walk on: where to, above all shells where the walk has come to its end,
    //    and the force.
    std::fill(told.begin(), told.end(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < n; ++i) {
      contact::Beneath at = points_[i].beneath;
      if (!is_here(points_[i])) continue;
      sheet_.find(points_[i].place, position, stride, at);
      told[2 * i] = sheet_.has(at.cell) ? n_cells + at.cell : at.cell;
      told[2 * i + 1] = points_[i].force;
    }
    parts.find_largest(told.data(), static_cast<int>(told.size()));
    // 2. All stand there. A walk that has left every part that knew its beginning goes on where it has come to.
    settled = true;
    for (std::size_t i = 0; i < n; ++i) {
      const int cell = static_cast<int>(told[2 * i]);
      settled = settled && cell >= n_cells;
      sheet_.stand_on(cell >= n_cells ? cell - n_cells : cell, points_[i].beneath);
      points_[i].force = told[2 * i + 1];
    }
  }
}

void Drawbeads::list_state(std::vector<StateField>& fields) {
  const auto of_points = [&](std::string name, std::size_t width, auto get, auto set) {
    fields.push_back({"beads",
                      std::move(name),
                      {points_.size(), width},
                      [=, this](double* to) {
                        for (Point& p : points_) get(p, to), to += width;
                      },
                      [=, this](const double* from) {
                        for (Point& p : points_) set(p, from), from += width;
                      }});
  };
  of_points(
      "spring", 2, [](const Point& p, double* to) { to[0] = p.force, to[1] = p.stiffness; },
      [](Point& p, const double* from) { p.force = from[0], p.stiffness = from[1]; });
  of_points(
      "direction", 3, [](const Point& p, double* to) { std::copy_n(p.direction, 3, to); },
      [](Point& p, const double* from) { std::copy_n(from, 3, p.direction); });
  of_points(
      "cell", 2, [](const Point& p, double* to) { to[0] = p.beneath.cell, to[1] = p.beneath.inside; },
      [this](Point& p, const double* from) {
        if (!(from[0] >= -1.0 && from[0] < sheet_.n_cells()))
          throw std::invalid_argument("the dump's beads are not those of this run");
        sheet_.stand_on(static_cast<int>(from[0]), p.beneath);
        p.beneath.inside = from[1] != 0.0 && is_here(p);
      });
  of_points(
      "weight", 4, [](const Point& p, double* to) { std::copy_n(p.beneath.weight, 4, to); },
      [](Point& p, const double* from) { std::copy_n(from, 4, p.beneath.weight); });
  fields.push_back(row_field("beads", "work", &work_, 1));
  fields.push_back(row_field("beads", "cycle", &cycle_, 1));
}

}  // namespace presswork::explicit_dynamics
