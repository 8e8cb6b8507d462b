// SPDX-License-Identifier: Apache-2.0
// What a law keeps at a point behind its stress, by name: each law lists the parts of its history in their order.
#pragma once

#include <variant>

#include "material/elastic_plastic.hpp"
#include "material/history_part.hpp"
#include "material/von_mises.hpp"

namespace presswork {

inline History list_history(const VonMises&) { return {{"eqps", 1}}; }

// Of a law in its own axes; solids keep the directions of these axes besides (element/point_history.hpp).
template <int N>
History list_history(const ElasticPlastic<N>& law) {
  History parts{{"eqps", 1}};
  if (law.flow.thermal.heats()) parts.push_back({"rise", 1});
  if (const auto* chaboche = std::get_if<Chaboche>(&law.kinematic)) {
    parts.push_back({"back_stress", N * chaboche->count});
  } else if (std::get_if<YoshidaUemori>(&law.kinematic)) {
    for (const HistoryPart& part : {HistoryPart{"back_stress", 2 * N}, HistoryPart{"expansion", 1},
                                    HistoryPart{"stagnation_centre", N}, HistoryPart{"stagnation_size", 1}})
      parts.push_back(part);
  }
  if (law.phases)
    for (const HistoryPart& part : {HistoryPart{"phase_strain", 1}, HistoryPart{"phase_trip", 1}})
      parts.push_back(part);
  if (law.thermoelastic.active()) parts.push_back({"temperature", 1});
  return parts;
}

}  // namespace presswork
