# SPDX-License-Identifier: Apache-2.0
"""Derivatives of a run by its parameters, increment by increment, by direct differentiation.

With u the nodes' increment, s_n the state before and p a parameter, equilibrium R(u, s_n, p) = 0 of every converged
increment gives

    K du/dp = -(dR/dp + dR/ds_n ds_n/dp)      ds/dp = ds/du du/dp + ds/ds_n ds_n/dp + ds/dp

K is the whole tangent at the increment, solved by the factors that Newton's method has left (whole_tangent.py), for all
parameters at a time. Nodes stay held as the run holds them: contact is differentiated within the increment, its
changes lie between increments. Increments are those of the run.

The derivatives on the right are taken along one direction at a time, (du, ds_n, dp), by two neighbours of the run: the
same model with the parameter a little less and a little more, whose states differ by the same part of ds/dp. So every
law, cell, tool and load counts without a line of its own, and so does everything that an increment keeps for the next
one. Where equilibrium is not solved to so many digits, the neighbour with less is the run itself, computed once for
all. K lacks what curved tools and the area of friction add to the tangent, so the solution is repeated with what is out
of balance, and the directions found are combined so that the residual is least (generalised conjugate residuals), until
nothing is. Tsay & Arora 1990, Comput. Methods Appl. Mech. Engrg. 81 (direct differentiation with history); there the
derivatives are written out, here they are differences of step h, with an error of h^2, on one side of h, and of
round-off over h.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from presswork.implicit.neighbours import Neighbour, Neighbours, SensitivityArrays, join, shift
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.placing import LostWorkpieceError
from presswork.model import FloatArray
from presswork.outcome import GaveUpError, Step
from presswork.state import State

BALANCED, DIGITS = 1e-10, 1e-1
"""Out of balance over the largest change of a nodal force, below which a derivative is found; and that of a run whose
equilibrium is not so near, over its tolerance."""
ENOUGH = 1e-4
"""The same, above which it is not, if it becomes no less."""
NOTHING = 1e-7
"""Part of the largest nodal force, and of the largest displacement, that these change by between two neighbours at
least, for what is out of balance: a number that moves the body as a whole changes no force at all."""
ROUND_OFF = 1e-11
"""Largest residual of neighbours, over the largest nodal force, where no force changes by more than NOTHING and the
residual falls no more."""
LATER = 1e-5
"""Difference in the end of a stage by which neighbours differ that differ by its end alone, over the stage."""
ALL_ALIKE = -1
"""Number in place of a parameter's, for neighbours that begin with the run's state."""
INNER = 0.3
"""Part of what is enough to which K is solved."""
MOST_ROUNDS = 30


class Sensitivities:
    """Follows a run and keeps the derivatives of its state; they are part of the state.

    same: a run of the same model whose matrix is not symmetric. lost: of which parameters there are none.
    """

    def __init__(
        self,
        procedure: ImplicitProcedure,
        same: Neighbour,
        neighbours: Sequence[Neighbours],
        lost: Sequence[bool],
    ) -> None:
        self._procedure = procedure
        self._same = same
        self.neighbours = neighbours
        self.rounds = 0
        """Back-substitutions so far, of all parameters."""
        self._held: State = procedure.state
        found = [_lose(each.differ()) if gone else each.differ() for each, gone in zip(neighbours, lost, strict=True)]
        procedure.state.add(SensitivityArrays({name: [f[name] for f in found] for name in found[0]}))
        procedure.followers.append(self)

    def note(self, trial: State) -> None:
        """Take note of which nodes are held in equilibrium."""
        self._held = trial.duplicate()

    def follow(self, state_n: State, trial: State, step: Step, next_stage: int | None) -> None:
        """Find the derivatives of a converged increment, and put them into its state.

        One that is not found is no number from then on: the run goes on without it.
        """
        courses = [_Course(n, each) for n, each in enumerate(self.neighbours) if not self.is_lost(state_n, n)]
        stops = step.fraction < 1.0 and self._procedure.ram.is_over(trial, step.stage)
        try:
            if stops:
                self._end_together(courses, state_n, step)
            self._go_along(courses, state_n, step)
            self._same.end_increment(trial[Progress], next_stage, stops=stops)
        except (GaveUpError, LostWorkpieceError):
            courses = []
        for course in courses:
            course.end_increment(trial[Progress], next_stage, stops=stops)
        found = {c.number: c.each for c in courses if not c.is_lost}
        arrays, names = trial.to_arrays(), state_n[SensitivityArrays].slope
        slopes = [
            found[number].differ() if number in found else {name: np.full_like(arrays[name], np.nan) for name in names}
            for number in range(len(self.neighbours))
        ]
        trial[SensitivityArrays].slope = {name: [each[name] for each in slopes] for name in names}

    def spread(self) -> None:
        """Put the neighbours where the derivatives of the run's state have them."""
        state, same = self._procedure.state, self._same.procedure
        same.state = shift(state, same.state, 0, 0.0)
        for number, each in enumerate(self.neighbours):
            for side in each.own if not self.is_lost(state, number) else []:
                side.procedure.state = shift(state, side.procedure.state, number, side.change)

    def is_lost_now(self, number: int) -> bool:
        """Return whether the same holds for the run's state."""
        return self.is_lost(self._procedure.state, number)

    @staticmethod
    def is_lost(state: State, number: int) -> bool:
        """Return whether the derivative by a parameter has not been found in some increment up to a state."""
        return bool(np.isnan(state[SensitivityArrays].slope["nodes.displacement"][number]).any())

    def _go_along(self, courses: Sequence[_Course], state_n: State, step: Step) -> None:
        """Take the neighbours through an increment. Raises GaveUpError if the run itself cannot be repeated."""
        self._same.begin(state_n, 0, step)
        for course in courses:
            for side in course.each.own:
                side.begin(state_n, course.number, step)
        if self._procedure.only_heat_flows(step.stage):
            return
        heat = None if step.is_at_rest else self._procedure.heat
        once = [(self._held, self._procedure.equilibrium.augmented_at)]
        for number, (held, augmented_at) in enumerate(heat.passes if heat else once):
            self._held = held
            for side in self._sides(courses) if number else []:
                side.begin_again()
            for taken in augmented_at:
                self._solve(courses, join(taken.nodes, taken.travel))
                for side in self._sides(courses):
                    side.augment(taken.by)
            for course in courses if number == 0 else []:
                course.predict(state_n, step)
            self._solve(courses, join(held.nodes.increment, self._same.find_travel(held)))
            if heat is not None:
                self._same.conduct()
                for course in courses:
                    course.conduct()

    def _end_together(self, courses: Sequence[_Course], state_n: State, step: Step) -> None:
        """Let the neighbours end a stage where each has spent its own energy, or reached its own limit of force.

        The part of the stage at its end is one number more: the neighbours differ by it, too, so that nothing is
        beyond the end. Raises GaveUpError.
        """
        size = step.fraction - step.fraction_n
        change, same = min(LATER, 0.1 * size), self._same.procedure
        sides = (Neighbour(same, sign * change, later=sign * change) for sign in (1.0, -1.0))
        end = _Course(ALL_ALIKE, Neighbours("", *sides))
        self._go_along([*courses, end], state_n, step)
        if end.is_lost:
            raise GaveUpError("no derivatives here: none by the end of the stage")
        for course in courses:
            course.end_like(end)

    def _sides(self, courses: Sequence[_Course]) -> list[Neighbour]:
        """Return all neighbours that still count."""
        return [self._same, *(side for c in courses if not c.is_lost for side in c.each.own)]

    def _solve(self, courses: Sequence[_Course], increment: FloatArray) -> None:
        """Find the derivatives of the increment; leaves the neighbours there, or their courses lost.

        increment: of the run, in equilibrium (n_points, freedoms) [mm, rad], joined with the travel of freedoms that
        interactions own. Raises GaveUpError.
        """
        main, length = self._procedure, self._procedure.mechanics.length
        self._same.evaluate(main, self._held, increment, with_stiffness=True)
        tangent = self._same.find_tangent(main)
        enough = min(max(BALANCED, DIGITS * main.model.solver.force_tolerance), ENOUGH)

        def evaluate(side: Neighbour, slope: FloatArray) -> None:
            side.evaluate(main, self._held, increment + side.change * slope)

        open_ = [c for c in courses if not c.is_lost and c.begin(increment, length, evaluate)]
        for _ in range(MOST_ROUNDS):
            if not open_:
                break
            rests, goals = [c.rest for c in open_], [INNER * enough * c.force for c in open_]
            directions = tangent.respond([r[0] for r in rests], [r[1] for r in rests], goals)
            open_ = [c for c, direction in zip(open_, directions, strict=True) if c.go(direction, enough, evaluate)]
        for course in open_:
            course.is_lost = True
        self.rounds += tangent.rounds


