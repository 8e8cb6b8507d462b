// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "arrays.hpp"
#include "contact/profile.hpp"

namespace presswork::bindings {

void bind_contact(nb::module_& m) {
  m.def(
      "touch_profile",
      [](Doubles segments, Doubles points) {
        require(segments.ndim() == 2 && segments.shape(1) == 7, "segments must have shape (n_segments, 7)");
        require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n, 2)");
        const std::size_t n = points.shape(0);
        require(segments.shape(0) > 0, "a profile needs a segment");
        double *gap, *normal, *second_gap, *second_normal;
        int *segment, *second_segment;
        auto gaps = new_array({n}, &gap);
        auto normals = new_array({n, 2}, &normal);
        auto second_gaps = new_array({n}, &second_gap);
        auto second_normals = new_array({n, 2}, &second_normal);
        auto of_gap = new_array({n}, &segment);
        auto of_second_gap = new_array({n}, &second_segment);
        const int n_segments = static_cast<int>(segments.shape(0));
        std::vector<profile::Prepared> prepared(n_segments);
        std::vector<profile::Box> boxes(2 * ProfileSearch::count_leaves(n_segments));
        const ProfileSearch search(n_segments, segments.data(), prepared.data(), boxes.data());
#pragma omp parallel for schedule(static) if (n > 2000)  // waking a thread takes longer than a short loop
        for (std::size_t i = 0; i < n; ++i) {
          const Touch t = search.touch(points.data()[2 * i], points.data()[2 * i + 1]);
          gap[i] = t.gap, second_gap[i] = t.second_gap;
          segment[i] = t.segment, second_segment[i] = t.second_segment;
          for (int k = 0; k < 2; ++k) normal[2 * i + k] = t.normal[k], second_normal[2 * i + k] = t.second_normal[k];
        }
        return std::make_tuple(gaps, normals, second_gaps, second_normals, of_gap, of_second_gap);
      },
      nb::arg("segments"), nb::arg("points"),
      "Gap (n) and normal (n, 2) of points to a tool profile, those of the second face where a point lies in an inner "
      "corner (infinite elsewhere), and the indices of the segments touched by the first and the second (-1: none).");
}

}  // namespace presswork::bindings
