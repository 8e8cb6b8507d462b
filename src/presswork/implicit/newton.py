# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of one increment: full or modified Newton with the active sets of interactions and a line search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork import stop
from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.line_search import take_correction
from presswork.implicit.linear.contract import LinearSolver, SolverError
from presswork.implicit.linear.system import Balance, LinearSystem
from presswork.implicit.nodal_forces import NodalForces
from presswork.implicit.progress import Progress
from presswork.interaction.contract import Interaction, Point
from presswork.interaction.placing import LostWorkpieceError
from presswork.model import FloatArray, Model
from presswork.outcome import BadGuess, Converged, Failed, IterationLog, Step
from presswork.state import State
from presswork.timing import Timing

NEAR = 0.1
"""Relative residual below which reactions are trusted to let nodes go."""
UNLOADED = 1e-2
"""Forces below this part of the largest so far count as nothing: residuals are measured against no less."""
CREDIBLE = 1e-2
"""A pull below this part of what is out of balance lets no node go."""
CALM = 1e-2
"""Relative residual at which soft springs are stiffened."""
KEPT = 0.1
"""Part of what is out of balance that a correction may leave, and the next one be found with the same factors."""
SOFT, STIFFENING = 300.0, 4.0
"""Gentle attempts: how many times softer springs begin, and by what they are stiffened each time."""
PUSHED = 1e-4
"""Part of the force that pushes a tool, or of the largest nodal force if that is more, which the tool may lack."""
STAGNANT = 0.1
"""Residual over its tolerance below which the last correction's size does not matter."""
CLOSE = 1e-6
"""Distance of constrained nodes from their places that is then close enough, over the model's size."""
ROUND_OFF = 2.0**-52
"""Size of corrections that no longer move nodes, over the model's size."""
FAINT = 1e-6
"""Relative residual below which round-off alone can leave one."""
LOST = 0.6
"""Correction over the increment above which an attempt that began from a good guess is given up."""
MOST_AUGMENTATIONS = 10
"""Most times that an increment takes over multipliers."""


@dataclass(frozen=True)
class Augmentation:
    """Equilibrium with multipliers that were not good enough, which were then taken over."""

    nodes: FloatArray
    """Increment of the nodes (n_points, freedoms) [mm, rad]."""
    travel: FloatArray
    """Travel of freedoms that interactions own (n,)."""
    by: Sequence[int]
    """The interactions that took over theirs, by their numbers."""


