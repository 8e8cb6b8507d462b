// SPDX-License-Identifier: Apache-2.0
// What a point keeps for its law behind the stress, by name, whatever the cell: point_response.hpp and umat_point.hpp
// have the values.
#pragma once

#include "element/point_response.hpp"
#include "element/umat_point.hpp"
#include "material/adiabatic_mises.hpp"
#include "material/history.hpp"

namespace presswork {

inline History list_point_history(const VonMises& law) { return list_history(law); }
inline History list_point_history(const AdiabaticMises&) { return {{"eqps", 1}, {"rise", 1}}; }
inline History list_point_history(const SheetLaw& law) { return list_history(law); }
template <int N>
History list_point_history(const ElasticPlastic<N>& law) {
  History parts = list_history(law);
  parts.push_back({"axes", axes_values<N>, true});
  return parts;
}
// N components.
template <int N>
History list_point_history(const Umat& law) {
  History parts{{"eqps", 1}};
  parts.insert(parts.end(), law.state.begin(), law.state.end());
  for (const HistoryPart& part : {HistoryPart{"deformation_gradient", 9}, HistoryPart{"strain", N},
                                  HistoryPart{"energy", 3}, HistoryPart{"heat", 1}, HistoryPart{"work", 1}})
    parts.push_back(part);
  return parts;
}

}  // namespace presswork
