# SPDX-License-Identifier: Apache-2.0
"""Linear systems: the matrix of all stiffnesses, and the solvers behind one contract."""
