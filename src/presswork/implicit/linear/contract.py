# SPDX-License-Identifier: Apache-2.0
"""The contract of a solver of linear systems."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from presswork.model import FloatArray


class SolverError(Exception):
    """The matrix could not be factorised: it is singular. Too little memory is a MemoryError."""


Modes = Callable[[], FloatArray]
"""Makes the rigid motions of the nodes (n, 6), in their own frames, zero where a freedom is prescribed."""


@dataclass(frozen=True)
class Iterations:
    """How an iterative solver found a solution."""

    count: int
    residual: float
    """Norm of the residual over that of the right-hand side."""
    remark: str = ""
    """Why the matrix was factorised after all."""

    def __str__(self) -> str:
        return f"factors ({self.remark})" if self.remark else f"{self.count} to {self.residual:.0e}"


class LinearSolver(Protocol):
    """A solver for one sparsity pattern."""

    name: str

    @property
    def negative_pivots(self) -> int:
        """Number of negative pivots of the last factors, as far as the solver reports it: a positive number is sure."""

    @property
    def iterations(self) -> Iterations | None:
        """Return the iterations of the last solution; None where it came from factors."""

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        """Take the matrix with these values."""

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution for one right-hand side. Raises SolverError."""

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        """Return the solutions (k, n) for several right-hand sides (k, n). Raises SolverError."""