class Equilibrium:
    """Solves increments of one model; holds the matrix and its factors, but nothing that a restart would need."""

    def __init__(
        self,
        model: Model,
        mechanics: Mechanics | ShellMechanics,
        interactions: Sequence[Interaction],
        timing: Timing,
        threads: int,
    ) -> None:
        self._model = model
        self._mechanics = mechanics
        self._interactions = interactions
        self.forces = NodalForces(mechanics, interactions, timing)
        self.system = LinearSystem(model, mechanics, interactions, timing, threads)
        self._noise = mechanics.force_of_round_off()
        extent = float(np.ptp(model.mesh.points, axis=0).max())
        self._close, self._least = CLOSE * extent, ROUND_OFF * extent
        self._softness = 1.0
        self.augmented_at: list[Augmentation] = []
        """Where multipliers were taken over in the last solution."""
        self._tangent_is_consistent = (
            model.solver.newton == "full"
            and model.solver.tangent == "consistent"
            and all(i.has_consistent_tangent for i in interactions)
        )

    @property
    def solver(self) -> LinearSolver:
        """The linear solver, which holds the last factors."""
        return self.system.solver

    @property
    def can_soften(self) -> bool:
        """Whether an increment that fails is worth a gentle attempt."""
        return any(i.can_soften for i in self._interactions)

    def _soften(self, softness: float) -> None:
        """Take the springs of interactions so many times softer than they are."""
        self._softness = softness
        for interaction in self._interactions:
            if interaction.can_soften:
                interaction.softness = softness

    def _largest(self, change: FloatArray) -> float:
        """Largest change of a freedom, made a length [mm]."""
        return float(np.abs(change * self._mechanics.length).max())

    def solve(
        self,
        state_n: State,
        trial: State,
        step: Step,
        guess: FloatArray,
        *,
        gently: bool = False,
        is_led: bool = False,
        keeps_factors: bool = False,
    ) -> Converged | Failed:
        """Find the trial state at step.fraction. state_n is not touched; trial is in equilibrium if Converged.

        gently: begin with soft springs and stiffen them as equilibrium comes near; takes more iterations. is_led: the
        guess is good, so that corrections larger than the increment itself lead nowhere. keeps_factors: full Newton
        keeps its factors while each correction leaves less than KEPT of what was out of balance.
        """
        log, size, factorised = IterationLog(), 0.0, False
        self._soften(SOFT if gently else 1.0)
        point = self._begin(state_n, trial, step, guess)
        if isinstance(point, BadGuess):
            return Failed(log, str(point), point.factor)
        most = self._model.solver.max_iterations * (2 if gently else 1)
        for iteration in range((most + 1) * (MOST_AUGMENTATIONS + 1)):
            stop.look()
            # 1. what holds the nodes at the present guess, and what is out of balance
            stiff = self._softness == 1.0
            point, balance, has_converged = self._find_balance(state_n, trial, point, log, size)
            # 2. in equilibrium? Else nearer to it with stiffer springs
            if has_converged:
                augmented = self._augment(state_n, trial, point)
                if augmented is None:
                    return self._complete(state_n, trial, point, balance, log)
                if len(log.augmented) == MOST_AUGMENTATIONS:
                    break
                point = augmented
                log.augmented.append(len(log))
                log.start = len(log)
                continue
            if iteration > 0 and log.residual[-1] < CALM:
                self._soften(max(1.0, self._softness / STIFFENING))
            if len(log) - log.since_augmented > most or (stiff and self._is_hopeless(log)):
                break
            if is_led and iteration > 1 and log.correction[-1] > LOST:
                return Failed(log, f"a correction is {log.correction[-1]:.2g} times the increment", 0.5)
            # 3. correction; constrained freedoms go all the way to where they must be
            keeps = keeps_factors and len(log) > 1 and log.residual[-1] < KEPT * log.residual[-2]
            try:
                refactorise = not factorised or self._needs_new_factors(balance, size, keeps=keeps)
                correction, travel = self.system.correct(balance, point, refactorise=refactorise)
            except (SolverError, LostWorkpieceError) as error:
                return Failed(log, str(error), 0.25)
            factorised = True
            log.solutions += [str(self.system.iterations)] if self.system.iterations else []
            moved = self._advance(state_n, trial, point, balance, correction, travel)
            if isinstance(moved, BadGuess):
                return Failed(log, str(moved), moved.factor)
            point = moved
            size = max(self._largest(correction), float(np.abs(travel).max(initial=0.0)))
        return Failed(log, f"no equilibrium after {len(log)} iterations, residual {log.residual[-1]:.1e}", 0.5)

    def _begin(self, state_n: State, trial: State, step: Step, guess: FloatArray) -> Point | BadGuess:
        """Return the forces at a first guess; at none where it cannot be evaluated."""
        self.forces.begin(state_n, step)
        self.augmented_at = []
        point = self.forces.evaluate(state_n, trial, step, guess, with_stiffness=True)
        if not isinstance(point, BadGuess) or point.is_final:
            return point
        for interaction in self._interactions:
            interaction.discard_guess(state_n, trial)
        return self.forces.evaluate(state_n, trial, step, np.zeros_like(guess), with_stiffness=True)

    def _find_balance(
        self, state_n: State, trial: State, point: Point, log: IterationLog, size: float
    ) -> tuple[Point, Balance, bool]:
        """Return the point with what holds its nodes, what is out of balance there, and whether that is nothing.

        size: of the last correction [mm]. An iterate is in equilibrium only when it has itself been searched for
        contact that pulls.
        """
        is_first, tolerance = len(log) == 0, self._model.solver.force_tolerance
        peak = max(state_n[Progress].peak_force, self._noise / UNLOADED)
        scale = max(self.forces.largest_force(point), UNLOADED * peak)
        near = not is_first and log.residual[-1] < NEAR
        pull = scale * max(tolerance, 0.0 if is_first else CREDIBLE * log.residual[-1])
        point, balance = self.forces.balance(state_n, trial, point, near=near, pull=pull)
        self._note(log, balance, scale, size, point.guess.increment)
        may_end = not is_first and self._softness == 1.0
        if may_end and self._has_converged(log, balance, scale, size):
            point, balance = self.forces.balance(state_n, trial, point, near=True, pull=scale * tolerance)
            log.forget_last()
            self._note(log, balance, scale, size, point.guess.increment)
        return point, balance, may_end and self._has_converged(log, balance, scale, size)

    def _augment(self, state_n: State, trial: State, point: Point) -> Point | None:
        """Let interactions take their multipliers over; return the point with these, None if they are good enough."""
        before = point.guess.increment
        augmented = [k for k, i in enumerate(self._interactions) if i.augment(trial, point.forces[k])]
        for k in augmented:
            point = self.forces.evaluate_again(k, state_n, trial, point)
        if augmented:
            travel = [i.find_travel(state_n, trial, point.guess.step) for i in self._interactions]
            self.augmented_at.append(Augmentation(before, np.concatenate(travel), augmented))
        return point if augmented else None

    def _needs_new_factors(self, balance: Balance, size: float, *, keeps: bool) -> bool:
        """Return whether modified Newton needs new factors, too: contact has changed, or constraints move nodes.

        keeps: full Newton is modified for now.
        """
        is_full = self._model.solver.newton == "full" and not keeps
        return is_full or balance.changes > 0 or self._largest(balance.constraints.value) > 1e-3 * size

    def _complete(
        self, state_n: State, trial: State, point: Point, balance: Balance, log: IterationLog
    ) -> Converged | Failed:
        """Fill the trial state, unless contact does not converge or an interaction finds a fault."""
        n_undecided = sum(i.n_undecided for i in self._interactions)
        if n_undecided:
            return Failed(log, f"contact of {n_undecided} nodes does not converge", 0.5)
        if fault := self.forces.find_fault(point, state_n[Progress].peak_force):
            return Failed(log, fault, 0.5)
        self._mechanics.complete(trial)
        self.forces.fill(state_n, trial, point, balance.constraints)
        return Converged(log)

    def _advance(
        self, state_n: State, trial: State, point: Point, balance: Balance, correction: FloatArray, travel: FloatArray
    ) -> Point | BadGuess:
        """Take the correction, or the part of it that keeps cells whole and does not overshoot."""

        def go(change: FloatArray, further: FloatArray) -> Point | BadGuess:
            self.forces.move(trial, point, balance, change, further)
            guess, is_full = point.guess, self._model.solver.newton == "full"
            return self.forces.evaluate(state_n, trial, guess.step, guess.increment + change, with_stiffness=is_full)

        sense = self._mechanics.sense if self._model.solver.line_search else None
        return take_correction(go, point, balance, correction, travel, sense)

    def _note(self, log: IterationLog, balance: Balance, scale: float, size: float, increment: FloatArray) -> None:
        log.residual.append(balance.largest_lacking / scale if scale > 0 else 0.0)
        moved, size = self._largest(increment), max(size, self._largest(balance.constraints.value))
        log.correction.append(size / moved if moved > 0 else (np.inf if size > 0 else 0.0))
        log.contact_changes.append(balance.changes)
        if balance.tuned:
            log.start = len(log)

    def _has_converged(self, log: IterationLog, balance: Balance, scale: float, size: float) -> bool:
        """Return whether an iterate that a correction of this size [mm] has led to is in equilibrium.

        Where a correction no longer moves nodes, the residual is round-off; for a sheet under hardly any force it is
        above any tolerance.
        """
        settings = self._model.solver
        if log.contact_changes[-1] > 0 or not balance.bears(PUSHED, min(PUSHED, settings.force_tolerance) * scale):
            return False
        residual, correction = log.residual[-1], log.correction[-1]
        is_held = self._largest(balance.constraints.value) <= self._close
        tolerance = max(settings.force_tolerance, FAINT if is_held and size <= self._least else 0.0)
        stagnant = is_held and residual <= STAGNANT * settings.force_tolerance
        small = correction <= settings.displacement_tolerance or stagnant
        return residual <= tolerance and small

    def _is_hopeless(self, log: IterationLog) -> bool:
        """Five iterations of full Newton with its own tangent that come no closer than the best before them.

        The first residual does not count: before anything has moved it may be zero.
        """
        r = log.residual
        if not np.isfinite(r[-1]):
            return True
        return self._tangent_is_consistent and len(r) - log.start > 7 and min(r[-5:]) > min(r[log.start : -5])
