# SPDX-License-Identifier: Apache-2.0
"""Arc length control: the load is an unknown too, so that limit points and snap-through can be passed.

Each increment moves the nodes by a given arc length s, |du| = s over the translations, and finds the part of the
stage's load that goes with it (Crisfield 1981: cylindrical arc; of its two roots the one that goes on as before).
The load fraction may fall on the way; the stage is over when it has reached 1. Loads only: prescribed displacements and
tools have load control.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import stop
from presswork.body.shells import ShellFailed, ShellMechanics
from presswork.implicit.linear_solver import SolverError
from presswork.implicit.stepping import (
    FRACTION,
    INCREMENTS,
    LAST,
    SIZE,
    STAGE,
    TIME,
    ImplicitProcedure,
    IncrementReport,
)
from presswork.interaction.contract import Constraints, Forces
from presswork.model import FloatArray, Model
from presswork.outcome import GaveUpError, IterationLog
from presswork.state import State

SMALLEST = 1e-4
"""Arc length over the first one below which it gives up."""
SHARPEST = 0.5
"""Cosine of the angle between an increment and the path's tangents at its ends below which the arc is shortened: an arc
too long for the path's turns finds the part of the path that lies behind, and goes backwards."""
LARGEST = 20.0
"""Arc length over the first one beyond which it does not grow."""


@dataclass(frozen=True)
class _Point:
    """A guess: increment (n_points, 6), load fraction, and the forces there."""

    increment: FloatArray
    fraction: float
    internal: FloatArray
    loads: Forces


@dataclass(frozen=True)
class _Found:
    """An increment in equilibrium."""

    trial: State
    point: _Point
    log: IterationLog


