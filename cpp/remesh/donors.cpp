// SPDX-License-Identifier: Apache-2.0
#include "remesh/donors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tensor/pack.hpp"

namespace presswork {

namespace {

constexpr double reach = 1.05, least_weight = 1e-3, ridge = 1e-13;
constexpr int enough_for_squares = 8, enough_for_lines = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Donated = Pack[most_donors];

// Weights of the donors in the value at the origin of a weighted least-squares fit with the first K of a basis.
template <int K>
void find_weights(const Pack (&basis)[most_donors][6], const Donated& weight, Donated& result) {
  // 1. normal equations, lower triangle
  Pack matrix[K][K], trace = 0.0;
  for (int i = 0; i < K; ++i)
    for (int j = 0; j <= i; ++j) matrix[i][j] = 0.0;
  for (int d = 0; d < most_donors; ++d)
    for (int i = 0; i < K; ++i) {
      const Pack own = weight[d] * basis[d][i];
      for (int j = 0; j <= i; ++j) matrix[i][j] += own * basis[d][j];
    }
  for (int i = 0; i < K; ++i) trace += matrix[i][i];
  const Pack added = ridge * trace + 1e-300;
  for (int i = 0; i < K; ++i) matrix[i][i] += added;
  // 2. Cholesky's factors L D L'; round-off leaves no pivot below the ridge
  Pack inverse[K], scaled[K];
  for (int i = 0; i < K; ++i) {
    Pack pivot = matrix[i][i];
    for (int j = 0; j < i; ++j) {
      Pack sum = matrix[i][j];
      for (int k = 0; k < j; ++k) sum -= scaled[k] * matrix[j][k];
      scaled[j] = sum;
      matrix[i][j] = sum * inverse[j];
      pivot -= sum * matrix[i][j];
    }
    inverse[i] = Pack(1.0) / select(pivot > added, pivot, added);
  }
  // 3. the first column of the inverse
  Pack x[K];
  for (int i = 0; i < K; ++i) {
    x[i] = i == 0 ? 1.0 : 0.0;
    for (int k = 0; k < i; ++k) x[i] -= matrix[i][k] * x[k];
  }
  for (int i = 0; i < K; ++i) x[i] *= inverse[i];
  for (int i = K - 1; i >= 0; --i)
    for (int k = i + 1; k < K; ++k) x[i] -= matrix[k][i] * x[k];
  for (int d = 0; d < most_donors; ++d) {
    Pack value = 0.0;
    for (int i = 0; i < K; ++i) value += basis[d][i] * x[i];
    result[d] = weight[d] * value;
  }
}

// Donors seen from pack_width new points, over the distance of each one's last donor.
struct Offsets {
  Donated x, y, weight;
  int count[pack_width] = {};
  double over[pack_width];

  Offsets() {
    for (int d = 0; d < most_donors; ++d) x[d] = y[d] = weight[d] = 0.0;
  }

  // Adds the donor d of `own`, the last one first.
  void add(int lane, int d, int own, const double* at, const double* donor) {
    const double off[2] = {donor[0] - at[0], donor[1] - at[1]};
    if (d == own - 1) {
      const double farthest = std::sqrt(off[0] * off[0] + off[1] * off[1]);
      count[lane] = own, over[lane] = farthest > 0.0 ? 1.0 / farthest : 1.0;
    }
    x[d].set(lane, off[0] * over[lane]);
    y[d].set(lane, off[1] * over[lane]);
    weight[d].set(lane, 1.0);
  }
};

// Finds the weights of the donors of n new points.
void weigh(Offsets& off, int n, Fit* fits) {
  Pack basis[most_donors][6];
  for (int d = 0; d < most_donors; ++d) {
    const Pack x = off.x[d], y = off.y[d], values[6] = {1.0, x, y, x * x, x * y, y * y};
    std::copy(values, values + 6, basis[d]);
    const Pack near = Pack(1.0) - (values[3] + values[5]) * (1.0 / (reach * reach));
    const Pack least = select(near > Pack(least_weight), near, Pack(least_weight));
    off.weight[d] *= least * least;
  }
  Donated linear, quadratic;
  find_weights<3>(basis, off.weight, linear);
  find_weights<6>(basis, off.weight, quadratic);
  for (int lane = 0; lane < n; ++lane)
    for (int d = 0; d < most_donors; ++d) {
      const bool is_line = off.count[lane] >= enough_for_lines;
      fits[lane].linear_weight[d] = is_line ? linear[d][lane] : (d == 0 ? 1.0 : 0.0);
      fits[lane].weight[d] = off.count[lane] >= enough_for_squares ? quadratic[d][lane] : fits[lane].linear_weight[d];
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

bool Donors::is_peak(int point, int home, const double* position, const double* values, Scratch& scratch) const {
  Near found[most_donors];
  const int count = find(position + 2 * static_cast<std::size_t>(point), home, scratch, found);
  return std::all_of(found, found + count, [&](const Near& near) {
    const int other = of_cell_.value[near.place];
    return other == point || values[other] < values[point];
  });
}

void Donors::fit(const double* at, const int* home, int n, Scratch& scratch, Fit* fits) const {
  Offsets off;
  for (int lane = 0; lane < n; ++lane) {
    Near found[most_donors];
    const int own = find(at + 2 * lane, home[lane], scratch, found);
    for (int d = 0; d < most_donors; ++d)
      fits[lane].donor[d] = of_cell_.value[own > 0 ? found[d < own ? d : 0].place : 0];
    for (int d = own - 1; d >= 0; --d) off.add(lane, d, own, at + 2 * lane, &position_[2 * found[d].place]);
  }
  weigh(off, n, fits);
}

void refit(const double* position, const double* at, int n, Fit* fits) {
  Offsets off;
  for (int lane = 0; lane < n; ++lane) {
    const int* donor = fits[lane].donor;
    int own = 1;
    while (own < most_donors && donor[own] != donor[0]) ++own;
    for (int d = own - 1; d >= 0; --d)
      off.add(lane, d, own, at + 2 * lane, position + 2 * static_cast<std::size_t>(donor[d]));
  }
  weigh(off, n, fits);
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
