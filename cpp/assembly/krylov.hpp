// SPDX-License-Identifier: Apache-2.0
// Stabilised bi-conjugate gradients (van der Vorst 1992) with the diagonal as preconditioner, for matrices that their
// diagonal conditions well, as the heat capacity does in short time steps. One thread, so the bits are always the same.
#pragma once

namespace presswork {

// Compressed rows; symmetric: only one triangle is stored.
struct SparseMatrix {
  int n;
  const int* indptr;   // (n + 1)
  const int* indices;  // (nnz)
  const double* data;  // (nnz)
  bool symmetric;
};

// Fill x (n), the solution to a residual of `tolerance` times that of rhs (n). Returns whether it is found within so
// many iterations; it is not for a diagonal that is not positive.
bool solve_iteratively(const SparseMatrix& matrix, const double* rhs, double tolerance, int most_iterations, double* x);

}  // namespace presswork
