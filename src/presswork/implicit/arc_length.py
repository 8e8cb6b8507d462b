# SPDX-License-Identifier: Apache-2.0
"""Arc length control: the load is an unknown too, so that limit points and snap-through can be passed.

Each increment moves the nodes by a given arc length s, |du| = s over the translations, and finds the part of the
stage's load that goes with it (Crisfield 1981: cylindrical arc; of its two roots the one that goes on as before). The
load fraction may fall during a stage; the stage is over when it has reached 1. Loads only: prescribed displacements and
tools have load control.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import stop
from presswork.implicit.linear.contract import SolverError
from presswork.implicit.linear.system import Balance
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.step_sizes import is_saved
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.contract import Constraints, Point, turn, turn_back
from presswork.interaction.loads import LoadArrays
from presswork.model import FloatArray, Model
from presswork.outcome import BadGuess, GaveUpError, IterationLog, Step
from presswork.state import State

SMALLEST = 1e-4
"""Arc length over the first one below which it gives up."""
SHARPEST = 0.5
"""Cosine of the angle between an increment and the path's tangents at its ends below which the arc is shortened: an arc
too long for the path's turns finds the part of the path that lies behind, and goes backwards."""
FEWEST = 5
"""Iterations below which arcs are short beside any turn of the path: more of them follow it no better."""
SHORTEST = 0.1
"""Arc length over the first one below which none is made that has found equilibrium, if only slowly."""
LARGEST = 20.0
"""Arc length over the first one beyond which it does not grow."""


@dataclass(frozen=True)
class _Found:
    """An increment in equilibrium."""

    trial: State
    point: Point
    constraints: Constraints
    log: IterationLog


