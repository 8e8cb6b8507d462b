# SPDX-License-Identifier: Apache-2.0
"""One time step of the heat equation by backward Euler and Newton's method (docs/theory/heat.md).

    (H(T) - H(T_n)) / dt + K(T) T = power of the films + sources

H is the heat content of the lumped masses, so that what a step stores is what flows in, to the tolerance of the
iteration, however the specific heat depends on temperature.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.body.heat import Conduction
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import LinearSolver, SolverError
from presswork.interaction.heat_films import Film, HeatFlow
from presswork.model import FloatArray, IntArray, MaskArray, Model
from presswork.outcome import Failed, IterationLog
from presswork.timing import Timing

MOST_ITERATIONS = 25
RESIDUAL = 1e-11
"""Largest out-of-balance over the sum of all heat flows."""
WORN = 1e-2
"""Part of what is out of balance that a correction leaves at most if its matrix is to serve again."""
INEXACT, FINEST = 1e-7, 1e-12
"""Largest and smallest residual of a correction found by iterations, over what is out of balance."""
MOST_INNER = 80
"""Such iterations beyond which factors are cheaper."""
CORRECTION = 1e-10
"""Largest correction [K] over the largest temperature: nothing smaller is worth an iteration."""
PRESCRIBED = "prescribed"
"""Kind under which the heat is counted that prescribed temperatures let in."""


@dataclass(frozen=True, kw_only=True)
class HeatProblem:
    """What a step is asked."""

    points: FloatArray
    """Where the nodes are at its end (n_points, d) [mm]."""
    temperature_n: FloatArray
    """At its start (n_points,) [degrees C]."""
    dt: float
    """[s]"""
    films: Sequence[Film]
    time: float
    """Of its end, since the stage began [s]."""
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
    """Heat that flowed in by kind of film, by prescribed temperatures and by sources, into the nodes that are counted
    and into the others (2,) [N mm/s]."""
    log: IterationLog


@dataclass(frozen=True)
class _Balance:
    """Heat flows at one guess."""

    residual: FloatArray
    capacity: FloatArray
    given: Sequence[HeatFlow]
    largest: float
    """Sum of all flows [N mm/s]."""


@dataclass
class _Matrix:
    """Newton's matrix."""

    data: FloatArray
    """(nnz,)."""
    is_factorised: bool = False
    """Whether the solver has the factors of it."""


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
            started = perf_counter()
            self._solver = make_solver(
                assembler.indptr, assembler.indices, symmetric=self.conduction.symmetric, threads=self._threads
            )
            self._timing.add("solve", started)
        return self._solver

    def solve(self, problem: HeatProblem, guess: FloatArray) -> HeatStep | Failed:
        """Find the temperatures at the end of a step from a guess at them (n_points,), or say why not.

        Newton's matrix of the first guess serves for all corrections as long as it brings each of them near.
        """
        mask = problem.mask
        temperature = np.where(mask != 0, problem.prescribed, guess)
        content_n, _ = self.conduction.content(problem.temperature_n)
        log = IterationLog()
        finished, matrix = False, None
        for _ in range(MOST_ITERATIONS):
            found = self._evaluate(problem, content_n, temperature, with_matrix=matrix is None)
            out = float(np.abs(found.residual[mask == 0]).sum())
            if not np.isfinite(out):
                return Failed(log, "temperatures grow without bound", 0.25)
            if finished or out <= RESIDUAL * found.largest:
                return HeatStep(temperature, _count(problem, found), log)
            relative = out / found.largest
            if matrix is not None and relative > WORN * log.residual[-1]:
                found, matrix = self._evaluate(problem, content_n, temperature, with_matrix=True), None
            if matrix is None:
                matrix = self._assemble(problem, found)
            change = self._correct(matrix, np.where(mask != 0, 0.0, -found.residual), 0.1 * RESIDUAL / relative)
            if change is None:
                return Failed(log, "the heat equation has no solution", 0.25)
            temperature = temperature + change
            log.residual.append(relative)
            log.correction.append(float(np.abs(change).max()))
            finished = log.correction[-1] <= CORRECTION * max(1.0, float(np.abs(temperature).max()))
        return Failed(log, f"no balance of heat after {MOST_ITERATIONS} iterations", 0.5)

    def _evaluate(
        self, problem: HeatProblem, content_n: FloatArray, temperature: FloatArray, *, with_matrix: bool
    ) -> _Balance:
        """Return what is out of balance at a guess."""
        started = perf_counter()
        content, capacity = self.conduction.content(temperature)
        stored = (content - content_n) / problem.dt
        flow = self.conduction.conduct(problem.points, temperature, with_matrix=with_matrix)
        given = [film.evaluate(temperature, problem.time) for film in problem.films]
        residual = stored + flow
        for each in given:
            residual -= each.power
        if problem.source is not None:
            residual -= problem.source
        largest = sum(float(np.abs(part).sum()) for part in (stored, flow, *(each.power for each in given)))
        self._timing.add("assembly", started)
        return _Balance(residual, capacity / problem.dt, given, largest)

    def _assemble(self, problem: HeatProblem, found: _Balance) -> _Matrix:
        """Return the derivative of what is out of balance, prescribed temperatures held."""
        started = perf_counter()
        diagonal = found.capacity + sum(each.slope for each in found.given)
        coupled = [each.coupled for each in found.given if each.coupled is not None]
        data = self.conduction.assemble(diagonal, coupled)
        scale, none = float(np.abs(diagonal).max()) or 1.0, np.zeros(len(diagonal))
        self.conduction.assembler.constrain(problem.mask, none, scale, data, none.copy())
        self._timing.add("assembly", started)
        return _Matrix(data)

    def _correct(self, matrix: _Matrix, rhs: FloatArray, accuracy: float) -> FloatArray | None:
        """Return Newton's correction, None if the matrix is singular. accuracy: residual over that before."""
        if self._iterative:
            started, assembler = perf_counter(), self.conduction.assembler
            change = _core.solve_iteratively(
                assembler.indptr,
                assembler.indices,
                matrix.data,
                rhs,
                symmetric=self.conduction.symmetric,
                tolerance=min(max(accuracy, FINEST), INEXACT),
                most_iterations=MOST_INNER,
            )
            self._timing.add("solve", started)
            if change is not None:
                return change
        solver, started = self.solver, perf_counter()
        try:
            if not matrix.is_factorised:
                solver.factorise(matrix.data)
                matrix.is_factorised = True
            return solver.solve(rhs)
        except SolverError:
            return None
        finally:
            self._timing.add("solve", started)


def _count(problem: HeatProblem, found: _Balance) -> dict[str, FloatArray]:
    """Return the heat that flows in, by kind (2,) [N mm/s]."""
    n = len(problem.mask) if problem.counted is None else problem.counted

    def apart(flow: FloatArray) -> FloatArray:
        return np.array([flow[:n].sum(), flow[n:].sum()])

    power = {PRESCRIBED: apart(np.where(problem.mask != 0, found.residual, 0.0))}
    for film, each in zip(problem.films, found.given, strict=True):
        power[film.kind] = power.get(film.kind, np.zeros(2)) + apart(each.power)
    if problem.source is not None:
        power["source"] = apart(problem.source)
    return power
