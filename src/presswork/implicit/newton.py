# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of one increment: full or modified Newton with the active sets of interactions and a line search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from presswork import stop
from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.line_search import take_correction
from presswork.implicit.linear.contract import LinearSolver, SolverError
from presswork.implicit.linear.system import Balance, Lacking, LinearSystem
from presswork.implicit.progress import Progress
from presswork.interaction.contract import Constraints, Forces, Guess, Interaction, Point, Resistance, turn
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
"""With a residual this many times below its tolerance, the last correction's size does not matter."""
LOST = 0.6
"""Correction over the increment above which an attempt that began from a good guess is given up."""
MOST_AUGMENTATIONS = 10
"""Times that an increment takes multipliers over."""


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
        self.system = LinearSystem(model, mechanics, interactions, timing, threads)
        self._timing = timing
        self._noise = mechanics.force_of_round_off()
        self._softness = 1.0
        self.augmented_at: list[tuple[FloatArray, FloatArray]] = []
        """Increments of the nodes, and of freedoms that interactions own, in equilibrium with multipliers that were not
        good enough, in the last solution."""
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

    def largest_force(self, point: Point) -> float:
        """Largest nodal force of the cells and of what drives them [N]."""
        length = self._mechanics.length
        largest = float(np.abs(point.internal / length).max())
        for interaction, forces in zip(self._interactions, point.forces, strict=True):
            if forces and interaction.is_driving:
                largest = max(largest, float(np.abs(forces.force / length[: forces.force.shape[1]]).max()))
        return largest

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
                    return self._settle(state_n, trial, point, balance, log)
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
            try:
                keeps = keeps_factors and len(log) > 1 and log.residual[-1] < KEPT * log.residual[-2]
                refactorise = not factorised or self._needs_new_factors(balance, size, keeps=keeps)
                correction, travel = self.system.correct(balance, point, refactorise=refactorise)
                if self.system.iterations:
                    log.solutions.append(str(self.system.iterations))
            except (SolverError, LostWorkpieceError) as error:
                return Failed(log, str(error), 0.25)
            factorised = True
            moved = self._advance(state_n, trial, point, balance, correction, travel)
            if isinstance(moved, BadGuess):
                return Failed(log, str(moved), moved.factor)
            point = moved
            size = max(self._largest(correction), float(np.abs(travel).max(initial=0.0)))
        return Failed(log, f"no equilibrium after {len(log)} iterations, residual {log.residual[-1]:.1e}", 0.5)

    def _begin(self, state_n: State, trial: State, step: Step, guess: FloatArray) -> Point | BadGuess:
        """Return the forces at a first guess; at none where it cannot be evaluated."""
        self.begin(state_n, step)
        self.augmented_at = []
        point = self.evaluate(state_n, trial, step, guess, with_stiffness=True)
        if not isinstance(point, BadGuess) or point.is_final:
            return point
        for interaction in self._interactions:
            interaction.give_up_guess(state_n, trial)
        return self.evaluate(state_n, trial, step, np.zeros_like(guess), with_stiffness=True)

    def _find_balance(
        self, state_n: State, trial: State, point: Point, log: IterationLog, size: float
    ) -> tuple[Point, Balance, bool]:
        """Return the point with what holds its nodes, what is out of balance there, and whether that is nothing.

        size: of the last correction [mm]. An iterate is in equilibrium only when it has itself been searched for
        contact that pulls.
        """
        is_first, tolerance = len(log) == 0, self._model.solver.force_tolerance
        peak = max(state_n[Progress].peak_force, self._noise / UNLOADED)
        scale = max(self.largest_force(point), UNLOADED * peak)
        near = not is_first and log.residual[-1] < NEAR
        pull = scale * max(tolerance, 0.0 if is_first else CREDIBLE * log.residual[-1])
        point, balance = self.balance(state_n, trial, point, near=near, pull=pull)
        self._note(log, balance, scale, size, point.guess.increment)
        may_end = not is_first and self._softness == 1.0
        if may_end and self._has_converged(log, balance, scale):
            point, balance = self.balance(state_n, trial, point, near=True, pull=scale * tolerance)
            log.forget_last()
            self._note(log, balance, scale, size, point.guess.increment)
        return point, balance, may_end and self._has_converged(log, balance, scale)

    def _augment(self, state_n: State, trial: State, point: Point) -> Point | None:
        """Let interactions take their multipliers over; return the point with these, None if they are good enough."""
        before = point.guess.increment
        augmented = [k for k, i in enumerate(self._interactions) if i.augment(trial, point.forces[k])]
        for k in augmented:
            point = self._evaluate_again(k, state_n, trial, point)
        if augmented:
            travel = [i.find_travel(state_n, trial, point.guess.step) for i in self._interactions]
            self.augmented_at.append((before, np.concatenate(travel)))
        return point if augmented else None

    def _needs_new_factors(self, balance: Balance, size: float, *, keeps: bool) -> bool:
        """Say whether modified Newton needs new factors, too: contact has changed, or constraints ask for a way.

        keeps: full Newton is modified for now.
        """
        is_full = self._model.solver.newton == "full" and not keeps
        return is_full or balance.changes > 0 or self._largest(balance.constraints.value) > 1e-3 * size

    def _settle(
        self, state_n: State, trial: State, point: Point, balance: Balance, log: IterationLog
    ) -> Converged | Failed:
        """Fill the trial state, unless contact does not settle."""
        unsettled = sum(i.n_unsettled for i in self._interactions)
        if unsettled:
            return Failed(log, f"contact of {unsettled} nodes does not settle", 0.5)
        self._mechanics.complete(trial)
        self.fill(state_n, trial, point, balance.constraints)
        return Converged(log)

    def fill(self, state_n: State, trial: State, point: Point, constraints: Constraints) -> None:
        """Fill the trial state with what equilibrium has found at a point."""
        trial.nodes.displacement, trial.nodes.increment = point.guess.displacement, point.guess.increment
        trial.nodes.reaction = point.reaction
        for interaction, forces in zip(self._interactions, point.forces, strict=True):
            interaction.settle(state_n, trial, forces, constraints)
        trial[Progress].peak_force = max(state_n[Progress].peak_force, self.largest_force(point))

    def balance(
        self, state_n: State, trial: State, point: Point, *, near: bool = False, pull: float = 0.0
    ) -> tuple[Point, Balance]:
        """Update what is held; return the point with the forces of it, and what is out of balance.

        near: equilibrium is near enough for reactions to let nodes go, those that pull by more than `pull` [N].
        """
        changes = 0
        for k, interaction in enumerate(self._interactions):
            started = perf_counter()
            changed = interaction.update(trial, point, point.forces[k], near=near, pull=pull)
            self._timing.add("contact", started)
            if changed and point.forces[k] is not None:
                point = self._evaluate_again(k, state_n, trial, point)
            changes += changed
        started = perf_counter()
        constraints = self._constrain(state_n, trial, point)
        length = self._mechanics.length
        resistances, drag, lacking = self._resist(state_n, trial, point, constraints)
        tuned = 0
        if near and not changes:
            credible = float(np.abs(lacking / length).max())
            changes = tuned = sum(i.tune(trial, point, pull=pull, credible=credible) for i in self._interactions)
            if tuned:
                resistances, drag, lacking = self._resist(state_n, trial, point, constraints)
        borders = []
        for k, interaction in enumerate(self._interactions):
            border, moved = interaction.border(trial, point, point.forces[k], resistances[k], near=near)
            borders.append(border)
            changes += moved
        self._timing.add("contact", started)
        return point, Balance(constraints, resistances, drag, tuple(borders), lacking, changes, tuned, length)

    def evaluate_like(
        self, other: Equilibrium, state_n: State, trial: State, held: State, step: Step, increment: FloatArray, *,
        with_stiffness: bool = False,
    ) -> Point | BadGuess:  # fmt: skip
        """Return the forces after an increment, the nodes held that another run of nearly the same model holds."""
        for own, led_by in zip(self._interactions, other._interactions, strict=True):
            own.hold_like(led_by, trial, held, state_n.nodes.displacement + increment)
        return self.evaluate(state_n, trial, step, increment, with_stiffness=with_stiffness)

    def find_lacking(self, state_n: State, trial: State, point: Point) -> Lacking:
        """Return what holds the nodes, and what is out of balance."""
        constraints = self._constrain(state_n, trial, point)
        resistances, _, lacking = self._resist(state_n, trial, point, constraints)
        return Lacking(constraints, resistances, lacking)

    def augment_like(self, trial: State, point: Point) -> None:
        """Let interactions take their multipliers over, as another run has done."""
        for interaction, own in zip(self._interactions, point.forces, strict=True):
            interaction.augment_like(trial, own)

    def begin(self, state_n: State, step: Step) -> None:
        """Take note of an increment that begins."""
        self._mechanics.begin_increment(state_n, step)
        for interaction in self._interactions:
            interaction.begin_increment(state_n, step)

    def _constrain(self, state_n: State, trial: State, point: Point) -> Constraints:
        """Return what is prescribed of the nodes at a guess."""
        constraints = self._nothing_held(point)
        for interaction in self._interactions:
            constraints = interaction.constrain(state_n, trial, point, constraints)
        return constraints

    def _resist(
        self, state_n: State, trial: State, point: Point, constraints: Constraints
    ) -> tuple[tuple[Resistance | None, ...], FloatArray, FloatArray]:
        """Return the resistances, their sum, and what is out of balance (n_points, freedoms) [N].

        The last is in the nodes' own frames, without freedoms that are prescribed.
        """
        resistances = tuple(i.resist(state_n, trial, point, constraints) for i in self._interactions)
        drag = np.zeros_like(point.reaction)
        for resistance in resistances:
            if resistance:
                drag += resistance.vector(len(drag))
        lacking = turn(constraints, drag - point.reaction)
        lacking[constraints.mask == 1] = 0.0
        return resistances, drag, lacking

    def _nothing_held(self, point: Point) -> Constraints:
        """Return constraints of nodes that are free."""
        shape = point.reaction.shape
        mask, turned = np.zeros(shape, dtype=np.uint8), np.zeros(shape[0], dtype=np.uint8)
        return Constraints(mask, np.zeros(shape), turned, np.zeros((shape[0], 2, 2)))

    def evaluate(
        self, state_n: State, trial: State, step: Step, increment: FloatArray, *, with_stiffness: bool,
        dt: float | None = None,
    ) -> Point | BadGuess:  # fmt: skip
        """Return the forces after `increment` (n_points, freedoms) [mm, rad] from state_n.

        dt: time that it takes [s]; None: that of the step.
        """
        dt = step.dt if dt is None else dt
        internal = self._mechanics.evaluate(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        if isinstance(internal, BadGuess):
            return internal
        guess = Guess(step, dt, increment, state_n.nodes.displacement + increment)
        started = perf_counter()
        reaction, found = internal.copy(), []
        for interaction in self._interactions:
            forces = interaction.evaluate(state_n, trial, guess)
            if isinstance(forces, BadGuess):
                self._timing.add("contact", started)
                return forces
            if forces:
                reaction[:, : forces.force.shape[1]] -= forces.force
            found.append(forces)
        self._timing.add("contact", started)
        return Point(guess, internal, tuple(found), reaction)

    def _evaluate_again(self, k: int, state_n: State, trial: State, point: Point) -> Point:
        """Return the point with one interaction's forces by its new multipliers or active set."""
        started = perf_counter()
        before, now = point.forces[k], self._interactions[k].evaluate(state_n, trial, point.guess)
        self._timing.add("contact", started)
        assert isinstance(before, Forces)
        assert isinstance(now, Forces), "the nodes have not moved"
        reaction = point.reaction.copy()
        reaction[:, : now.force.shape[1]] = reaction[:, : now.force.shape[1]] + before.force - now.force
        return replace(point, forces=(*point.forces[:k], now, *point.forces[k + 1 :]), reaction=reaction)

    def _advance(
        self, state_n: State, trial: State, point: Point, balance: Balance, correction: FloatArray, travel: FloatArray
    ) -> Point | BadGuess:
        """Take the correction, or the part of it that keeps cells whole and does not overshoot."""

        def go(change: FloatArray, further: FloatArray) -> Point | BadGuess:
            self._move(trial, point, balance, change, further)
            guess, is_full = point.guess, self._model.solver.newton == "full"
            return self.evaluate(state_n, trial, guess.step, guess.increment + change, with_stiffness=is_full)

        sense = self._mechanics.sense if self._model.solver.line_search else None
        return take_correction(go, point, balance, correction, travel, sense)

    def _move(self, trial: State, point: Point, balance: Balance, change: FloatArray, travel: FloatArray) -> None:
        """Tell interactions of a change of the nodes, and move what has freedoms of its own."""
        for interaction, forces, border in zip(self._interactions, point.forces, balance.borders, strict=True):
            if forces:
                interaction.predict(forces, change)
            if border and border.is_open:
                interaction.move(trial, border, travel)

    def _note(self, log: IterationLog, balance: Balance, scale: float, size: float, increment: FloatArray) -> None:
        log.residual.append(balance.largest_lacking / scale if scale > 0 else 0.0)
        moved, size = self._largest(increment), max(size, self._largest(balance.constraints.value))
        log.correction.append(size / moved if moved > 0 else (np.inf if size > 0 else 0.0))
        log.contact_changes.append(balance.changes)
        if balance.tuned:
            log.start = len(log)

    def _has_converged(self, log: IterationLog, balance: Balance, scale: float) -> bool:
        settings = self._model.solver
        if log.contact_changes[-1] > 0 or not balance.bears(PUSHED, min(PUSHED, settings.force_tolerance) * scale):
            return False
        residual, correction = log.residual[-1], log.correction[-1]
        small = correction <= settings.displacement_tolerance or residual <= STAGNANT * settings.force_tolerance
        return residual <= settings.force_tolerance and small

    def _is_hopeless(self, log: IterationLog) -> bool:
        """Five iterations of full Newton with its own tangent that come no closer than the best before them.

        The first residual does not count: before anything has moved it may be zero.
        """
        r = log.residual
        if not np.isfinite(r[-1]):
            return True
        return self._tangent_is_consistent and len(r) - log.start > 7 and min(r[-5:]) > min(r[log.start : -5])
