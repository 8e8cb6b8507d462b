// SPDX-License-Identifier: Apache-2.0
#include "contact/bending_along.hpp"

#include <algorithm>

#include "arrays.hpp"

namespace presswork::bindings {

namespace {

auto find_bending_along(Doubles centre, Doubles bending, Ints own, Doubles along, Doubles way, Doubles within) {
  const std::size_t n_cells = centre.shape(0), n = own.size();
  require(centre.ndim() == 2 && centre.shape(1) == 3, "centre must have shape (n_cells, 3)");
  require(bending.ndim() == 2 && bending.shape(0) == n_cells && bending.shape(1) == 6,
          "bending must have shape (n_cells, 6)");
  require(along.ndim() == 2 && along.shape(0) == n && along.shape(1) == 3, "along must have shape (n, 3)");
  require(way.ndim() == 2 && way.shape(0) == n, "way must have shape (n, n_places)");
  require(within.ndim() == 2 && within.shape(0) == n && within.shape(1) == way.shape(1),
          "within must have the shape of way");
  require(std::all_of(own.data(), own.data() + n, [&](int c) { return c >= 0 && std::size_t(c) < n_cells; }),
          "there is no such cell");
  double *up, *down;
  auto ups = new_array({n}, &up);
  auto downs = new_array({n}, &down);
  const contact::BendingAlong lines{static_cast<int>(n_cells),
                                    centre.data(),
                                    bending.data(),
                                    static_cast<int>(n),
                                    static_cast<int>(way.shape(1)),
                                    own.data(),
                                    along.data(),
                                    way.data(),
                                    within.data()};
  {
    nb::gil_scoped_release release;
    lines.find(up, down);
  }
  return std::make_tuple(ups, downs);
}

}  // namespace

void bind_bending_along(nb::module_& m) {
  m.def(
      "find_bending_along", &find_bending_along, nb::arg("centre"), nb::arg("bending"), nb::arg("own"),
      nb::arg("along"), nb::arg("way"), nb::arg("within"),
      "Find the largest bending strain to either side (n), (n) on lines through cells `own` (n) of a sheet.\n"
      "centre (n_cells, 3), bending (n_cells, 6; xx, yy, zz, xy, yz, xz): of all cells; along (n, 3): unit vectors;\n"
      "way (n, n_places): places on the lines from the cell, outwards to one side, then to the other; within: as way,\n"
      "distance from a place to the nearest centre beyond which no cell lies there.");
}

}  // namespace presswork::bindings
