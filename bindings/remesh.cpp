// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>

#include "arrays.hpp"
#include "remesh/cell_grid.hpp"
#include "remesh/donors.hpp"
#include "remesh/smoothing.hpp"
#include "remesh/thickness.hpp"
#include "remesh/triangulation.hpp"
#include "tensor/pack.hpp"

namespace presswork::bindings {

namespace {

Cells view_cells(const Ints& cells, int n_points) {
  require(cells.ndim() == 2 && (cells.shape(1) == 3 || cells.shape(1) == 4), "cells must have shape (n, 3 | 4)");
  for (std::size_t i = 0; i < cells.size(); ++i)
    require(cells.data()[i] >= 0 && (n_points < 0 || cells.data()[i] < n_points), "cells must be node indices");
  return {static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1)), cells.data()};
}

std::size_t count_places(const Doubles& places) {
  require(places.ndim() == 2 && places.shape(1) == 2, "places must have shape (n, 2)");
  return places.shape(0);
}

void require_cells(const Ints& of, std::size_t n, int n_cells) {
  require(of.size() == n, "one cell a point");
  for (std::size_t i = 0; i < n; ++i) require(of.data()[i] >= 0 && of.data()[i] < n_cells, "cells must exist");
}

std::tuple<NewArray<std::int64_t>, NewArray<std::int64_t>, NewDoubles> locate(Doubles points, Ints cells,
                                                                              Doubles wanted) {
  const Cells view = view_cells(cells, static_cast<int>(count_places(points)));
  const std::size_t n = count_places(wanted);
  require(view.n > 0, "a mesh has cells");
  std::int64_t *cell, *nodes;
  double* share;
  auto result = std::make_tuple(new_array({n}, &cell), new_array({n, 3}, &nodes), new_array({n, 3}, &share));
  nb::gil_scoped_release release;
  const CellGrid grid(points.data(), view);
#pragma omp parallel for schedule(static) if (n > 2000)  // waking a thread takes longer than a short loop
  for (std::size_t i = 0; i < n; ++i) {
    const PlaceInCell place = grid.locate(wanted.data() + 2 * i);
    cell[i] = place.cell;
    std::copy(place.nodes, place.nodes + 3, nodes + 3 * i);
    std::copy(place.share, place.share + 3, share + 3 * i);
  }
  return result;
}

// Donors, and how many cells they are found in.
struct BoundDonors {
  Donors donors;
  int n_cells;
};

std::tuple<NewArray<int>, NewDoubles, NewDoubles> fit(const BoundDonors& self, Doubles places, Ints home) {
  const std::size_t n = count_places(places);
  require_cells(home, n, self.n_cells);
  int* donor;
  double *weight, *linear_weight;
  const std::vector<std::size_t> shape{n, most_donors};
  auto result = std::make_tuple(new_array(shape, &donor), new_array(shape, &weight), new_array(shape, &linear_weight));
  nb::gil_scoped_release release;
#pragma omp parallel if (n > 2000)  // waking a thread takes longer than a short loop
  {
    auto scratch = self.donors.make_scratch();
#pragma omp for schedule(static)
    for (std::size_t first = 0; first < n; first += pack_width) {
      Fit found[pack_width];
      const std::size_t count = std::min<std::size_t>(pack_width, n - first);
      self.donors.fit(places.data() + 2 * first, home.data() + first, static_cast<int>(count), scratch, found);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = most_donors * (first + i);
        std::copy(found[i].donor, found[i].donor + most_donors, donor + place);
        std::copy(found[i].weight, found[i].weight + most_donors, weight + place);
        std::copy(found[i].linear_weight, found[i].linear_weight + most_donors, linear_weight + place);
      }
    }
  }
  return result;
}

std::tuple<NewDoubles, NewDoubles> refit_donors(Doubles position, Doubles places, Ints donor) {
  const std::size_t n_old = count_places(position), n = count_places(places);
  require(donor.ndim() == 2 && donor.shape(0) == n && donor.shape(1) == most_donors, "donor (n, donors)");
  for (std::size_t i = 0; i < donor.size(); ++i)
    require(donor.data()[i] >= 0 && static_cast<std::size_t>(donor.data()[i]) < n_old, "donors must exist");
  double *weight, *linear_weight;
  const std::vector<std::size_t> shape{n, most_donors};
  auto result = std::make_tuple(new_array(shape, &weight), new_array(shape, &linear_weight));
  nb::gil_scoped_release release;
  for (std::size_t first = 0; first < n; first += pack_width) {
    Fit found[pack_width];
    const std::size_t count = std::min<std::size_t>(pack_width, n - first);
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(donor.data() + most_donors * (first + i), most_donors, found[i].donor);
    refit(position.data(), places.data() + 2 * first, static_cast<int>(count), found);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = most_donors * (first + i);
      std::copy(found[i].weight, found[i].weight + most_donors, weight + place);
      std::copy(found[i].linear_weight, found[i].linear_weight + most_donors, linear_weight + place);
    }
  }
  return result;
}

