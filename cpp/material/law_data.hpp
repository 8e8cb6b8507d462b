// SPDX-License-Identifier: Apache-2.0
// What a law's plain view points at, and who keeps it.
//
// A kernel sees a law as a plain struct (a view): numbers, and pointers to tables. Owned keeps the tables alive for as
// long as anybody has the law; it is what bindings and blocks hold.
#pragma once

#include <memory>
#include <vector>

#include "material/hardening.hpp"

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

}  // namespace presswork
