# SPDX-License-Identifier: Apache-2.0
"""Forces on the nodes at a guess of an increment, what holds the nodes there, and what is out of balance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.linear.system import Balance, Lacking
from presswork.implicit.progress import Progress
from presswork.interaction.contract import Constraints, Forces, Guess, Interaction, Point, Resistance, turn
from presswork.interaction.led import Led
from presswork.model import FloatArray
from presswork.outcome import BadGuess, Step
from presswork.state import State
from presswork.timing import Timing


class NodalForces:
    """Asks cells and interactions of one model for their forces; holds nothing of its own."""

    def __init__(
        self, mechanics: Mechanics | ShellMechanics, interactions: Sequence[Interaction], timing: Timing
    ) -> None:
        self._mechanics = mechanics
        self._interactions = interactions
        self._timing = timing

    def begin(self, state_n: State, step: Step) -> None:
        """Take note of an increment that begins."""
        self._mechanics.begin_increment(state_n, step)
        for interaction in self._interactions:
            interaction.begin_increment(state_n, step)

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

    def evaluate_like(
        self, other: NodalForces, state_n: State, trial: State, held: State, step: Step, increment: FloatArray, *,
        with_stiffness: bool = False,
    ) -> Point | BadGuess:  # fmt: skip
        """Return the forces after an increment, the nodes held that another run of nearly the same model holds."""
        for own, led_by in zip(self._interactions, other._interactions, strict=True):
            if isinstance(own, Led) and isinstance(led_by, type(own)):
                own.hold_like(led_by, trial, held, state_n.nodes.displacement + increment)
        return self.evaluate(state_n, trial, step, increment, with_stiffness=with_stiffness)

    def evaluate_again(self, k: int, state_n: State, trial: State, point: Point) -> Point:
        """Return the point with one interaction's forces by its new multipliers or active set."""
        started = perf_counter()
        before, now = point.forces[k], self._interactions[k].evaluate(state_n, trial, point.guess)
        self._timing.add("contact", started)
        assert isinstance(before, Forces)
        assert isinstance(now, Forces), "the nodes have not moved"
        reaction = point.reaction.copy()
        reaction[:, : now.force.shape[1]] = reaction[:, : now.force.shape[1]] + before.force - now.force
        return replace(point, forces=(*point.forces[:k], now, *point.forces[k + 1 :]), reaction=reaction)

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
                point = self.evaluate_again(k, state_n, trial, point)
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
                constraints = self._constrain(state_n, trial, point)
                resistances, drag, lacking = self._resist(state_n, trial, point, constraints)
        borders = []
        for k, interaction in enumerate(self._interactions):
            border, moved = interaction.border(trial, point, point.forces[k], resistances[k], near=near)
            borders.append(border)
            changes += moved
        self._timing.add("contact", started)
        return point, Balance(constraints, resistances, drag, tuple(borders), lacking, changes, tuned, length)

    def find_lacking(self, state_n: State, trial: State, point: Point) -> Lacking:
        """Return what holds the nodes, and what is out of balance."""
        constraints = self._constrain(state_n, trial, point)
        resistances, _, lacking = self._resist(state_n, trial, point, constraints)
        return Lacking(constraints, resistances, lacking)

    def augment_like(self, trial: State, point: Point, by: Sequence[int]) -> None:
        """Let interactions take their multipliers over, as those of another run have done, by their numbers."""
        for number in by:
            interaction = self._interactions[number]
            if isinstance(interaction, Led):
                interaction.augment_like(trial, point.forces[number])

    def fill(self, state_n: State, trial: State, point: Point, constraints: Constraints) -> None:
        """Fill the trial state with what equilibrium has found at a point."""
        trial.nodes.displacement, trial.nodes.increment = point.guess.displacement, point.guess.increment
        trial.nodes.reaction = point.reaction
        for interaction, forces in zip(self._interactions, point.forces, strict=True):
            interaction.end_increment(state_n, trial, forces, constraints)
        trial[Progress].peak_force = max(state_n[Progress].peak_force, self.largest_force(point))

    def find_fault(self, point: Point, peak: float) -> str:
        """Explain why a point is no equilibrium though its forces balance; empty: it is. peak: largest nodal force
        before [N]."""
        loads = np.zeros_like(point.reaction)
        for interaction, forces in zip(self._interactions, point.forces, strict=True):
            if forces and interaction.is_driving:
                loads[:, : forces.force.shape[1]] += forces.force
        peak = max(peak, self.largest_force(point))
        faults = (i.find_fault(forces, loads, peak) for i, forces in zip(self._interactions, point.forces, strict=True))
        return next(filter(None, faults), "")

    def largest_force(self, point: Point) -> float:
        """Largest nodal force of the cells and of what drives them [N]."""
        length = self._mechanics.length
        largest = float(np.abs(point.internal / length).max())
        for interaction, forces in zip(self._interactions, point.forces, strict=True):
            if forces and interaction.is_driving:
                largest = max(largest, float(np.abs(forces.force / length[: forces.force.shape[1]]).max()))
        return largest

    def move(self, trial: State, point: Point, balance: Balance, change: FloatArray, travel: FloatArray) -> None:
        """Pass a change of the nodes to the interactions, and move what has freedoms of its own."""
        for interaction, forces, border in zip(self._interactions, point.forces, balance.borders, strict=True):
            if forces:
                interaction.predict(forces, change)
            if border and border.is_open:
                interaction.move(trial, border, travel)

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