class ArcLengthProcedure(ImplicitProcedure):
    """Advances a shell through its stages by arc length."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self._first_arcs: dict[int, float] = {}

    def _next_increment(self) -> IncrementReport:
        """Find the next point of the path; shorten the arc where there is none."""
        progress, settings = self.state.progress, self.model.solver
        stage, fraction_n = int(progress[STAGE]), float(progress[FRACTION])
        first = self._first_arc(stage)
        arc = float(progress[SIZE]) if progress[LAST] != 0.0 else first
        cutbacks: list[str] = []
        while True:
            found = self._follow(stage, fraction_n, arc)
            if isinstance(found, _Found):
                break
            cutbacks.append(f"arc of {arc:.3g} mm: {found}")
            arc *= 0.5
            if arc < SMALLEST * first:
                raise GaveUpError(
                    f"stage {self.model.stages[stage].name!r} at {fraction_n:.2%}: even an arc of {arc:.1e} mm finds "
                    f"no equilibrium ({found}). Try a finer mesh"
                )
        trial, point, log = found.trial, found.point, found.log
        fraction, over = point.fraction, point.fraction >= 1.0 - 1e-12
        trial.displacement, trial.increment = self.state.displacement + point.increment, point.increment
        trial.reaction, trial.external_force = point.internal - point.loads.force, point.loads.force
        size = arc * float(np.clip(np.sqrt(settings.target_iterations / max(len(log), 1)), 0.5, 1.5))
        self._start = self.state
        self._commit(trial, stage, fraction_n, 1.0 if over else fraction, arc, log, len(cutbacks))
        now = self.state.progress
        if not over:
            now[SIZE] = min(size, LARGEST * first)
            now[LAST] = arc
        return IncrementReport(
            number=int(now[INCREMENTS]),
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=float(now[TIME]),
            log=log,
            cutbacks=cutbacks,
            is_save_point=self._is_save_point(fraction_n, fraction, over),
        )

    def _shells(self) -> ShellMechanics:
        assert isinstance(self.mechanics, ShellMechanics), "the case allows arc length for shells only"
        return self.mechanics

    def _first_arc(self, stage: int) -> float:
        """Arc length [mm] of the undeformed sheet's answer to the first increment of load."""
        if stage not in self._first_arcs:
            state = self._shells().at_rest()
            increment = np.zeros_like(state.displacement)
            point = self._evaluate(state, state.duplicate(), stage, increment, 0.0)
            assert isinstance(point, _Point), "the undeformed sheet can be evaluated"
            answer = self._tangents(state, stage, point)[1]
            self._first_arcs[stage] = self.model.solver.initial_increment * float(np.linalg.norm(answer[:, :3]))
        return self._first_arcs[stage]

    def _evaluate(
        self, state_n: State, trial: State, stage: int, increment: FloatArray, fraction: float
    ) -> _Point | ShellFailed:
        mechanics = self._shells()
        internal = mechanics.evaluate(state_n, trial, increment, with_stiffness=True)
        if isinstance(internal, ShellFailed):
            return internal
        loads = self.interactions.loads.at(state_n, increment, stage, fraction)
        return _Point(increment, fraction, internal, loads)

    def _tangents(self, state_n: State, stage: int, point: _Point) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return what the forces out of balance and the whole load would move (n_points, 6), and what is lacking."""
        mechanics, solver = self._shells(), self.equilibrium.solver
        constraints = self.interactions.supports.prescribe(state_n, stage, 0.0, point.increment)
        ends = [self.interactions.loads.at(state_n, point.increment, stage, f).force for f in (0.0, 1.0)]
        lacking = _turn(constraints, point.loads.force - point.internal)
        lacking[constraints.mask == 1] = 0.0
        data = np.zeros(len(mechanics.assembler.indices))
        mechanics.assemble_stiffness(constraints.turned, constraints.frames, data)
        if len(point.loads.pairs):
            mechanics.assembler.add_blocks(
                point.loads.pairs, point.loads.blocks, constraints.turned, constraints.frames, data
            )
        load = _turn(constraints, ends[1] - ends[0])
        load[constraints.mask == 1] = 0.0
        rhs, mask = lacking.reshape(-1).copy(), constraints.mask.reshape(-1)
        mechanics.assembler.constrain(mask, constraints.value.reshape(-1), float(data.max()), data, rhs)
        solver.factorise(data)
        moves = [solver.solve(b).reshape(lacking.shape) for b in (rhs, load.reshape(-1))]
        for move in moves:
            move[:, 3:] = np.einsum("nji,nj->ni", constraints.frames, move[:, 3:])
        return moves[0], moves[1], lacking

    def _follow(self, stage: int, fraction_n: float, arc: float, *, end: bool = False) -> _Found | str:
        """Find equilibrium an arc further on, or at the end of the stage, or say why not."""
        settings, mechanics = self.model.solver, self._shells()
        state_n, trial, log = self.state, self.state.duplicate(), IterationLog()
        point = self._evaluate(state_n, trial, stage, np.zeros_like(state_n.displacement), fraction_n)
        peak = max(float(state_n.peak_force[0]), mechanics.force_of_round_off())
        for iteration in range(settings.max_iterations + 1):
            stop.look()
            if isinstance(point, ShellFailed):
                return str(point)
            try:
                correction, answer, lacking = self._tangents(state_n, stage, point)
            except SolverError as error:
                return str(error)
            largest = max(float(np.abs(f / mechanics.length).max()) for f in (point.internal, point.loads.force))
            log.residual.append(float(np.abs(lacking / mechanics.length).max()) / max(largest, 1e-2 * peak))
            log.contact_changes.append(0)
            if iteration == 0:
                sign = 1.0 if not state_n.increment.any() else np.sign((answer * state_n.increment)[:, :3].sum())
                change = float(sign or 1.0) * arc / float(np.linalg.norm(answer[:, :3]))
                if end or fraction_n + change >= 1.0:  # the end of the stage lies within this arc: load control
                    change, end = 1.0 - fraction_n, True
                step, ahead = correction + change * answer, change * answer
            elif log.residual[-1] <= settings.force_tolerance and log.correction[-1] <= settings.displacement_tolerance:
                if point.fraction > 1.0 + 1e-12:
                    return self._follow(stage, fraction_n, arc, end=True)
                bends = min(_cosine(point.increment, ahead), abs(_cosine(point.increment, answer))) < SHARPEST
                if bends and not end:
                    return "the path turns too sharply"
                trial.peak_force = np.maximum(state_n.peak_force, largest)
                return _Found(trial, point, log)
            else:
                change = 0.0 if end else _on_arc(point.increment, correction, answer, arc)
                step = correction + change * answer
            moved = point.increment + step
            size = float(np.abs(moved * mechanics.length).max())
            log.correction.append(float(np.abs(step * mechanics.length).max()) / size if size > 0 else 0.0)
            point = self._evaluate(state_n, trial, stage, moved, point.fraction + change)
        return f"no equilibrium after {len(log)} iterations, residual {log.residual[-1]:.1e}"


def _turn(constraints: Constraints, vector: FloatArray) -> FloatArray:
    """Take the rotations of a nodal vector into the nodes' frames."""
    turned = vector.copy()
    turned[:, 3:] = np.einsum("nij,nj->ni", constraints.frames, vector[:, 3:])
    return turned


def _cosine(first: FloatArray, second: FloatArray) -> float:
    """Return the cosine of the angle between the translations of two increments (n_points, 6)."""
    u, v = first[:, :3], second[:, :3]
    size = float(np.linalg.norm(u) * np.linalg.norm(v))
    return float((u * v).sum()) / size if size > 0.0 else 1.0


def _on_arc(increment: FloatArray, correction: FloatArray, answer: FloatArray, arc: float) -> float:
    """Return the change of load that keeps the increment's translations on the arc, or brings them nearest to it.

    Near a limit load the correction alone may be longer than the arc; then no load leads back to it, and a shorter arc
    would only be missed by more.
    """
    u, v, w = increment[:, :3], correction[:, :3], answer[:, :3]
    start = u + v
    a, b = float((w * w).sum()), 2.0 * float((start * w).sum())
    c = float((start * start).sum()) - arc**2
    root = b**2 - 4.0 * a * c
    if root < 0.0:
        return -b / (2.0 * a)
    choices = [(-b + s * np.sqrt(root)) / (2.0 * a) for s in (1.0, -1.0)]
    chosen: float = max(choices, key=lambda x: float(((start + x * w) * u).sum()))
    return chosen
