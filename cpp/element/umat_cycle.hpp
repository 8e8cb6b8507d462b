// SPDX-License-Identifier: Apache-2.0
// A law from a shared library in the explicit loop, where the state of cells is kept in rows of packs.
#pragma once

#include <memory>
#include <vector>

#include "element/umat_point.hpp"
#include "material/law_data.hpp"

namespace presswork {

// Of N components, with the elastic constants of its first tangent.
template <int N>
struct CycleUmat {
  const Umat* umat;
  double young, poisson;

  double shear_modulus() const { return young / (2.0 * (1.0 + poisson)); }
  double bulk_modulus() const { return young / (3.0 * (1.0 - 2.0 * poisson)); }
};

// How many it keeps behind the equivalent plastic strain: its state variables, then UmatHistory.
template <int N>
int kept_values(const CycleUmat<N>& law) {
  return law.umat->n_state + UmatHistory<N>::size;
}

template <int N>
double start_temperature(const CycleUmat<N>&) {
  return 0.0;
}

template <int N>
Owned<CycleUmat<N>> own_umat(const Umat& given, double young, double poisson) {
  auto umat = std::make_shared<const Umat>(given);
  const CycleUmat<N> view{umat.get(), young, poisson};
  return {view, {std::move(umat)}};
}

// What the routine keeps at one point of a pack's cells, lane by lane, at the start and at the end of a cycle.
class UmatRows {
 public:
  UmatLanes lanes;

  // From n rows of the pack, of which so many lanes have a cell of their own.
  void take(const Pack* rows, int n, int used) {
    values_.resize(std::size_t(2) * n * pack_width);
    lanes.count = used;
    for (int lane = 0; lane < used; ++lane) {
      double* const before = &values_[std::size_t(2 * lane) * n];
      lanes.history_n[lane] = before, lanes.history[lane] = before + n;
      for (int i = 0; i < n; ++i) before[i] = rows[i][lane], before[n + i] = 0.0;
    }
  }

 private:
  std::vector<double> values_;  // [lane][start, end][row]
};

namespace umat {

// Lanes' histories at the end of a cycle go to n rows of the pack.
inline void keep_rows(const UmatLanes& lanes, int n, Pack* rows) {
  for (int lane = 0; lane < pack_width; ++lane)
    for (int i = 0; i < n; ++i) rows[i].set(lane, lanes.history[std::min(lane, lanes.count - 1)][i]);
}

}  // namespace umat

}  // namespace presswork