Evaluate = Callable[[Neighbour, FloatArray], None]
"""Evaluates a neighbour at a derivative of the nodes' increment. Raises GaveUpError."""


class _Course:
    """The search for the derivative by one parameter in an increment."""

    def __init__(self, number: int, each: Neighbours) -> None:
        self.number, self.each = number, each
        self.is_lost = False
        self.start: FloatArray | None = None
        """Derivative with which the search begins, where it is known."""

    @property
    def force(self) -> float:
        """Largest derivative of a nodal force so far."""
        return self._lack.force

    def predict(self, state_n: State, step: Step) -> None:
        """Begin the search with the derivative of the increment before, for each part of the stage."""
        last = state_n[Progress].last_size
        if self.start is None and self.number >= 0 and step.fraction_n > 0.0 and last > 0.0:
            slope = state_n[SensitivityArrays].slope["nodes.increment"][self.number]
            travel = self.each.more.find_last_travel() - self.each.less.find_last_travel()
            self.start = join(slope, travel / self.each.apart) * (step.fraction - step.fraction_n) / last

    def begin(self, increment: FloatArray, length: FloatArray, evaluate: Evaluate) -> bool:
        """Begin with what was predicted, or nodes that do not move by the parameter; return whether to go on."""
        first = np.zeros_like(increment) if self.start is None else self.start
        self._lack, self._begin, self._slope = _Lack(length, increment, self.each.apart), first, first
        self._directions: list[FloatArray] = []
        self._taken: list[FloatArray] = []
        if not self._evaluate(self._slope, evaluate):
            return False
        self.rest = self._first = self._lack.find(self.each)
        return True

    def go(self, direction: FloatArray, enough: float, evaluate: Evaluate) -> bool:
        """Take another step of the solution; return whether the derivative is still to be found."""
        if not self._evaluate(self._slope + direction, evaluate):
            return False
        # 1. what the way leaves
        left, lack = self._lack.find(self.each), self._lack
        reached = self._slope + direction
        stays = lack.size(left, reached) > 0.5 * lack.size(self.rest, reached)
        if lack.size(left, reached) < enough or (stays and lack.is_round_off(left, reached)):
            self._slope = reached
            return False
        # 2. the ways so far, combined so that the least is left: what is lacking is linear in the slope
        self._directions.append(direction)
        self._taken.append(np.subtract(self.rest, left))
        share = lack.combine(self._first, self._taken, reached)
        slope = self._begin + np.tensordot(share, self._directions, axes=1)
        rest = np.subtract(self._first, np.tensordot(share, self._taken, axes=1))
        stagnates = lack.size(rest, slope) > 0.5 * lack.size(self.rest, slope)
        self._slope, self.rest = slope, rest
        if lack.size(rest, slope) < (ENOUGH if stagnates else enough):
            self._evaluate(slope, evaluate)
            return False
        return True

    def conduct(self) -> None:
        """Take the neighbours' heat to the end of the increment; equilibrium that is found again begins from here."""
        self.start = self._slope
        try:
            for side in [] if self.is_lost else self.each.own:
                side.conduct()
        except GaveUpError:
            self.is_lost = True

    def end_like(self, end: _Course) -> None:
        """Go on from here to where the neighbours' stages end. end: the derivative by the part of the stage."""
        if self.is_lost:
            return
        excess, by_end = (
            (each.more.find_excess() - each.less.find_excess()) / each.apart for each in (self.each, end.each)
        )
        if by_end == 0.0:
            self.is_lost = True
            return
        self.start = self._slope - excess / by_end * end._slope
        for side in self.each.own:
            side.later = -side.change * excess / by_end

    def end_increment(self, progress: Progress, next_stage: int | None, *, stops: bool) -> None:
        """Complete the neighbours' states at the end of the increment."""
        try:
            for side in [] if self.is_lost else self.each.own:
                side.end_increment(progress, next_stage, stops=stops)
                side.later = 0.0
        except GaveUpError:
            self.is_lost = True

    def _evaluate(self, slope: FloatArray, evaluate: Evaluate) -> bool:
        try:
            for side in self.each.own:
                evaluate(side, slope)
        except (GaveUpError, LostWorkpieceError):
            self.is_lost = True
        return not self.is_lost


