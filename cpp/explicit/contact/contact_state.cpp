// SPDX-License-Identifier: Apache-2.0
// All that contact with tools remembers: of each tool its motion, its pairs with the points and its edges; of the
// points half thickness, room and held energy; sums. It does not depend on the SIMD width.
#include <algorithm>

#include "explicit/contact/tool_contact.hpp"

namespace presswork::explicit_dynamics {

void ToolContact::list_state(std::vector<StateField>& fields) {
  for (int t = 0; t < static_cast<int>(tools.size()); ++t) list_tool(t, fields);
  const std::pair<const char*, std::vector<double>*> of_points[] = {{"half", &half_}, {"room", &room_}};
  for (const auto& [name, values] : of_points) {
    // slots are filled up to whole groups: that many for any width
    fields.push_back(row_field("contact", name, values->data(), values->size()));
  }
  StateField held = row_field("contact", "held", held_.data(), held_.size());
  held.write = [this](const double* from) {
    std::copy_n(from, held_.size(), held_.data());
    for (int node : left_) held_[node] = 0.0;
  };
  fields.push_back(std::move(held));
  const std::pair<const char*, double*> sums[] = {{"friction", &total_.friction}, {"damping", &total_.damping},
                                                  {"squeeze", &total_.squeeze},   {"external", &work_.external},
                                                  {"drag", &work_.drag},          {"step", &step_}};
  for (const auto& [name, value] : sums) fields.push_back(row_field("contact", name, value, 1));
  fields.push_back(row_field("contact", "started", &started_, 1));
  StateField cycle = row_field("contact", "cycle", &cycle_, 1);
  cycle.write = [this](const double* from) {
    cycle_ = static_cast<int>(*from);
    total_.lost = std::numeric_limits<int>::max();
  };
  fields.push_back(std::move(cycle));
}

void ToolContact::list_tool(int number, std::vector<StateField>& fields) {
  const std::string owner = "tool_" + std::to_string(number);
  Tool& tool = tools[number];
  Pairs& of = pairs_[number];
  fields.push_back(row_field(owner, "displacement", tool.displacement, 3));
  fields.push_back(row_field(owner, "velocity", tool.velocity, 3));
  fields.push_back(row_field(owner, "force", tool.force, 3));
  fields.push_back(row_field(owner, "push", &tool.push, 1));
  fields.push_back(row_field(owner, "was_pushed", &tool.was_pushed, 1));
  fields.push_back(row_field(owner, "travel", &tool.travel, 1));
  fields.push_back({owner,
                    "pairs",
                    {of.hint.size(), std::size_t(rows)},
                    [&of](double* to) {
                      for (std::size_t slot = 0; slot < of.hint.size(); ++slot) {
                        const auto* row = reinterpret_cast<const Pack*>(&of.packs[slot / width]);
                        for (int r = 0; r < rows; ++r) *to++ = row[r][static_cast<int>(slot % width)];
                      }
                    },
                    [&of, number, this](const double* from) {
                      for (std::size_t slot = 0; slot < of.hint.size(); ++slot) {
                        auto* row = reinterpret_cast<Pack*>(&of.packs[slot / width]);
                        for (int r = 0; r < rows; ++r) row[r].set(static_cast<int>(slot % width), *from++);
                      }
                      of.look_again();
                      for (int node : left_) leave(number, node);
                    }});
  fields.push_back(row_field(owner, "hint", of.hint.data(), of.hint.size()));
  edges_.list_state(number, owner, fields);
}

void ToolContact::copy_pairs(int tool, double* to, int* hint) const {
  const Pairs& of = pairs_[tool];
  for (int node = 0; node < n_nodes_; ++node) {
    const auto* row = reinterpret_cast<const Pack*>(&of.packs[node / width]);
    for (int r = 0; r < rows; ++r) to[std::size_t(r) * n_nodes_ + node] = row[r][node % width];
    hint[node] = of.hint[node];
  }
}

void ToolContact::take_pairs(int tool, const double* from, const int* hint) {
  Pairs& of = pairs_[tool];
  for (int node = 0; node < n_nodes_; ++node) {
    auto* row = reinterpret_cast<Pack*>(&of.packs[node / width]);
    for (int r = 0; r < rows; ++r) row[r].set(node % width, from[std::size_t(r) * n_nodes_ + node]);
    of.hint[node] = hint[node];
  }
  of.look_again();
}

void EdgeContact::list_state(int tool, const std::string& owner, std::vector<StateField>& fields) {
  Pairs& of = pairs_[tool];
  if (of.at.empty()) return;
  const auto of_edges = [&](const char* name, std::size_t width, auto get, auto set) {
    fields.push_back({owner,
                      name,
                      {of.at.size(), width},
                      [=, &of](double* to) {
                        for (Touching& p : of.at) get(p, to), to += width;
                      },
                      [=, &of](const double* from) {
                        for (Touching& p : of.at) set(p, from), from += width;
                      }});
  };
  of_edges(
      "edge_asked", before_hints, [](const Touching& p, double* to) { std::copy_n(records_of(p), before_hints, to); },
      [](Touching& p, const double* from) { std::copy_n(from, before_hints, records_of(p)); });
  of_edges(
      "edge_force", 8, [](const Touching& p, double* to) { std::copy_n(records_of(p) + 8, 8, to); },
      [](Touching& p, const double* from) { std::copy_n(from, 8, records_of(p) + 8); });
  of_edges(
      "edge_hint", 2, [](const Touching& p, double* to) { to[0] = p.hint, to[1] = p.sharp_hint; },
      [](Touching& p, const double* from) {
        p.hint = static_cast<std::int32_t>(from[0]), p.sharp_hint = static_cast<std::int32_t>(from[1]);
      });
  fields.push_back({owner,
                    "edge_wake",
                    {of.at.size()},
                    [&of](double* to) { std::copy_n(of.wake.data(), of.at.size(), to); },
                    [&of](const double* from) {
                      std::copy_n(from, of.at.size(), of.wake.data());
                      std::fill(of.wake_group.begin(), of.wake_group.end(), 0.0);
                    }});
}

}  // namespace presswork::explicit_dynamics