NewArray<bool> find_peaks(const BoundDonors& self, Doubles places, Ints home, Doubles values, Ints candidates) {
  const std::size_t n_old = count_places(places), n = candidates.size();
  require_cells(home, n_old, self.n_cells);
  require(values.size() == n_old, "one value a point");
  for (std::size_t i = 0; i < n; ++i)
    require(candidates.data()[i] >= 0 && static_cast<std::size_t>(candidates.data()[i]) < n_old, "points must exist");
  bool* peak;
  auto result = new_array({n}, &peak);
  nb::gil_scoped_release release;
#pragma omp parallel if (n > 2000)  // waking a thread takes longer than a short loop
  {
    auto scratch = self.donors.make_scratch();
#pragma omp for schedule(static)
    for (std::size_t i = 0; i < n; ++i) {
      const int point = candidates.data()[i];
      peak[i] = self.donors.is_peak(point, home.data()[point], places.data(), values.data(), scratch);
    }
  }
  return result;
}

NewDoubles apply(Ints donor, Doubles weight, Doubles linear_weight, Doubles values) {
  require(donor.ndim() == 2 && donor.shape(1) == most_donors && weight.size() == donor.size() &&
              linear_weight.size() == donor.size() && values.ndim() == 2,
          "donor, weight, linear_weight (n, donors), values (n_old, m)");
  for (std::size_t i = 0; i < donor.size(); ++i)
    require(donor.data()[i] >= 0 && static_cast<std::size_t>(donor.data()[i]) < values.shape(0), "donors must exist");
  double* found;
  auto result = new_array({donor.shape(0), values.shape(1)}, &found);
  nb::gil_scoped_release release;
  apply_fit(donor.data(), weight.data(), linear_weight.data(), static_cast<int>(donor.shape(0)), values.data(),
            static_cast<int>(values.shape(1)), found);
  return result;
}

std::optional<std::tuple<NewArray<int>, NewArray<int>>> restore(Doubles points, Ints corners, Ints beside) {
  const std::size_t n_points = count_places(points), n = corners.shape(0);
  require(corners.ndim() == 2 && corners.size() == 3 * n && beside.size() == 3 * n, "corners and beside: (n, 3)");
  for (std::size_t i = 0; i < 3 * n; ++i)
    require(corners.data()[i] >= 0 && static_cast<std::size_t>(corners.data()[i]) < n_points &&
                beside.data()[i] >= -1 && beside.data()[i] < static_cast<int>(n),
            "corners must be points, beside triangles or -1");
  int *own, *other;
  auto result = std::make_tuple(new_array({n, 3}, &own), new_array({n, 3}, &other));
  std::copy(corners.data(), corners.data() + 3 * n, own);
  std::copy(beside.data(), beside.data() + 3 * n, other);
  if (!restore_delaunay(points.data(), static_cast<int>(n), own, other)) return std::nullopt;
  return result;
}

NewDoubles smooth(Doubles points, Ints cells, int n_fixed, int most_rounds, int most_retreats, double good) {
  const std::size_t n = count_places(points);
  const Cells view = view_cells(cells, static_cast<int>(n));
  require(view.corners == 4 && n_fixed >= 0, "cells are quadrilaterals");
  double* moved;
  auto result = new_array({n, 2}, &moved);
  std::copy(points.data(), points.data() + 2 * n, moved);
  smooth_cells(moved, static_cast<int>(n), view, n_fixed, {most_rounds, most_retreats, good});
  return result;
}

