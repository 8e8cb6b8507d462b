// SPDX-License-Identifier: Apache-2.0
// Rigid tools of solids and ties of a loop as a device takes them, and what goes back into the loop.
#pragma once

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
    follow();
    view = {static_cast<int>(from.size()),
            nodes.touches_walls.data(),
            body.data(),
            surface.data(),
            node.data(),
            work.data(),
            nullptr,
            nullptr};
  }
  // They move from now on as the loop's do.
  void follow() {
    for (std::size_t i = 0; i < body.size(); ++i) body[i] = *(*own)[i];
  }
  // Whether their limits of friction are where they were when they were borrowed.
  bool knows_limits() const {
    for (std::size_t i = 0; i < body.size(); ++i)
      if (node[i].friction_limit != (*own)[i]->lend().friction_limit) return false;
    return true;
  }
  void give_back() const {
    for (std::size_t i = 0; i < body.size(); ++i) (*own)[i]->go_where(body[i]);
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
