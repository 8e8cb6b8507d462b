// SPDX-License-Identifier: Apache-2.0
// Rigid tools that hold nodes of solids in space, and what is held and tied beside them.
#pragma once

#include <nanobind/nanobind.h>

#include "explicit/space/loop.hpp"

namespace presswork::bindings {

void bind_space_walls(nanobind::class_<explicit_dynamics::SpaceLoop<double>>& loop);

}  // namespace presswork::bindings
