// SPDX-License-Identifier: Apache-2.0
// What Python sees of the rigid tools of an explicit loop, in the plane and in space.
#pragma once

#include <algorithm>

#include "arrays.hpp"

namespace presswork::bindings {

template <class Loop>
auto& wall_of(const Loop& self, int wall) {
  require(wall >= 0 && std::size_t(wall) < self.walls.size(), "there is no wall of this number");
  return *self.walls[wall];
}

template <class Loop, class... Rest>
void bind_wall_sums(nb::class_<Loop, Rest...>& c) {
  c.def(
       "begin_wall_sums", [](Loop& self, int wall) { wall_of(self, wall).begin_sums(); }, nb::arg("wall"),
       "Sum up anew what a wall presses and rubs.")
      .def(
          "set_wall_sums",
          [](Loop& self, int wall, Doubles pressed, Doubles rubbed) {
            auto& of = wall_of(self, wall);
            require(pressed.size() == of.pressed.size() && rubbed.size() == of.rubbed.size(),
                    "pressed and rubbed must have shape (n_nodes)");
            std::copy_n(pressed.data(), pressed.size(), of.pressed.data());
            std::copy_n(rubbed.data(), rubbed.size(), of.rubbed.data());
          },
          nb::arg("wall"), nb::arg("pressed"), nb::arg("rubbed"),
          "Set those sums, as wall_pressed and wall_rubbed give them.");
}

}  // namespace presswork::bindings
