# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of one increment: full or modified Newton with contact's active set and a line search."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

import numpy as np

from presswork import stop
from presswork.body.shells import ShellMechanics
from presswork.body.solids import BadGuess, LawFailed, Mechanics, PassedThrough, factor_of
from presswork.implicit.linear_solver import LinearSolver, SolverError
from presswork.implicit.linear_system import Balance, LinearSystem, Point, turn
from presswork.interaction.body_contact import BodyContacts, BodyForces
from presswork.interaction.floating_tools import FloatingTools, LostWorkpieceError
from presswork.interaction.friction import Friction, FrictionForces
from presswork.interaction.inertia import Inertia
from presswork.interaction.pushed_sheet_tools import PushedSheetTools
from presswork.interaction.sheet_contact import SheetContact, SheetForces
from presswork.interaction.tool_contact import Constraints, Contact
from presswork.model import BoolArray, FloatArray, Model
from presswork.outcome import Converged, Failed, IterationLog, Step
from presswork.state import State
from presswork.timing import Timing

NEAR = 0.1
"""Relative residual below which reactions are trusted to let nodes go."""
OVERSHOOT = 0.8
"""Work left along a correction, over that at its start, above which the correction is shortened."""
SMALLEST_PART = 0.1
UNLOADED = 1e-2
"""Forces below this part of the largest so far count as nothing: residuals are measured against no less."""
CREDIBLE = 1e-2
"""A pull below this part of what is out of balance lets no node go."""
CALM = 1e-2
"""Relative residual at which soft friction is stiffened."""
SOFT, STIFFENING = 300.0, 4.0
"""Gentle friction: how many times softer it begins, and by what it is stiffened each time."""
STAGNANT = 0.1
"""With a residual this many times below its tolerance, the last correction's size does not matter."""


