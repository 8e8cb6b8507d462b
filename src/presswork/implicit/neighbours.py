# SPDX-License-Identifier: Apache-2.0
"""Neighbours of a run: the same model with a number a little less or more, taken through the run's increments."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np

from presswork.implicit.epochs import end_increment_at_rest
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.linear.bordered_tangent import BorderedTangent
from presswork.implicit.linear.system import Lacking
from presswork.implicit.linear.whole_tangent import WholeTangent
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.contract import Point, turn_back
from presswork.interaction.led import Led
from presswork.model import FloatArray
from presswork.outcome import BadGuess, Failed, GaveUpError, IterationLog, Step
from presswork.state import Arrays, State


@dataclass
class SensitivityArrays(Arrays):
    """Derivatives of the converged state by the parameters of a run."""

    owner = "sensitivities"
    slope: dict[str, list[FloatArray]]
    """Derivative of each array of the State, by its name in a checkpoint: one parameter after the other, in its form
    and unit over that of the parameter. They are replaced, never written to."""

    def duplicate(self) -> SensitivityArrays:
        """Return a copy with the same arrays."""
        return SensitivityArrays(self.slope)


class Neighbour:
    """A run of nearly the same model. counts_work: whether it adds up the work done in increments."""

    def __init__(
        self, procedure: ImplicitProcedure, change: float, *, counts_work: bool = False, later: float = 0.0
    ) -> None:
        self.procedure = procedure
        self.change = change
        """Change of the parameter from its value in the run."""
        self.later = later
        """Difference in time by which its increment ends later than that of the run, over the stage."""
        self._counts_work = counts_work
        self._begun: _Begun | None = None

    @property
    def now(self) -> _Begun:
        """Return where it is in the present increment."""
        assert self._begun is not None, "an increment has begun"
        return self._begun

    def begin(self, state_n: State, number: int, step: Step) -> None:
        """Put it beside the state before an increment, and let the increment begin.

        number: of the parameter; -1: it begins where the run does.
        """
        procedure = self.procedure
        beside = shift(state_n, procedure.state, number, self.change if number >= 0 else 0.0)
        step = procedure.step_like(beside, step, step.fraction + self.later)
        if step.fraction_n == 0.0 and step.stage > 0:
            for interaction in procedure.interactions.all:
                interaction.begin_stage(beside, step.stage)
            if procedure.heat is not None:
                procedure.heat.forming.begin_stage(beside[HeatArrays])
        trial = beside.duplicate()
        if procedure.heat is not None and not step.is_at_rest:
            procedure.heat.begin_increment(beside, trial, step.dt)
        self._begun = _Begun(beside, trial, step)
        if procedure.only_heat_flows(step.stage):
            trial.nodes.increment = np.zeros_like(trial.nodes.increment)
            return
        for interaction in [] if step.is_at_rest else procedure.interactions.all:
            interaction.place(beside, trial, step, 1.0)
        procedure.equilibrium.forces.begin(beside, step)

    def evaluate(
        self, main: ImplicitProcedure, held: State, increment: FloatArray, *, with_stiffness: bool = False
    ) -> None:
        """Find what is out of balance after an increment of its own (n_points, freedoms) [mm, rad].

        main, held: the run, and its state in equilibrium. Raises GaveUpError.
        """
        now, own = self.now, self.procedure.equilibrium.forces
        nodes, travel = split(increment, now.trial)
        for interaction in self.procedure.interactions.all:
            if len(travel) and isinstance(interaction, Led):
                interaction.travel_like(now.state_n, now.trial, now.step, travel)
        point = own.evaluate_like(
            main.equilibrium.forces, now.state_n, now.trial, held, now.step, nodes, with_stiffness=with_stiffness
        )
        if isinstance(point, BadGuess):
            raise GaveUpError(f"no derivatives here: {point}")
        now.point, now.lacking = point, own.find_lacking(now.state_n, now.trial, point)
        constraints = now.lacking.constraints
        found = zip(self.procedure.interactions.all, point.forces, strict=True)
        missing = np.concatenate(
            [np.zeros(0), *(i.find_missing(now.trial, point, forces) for i, forces in found if isinstance(i, Led))]
        )
        now.force = join(turn_back(constraints, now.lacking.force.copy()), missing)
        now.missing = turn_back(constraints, np.where(constraints.mask == 1, constraints.value, 0.0))
        now.missing = join(now.missing, np.zeros_like(missing))

    def find_tangent(self, main: ImplicitProcedure) -> BorderedTangent:
        """Return the tangent at the point that was evaluated with stiffness."""
        now, system = self.now, self.procedure.equilibrium.system
        held = now.lacking.constraints
        matrix = system.find_whole(held, now.point, now.lacking.resistances)
        whole = WholeTangent(main.equilibrium.system, matrix, held, main.mechanics.length)
        return BorderedTangent(whole, self.procedure.interactions.all, now.trial, now.point)

    def find_travel(self, trial: State) -> FloatArray:
        """Return how far the own freedoms of interactions have gone in a trial state from where it has begun (n,)."""
        now = self.now
        return np.concatenate([i.find_travel(now.state_n, trial, now.step) for i in self.procedure.interactions.all])

    def find_last_travel(self) -> FloatArray:
        """Return the same of the increment before (n,)."""
        now = self.now
        led = (i for i in self.procedure.interactions.all if isinstance(i, Led))
        return np.concatenate([np.zeros(0), *(i.find_last_travel(now.state_n, now.step) for i in led)])

    def augment(self, by: Sequence[int]) -> None:
        """Take over the multipliers of interactions, by their numbers, where the run has."""
        self.procedure.equilibrium.forces.augment_like(self.now.trial, self.now.point, by)

    def conduct(self) -> None:
        """Take the heat of its increment in equilibrium to the end; equilibrium may be looked for again then.

        Raises GaveUpError.
        """
        now, procedure = self.now, self.procedure
        assert procedure.heat is not None
        procedure.equilibrium.forces.fill(now.state_n, now.trial, now.point, now.lacking.constraints)
        off = procedure.heat.advance(now.state_n, now.trial, now.step, now.step.dt)
        if isinstance(off, Failed):
            raise GaveUpError(f"no derivatives here: {off.reason}")

    def begin_again(self) -> None:
        """Look for equilibrium anew with the temperatures that heat has found, as the run does."""
        self.procedure.equilibrium.forces.begin(self.now.state_n, self.now.step)

    def find_excess(self) -> float:
        """Return the work [N mm] or force [N] of its increment beyond that which ends its stage.

        The increment is complete then: what follows begins it again.
        """
        now, procedure = self.now, self.procedure
        procedure.equilibrium.forces.fill(now.state_n, now.trial, now.point, now.lacking.constraints)
        procedure.end_increment(now.state_n, now.trial, now.step)
        return procedure.ram.find_excess(now.state_n, now.trial, now.step)

    def end_increment(self, progress: Progress, next_stage: int | None, *, stops: bool = False) -> None:
        """Complete its state at the end of an increment; the run's progress goes with it. Raises GaveUpError.

        stops: whether the stage ends here, before its travel is complete.
        """
        now, procedure = self.now, self.procedure
        if not procedure.only_heat_flows(now.step.stage):
            procedure.equilibrium.forces.fill(now.state_n, now.trial, now.point, now.lacking.constraints)
        if now.step.is_at_rest:
            end_increment_at_rest(procedure, now.state_n, now.trial, now.step)
        else:
            procedure.end_increment(now.state_n, now.trial, now.step)
            if procedure.sheet_heat is not None:
                procedure.sheet_heat.find(now.state_n, now.trial, now.step, IterationLog())
            if self._counts_work or procedure.ram.is_needed:
                procedure.count_work(now.state_n, now.trial, now.step)
            if procedure.ram.is_needed:
                procedure.ram.commit(now.state_n, now.trial, now.step)
            if procedure.sheet_heat is not None:
                procedure.sheet_heat.take(now.trial)
            procedure.evolve(now.state_n, now.trial, now.step)
        for interaction in procedure.interactions.all if stops else ():
            interaction.stop(now.trial, now.step.stage, now.step.fraction)
        if next_stage is not None:
            procedure.end_stage(now.trial, next_stage)
        now.trial.replace(progress.duplicate())
        procedure.state = now.trial


@dataclass
class _Begun:
    """A neighbour in an increment."""

    state_n: State
    trial: State
    step: Step
    """Step of the run's share of the stage, in its own time."""
    point: Point = field(init=False)
    lacking: Lacking = field(init=False)
    force: FloatArray = field(init=False)
    """Out of balance where nothing is prescribed (n_points, freedoms) [N], in the global frame."""
    missing: FloatArray = field(init=False)
    """What nodes still have to move where something is, in the same form [mm, rad]."""