class _Lack:
    """What is out of balance in a derivative, and what nodes that are held still have to move: two nodal vectors."""

    def __init__(self, length: FloatArray, increment: FloatArray, apart: float) -> None:
        self._length = length
        self._least_displacement = max(NOTHING * float(np.abs(increment * length).max()) / apart, 1e-300)
        self._round_off = 0.0
        self.force = 0.0
        """Largest derivative of a nodal force that holds the nodes so far, made a force."""

    def find(self, each: Neighbours) -> FloatArray:
        """Return both for the present displacements of the neighbours (2, n_points, freedoms)."""
        more, less = each.more.now, each.less.now
        change = np.abs((more.point.reaction - less.point.reaction) / self._length).max()
        least = NOTHING * np.abs(more.point.reaction / self._length).max()
        self.force = max(self.force, float(max(change, least)) / each.apart, 1e-300)
        self._round_off = ROUND_OFF / NOTHING * float(least) / each.apart if change <= least else 0.0
        return np.array([more.force - less.force, more.missing - less.missing]) / each.apart

    def size(self, lack: FloatArray, slope: FloatArray) -> float:
        """Return the larger of both over the forces and displacements of the derivative."""
        return float(np.abs(self._weigh(lack, slope)).max())

    def is_round_off(self, lack: FloatArray, slope: FloatArray) -> bool:
        """Return whether the residuals of forces and displacements are within round-off."""
        forces, displacements = np.abs(self._weigh(lack, slope)).max(axis=(1, 2))
        return bool(forces * self.force <= self._round_off and displacements <= ENOUGH)

    def combine(self, first: FloatArray, taken: Sequence[FloatArray], slope: FloatArray) -> FloatArray:
        """Return the shares of directions' residuals (n, 2, n_points, freedoms) that leave the least of the first."""
        columns = np.column_stack([self._weigh(each, slope).ravel() for each in taken])
        return np.asarray(np.linalg.lstsq(columns, self._weigh(first, slope).ravel(), rcond=None)[0])

    def _weigh(self, lack: FloatArray, slope: FloatArray) -> FloatArray:
        largest = max(float(np.abs(slope * self._length).max()), self._least_displacement)
        return np.array([lack[0] / self._length / self.force, lack[1] * self._length / largest])


def _lose(slope: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: np.full_like(values, np.nan) for name, values in slope.items()}
