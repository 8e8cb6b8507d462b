// SPDX-License-Identifier: Apache-2.0
#include "contact/sheet_waves.hpp"

#include <algorithm>

#include "arrays.hpp"

namespace presswork::bindings {

namespace {

auto find_sheet_waves(Doubles centre, Doubles bending, Doubles along, Ints own, Doubles step, Doubles size,
                      Doubles thickness, int n_places, double least_height) {
  const std::size_t n_cells = centre.shape(0), n = own.size();
  require(centre.ndim() == 2 && centre.shape(1) == 3, "centre must have shape (n_cells, 3)");
  require(bending.ndim() == 2 && bending.shape(0) == n_cells && bending.shape(1) == 6,
          "bending must have shape (n_cells, 6)");
  require(along.ndim() == 2 && along.shape(0) == n_cells && along.shape(1) == 3, "along must have shape (n_cells, 3)");
  require(step.size() == n && size.size() == n && thickness.size() == n, "step, size, thickness must have shape (n)");
  require(n_places >= 1 && n_places <= contact::SheetWaves::most_places, "n_places must be 1 to 64");
  require(std::all_of(own.data(), own.data() + n, [&](int c) { return c >= 0 && std::size_t(c) < n_cells; }),
          "there is no such cell");
  double *amplitude, *side;
  auto amplitudes = new_array({n}, &amplitude);
  auto sides = new_array({n}, &side);
  const contact::SheetWaves lines{static_cast<int>(n_cells),
                                  centre.data(),
                                  bending.data(),
                                  along.data(),
                                  static_cast<int>(n),
                                  n_places,
                                  own.data(),
                                  step.data(),
                                  size.data(),
                                  thickness.data(),
                                  least_height};
  {
    nb::gil_scoped_release release;
    lines.find(amplitude, side);
  }
  return std::make_tuple(amplitudes, sides);
}

}  // namespace

void bind_sheet_waves(nb::module_& m) {
  m.def(
      "find_sheet_waves", &find_sheet_waves, nb::arg("centre"), nb::arg("bending"), nb::arg("along"), nb::arg("own"),
      nb::arg("step"), nb::arg("size"), nb::arg("thickness"), nb::kw_only(), nb::arg("n_places"),
      nb::arg("least_height"),
      "Find waves of a sheet on lines through cells `own` (n) along its most compressed directions: the bending "
      "strain\n"
      "(n) that a line has to one side between two places with as much to the other, and that of the cell itself (n).\n"
      "centre (n_cells, 3), bending (n_cells, 6; xx, yy, zz, xy, yz, xz), along (n_cells, 3; zero where it is not\n"
      "compressed): of all cells; step (n): from place to place of a line, n_places to either side; size (n): "
      "distance\n"
      "from a place to the nearest centre beyond which no cell lies there; thickness (n) [mm]. least_height: of a "
      "wave\n"
      "over the thickness, below which it is none.");
}

}  // namespace presswork::bindings
