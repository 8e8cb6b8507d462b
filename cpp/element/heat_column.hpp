// SPDX-License-Identifier: Apache-2.0
// Heat in a row of finite volumes behind a surface, by backward Euler: a tridiagonal system with one matrix for all
// rows of a steel, solved by elimination (Thomas).
//
//   (C_i / dt) (T_i - T_n,i) = k_i-1 (T_i-1 - T_i) + k_i (T_i+1 - T_i)
#pragma once

#include <cstddef>
#include <vector>

namespace presswork {

class HeatColumn {
 public:
  // capacity (n) of the volumes over an area of 1 mm2 [N/(mm K)], between (n - 1): conductance from each volume to the
  // next [N/(mm s K)].
  HeatColumn(std::vector<double> capacity, std::vector<double> between)
      : capacity_(std::move(capacity)), between_(std::move(between)), storage_(size()), pivot_(size()) {}

  std::size_t size() const { return capacity_.size(); }

  void set_step(double dt) {
    const std::size_t n = size();
    for (std::size_t i = 0; i < n; ++i) {
      storage_[i] = capacity_[i] / dt;
      double diagonal = storage_[i] + (i > 0 ? between_[i - 1] : 0.0) + (i + 1 < n ? between_[i] : 0.0);
      if (i > 0) diagonal -= between_[i - 1] * between_[i - 1] * pivot_[i - 1];
      pivot_[i] = 1.0 / diagonal;
    }
  }

  // Temperatures after the step without a flux at the surface (n), from those before it.
  void rest(const double* before, double* after) const {
    for (std::size_t i = 0; i < size(); ++i) after[i] = storage_[i] * before[i];
    solve(after);
  }

  // What a flux of 1 into the surface adds to them (n) [K mm s/N].
  void answer(double* added) const {
    for (std::size_t i = 0; i < size(); ++i) added[i] = i == 0 ? 1.0 : 0.0;
    solve(added);
  }

 private:
  void solve(double* x) const {
    const std::size_t n = size();
    for (std::size_t i = 1; i < n; ++i) x[i] += between_[i - 1] * pivot_[i - 1] * x[i - 1];
    x[n - 1] *= pivot_[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) x[i] = (x[i] + between_[i] * x[i + 1]) * pivot_[i];
  }

  std::vector<double> capacity_, between_, storage_, pivot_;  // pivot: inverse
};

}  // namespace presswork
