// SPDX-License-Identifier: Apache-2.0
// Rigid tools of solids and ties of a loop as a device takes them, and what goes back into the loop.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "device/borrowed_tools.hpp"
#include "device/ties.hpp"
#include "device/walls.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::device {

using explicit_dynamics::CyclicTies;
using explicit_dynamics::SpaceWall;

struct BorrowedWalls {
  std::vector<std::unique_ptr<SpaceWall>>* own = nullptr;  // none: no walls
  std::vector<WallBody> body;
  std::vector<Surface> surface;
  std::vector<WallNodes> node;  // their arrays are those of the loop
  std::vector<double> work;
  Walls view{};

  void take(std::vector<std::unique_ptr<SpaceWall>>& from, explicit_dynamics::SpaceNodes<double>& nodes) {
    own = &from;
    for (const auto& each : from) surface.push_back(BorrowedTools::see(each->surface())), node.push_back(each->lend());
    body.resize(from.size()), work.assign(2 * std::size_t(nodes.n), 0.0);
    begin(nodes);
    view = {static_cast<int>(from.size()),
            nodes.touches_walls.data(),
            body.data(),
            surface.data(),
            node.data(),
            work.data(),
            nullptr,
            nullptr};
  }
  bool spins() const {
    return std::any_of(body.begin(), body.end(), [](const WallBody& each) { return each.motion.spin != 0.0; });
  }
  // As before cycles of the loop, where nodes are as they are.
  void begin(explicit_dynamics::SpaceNodes<double>& nodes) {
    for (std::size_t i = 0; i < body.size(); ++i) (*own)[i]->begin(nodes, 0), body[i] = *(*own)[i];
  }
  void give_back() const {
    for (std::size_t i = 0; i < body.size(); ++i) static_cast<WallBody&>(*(*own)[i]) = body[i];
  }
};

struct BorrowedTies {
  std::vector<int> pair;
  Ties view{};

  void take(const CyclicTies& from) {
    for (const auto& [first, last] : from.pairs()) pair.push_back(first), pair.push_back(last);
    view = {static_cast<int>(from.pairs().size()), pair.data(), from.cosine(), from.sine(), nullptr};
  }
};

}  // namespace presswork::device
