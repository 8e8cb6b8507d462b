// SPDX-License-Identifier: Apache-2.0
// All that contact with tools remembers, as numbers, and back. Per tool its motion, then of each slot the rows and the
// hint, and its edges; half thicknesses, room and held energy; sums. It does not depend on the SIMD width.
#include <stdexcept>

#include "explicit/tool_contact.hpp"

namespace presswork::explicit_dynamics {

std::vector<double> ToolContact::dump() const {
  std::vector<double> to;
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const Tool& tool = tools[t];
    const Pairs& of = pairs_[t];
    for (const auto* v : {tool.displacement, tool.velocity, tool.force}) to.insert(to.end(), v, v + 3);
    to.push_back(tool.push), to.push_back(tool.travel);
    for (std::size_t slot = 0; slot < of.hint.size(); ++slot) {
      const auto* row = reinterpret_cast<const Pack*>(&of.packs[slot / width]);
      for (int r = 0; r < rows; ++r) to.push_back(row[r][static_cast<int>(slot % width)]);
      to.push_back(of.hint[slot]);
    }
    edges_.dump(static_cast<int>(t), to);
  }
  for (const auto* rows_of : {&half_, &room_, &held_}) to.insert(to.end(), rows_of->begin(), rows_of->end());
  for (double x :
       {total_.friction, total_.damping, total_.squeeze, external_, drag_, step_, double(started_), double(cycle_)})
    to.push_back(x);
  return to;
}

double ToolContact::step_of(const std::vector<double>& from) const {
  std::size_t size = 8 + 3 * half_.size() + edges_.dump_size();
  for (const Pairs& of : pairs_) size += 11 + (rows + 1) * of.hint.size();
  if (from.size() != size) throw std::invalid_argument("the dump's tools are not those of this run");
  return from[size - 3];
}

void ToolContact::restore(const std::vector<double>& from) {
  const double* at = from.data();
  for (std::size_t t = 0; t < tools.size(); ++t) {
    Tool& tool = tools[t];
    Pairs& of = pairs_[t];
    for (auto* v : {tool.displacement, tool.velocity, tool.force})
      for (int i = 0; i < 3; ++i) v[i] = *at++;
    tool.push = *at++, tool.travel = *at++;
    for (std::size_t slot = 0; slot < of.hint.size(); ++slot) {
      auto* row = reinterpret_cast<Pack*>(&of.packs[slot / width]);
      for (int r = 0; r < rows; ++r) row[r].set(static_cast<int>(slot % width), *at++);
      of.hint[slot] = static_cast<int>(*at++);
    }
    edges_.restore(static_cast<int>(t), at);
  }
  for (auto* rows_of : {&half_, &room_, &held_})
    for (double& h : *rows_of) h = *at++;
  for (double* x : {&total_.friction, &total_.damping, &total_.squeeze, &external_, &drag_, &step_}) *x = *at++;
  started_ = static_cast<int>(*at++), cycle_ = static_cast<int>(*at++);
  total_.lost = std::numeric_limits<int>::max();
}

}  // namespace presswork::explicit_dynamics
