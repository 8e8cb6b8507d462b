// SPDX-License-Identifier: Apache-2.0
#include "kinematics/increment.hpp"

#include "arrays.hpp"

namespace presswork::bindings {

void bind_kinematics(nb::module_& m) {
  nb::enum_<StrainMeasure>(m, "StrainMeasure", "Strain of an increment as a function of its stretch U.")
      .value("log", StrainMeasure::log)
      .value("stretch", StrainMeasure::stretch)
      .value("green_lagrange", StrainMeasure::green_lagrange)
      .value("small", StrainMeasure::small);
  m.def(
      "measure_increments",
      [](Doubles F, StrainMeasure measure) {
        require(F.ndim() == 2 && F.shape(1) == 5, "F must have shape (n, 5): 11, 12, 21, 22, 33");
        double *strain, *turn, *dstrain;
        auto strains = new_array({F.shape(0), 4}, &strain);
        auto turns = new_array({F.shape(0), 2}, &turn);
        auto derivatives = new_array({F.shape(0), 4, 5}, &dstrain);
        for (std::size_t i = 0; i < F.shape(0); ++i) {
          Increment<double> inc;
          measure_increment(F.data() + 5 * i, measure, true, inc);
          for (int k = 0; k < 4; ++k) {
            strain[4 * i + k] = inc.strain[k];
            for (int j = 0; j < 5; ++j) dstrain[20 * i + 5 * k + j] = inc.dstrain[k][j];
          }
          turn[2 * i] = inc.cosine;
          turn[2 * i + 1] = inc.sine;
        }
        return std::make_tuple(strains, turns, derivatives);
      },
      nb::arg("F"), nb::arg("measure"),
      "Strain (n, 4: xx, yy, zz, xy), rotation (n, 2: cosine, sine) and d strain / d l* (n, 4, 5) of increments F (n, "
      "5).");
}

}  // namespace presswork::bindings