NewArray<bool> find_near(Ints cells, Ints home, Ints others) {
  const Cells view = view_cells(cells, -1);
  const std::size_t n = home.size();
  require_cells(home, n, view.n);
  require(others.ndim() == 2 && others.shape(0) == n, "others must have a row for each home");
  require_cells(others, others.size(), view.n);
  bool* near;
  auto result = new_array({n, others.shape(1)}, &near);
  nb::gil_scoped_release release;
  mark_near(view, home.data(), static_cast<int>(n), others.data(), static_cast<int>(others.shape(1)), near);
  return result;
}

NewDoubles find_thickness(Doubles middle, Doubles normal, Doubles radius, double reach, double opposite) {
  const std::size_t n = radius.size();
  require(middle.size() == 3 * n && normal.size() == 3 * n, "middle and normal: (n, 3), radius: (n,)");
  double* thickness;
  auto result = new_array({n}, &thickness);
  nb::gil_scoped_release release;
  measure_thickness(middle.data(), normal.data(), radius.data(), static_cast<int>(n), reach, opposite, thickness);
  return result;
}

}  // namespace

void bind_remesh(nb::module_& m) {
  m.attr("most_donors") = most_donors;
  m.attr("donor_rings") = rings;
  m.def("locate_in_cells", &locate, nb::arg("points"), nb::arg("cells"), nb::arg("wanted"),
        "Cell (n,) in which, or nearest to which, each wanted point (n, 2) lies, corners of a triangle of it (n, 3), "
        "and barycentric coordinates there (n, 3).");
  m.def("restore_delaunay", &restore, nb::arg("points"), nb::arg("corners"), nb::arg("beside"),
        "Delaunay's triangles (n, 3) of points (n_points, 2) that have moved a little, and which lie opposite to each "
        "corner (n, 3), from those before; None where a triangle has turned inside out.");
  m.def("smooth_cells", &smooth, nb::arg("points"), nb::arg("cells"), nb::arg("n_fixed"), nb::kw_only(),
        nb::arg("most_rounds"), nb::arg("most_retreats"), nb::arg("good"),
        "Points (n, 2) of quadrilaterals (m, 4), all but the first n_fixed moved towards the middle of their "
        "neighbours in rounds. Where a cell of a quality below good would become worse its nodes go back.");
  m.def("find_near_cells", &find_near, nb::arg("cells"), nb::arg("home"), nb::arg("others"),
        "Which other cells (n, k) share a node with the cell home (n,), or with a cell that does.");
  m.def("measure_thickness", &find_thickness, nb::arg("middle"), nb::arg("normal"), nb::arg("radius"), nb::kw_only(),
        nb::arg("reach"), nb::arg("opposite"),
        "Distance [mm] along the normals outwards (n, 3) of faces with these middles (n, 3) and radii (n,) of the "
        "nearest face that looks the other way, by a cosine below -opposite; infinite beyond reach (n,).");
  nb::class_<BoundDonors>(m, "Donors", "Points of an old mesh from which values at new points are fitted.")
      .def(
          "__init__",
          [](BoundDonors* self, Doubles position, Ints cell_of, Ints cells) {
            const Cells view = view_cells(cells, -1);
            const std::size_t n = count_places(position);
            require_cells(cell_of, n, view.n);
            new (self) BoundDonors{{position.data(), cell_of.data(), static_cast<int>(n), view}, view.n};
          },
          nb::arg("position"), nb::arg("cell_of"), nb::arg("cells"))
      .def("fit", &fit, nb::arg("places"), nb::arg("home"),
           "Donors of new points (n, 2), whose cells home (n,) are, the nearest first, and their weights in the "
           "quadratic and the linear fit, each (n, most_donors).")
      .def("find_peaks", &find_peaks, nb::arg("places"), nb::arg("home"), nb::arg("values"), nb::arg("candidates"),
           "Which candidates (n,) among these points have a value above those of all their other donors (n,).\n\n"
           "places (n_old, 2), home (n_old,), values (n_old,): of all points, as they were given.");
  m.def("refit_donors", &refit_donors, nb::arg("position"), nb::arg("places"), nb::arg("donor"),
        "Weights in the quadratic and the linear fit, each (n, most_donors), of donors (n, most_donors) as Donors.fit "
        "has found them, once their positions (n_old, 2) and the new places (n, 2) have changed a little.");
  m.def("apply_fit", &apply, nb::arg("donor"), nb::arg("weight"), nb::arg("linear_weight"), nb::arg("values"),
        "Values (n, m) at new points by the fits of Donors from values at old ones (n_old, m).");
}

}  // namespace presswork::bindings
