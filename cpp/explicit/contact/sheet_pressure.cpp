// SPDX-License-Identifier: Apache-2.0
#include "explicit/contact/sheet_pressure.hpp"

namespace presswork::explicit_dynamics {

int SheetPressures::add(std::vector<int> cells, double side, const EnclosedFluid& fluid) {
  const int number = count(), first = static_cast<int>(cells_.size()) / corners;
  const int last = first + static_cast<int>(cells.size()) / corners;
  pressures_.push_back({first, last, side, fluid, {}});
  for (int from = first; from < last; from += chunk) chunks_.push_back({number, from, std::min(last, from + chunk)});
  cells_.insert(cells_.end(), cells.begin(), cells.end());
  area_.assign(3 * cells_.size(), 0.0);
  list_nodes();
  return number;
}

void SheetPressures::list_nodes() {
  std::vector<int> n_of(n_nodes_, 0);
  for (int node : cells_) ++n_of[node];
  node_.clear(), first_of_node_.assign(1, 0);
  std::vector<int> place(n_nodes_, -1);
  for (int node = 0; node < n_nodes_; ++node) {
    if (n_of[node] == 0) continue;
    place[node] = first_of_node_.back();
    node_.push_back(node);
    first_of_node_.push_back(first_of_node_.back() + n_of[node]);
  }
  slot_.resize(cells_.size()), slot_pressure_.resize(cells_.size());
  for (int i = 0; i < count(); ++i)
    for (int s = corners * pressures_[i].first; s < corners * pressures_[i].last; ++s) {
      const int at = place[cells_[s]]++;
      slot_[at] = s, slot_pressure_[at] = i;
    }
}

bool SheetPressures::lasts(int n_cycles) const {
  return std::all_of(pressures_.begin(), pressures_.end(),
                     [=](const Pressure& each) { return each.course.size() >= std::size_t(n_cycles); });
}

double SheetPressures::find_pressures(int cycle) {
  double work = 0.0;
  std::vector<double> swept(pressures_.size(), 0.0);
  for (const Chunk& each : chunks_) swept[each.pressure] += each.swept;
  for (std::size_t i = 0; i < pressures_.size(); ++i) {
    Pressure& of = pressures_[i];
    const double before = of.now, given = of.course[cycle];
    of.swept += swept[i];
    of.now = of.fluid.stiffness > 0.0 ? of.fluid.pressure(given, of.swept) : given;
    work += 0.5 * (before + of.now) * swept[i];
  }
  return work;
}

void SheetPressures::list_state(std::vector<StateField>& fields) {
  for (std::size_t i = 0; i < pressures_.size(); ++i) {
    const std::string owner = "pressure_" + std::to_string(i);
    fields.push_back(row_field(owner, "pressure", &pressures_[i].now, 1));
    fields.push_back(row_field(owner, "swept", &pressures_[i].swept, 1));
  }
}

}  // namespace presswork::explicit_dynamics
