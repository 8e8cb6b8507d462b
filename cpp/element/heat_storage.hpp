// SPDX-License-Identifier: Apache-2.0
// Heat content of a unit of mass by temperature: the integral of the specific heat, and latent heat.
//
// The specific heat is linear between the rows of its table and constant beyond; latent heat is taken up evenly from
// the start to the end of a transformation.
#pragma once

#include <algorithm>
#include <cstddef>

namespace presswork {

struct HeatContent {
  static constexpr int columns = 4;
  // (n, 4): a temperature [degrees C], increasing, from where on the specific heat [mm2/(s2 K)] and its slope
  // [mm2/(s2 K2)] hold, and the heat content there [mm2/s2]; the first row holds below it, too
  const double* piece;
  int n;
  double latent, start, end;  // [mm2/s2], [degrees C]

  void find(double temperature, double& content, double& specific) const {
    const double* p = piece;
    for (int i = 1; i < n && piece[columns * i] <= temperature; ++i) p = piece + columns * i;
    const double above = temperature - p[0];
    specific = p[1] + p[2] * above;
    content = p[3] + 0.5 * (p[1] + specific) * above;
    if (latent == 0.0) return;
    const double part = (temperature - start) / (end - start);
    content += latent * std::clamp(part, 0.0, 1.0);
    if (part > 0.0 && part < 1.0) specific += latent / (end - start);
  }
};

}  // namespace presswork
