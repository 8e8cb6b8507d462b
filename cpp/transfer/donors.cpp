// SPDX-License-Identifier: Apache-2.0
#include "transfer/donors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace presswork {

namespace {

constexpr double reach = 1.05, least_weight = 1e-3, ridge = 1e-13;
constexpr int enough_for_squares = 8, enough_for_lines = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Weights of the donors in the value at the origin of a weighted least-squares fit with the first K of a basis.
template <int K>
void find_weights(const double (&basis)[most_donors][6], const double* weight, int n, double* result) {
  // 1. normal equations, lower triangle
  double matrix[K][K] = {};
  for (int d = 0; d < n; ++d)
    for (int i = 0; i < K; ++i) {
      const double own = weight[d] * basis[d][i];
      for (int j = 0; j <= i; ++j) matrix[i][j] += own * basis[d][j];
    }
  double trace = 0.0;
  for (int i = 0; i < K; ++i) trace += matrix[i][i];
  const double added = ridge * std::max(trace, 1e-300);
  for (int i = 0; i < K; ++i) matrix[i][i] += added;
  // 2. Cholesky's factors L D L'; round-off leaves no pivot below the ridge
  double pivot[K];
  for (int i = 0; i < K; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = matrix[i][j];
      for (int k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k] * pivot[k];
      if (j < i)
        matrix[i][j] = sum / pivot[j];
      else
        pivot[i] = std::max(sum, added);
    }
  }
  // 3. the first column of the inverse
  double x[K];
  for (int i = 0; i < K; ++i) {
    x[i] = i == 0 ? 1.0 : 0.0;
    for (int k = 0; k < i; ++k) x[i] -= matrix[i][k] * x[k];
  }
  for (int i = 0; i < K; ++i) x[i] /= pivot[i];
  for (int i = K - 1; i >= 0; --i)
    for (int k = i + 1; k < K; ++k) x[i] -= matrix[k][i] * x[k];
  for (int d = 0; d < n; ++d) {
    double value = 0.0;
    for (int i = 0; i < K; ++i) value += basis[d][i] * x[i];
    result[d] = weight[d] * value;
  }
}

}  // namespace

Donors::Donors(const double* position, const int* cell_of, int n, Cells cells)
    : neighbours_(find_neighbours(cells)),
      of_cell_(gather_by_key(cell_of, n, cells.n)),
      position_(2 * static_cast<std::size_t>(n)),
      box_(cells.n, {{infinity, infinity}, {-infinity, -infinity}}) {
  for (int place = 0; place < n; ++place) {
    const int point = of_cell_.value[place];
    Box& box = box_[cell_of[point]];
    for (int k = 0; k < 2; ++k) {
      const double x = position_[2 * place + k] = position[2 * static_cast<std::size_t>(point) + k];
      box.low[k] = std::min(box.low[k], x), box.high[k] = std::max(box.high[k], x);
    }
  }
}

int Donors::find(const double* at, int home, Scratch& scratch, Near* found) const {
  int count = 0;
  const auto is_too_far = [&](const Box& box) {
    if (count < most_donors || box.low[0] > box.high[0]) return false;  // an empty cell leads on
    double square = 0.0;
    for (int k = 0; k < 2; ++k) {
      const double off = std::max({box.low[k] - at[k], at[k] - box.high[k], 0.0});
      square += off * off;
    }
    return square > found[most_donors - 1].square;
  };
  const auto insert = [&](int place) {
    const double off[2] = {position_[2 * place] - at[0], position_[2 * place + 1] - at[1]};
    const Near own{off[0] * off[0] + off[1] * off[1], place};
    const auto is_nearer = [&](const Near& other) {
      return own.square < other.square || (own.square == other.square && own.place < other.place);
    };
    if (count == most_donors && !is_nearer(found[count - 1])) return;
    int k = count < most_donors ? count++ : count - 1;
    for (; k > 0 && is_nearer(found[k - 1]); --k) found[k] = found[k - 1];
    found[k] = own;
  };
  ++scratch.now;
  scratch.front.assign(1, home);
  scratch.stamp[home] = scratch.now;
  for (int ring = 0; ring <= rings && !scratch.front.empty(); ++ring) {
    scratch.next.clear();
    for (int cell : scratch.front) {
      if (is_too_far(box_[cell])) continue;
      for (int place = of_cell_.begin[cell]; place < of_cell_.begin[cell + 1]; ++place) insert(place);
      for (int other : neighbours_[cell]) {
        if (scratch.stamp[other] == scratch.now) continue;
        scratch.stamp[other] = scratch.now;
        scratch.next.push_back(other);
      }
    }
    scratch.front.swap(scratch.next);
  }
  return count;
}

Fit Donors::fit(const double* at, int home, Scratch& scratch) const {
  Near found[most_donors];
  const int n = find(at, home, scratch, found);
  Fit fit{};
  double basis[most_donors][6], weight[most_donors];
  const double farthest = n > 0 ? std::sqrt(found[n - 1].square) : 0.0, length = farthest > 0.0 ? farthest : 1.0;
  for (int d = 0; d < most_donors; ++d) fit.donor[d] = n > 0 ? of_cell_.value[found[d < n ? d : 0].place] : 0;
  for (int d = 0; d < n; ++d) {
    const double x = (position_[2 * found[d].place] - at[0]) / length;
    const double y = (position_[2 * found[d].place + 1] - at[1]) / length;
    const double values[6] = {1.0, x, y, x * x, x * y, y * y};
    std::copy(values, values + 6, basis[d]);
    const double near = std::max(1.0 - (x * x + y * y) / (reach * reach), least_weight);
    weight[d] = near * near;
  }
  if (n < enough_for_lines) {
    fit.weight[0] = fit.linear_weight[0] = 1.0;
    return fit;
  }
  find_weights<3>(basis, weight, n, fit.linear_weight);
  if (n < enough_for_squares)
    std::copy(fit.linear_weight, fit.linear_weight + most_donors, fit.weight);
  else
    find_weights<6>(basis, weight, n, fit.weight);
  return fit;
}

void apply_fit(const int* donor, const double* weight, const double* linear_weight, int n_new, const double* values,
               int m, double* result) {
#pragma omp parallel for schedule(static) if (n_new > 2000)  // waking a thread takes longer than a short loop
  for (int i = 0; i < n_new; ++i) {
    const int* from = donor + static_cast<std::size_t>(most_donors) * i;
    const double* own = weight + static_cast<std::size_t>(most_donors) * i;
    const double* own_linear = linear_weight + static_cast<std::size_t>(most_donors) * i;
    const double* nearest = values + static_cast<std::size_t>(m) * from[0];
    for (int c = 0; c < m; ++c) {
      double linear = 0.0, square = 0.0, low = infinity, high = -infinity;
      for (int d = 0; d < most_donors; ++d) {
        const double given = values[static_cast<std::size_t>(m) * from[d] + c] - nearest[c];
        linear += own_linear[d] * given, square += own[d] * given;
        low = std::min(low, given), high = std::max(high, given);
      }
      result[static_cast<std::size_t>(m) * i + c] =
          nearest[c] + std::clamp(square, std::min(low, linear), std::max(high, linear));
    }
  }
}

}  // namespace presswork