class Equilibrium:
    """Solves increments of one model; holds the matrix and its factors, but nothing that a restart would need."""

    def __init__(
        self, model: Model, mechanics: Mechanics | ShellMechanics, contact: Contact, timing: Timing, threads: int
    ) -> None:
        self._model = model
        self._mechanics = mechanics
        self._contact = contact
        self.friction = Friction(model, contact)
        self.floating_tools = FloatingTools(model, contact)
        self.bodies = BodyContacts(model, mechanics)
        self.sheet = SheetContact(model) if model.sheet_tools or model.sheet_beads else None
        self.pushed_sheet_tools = PushedSheetTools(model)
        self.inertia = Inertia(model)
        self.system = LinearSystem(model, mechanics, self.floating_tools, self.pushed_sheet_tools, timing, threads)
        self._timing = timing
        self._noise = mechanics.force_of_round_off()

    @property
    def solver(self) -> LinearSolver:
        """The linear solver, which holds the last factors."""
        return self.system.solver

    def fixed(self, stage: int) -> BoolArray:
        """Return the components that supports and prescribed displacements hold in a stage (n_points, freedoms)."""
        return self._mechanics.supports.fixed(stage)

    def _supports(self, state_n: State, step: Step, increment: FloatArray) -> Constraints:
        return self._mechanics.supports.constrain(state_n, step.stage, step.fraction - step.fraction_n, increment)

    def _largest(self, change: FloatArray) -> float:
        """Largest change of a freedom, made a length [mm]."""
        return float(np.abs(change * self._mechanics.length).max())

    def solve(
        self, state_n: State, trial: State, step: Step, guess: FloatArray, *, gently: bool = False
    ) -> Converged | Failed:
        """Find the trial state at step.fraction. state_n is not touched; trial is in equilibrium if Converged.

        gently: begin with soft friction and stiffen it as equilibrium comes near; takes more iterations.
        """
        settings = self._model.solver
        log = IterationLog()
        fixed = self.fixed(step.stage)
        peak = max(float(state_n.peak_force[0]), self._noise / UNLOADED)
        self._mechanics.begin_increment(state_n, step)
        self._contact.begin_increment()
        self.floating_tools.begin_increment()
        self.bodies.begin_increment(state_n)
        if self.sheet:
            self.sheet.begin_increment(state_n)
        self.friction.softness = SOFT if gently else 1.0
        if self.friction.is_needed:
            self.friction.begin_increment(state_n, self._mechanics.nodal_flow_stress(state_n))
        increment, point = guess, self._evaluate(state_n, trial, step, guess, with_stiffness=True)
        if isinstance(point, LawFailed) and point.is_final:
            return Failed(log, str(point), factor_of(point))
        if isinstance(point, BadGuess):
            increment = np.zeros_like(guess)
            trial.sheet_tool_move -= trial.sheet_tool_travel - state_n.sheet_tool_travel
            trial.sheet_tool_travel = state_n.sheet_tool_travel.copy()
            point = self._evaluate(state_n, trial, step, increment, with_stiffness=True)
            if isinstance(point, BadGuess):
                return Failed(log, str(point), factor_of(point))
        size, factorised = 0.0, False
        most = settings.max_iterations * (2 if gently else 1)
        for iteration in range(most + 1):
            stop.look()
            # 1. contact at the present guess, and what is out of balance
            may_release = iteration > 0 and log.residual[-1] < NEAR
            scale = max(point.largest_force, UNLOADED * peak)
            pull = scale * max(settings.force_tolerance, CREDIBLE * log.residual[-1] if iteration else 0.0)
            point, balance = self._balance(state_n, trial, step, increment, point, fixed, near=may_release, pull=pull)

            # 2. converged? Not before this very iterate has been searched for contact that pulls
            self._note(log, balance, scale, size, increment)
            stiff = self.friction.softness == 1.0
            if iteration > 0 and stiff and not may_release and self._has_converged(log):
                pull = scale * settings.force_tolerance
                point, balance = self._balance(state_n, trial, step, increment, point, fixed, near=True, pull=pull)
                log.forget_last()
                self._note(log, balance, scale, size, increment)
            missing = self._largest(balance.constraints.value)
            if iteration > 0 and log.residual[-1] < CALM:
                self.friction.softness = max(1.0, self.friction.softness / STIFFENING)
            has_converged = iteration > 0 and stiff and self._has_converged(log)
            if has_converged and self.bodies.augment(trial, point.bodies):
                point = self._touch_again(state_n, trial, point)
                continue
            if has_converged:
                unsettled = self._contact.n_unsettled + self.bodies.n_unsettled
                if unsettled:
                    return Failed(log, f"contact of {unsettled} nodes does not settle", 0.5)
                trial.displacement, trial.increment = point.displacement, increment
                trial.reaction, trial.external_force = point.reaction, point.loads.force
                self.friction.settle(state_n, trial, balance.constraints.turned == 1)
                self.bodies.settle(state_n, trial, point.bodies)
                if self.sheet and point.sheet:
                    self.sheet.settle(trial, point.sheet)
                if point.inertia:
                    trial.velocity, trial.inertia_force = point.inertia.velocity, point.inertia.resistance
                trial.peak_force = np.maximum(state_n.peak_force, point.largest_force)
                return Converged(log)
            if iteration == most or (stiff and self._is_hopeless(log)):
                break

            # 3. correction; constrained freedoms go all the way to where they must be
            try:
                has_changed = balance.changes > 0 or missing > 1e-3 * size
                refactorise = settings.newton == "full" or not factorised or has_changed
                correction, travel = self.system.correct(balance, point, refactorise=refactorise)
            except (SolverError, LostWorkpieceError) as error:
                return Failed(log, str(error), 0.25)
            factorised = True
            moved = self._advance(state_n, trial, step, point, balance, increment, correction, travel)
            if isinstance(moved, BadGuess):
                return Failed(log, str(moved), factor_of(moved))
            increment, point, part = moved
            if balance.floating:
                self.floating_tools.move(trial, balance.floating, part * travel)
            size = max(self._largest(correction), float(np.abs(travel).max(initial=0.0)))
        return Failed(log, f"no equilibrium after {len(log)} iterations, residual {log.residual[-1]:.1e}", 0.5)

    def _balance(
        self, state_n: State, trial: State, step: Step, increment: FloatArray, point: Point, fixed: BoolArray,
        *, near: bool, pull: float,
    ) -> tuple[Point, Balance]:  # fmt: skip
        """Update what is held; return the point with the forces of it, and what is out of balance.

        near: equilibrium is near enough for reactions to let nodes go, those that pull by more than `pull` [N].
        """
        body_changes = self.bodies.update(point.bodies, near=near)
        if body_changes:
            point = self._touch_again(state_n, trial, point)
        started = perf_counter()
        self._contact.search(trial, point.displacement)
        changes = body_changes + self._contact.update(trial, point.reaction, fixed, near=near, tolerance=pull)
        supports = self._supports(state_n, step, increment)
        constraints = self._contact.constrain(trial, point.displacement, supports)
        friction = self._rub(state_n, trial, point, constraints)
        drag = friction.vector(len(point.reaction)) if friction else np.zeros_like(point.reaction)
        floating = None
        if self.floating_tools.is_needed:
            floating, stops = self.floating_tools.evaluate(
                trial, point.reaction, friction, supports, step.stage, step.fraction, near=near
            )
            changes += stops
        lacking = turn(constraints, drag - point.reaction)
        lacking[constraints.mask == 1] = 0.0
        self._timing.add("contact", started)
        pushed = None
        if self.pushed_sheet_tools.is_needed and point.sheet:
            pushed = self.pushed_sheet_tools.evaluate(trial, point.sheet, step.stage, step.fraction)
        length = self._mechanics.length
        return point, Balance(constraints, friction, drag, floating, pushed, lacking, changes, length)

    def _evaluate(
        self, state_n: State, trial: State, step: Step, increment: FloatArray, *, with_stiffness: bool
    ) -> Point | BadGuess:
        dt = self._model.stages[step.stage].time_between(step.fraction_n, step.fraction)
        internal = self._mechanics.evaluate(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        if isinstance(internal, BadGuess):
            return internal
        loads = self._mechanics.apply_loads(state_n, increment, step.stage, step.fraction)
        displacement = state_n.displacement + increment
        bodies = self._touch_bodies(state_n, trial, displacement)
        if isinstance(bodies, PassedThrough):
            return bodies
        reaction = internal - loads.force - bodies.force
        sheet = self._touch_sheet(state_n, trial, displacement, step)
        if sheet:
            reaction -= sheet.force
        inertia = self.inertia.evaluate(state_n, increment, dt) if self.inertia.is_needed else None
        if inertia:
            reaction[:, : inertia.resistance.shape[1]] += inertia.resistance
        return Point(displacement, internal, loads, bodies, sheet, inertia, reaction, self._mechanics.length)

    def _touch_sheet(self, state_n: State, trial: State, displacement: FloatArray, step: Step) -> SheetForces | None:
        started = perf_counter()
        found = self.sheet.evaluate(state_n, trial, displacement, step.stage, step.fraction) if self.sheet else None
        self._timing.add("contact", started)
        return found

    def _touch_bodies(self, state_n: State, trial: State, displacement: FloatArray) -> BodyForces | PassedThrough:
        started = perf_counter()
        bodies = self.bodies.evaluate(state_n, trial, displacement)
        self._timing.add("contact", started)
        return bodies

    def _touch_again(self, state_n: State, trial: State, point: Point) -> Point:
        """Return the point with the forces between bodies that follow from new multipliers or another active set."""
        bodies = self._touch_bodies(state_n, trial, point.displacement)
        assert isinstance(bodies, BodyForces)  # where they are has not changed
        return replace(point, bodies=bodies, reaction=point.reaction + point.bodies.force - bodies.force)

    def _advance(
        self,
        state_n: State,
        trial: State,
        step: Step,
        point: Point,
        balance: Balance,
        increment: FloatArray,
        correction: FloatArray,
        travel: FloatArray,
    ) -> tuple[FloatArray, Point, float] | BadGuess:
        """Take the correction, or the part of it that keeps cells whole and does not overshoot; return the part too."""
        full = self._model.solver.newton == "full"
        drag = balance.drag
        missing = max(self._largest(balance.constraints.value), float(np.abs(travel).max(initial=0.0)))
        part, gone = 1.0, 0.0
        while True:
            if balance.pushed:
                self.pushed_sheet_tools.move(trial, balance.pushed, (part - gone) * travel)
                gone = part
            taken = increment + part * correction
            self.bodies.predict(point.bodies, part * correction)
            found = self._evaluate(state_n, trial, step, taken, with_stiffness=full)
            if not isinstance(found, BadGuess) or part < SMALLEST_PART:
                break
            if isinstance(found, LawFailed) and found.is_final:
                break
            part *= 0.5
        if isinstance(found, BadGuess):
            return found
        largest = self._largest(correction)
        if not self._model.solver.line_search or part < 1.0 or missing > 1e-3 * largest:
            return taken, found, part
        before = float(((drag - point.reaction) * correction).sum())
        after = float(((drag - found.reaction) * correction).sum())
        if abs(after) <= OVERSHOOT * abs(before):
            return taken, found, part
        part = float(np.clip(before / (before - after), 0.1, 0.9)) if before != after else 0.5
        self.bodies.predict(point.bodies, part * correction)
        shorter = self._evaluate(state_n, trial, step, increment + part * correction, with_stiffness=full)
        if isinstance(shorter, BadGuess):
            return shorter
        return increment + part * correction, shorter, part

    def _rub(self, state_n: State, trial: State, point: Point, constraints: Constraints) -> FrictionForces | None:
        if not self.friction.is_needed:
            return None
        return self.friction.evaluate(state_n, trial, point.displacement, point.reaction, constraints.turned == 1)

    def _note(self, log: IterationLog, balance: Balance, scale: float, size: float, increment: FloatArray) -> None:
        log.residual.append(balance.largest_lacking / scale if scale > 0 else 0.0)
        moved, size = self._largest(increment), max(size, self._largest(balance.constraints.value))
        log.correction.append(size / moved if moved > 0 else (np.inf if size > 0 else 0.0))
        log.contact_changes.append(balance.changes)

    def _has_converged(self, log: IterationLog) -> bool:
        settings = self._model.solver
        if log.contact_changes[-1] > 0:
            return False
        residual, correction = log.residual[-1], log.correction[-1]
        small = correction <= settings.displacement_tolerance or residual <= STAGNANT * settings.force_tolerance
        return residual <= settings.force_tolerance and small

    def _is_hopeless(self, log: IterationLog) -> bool:
        """Five iterations of full Newton with its own tangent that come no closer than the best before them.

        The first residual does not count: before anything has moved it may be zero.
        """
        r, settings = log.residual, self._model.solver
        if not np.isfinite(r[-1]):
            return True
        rubs_otherwise = self.friction.is_needed and settings.friction_tangent != "return_mapping"
        quadratic = settings.newton == "full" and settings.tangent == "consistent" and not rubs_otherwise
        return quadratic and len(r) > 8 and min(r[-5:]) > min(r[1:-5])
