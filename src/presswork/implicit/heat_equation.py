# SPDX-License-Identifier: Apache-2.0
"""One time step of the heat equation (cpp/assembly/heat_equation.hpp, docs/theory/heat.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.body.heat import Conduction
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import LinearSolver, SolverError
from presswork.interaction.heat.heat_films import Film
from presswork.model import FloatArray, IntArray, MaskArray, Model
from presswork.outcome import Failed, IterationLog
from presswork.timing import Timing

PRESCRIBED = "prescribed"
"""Kind under which the heat is counted that prescribed temperatures let in."""


@dataclass(frozen=True, kw_only=True)
class HeatProblem:
    """What a step is asked."""

    points: FloatArray
    """Where the nodes are at its end (n_points, d) [mm]."""
    temperature_n: FloatArray
    """Temperature at its start (n_points,) [degrees C]."""
    dt: float
    """[s]"""
    films: Sequence[Film]
    time: float
    """Time at its end, since the stage began [s]."""
    mask: MaskArray
    """Nodes whose temperature is prescribed (n_points,)."""
    prescribed: FloatArray
    """Their temperatures (n_points,) [degrees C]."""
    source: FloatArray | None = None
    """Heat made at the nodes (n_points,) [N mm/s]."""
    counted: int | None = None
    """The heat of the first so many nodes and of the others is counted apart; None: of all together."""


@dataclass(frozen=True)
class HeatStep:
    """A converged step."""

    temperature: FloatArray
    """(n_points,) [degrees C]."""
    power: Mapping[str, FloatArray]
    """Heat that flowed in by kind of film and by prescribed temperatures, into the nodes that are counted and into the
    others (2,) [N mm/s]."""
    log: IterationLog


_REASONS = {
    "unbounded": ("temperatures grow without bound", 0.25),
    "singular": ("the heat equation has no solution", 0.25),
    "no balance": ("no balance of heat after 25 iterations", 0.5),
}
"""Why there is no solution, and by what to shorten the step."""


class HeatEquation:
    """Solves the heat equation of a model, step by step; it keeps factors and pattern, no state."""

    def __init__(
        self, model: Model, couplings: IntArray, timing: Timing, threads: int, *, iterative: bool = False
    ) -> None:
        """Couplings: pairs of nodes (n, 2) that exchange heat and share no cell.

        iterative: solve by conjugate gradients where they find a solution quickly, as in short time steps.
        """
        self.conduction = Conduction(model, couplings)
        self._couplings, self._timing, self._threads, self._iterative = couplings, timing, threads, iterative
        self._solver: LinearSolver | None = None

    def couple(self, couplings: IntArray) -> None:
        """Let other pairs of nodes (n, 2) exchange heat from now on."""
        if np.array_equal(couplings, self._couplings):
            return
        self._couplings = couplings
        self.conduction.couple(couplings)
        self._solver = None

    @property
    def solver(self) -> LinearSolver:
        """The solver by factors, analysed for the present couplings."""
        if self._solver is None:
            assembler = self.conduction.assembler
            self._solver = make_solver(
                assembler.indptr, assembler.indices, symmetric=self.conduction.symmetric, threads=self._threads
            )
        return self._solver

    def solve(self, problem: HeatProblem, guess: FloatArray) -> HeatStep | Failed:
        """Find the temperatures at the end of a step from a guess at them (n_points,), or return the reason why not.

        Raises ValueError for a cell that is turned inside out.
        """
        found = self.conduction.equation.solve(
            self.conduction.assembler,
            points=problem.points,
            temperature_n=problem.temperature_n,
            dt=problem.dt,
            films=[film.at(problem.time) for film in problem.films],
            mask=problem.mask,
            prescribed=problem.prescribed,
            source=problem.source,
            counted=len(problem.mask) if problem.counted is None else problem.counted,
            guess=guess,
            iterative=self._iterative,
            direct=self._solve_by_factors,
        )
        self._timing.add_seconds("assembly", found.assembly_seconds)
        self._timing.add_seconds("solve", found.solve_seconds)
        log = IterationLog(found.residual, found.correction)
        if found.outcome == "turned cell":
            raise ValueError(f"cell {found.cell + 1} of block {found.block + 1} is turned inside out")
        if found.outcome != "converged":
            return Failed(log, *_REASONS[found.outcome])
        power: dict[str, FloatArray] = {}
        kinds = [*(film.kind for film in problem.films), PRESCRIBED]
        for kind, each in zip(kinds, found.power, strict=True):
            power[kind] = power[kind] + each if kind in power else each
        return HeatStep(np.asarray(found.temperature), power, log)

    def _solve_by_factors(self, fresh: bool, data: FloatArray, rhs: FloatArray) -> FloatArray | None:
        """Return a correction by the direct solver, which keeps the factors of the last fresh matrix."""
        try:
            if fresh:
                self.solver.factorise(data.copy())
            return self.solver.solve(rhs)
        except SolverError:
            return None