class ArcLengthProcedure(ImplicitProcedure):
    """Advances a shell through its stages by arc length."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self._first_arcs: dict[int, float] = {}

    def _next_increment(self) -> IncrementReport:
        """Find the next point of the path; shorten the arc where there is none."""
        progress, settings = self.state[Progress], self.model.solver
        stage, fraction_n = progress.stage, progress.fraction
        first = self._first_arc(stage)
        arc = progress.next_size if progress.last_size != 0.0 else first
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
        trial, log = found.trial, found.log
        fraction = found.point.guess.step.fraction
        over = fraction >= 1.0 - 1e-12
        self._start = self.state
        self.equilibrium.forces.fill(self._start, trial, found.point, found.constraints)
        size = find_next_arc(arc, first, len(log), settings.target_iterations)
        self.end_increment(self._start, trial, self._step(stage, fraction_n, 1.0 if over else fraction))
        self._commit(trial, stage, fraction_n, 1.0 if over else fraction, arc, log, len(cutbacks))
        now = self.state[Progress]
        if not over:
            now.next_size = size
            now.last_size = arc
        return IncrementReport(
            number=now.increments,
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=now.time,
            log=log,
            cutbacks=cutbacks,
            is_save_point=is_saved(self.model, now.increments, fraction_n, fraction, at_end=over),
        )

    def _first_arc(self, stage: int) -> float:
        """Arc length [mm] of the undeformed sheet's answer to the first increment of load."""
        if stage not in self._first_arcs:
            state = self.at_rest()
            state.replace(self.state[LoadArrays].duplicate())
            increment = np.zeros_like(state.nodes.displacement)
            trial = state.duplicate()
            point = self._evaluate(state, trial, self._step(stage, 0.0, 0.0), increment)
            assert isinstance(point, Point), "the undeformed sheet can be evaluated"
            answer = self._tangents(state, trial, point)[1]
            self._first_arcs[stage] = self.model.solver.initial_increment * float(np.linalg.norm(answer[:, :3]))
        return self._first_arcs[stage]

    def _evaluate(self, state_n: State, trial: State, step: Step, increment: FloatArray) -> Point | BadGuess:
        """Return the forces of an increment in no time: laws with a rate are refused with arc length."""
        return self.equilibrium.forces.evaluate(state_n, trial, step, increment, with_stiffness=True, dt=0.0)

    def _tangents(self, state_n: State, trial: State, point: Point) -> tuple[FloatArray, FloatArray, Balance]:
        """Return what the forces out of balance and the whole load would move (n_points, 6), and the balance."""
        point, balance = self.equilibrium.forces.balance(state_n, trial, point)
        guess, constraints = point.guess, balance.constraints
        ends = [self.interactions.loads.at(state_n, guess.increment, guess.step.stage, f).force for f in (0.0, 1.0)]
        load = turn(constraints, ends[1] - ends[0])
        load[constraints.mask == 1] = 0.0
        system = self.equilibrium.system
        rhs = system.factorise(point, balance)
        moves = [system.solver.solve(b.reshape(-1)).reshape(load.shape) for b in (rhs, load)]
        return turn_back(constraints, moves[0]), turn_back(constraints, moves[1]), balance

    def _follow(self, stage: int, fraction_n: float, arc: float, *, end: bool = False) -> _Found | str:
        """Find equilibrium an arc further on, or at the end of the stage, or return the reason why not."""
        settings, mechanics = self.model.solver, self.mechanics
        state_n, trial, log = self.state, self.state.duplicate(), IterationLog()
        step_n = self._step(stage, fraction_n, fraction_n)
        point = self._evaluate(state_n, trial, step_n, np.zeros_like(state_n.nodes.displacement))
        peak = max(state_n[Progress].peak_force, mechanics.force_of_round_off())
        for iteration in range(settings.max_iterations + 1):
            stop.look()
            if isinstance(point, BadGuess):
                return str(point)
            increment, fraction = point.guess.increment, point.guess.step.fraction
            try:
                correction, answer, balance = self._tangents(state_n, trial, point)
            except SolverError as error:
                return str(error)
            largest = self.equilibrium.forces.largest_force(point)
            log.residual.append(balance.largest_lacking / max(largest, 1e-2 * peak))
            log.contact_changes.append(0)
            if iteration == 0:
                ahead_n = float((answer * state_n.nodes.increment)[:, :3].sum())
                begins = state_n[Progress].last_size == 0.0  # towards the load that the stage gives
                sign = 1.0 if begins or ahead_n == 0.0 else np.sign(ahead_n)
                change = float(sign) * arc / float(np.linalg.norm(answer[:, :3]))
                if end or fraction_n + change >= 1.0:  # the end of the stage lies within this arc: load control
                    change, end = 1.0 - fraction_n, True
                step, ahead = correction + change * answer, change * answer
            elif log.residual[-1] <= settings.force_tolerance and log.correction[-1] <= settings.displacement_tolerance:
                if fraction > 1.0 + 1e-12:
                    return self._follow(stage, fraction_n, arc, end=True)
                bends = min(_cosine(increment, ahead), abs(_cosine(increment, answer))) < SHARPEST
                if bends and not end:
                    return "the path turns too sharply"
                return _Found(trial, point, balance.constraints, log)
            else:
                change = 0.0 if end else _on_arc(increment, correction, answer, arc)
                step = correction + change * answer
            moved = increment + step
            size = float(np.abs(moved * mechanics.length).max())
            log.correction.append(float(np.abs(step * mechanics.length).max()) / size if size > 0 else 0.0)
            point = self._evaluate(state_n, trial, self._step(stage, fraction_n, fraction + change), moved)
        return f"no equilibrium after {len(log)} iterations, residual {log.residual[-1]:.1e}"


def find_next_arc(arc: float, first: float, iterations: int, target: int) -> float:
    """Return the length of the next arc [mm] after one that took so many iterations (Ramm 1981)."""
    factor = float(np.clip(np.sqrt(max(target, FEWEST) / iterations), 0.5, 1.5))
    return min(max(arc * factor, min(arc, SHORTEST * first)), LARGEST * first)


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