@dataclass(frozen=True)
class Neighbours:
    """Two runs by which a derivative is found: with more of a parameter, and with less or as much."""

    key: str
    """Name of the parameter."""
    more: Neighbour
    less: Neighbour

    @property
    def own(self) -> list[Neighbour]:
        """Return the neighbours that belong to this parameter alone."""
        return [side for side in (self.more, self.less) if side.change]

    @property
    def apart(self) -> float:
        """How far the parameters of both are apart."""
        return self.more.change - self.less.change

    def differ(self) -> dict[str, FloatArray]:
        """Return the derivative of the state, array by array."""
        more, less = self.more.procedure.state.to_arrays(), self.less.procedure.state.to_arrays()
        found = {}
        for name, values in more.items():
            if values.dtype == np.float64:
                with np.errstate(invalid="ignore"):  # infinite in both: what is not there
                    change = np.subtract(values, less[name], dtype=np.float64) / self.apart
                found[name] = change if np.isfinite(change).all() else np.nan_to_num(change, nan=0.0)
        return found


def join(nodes: FloatArray, own: FloatArray) -> FloatArray:
    """Return a nodal vector (n_points, freedoms) with a row for each freedom of interactions (n,), in column one."""
    rows = np.zeros((len(own), nodes.shape[1]))
    rows[:, 0] = own
    return np.vstack([nodes, rows]) if len(own) else nodes


def split(joined: FloatArray, state: State) -> tuple[FloatArray, FloatArray]:
    """Return what join() has joined."""
    n = len(state.nodes.increment)
    return joined[:n], joined[n:, 0]


def shift(state: State, own: State, number: int, change: float) -> State:
    """Return a state with the derivative by a parameter times its change added, in the form of a neighbour's own."""
    shifted = State(*(copy(owned) for owned in own))
    slope = state[SensitivityArrays].slope if change else {}
    for owned in shifted:
        arrays = state[type(owned)].to_arrays()
        owned.take_arrays(
            {n: np.add(a, change * slope[n][number]) if n in slope else a.copy() for n, a in arrays.items()}
        )
    return shifted
