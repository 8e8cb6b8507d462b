// SPDX-License-Identifier: Apache-2.0
// The tables that a law's view points at: what has to be copied where a device computes the law.
#pragma once

#include "element/layered_section.hpp"
#include "material/von_mises.hpp"

namespace presswork::device {

// Calls f(pointer, n) for each table of n numbers; the pointer may be changed.
template <class F>
void for_each_table(TabulatedHardening& table, const F& f) {
  if (!table.rows) return;
  const std::size_t n = 4 * static_cast<std::size_t>(table.last + 1);
  f(table.rows, n);
  if (table.float_rows) f(table.float_rows, n);
}

template <class F>
void for_each_table(Hardening& hardening, const F& f) {
  std::visit(
      [&](auto& law) {
        if constexpr (requires { law.n_rows; })
          if (law.rows) f(law.rows, static_cast<std::size_t>(law.n_rows) * law.columns);
      },
      hardening.law);
}

template <class F>
void for_each_table(Flow& flow, const F& f) {
  for_each_table(flow.hardening, f);
  if (auto* hot = std::get_if<hot_hardening::Table>(&flow.hot.law); hot && hot->rows) {
    const std::size_t e = hot->n[0], r = hot->n[1], t = hot->n[2];
    f(hot->rows, e + r + t + e * r * t);
  }
  for_each_table(flow.table, f);
}

template <class F>
void for_each_table(FastMises& law, const F& f) {
  for_each_table(law.hardening, f);
}

template <class F>
void for_each_table(VonMises& law, const F& f) {
  for_each_table(law.hardening, f);
}

template <int N, class F>
void for_each_table(ElasticPlastic<N>& law, const F& f) {
  for_each_table(law.flow, f);
  Thermoelastic& heat = law.thermoelastic;
  for (TemperatureCurve* curve : {&heat.expansion, &heat.young_factor, &heat.poisson})
    if (curve->given()) f(curve->rows, static_cast<std::size_t>(curve->n_rows) * TemperatureCurve::columns);
}

template <class F>
void for_each_table(GeneralSheet& sheet, const F& f) {
  for_each_table(sheet.law, f);
}

}  // namespace presswork::device
