// SPDX-License-Identifier: Apache-2.0
// What a law's plain view points at, and who keeps it.
//
// A kernel sees a law as a plain struct (a view): numbers, and pointers to tables. Owned keeps the tables alive for as
// long as anybody has the law; it is what bindings and blocks hold.
#pragma once

#include <memory>
#include <vector>

#include "material/hardening.hpp"
#include "material/hot_hardening.hpp"

namespace presswork {

template <class View>
struct Owned {
  View view;
  std::vector<std::shared_ptr<const void>> data = {};  // what the view points at
};

// A hardening law from its parameters, as `fields` has them, or the rows of a table. False where their number is wrong.
inline bool make_hardening(HardeningLaw which, std::vector<double> parameters, Hardening& made,
                           std::vector<std::shared_ptr<const void>>& data) {
  bool fits = false;
  for_each_alternative<Hardening::Law>([&](std::size_t index, auto law) {
    if (static_cast<int>(index) != static_cast<int>(which)) return;
    if constexpr (requires { law.rows; }) {
      const std::size_t columns = law.columns, n = parameters.size();
      fits = n > 0 && n % columns == 0 && (columns == 2 || n > columns);
      auto rows = std::make_shared<const std::vector<double>>(std::move(parameters));
      law.rows = rows->data(), law.n_rows = static_cast<int>(n / columns);
      data.push_back(std::move(rows));
    } else {
      std::size_t count = 0;
      law.fields([&](const char*, double& value) {
        if (count < parameters.size()) value = parameters[count];
        ++count;
      });
      fits = count == parameters.size();
    }
    made.law = law;
  });
  return fits;
}

inline constexpr std::size_t cold_laws = std::variant_size_v<Hardening::Law>;  // of HardeningLaw; hot ones follow

// The rows of a table of strains, rates and temperatures, as hot_hardening::Table has them behind three numbers. False
// where their number is wrong.
inline bool read_hot_table(std::vector<double> parameters, hot_hardening::Table& table,
                           std::vector<std::shared_ptr<const void>>& data) {
  if (parameters.size() < 3) return false;
  std::size_t axes = 0, values = 1;
  for (int i = 0; i < 3; ++i) {
    if (!(parameters[i] >= 1.0 && parameters[i] < 1e6)) return false;
    table.n[i] = static_cast<int>(parameters[i]);
    axes += table.n[i], values *= table.n[i];
  }
  if (parameters.size() != 3 + axes + values) return false;
  auto rows = std::make_shared<const std::vector<double>>(std::move(parameters));
  const double *e = rows->data() + 3, *r = e + table.n[0], *t = r + table.n[1];
  table.rows = e;
  table.window = {e[0], r[-1], r[0], t[-1], t[0], t[table.n[2] - 1]};
  data.push_back(std::move(rows));
  return true;
}

// As make_hardening, for the laws of strain, rate and temperature together.
inline bool make_hot_hardening(HardeningLaw which, std::vector<double> parameters, HotHardening& made,
                               std::vector<std::shared_ptr<const void>>& data) {
  bool fits = false;
  for_each_alternative<HotHardening::Law>([&](std::size_t index, auto law) {
    if (static_cast<std::size_t>(which) != cold_laws + index) return;
    if constexpr (requires { law.rows; }) {
      fits = read_hot_table(std::move(parameters), law, data);
    } else {
      std::size_t count = 0;
      law.fields([&](const char*, double& value) {
        if (count < parameters.size()) value = parameters[count];
        ++count;
      });
      fits = count == parameters.size();
    }
    made.law = law, made.chosen = true;
  });
  return fits;
}

}  // namespace presswork
