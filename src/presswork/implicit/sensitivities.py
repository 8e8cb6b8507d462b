# SPDX-License-Identifier: Apache-2.0
"""Derivatives of a run by its parameters, increment by increment, by direct differentiation.

With u the nodes' increment, s_n the state before and p a parameter, equilibrium R(u, s_n, p) = 0 of every converged
increment gives

    K du/dp = -(dR/dp + dR/ds_n ds_n/dp)      ds/dp = ds/du du/dp + ds/ds_n ds_n/dp + ds/dp

K is the matrix that Newton's method has left, factorised; so a parameter costs back-substitutions and evaluations of
forces, and no factors. Nodes stay held as the run holds them: contact is differentiated within the increment, its
changes lie between increments. Increments are those of the run.

The derivatives on the right are taken along one direction at a time, (du, ds_n, dp), by two neighbours of the run: the
same model with the parameter a little less and a little more, whose states differ by the same part of ds/dp. So every
law, cell, tool and load counts without a line of its own, and so does all that an increment keeps for the next one.
K lacks what friction and curved tools add to the tangent and half of its unsymmetric part, so the solution is repeated
with what is out of balance, and the ways found are combined so that the least is left (generalised conjugate
residuals), until nothing is. Tsay & Arora 1990, Comput. Methods Appl. Mech. Engrg. 81 (direct
differentiation with history); there the derivatives are written out, here they are central differences of step h, with
an error of h^2 and of round-off over h.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.contract import Constraints, Point, turn_back
from presswork.model import FloatArray
from presswork.outcome import BadGuess, GaveUpError, Step
from presswork.state import Arrays, State

BALANCED, DIGITS = 1e-10, 1e-2
"""Out of balance over the largest change of a nodal force, below which a derivative is found; and that of a run whose
equilibrium is not so near, over its tolerance."""
ENOUGH = 1e-4
"""The same, above which it is not, if it becomes no less."""
MOST_ROUNDS = 30


@dataclass
class SensitivityArrays(Arrays):
    """Derivatives of the converged state by the parameters of a run."""

    owner = "sensitivities"
    slope: dict[str, list[FloatArray]]
    """Of each array of the State, by its name in a checkpoint: by one parameter after the other, in its form and unit
    over that of the parameter."""


@dataclass(frozen=True)
class Neighbours:
    """Two runs beside one, with a parameter less and more by a step."""

    key: str
    """Name of the parameter."""
    step: float
    less: ImplicitProcedure
    more: ImplicitProcedure

    @property
    def sides(self) -> tuple[tuple[ImplicitProcedure, float], ...]:
        """Each with its change of the parameter."""
        return (self.more, self.step), (self.less, -self.step)

    def differ(self) -> dict[str, FloatArray]:
        """Return the derivative of the state, array by array."""
        more, less = self.more.state.to_arrays(), self.less.state.to_arrays()
        found = {}
        for name, values in more.items():
            if values.dtype == np.float64:
                with np.errstate(invalid="ignore"):  # infinite in both: what is not there
                    change = np.subtract(values, less[name], dtype=np.float64) / (2.0 * self.step)
                found[name] = np.nan_to_num(change, nan=0.0)
        return found


@dataclass
class _Side:
    """One neighbour in an increment."""

    procedure: ImplicitProcedure
    change: float
    state_n: State
    trial: State
    point: Point = field(init=False)
    constraints: Constraints = field(init=False)
    lacking: FloatArray = field(init=False)
    """Out of balance where nothing is prescribed (n_points, freedoms) [N], in the global frame."""
    missing: FloatArray = field(init=False)
    """What nodes still have to move where something is, in the same form [mm, rad]."""


class Sensitivities:
    """Follows a run and keeps the derivatives of its state; they are part of the state."""

    def __init__(self, procedure: ImplicitProcedure, neighbours: Sequence[Neighbours]) -> None:
        self._procedure = procedure
        self.neighbours = neighbours
        self.rounds = 0
        """Back-substitutions so far, of all parameters."""
        self._held: State = procedure.state
        found = [each.differ() for each in neighbours]
        procedure.state.add(SensitivityArrays({name: [f[name] for f in found] for name in found[0]}))
        procedure.followers.append(self)

    def note(self, trial: State) -> None:
        """Take note of which nodes are held in equilibrium."""
        self._held = trial.duplicate()

    def follow(self, state_n: State, trial: State, step: Step, next_stage: int | None) -> None:
        """Find the derivatives of a converged increment, and put them into its state.

        One that is not found is no number from then on: the run goes on without it.
        """
        arrays, found = trial.to_arrays(), []
        for number, each in enumerate(self.neighbours):
            try:
                if self.is_lost(state_n, number):
                    raise GaveUpError("no derivative to begin with")
                self._go_along(number, each, state_n, trial, step, next_stage)
                found.append(each.differ())
            except GaveUpError:
                found.append({name: np.full_like(arrays[name], np.nan) for name in state_n[SensitivityArrays].slope})
        trial[SensitivityArrays].slope = {name: [f[name] for f in found] for name in found[0]}

    @staticmethod
    def is_lost(state: State, number: int) -> bool:
        """Say whether the derivative by a parameter has not been found in some increment up to a state."""
        return bool(np.isnan(state[SensitivityArrays].slope["nodes.displacement"][number]).any())

    def _go_along(
        self, number: int, each: Neighbours, state_n: State, trial: State, step: Step, next_stage: int | None
    ) -> None:
        """Take the neighbours through an increment. Raises GaveUpError."""
        sides = [self._begin(*side, number, state_n, step) for side in each.sides]
        for increment in self._procedure.equilibrium.augmented_at:
            self._solve(sides, each, increment, step)
            for side in sides:
                side.procedure.equilibrium.augment_like(side.trial, side.point)
        self._solve(sides, each, self._held.nodes.increment, step)
        for side in sides:
            side.procedure.equilibrium.fill(side.state_n, side.trial, side.point, side.constraints)
            side.procedure.settle(side.state_n, side.trial, step)
            side.procedure.evolve(side.state_n, side.trial, step)
            if next_stage is not None:
                side.procedure.end_stage(side.trial, next_stage)
            side.trial.replace(trial[Progress].duplicate())
            side.procedure.state = side.trial

    def _begin(self, procedure: ImplicitProcedure, change: float, number: int, state_n: State, step: Step) -> _Side:
        """Put a neighbour beside the state before an increment, and let the increment begin."""
        beside = _shift(state_n, procedure.state, number, change)
        if step.fraction_n == 0.0 and step.stage > 0:
            for interaction in procedure.interactions.all:
                interaction.begin_stage(beside, step.stage)
        trial = beside.duplicate()
        for interaction in procedure.interactions.all:
            interaction.place(beside, trial, step, 1.0)
        procedure.equilibrium.begin(beside, step)
        return _Side(procedure, change, beside, trial)

    def _evaluate(self, side: _Side, increment: FloatArray, step: Step) -> None:
        """Find what is out of balance at a neighbour after an increment of its own (n_points, freedoms) [mm, rad]."""
        main, equilibrium = self._procedure.equilibrium, side.procedure.equilibrium
        point = equilibrium.evaluate_like(main, side.state_n, side.trial, self._held, step, increment)
        if isinstance(point, BadGuess):
            raise GaveUpError(f"no derivatives here: {point}")
        side.point = point
        side.constraints, lacking = equilibrium.find_lacking(side.state_n, side.trial, point)
        side.lacking = turn_back(side.constraints, lacking)
        side.missing = turn_back(side.constraints, np.where(side.constraints.mask == 1, side.constraints.value, 0.0))

    def _solve(self, sides: Sequence[_Side], each: Neighbours, increment: FloatArray, step: Step) -> None:
        """Find the derivative of the increment; leaves the neighbours there. Raises GaveUpError.

        increment: of the run, in equilibrium (n_points, freedoms) [mm, rad].
        """
        system, length = self._procedure.equilibrium.system, self._procedure.mechanics.length
        lack = _Lack(length)
        for side in sides:
            self._evaluate(side, increment, step)
        rest = first = lack.find(sides, each.step)
        slope, ways, taken = np.zeros_like(increment), [], []
        enough = min(max(BALANCED, DIGITS * self._procedure.model.solver.force_tolerance), ENOUGH)
        for _ in range(MOST_ROUNDS):
            # 1. the way that the factors at hand give, and what it leaves
            way = system.respond(rest[0]) + rest[1]
            self.rounds += 1
            for side in sides:
                self._evaluate(side, increment + side.change * (slope + way), step)
            left = lack.find(sides, each.step)
            if lack.size(left, slope + way) < enough:
                return
            # 2. the ways so far, combined so that the least is left: what is lacking is linear in the slope
            ways.append(way)
            taken.append(np.subtract(rest, left))
            share = lack.combine(first, taken, slope + way)
            slope = np.tensordot(share, ways, axes=1)
            before, rest = rest, np.subtract(first, np.tensordot(share, taken, axes=1))
            stagnates = lack.size(rest, slope) > 0.5 * lack.size(before, slope)
            if lack.size(rest, slope) < (ENOUGH if stagnates else enough):
                for side in sides:
                    self._evaluate(side, increment + side.change * slope, step)
                return
        raise GaveUpError(
            f"the derivative by {each.key} is not found: {lack.size(rest, slope):.1e} of its forces stay out of balance"
        )


class _Lack:
    """What is out of balance in a derivative, and what nodes that are held still have to move: two nodal vectors."""

    def __init__(self, length: FloatArray) -> None:
        self._length = length
        self._force = 0.0

    def find(self, sides: Sequence[_Side], step: float) -> FloatArray:
        """Return both for the present ways of the neighbours (2, n_points, freedoms)."""
        more, less = sides
        reaction = (more.point.reaction - less.point.reaction) / (2.0 * step)
        self._force = max(self._force, float(np.abs(reaction / self._length).max()), 1e-300)
        return np.array([more.lacking - less.lacking, more.missing - less.missing]) / (2.0 * step)

    def size(self, lack: FloatArray, slope: FloatArray) -> float:
        """Return the larger of both over the forces and ways of the derivative."""
        return float(np.abs(self._weigh(lack, slope)).max())

    def combine(self, first: FloatArray, taken: Sequence[FloatArray], slope: FloatArray) -> FloatArray:
        """Return the shares of what ways have taken (n, 2, n_points, freedoms) that leave the least of the first."""
        columns = np.column_stack([self._weigh(each, slope).ravel() for each in taken])
        return np.asarray(np.linalg.lstsq(columns, self._weigh(first, slope).ravel(), rcond=None)[0])

    def _weigh(self, lack: FloatArray, slope: FloatArray) -> FloatArray:
        way = max(float(np.abs(slope * self._length).max()), 1e-300)
        return np.array([lack[0] / self._length / self._force, lack[1] * self._length / way])


def _shift(state: State, own: State, number: int, change: float) -> State:
    """Return a state with the derivative by a parameter times its change added, in the form of a neighbour's own."""
    shifted, arrays = own.duplicate(), state.to_arrays()
    slope = state[SensitivityArrays].slope
    shifted.load_arrays(
        {
            name: np.add(arrays[name], change * slope[name][number]) if name in slope else arrays[name]
            for name in shifted.to_arrays()
        }
    )
    return shifted
