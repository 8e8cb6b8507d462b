// SPDX-License-Identifier: Apache-2.0
#include "assembly/krylov.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace presswork {

namespace {

using Vector = std::vector<double>;

double sum(const Vector& a, const Vector& b) {
  double lanes[4] = {0.0, 0.0, 0.0, 0.0};
  const std::size_t n = a.size();
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t l = 0; l < 4; ++l) lanes[l] += a[i + l] * b[i + l];
  for (; i < n; ++i) lanes[0] += a[i] * b[i];
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

double norm(const Vector& a) { return std::sqrt(sum(a, a)); }

Vector take_diagonal(const SparseMatrix& matrix) {
  Vector diagonal(matrix.n, 0.0);
  for (int i = 0; i < matrix.n; ++i)
    for (int k = matrix.indptr[i]; k < matrix.indptr[i + 1]; ++k)
      if (matrix.indices[k] == i) diagonal[i] += matrix.data[k];
  return diagonal;
}

void multiply(const SparseMatrix& matrix, const Vector& x, Vector& y) {
  const auto* indices = matrix.indices;
  const auto* data = matrix.data;
  for (int i = 0; i < matrix.n; ++i) {
    double row = 0.0;
    for (int k = matrix.indptr[i]; k < matrix.indptr[i + 1]; ++k) row += data[k] * x[indices[k]];
    y[i] = row;
  }
  if (!matrix.symmetric) return;
  for (int i = 0; i < matrix.n; ++i)
    for (int k = matrix.indptr[i]; k < matrix.indptr[i + 1]; ++k)
      if (indices[k] != i) y[indices[k]] += data[k] * x[i];
}

}  // namespace

bool solve_iteratively(const SparseMatrix& matrix, const double* rhs, double tolerance, int most_iterations,
                       double* x) {
  const int n = matrix.n;
  const Vector diagonal = take_diagonal(matrix);
  if (!std::all_of(diagonal.begin(), diagonal.end(), [](double d) { return d > 0.0; })) return false;
  const Vector shadow(rhs, rhs + n);
  Vector r = shadow, p(n, 0.0), v(n, 0.0), s(n), t(n), direction(n), second(n);
  std::fill(x, x + n, 0.0);
  double rho = 1.0, alpha = 1.0, omega = 1.0;
  const double goal = tolerance * norm(shadow);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (norm(r) <= goal) return true;
    const double rho_n = rho;
    rho = sum(shadow, r);
    if (rho == 0.0 || omega == 0.0) return false;
    const double beta = (rho / rho_n) * (alpha / omega);
    for (int i = 0; i < n; ++i) {
      p[i] = r[i] + beta * (p[i] - omega * v[i]);
      direction[i] = p[i] / diagonal[i];
    }
    multiply(matrix, direction, v);
    const double across = sum(shadow, v);
    alpha = rho / (across != 0.0 ? across : 1e-300);
    for (int i = 0; i < n; ++i) {
      s[i] = r[i] - alpha * v[i];
      second[i] = s[i] / diagonal[i];
    }
    multiply(matrix, second, t);
    const double length = sum(t, t);
    omega = sum(t, s) / (length != 0.0 ? length : 1e-300);
    for (int i = 0; i < n; ++i) {
      x[i] += alpha * direction[i] + omega * second[i];
      r[i] = s[i] - omega * t[i];
    }
  }
  return false;
}

}  // namespace presswork
