# SPDX-License-Identifier: Apache-2.0
"""The implicit quasi-static procedure: stages, automatic increments, cut-backs.

It advances the converged State an increment at a time and knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from presswork import _core
from presswork.body.make import make_mechanics
from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.body.thermoelastic import find_thermal_work, keep_temperatures
from presswork.evolution.points import Evolution
from presswork.implicit.accuracy import Accuracy
from presswork.implicit.energy import Work, add_external_work, add_work, balance
from presswork.implicit.first_guess import FormerIncrement, find_first_guess, keep_former
from presswork.implicit.follower import Follower
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.heat_of_increments import MOST_PASSES, HeatOfIncrements
from presswork.implicit.heat_of_stamping import HeatOfStamping
from presswork.implicit.held import check_held, check_pushed, note_loose
from presswork.implicit.newton import Equilibrium
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.ram import Ram
from presswork.implicit.remedy import find_remedy
from presswork.implicit.stability import BELIEVED, judge_stability, shows_stability
from presswork.implicit.step_sizes import SMALLEST, find_next_size, find_remaining, is_saved, list_ends
from presswork.implicit.temperature_change import find_temperatures, judge_change
from presswork.interaction.contract import Interaction
from presswork.interaction.of_model import Interactions
from presswork.interaction.supports import NotHeldError
from presswork.model import FloatArray, Model
from presswork.outcome import Converged, Failed, GaveUpError, IterationLog, Step, TooCoarse
from presswork.ranks.world import World
from presswork.state import State
from presswork.threads import available_threads
from presswork.timing import Timing

BACK = 1e-3
"""Fraction of the last increment by which the first guess is reversed where a stage releases what held the workpiece:
the tangent from there is that of unloading."""
WORTH_ALL = 0.25
"""Length of an increment over the last one up to which an attempt is worth all iterations."""
ENOUGH_FOR_THREADS = 10_000
"""Freedoms below which waking a second thread costs more than it gives."""


class ImplicitProcedure:
    """Advances one model through its stages.

    others: interactions of one's own, beside those that the model names (presswork.interaction.contract). before: the
    same run on the mesh before, with its threads, others and world; the caller then fills the State (epochs.new_epoch).
    begins_formed: the caller fills the State with a formed sheet; then it checks itself that something holds it.
    world: the ranks that share the cells of solids, if there are several.
    """

    def __init__(
        self,
        model: Model,
        *,
        threads: int = 0,
        others: Sequence[Interaction] = (),
        before: ImplicitProcedure | None = None,
        begins_formed: bool = False,
        world: World | None = None,
    ) -> None:
        self.threads, self.others = threads, tuple(others)
        self.world: World | None = before.world if before else world
        if before:
            self.threads, self.others = before.threads, tuple(copy(i) for i in before.others)
        freedoms = model.freedoms * len(model.mesh.points)
        threads = self.threads or (available_threads() if freedoms > ENOUGH_FOR_THREADS else 1)
        _core.set_threads(threads)
        self.model = model
        self.timing: Timing = before.timing if before else Timing("assembly", "contact", "analysis", "solve")
        for interaction in self.others:
            interaction.find_places(model.mesh)
        self.mechanics = make_mechanics(model, self.timing, self.world)
        interactions_n = before.interactions if before else None
        self.interactions: Interactions = Interactions(model, self.mechanics, self.others, interactions_n)
        self.equilibrium = Equilibrium(model, self.mechanics, self.interactions.all, self.timing, threads)
        self.ram = Ram(model)
        self.heat: HeatOfIncrements | None = None
        self.sheet_heat: HeatOfStamping | None = None
        if model.heat is not None and isinstance(self.mechanics, Mechanics):
            self.heat = HeatOfIncrements(model, self.mechanics, self.interactions, self.timing, threads)
        elif model.heat is not None and isinstance(self.mechanics, ShellMechanics):
            self.sheet_heat = HeatOfStamping(model, self.mechanics)
        self.evolution = Evolution(model)
        self.accuracy = Accuracy(model, self.mechanics)
        self.followers: list[Follower] = []
        """Followers that learn of every increment in equilibrium."""
        self.state = self.at_rest()
        self._start, self._releases, self._to_rest = self.state, False, False
        if before:
            self.initial_volume: float = before.initial_volume
            return
        self.interactions.tools.contact.begin(self.state, self.interactions.supports.fixed(0))
        if not begins_formed:
            check_held(self.model, self.interactions, self.state)
        self.mechanics.evaluate(self.state, self.state, self.state.nodes.increment, with_stiffness=False)
        self.mechanics.complete(self.state)
        self.initial_volume = self.volume()

    def at_rest(self) -> State:
        """Return the State before the first increment."""
        state = self.mechanics.at_rest()
        state.add(Progress(next_size=self.model.solver.initial_increment), Work(), *self.accuracy.at_rest())
        if self.model.analysis == "shell" and self.model.space_tools:
            state.add(FormerIncrement(np.zeros_like(state.nodes.increment)))
        for interaction in self.interactions.all:
            state.add(*interaction.at_rest())
        if self.ram.is_needed:
            state.add(self.ram.at_rest())
        if self.heat is not None:
            state.add(self.heat.forming.at_rest())
            self.heat.spread(state)
        if self.sheet_heat is not None:
            state.add(self.sheet_heat.at_rest())
            self.sheet_heat.spread(state)
        keep_temperatures(self.model, state)
        if self.heat is not None:
            self.heat.mixtures.begin(state)
        if self.evolution.names:
            state.add(self.evolution.at_rest(state))
        return state

    def contact_forces(self) -> dict[str, FloatArray]:
        """Return what the first body of each contact does to the second (2,) [N], as modelled."""
        return self.interactions.bodies.total_forces(self.state)

    def volume(self) -> float:
        """Volume of the workpiece as modelled [mm3]."""
        return float(sum(v.sum() for v in self.state.cells.volume))

    def remaining(self) -> float:
        """Part of the whole process still to be computed, counted in stage durations."""
        return find_remaining(self.model, self.state[Progress])

    def advance(self) -> Iterator[IncrementReport]:
        """Compute increment after increment; self.state is converged at each yield. Raises GaveUpError."""
        while self.state[Progress].stage < len(self.model.stages):
            yield self._next_increment()

    def present_step(self) -> Step:
        """Return the step of no length at which the converged state is."""
        stage, fraction = self.state[Progress].stage, self.state[Progress].fraction
        return (
            self._step(stage - 1, 1.0, 1.0) if fraction == 0.0 and stage > 0 else self._step(stage, fraction, fraction)
        )

    def _next_increment(self) -> IncrementReport:
        progress = self.state[Progress]
        stage, fraction_n = progress.stage, progress.fraction
        points = list_ends(self.model, stage)
        target = float(points[np.searchsorted(points, fraction_n + 1e-12)])
        size, first = progress.next_size, 0.0
        least = self.model.solver.min_increment if size >= self.model.solver.min_increment else size / SMALLEST
        cutbacks: list[str] = []
        self._start, self._releases, self._to_rest = self.state, False, False
        if fraction_n == 0.0 and stage > 0:
            self._begin_stage(stage)
        fitting = self.ram.longest(self._start, stage, fraction_n)
        while True:
            self.equilibrium.system.negative_pivots = 0
            step = min(size, target - fraction_n, fitting)
            if not self._to_rest and step * (1 + 1e-9) < target - fraction_n < 2 * step:
                step = 0.5 * (target - fraction_n)
            fraction = target if step >= (target - fraction_n) * (1 - 1e-9) else fraction_n + step
            first = first or step
            trial, outcome = self._attempt_all(stage, fraction_n, fraction)
            if shows_stability(self.model) and not isinstance(outcome, Failed):
                pivots, shortest = self.equilibrium.system.count_negative(), max(BELIEVED * first, 2.0 * least)
                outcome = judge_stability(self._start, trial, outcome, pivots, is_shortest=step <= shortest)
            if self.heat is not None and not isinstance(outcome, Failed):
                outcome = self._conduct(self.heat, trial, self._step(stage, fraction_n, fraction), outcome)
            made = self._step(stage, fraction_n, fraction)
            if not isinstance(outcome, Failed):
                outcome = self._complete(trial, made, outcome.log)
            if not isinstance(outcome, Failed):
                shorter = self.ram.shorten(self._start, trial, made)
                if shorter is None:
                    break
                fitting, self._to_rest = shorter
                continue
            cutbacks.append(f"{step:.3g} of the stage: {outcome.reason}")
            size, self._to_rest = step * outcome.factor, False
            if isinstance(outcome, TooCoarse):
                least = min(least, size / SMALLEST)
            elif size < least:
                where = f"stage {self.model.stages[stage].name!r} at {fraction_n:.2%}"
                remedy = find_remedy(self.model, self.equilibrium.system.negative_pivots)
                raise GaveUpError(
                    f"{where}: even an increment of {step:.1e} of the stage finds no equilibrium ({outcome.reason}). "
                    f"{remedy}"
                )
        is_over = self._commit(trial, stage, fraction_n, fraction, size, outcome.log, len(cutbacks))
        return IncrementReport(
            number=self.state[Progress].increments,
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=self.state[Progress].time,
            log=outcome.log,
            cutbacks=cutbacks,
            is_save_point=is_saved(
                self.model, self.state[Progress].increments, fraction_n, fraction, at_end=is_over or fraction == target
            ),
        )

    def _attempt_all(self, stage: int, fraction_n: float, fraction: float) -> tuple[State, Converged | Failed]:
        """Attempt an increment; where that fails, gently and from rest, if these may help."""
        trial, outcome = self._attempt(stage, fraction_n, fraction)
        if isinstance(outcome, Failed) and self.equilibrium.can_soften:
            trial, outcome = self._attempt(stage, fraction_n, fraction, gently=True)
        if isinstance(outcome, Failed) and self._may_turn:
            trial, outcome = self._attempt(stage, fraction_n, fraction, from_rest=True)
        return trial, outcome

    def _complete(self, trial: State, made: Step, log: IterationLog) -> Converged | Failed:
        """Complete a trial state in equilibrium, and judge whether the increment is short enough."""
        for follower in self.followers:
            follower.note(trial)
        self.end_increment(self._start, trial, made)
        if self.sheet_heat is not None:
            outcome = self.sheet_heat.find(self._start, trial, made, log)
            if isinstance(outcome, Failed):
                return outcome
            log = outcome.log
        return self.accuracy.judge(made, log)

    def _begin_stage(self, stage: int) -> None:
        """Prepare a copy of the converged state for a stage that begins. Raises GaveUpError."""
        self._start = self.state.duplicate()
        released = [i.begin_stage(self._start, stage) for i in self.interactions.all]
        self._releases = any(released)
        if self.heat is not None:
            self.heat.forming.begin_stage(self._start[HeatArrays])
        try:
            check_pushed(self.model, self.interactions, self._start, stage)
        except NotHeldError as error:
            raise GaveUpError(str(error)) from error

    @property
    def _may_turn(self) -> bool:
        """Return whether the load may turn in the next increment: shells that no tool leads may buckle, snap or
        collapse.
        """
        return self.model.analysis == "shell" and not self.model.space_tools and bool(self.state.nodes.increment.any())

    def _attempt(
        self, stage: int, fraction_n: float, fraction: float, *, gently: bool = False, from_rest: bool = False
    ) -> tuple[State, Converged | Failed]:
        """Try an increment, from the last one scaled or from where the sheet is (from_rest)."""
        state_n, trial = self._start, self._start.duplicate()
        if self.only_heat_flows(stage):
            trial.nodes.increment = np.zeros_like(trial.nodes.increment)
            return trial, Converged(IterationLog())
        last = state_n[Progress].last_size
        ratio = (fraction - fraction_n) / last if last > 0 and not from_rest else 0.0
        step = self._step(stage, fraction_n, fraction)
        if self.heat is not None:
            self.heat.begin_increment(state_n, trial, step.dt)
        for interaction in self.interactions.all:
            interaction.place(state_n, trial, step, ratio)
        guess = state_n.nodes.increment * (-BACK if self._releases else ratio)
        is_led = FormerIncrement in state_n and not self._releases
        if is_led:
            fixed = self.interactions.supports.fixed(stage)
            guess = find_first_guess(state_n, trial, fraction - fraction_n, self.interactions.all, fixed)
        if self.interactions.loose:
            guess = self.interactions.loose.steady(state_n, guess)
        is_led &= fraction - fraction_n > WORTH_ALL * last > 0.0
        return trial, self.equilibrium.solve(state_n, trial, step, guess, gently=gently, is_led=is_led)

    def only_heat_flows(self, stage: int) -> bool:
        """Return whether nothing moves in a stage."""
        return self.model.stages[stage].dwell is not None

    def _conduct(self, heat: HeatOfIncrements, trial: State, step: Step, found: Converged) -> Converged | Failed:
        """Take the heat of an increment in equilibrium to its end; repeat both where temperatures given were off."""
        state_n, log = self._start, found.log
        heat.passes = []
        for _ in range(MOST_PASSES):
            if self.followers:
                heat.passes.append((trial.duplicate(), self.equilibrium.augmented_at))
            off = heat.advance(state_n, trial, step, step.dt)
            if isinstance(off, Failed):
                return Failed(log, off.reason, off.factor)
            if off <= heat.tolerance:
                return judge_change(self.model, state_n.cells.temperature, trial.cells.temperature, step, log)
            again = self.equilibrium.solve(state_n, trial, step, trial.nodes.increment)
            log.extend(again.log)
            if isinstance(again, Failed):
                return Failed(log, again.reason, again.factor)
        return Failed(log, f"temperatures still change by {off:.3g} K from pass to pass", 0.5)

    def _step(self, stage: int, fraction_n: float, fraction: float) -> Step:
        """Return where the next increment leads."""
        now = self.state[Progress]
        dt = self.ram.take_time(self._start, stage, fraction_n, fraction, to_rest=self._to_rest)
        since = self.ram.stage_time(self._start, stage, fraction_n)
        return Step(stage, fraction_n, fraction, now.increments + 1, now.time, dt, since)

    def step_like(self, state_n: State, step: Step, fraction: float) -> Step:
        """Return a part of a stage near one that another run has gone, in the time that it takes here.

        step: of that run, whose mean speeds count in a blow: where it comes to rest, a run beside it may have no energy
        left.
        """
        if self.ram.strikes(step.stage) and not step.is_at_rest:
            dt = step.dt * (fraction - step.fraction_n) / (step.fraction - step.fraction_n)
        else:
            dt = self.ram.take_time(state_n, step.stage, step.fraction_n, fraction, to_rest=False)
        since = self.ram.stage_time(state_n, step.stage, step.fraction_n)
        return replace(step, fraction=fraction, dt=dt, stage_time_n=since)

    def end_increment(self, state_n: State, trial: State, step: Step) -> None:
        """Complete a trial state in equilibrium."""
        self.mechanics.end_increment(state_n, trial, step.dt)
        for interaction in self.interactions.all:
            interaction.commit(state_n, trial, step)
        self.accuracy.correct(state_n, trial, step)

    def _commit(
        self,
        trial: State,
        stage: int,
        fraction_n: float,
        fraction: float,
        size: float,
        log: IterationLog,
        cutbacks: int,
    ) -> bool:
        """Make the trial state in equilibrium the converged one; return whether the stage is over."""
        step, state_n = self._step(stage, fraction_n, fraction), self._start
        self.count_work(state_n, trial, step)
        if self.ram.is_needed:
            self.ram.commit(state_n, trial, step)
        if self.sheet_heat is not None:
            self.sheet_heat.take(trial)
        self.evolve(state_n, trial, step)
        note_loose(self.model, self.interactions, trial, stage)
        if FormerIncrement in trial:
            keep_former(state_n, trial)
        p = trial[Progress]
        p.time += step.dt
        p.increments += 1
        p.iterations += len(log)
        p.cutbacks += cutbacks
        p.last_size = fraction - fraction_n
        size = find_next_size(self.model.solver, size, log, cutbacks)
        size = self.accuracy.limit(state_n, trial, step, size)
        p.next_size = size
        p.stage, p.fraction = stage, fraction
        is_over = fraction == 1.0 or self.ram.is_over(trial, stage)
        if is_over:
            if fraction < 1.0:
                for interaction in self.interactions.all:
                    interaction.stop(trial, stage, fraction)
            p.stage, p.fraction, p.last_size = stage + 1, 0.0, 0.0
            if stage + 1 < len(self.model.stages):
                self.end_stage(trial, stage + 1)
            p.next_size = min(size, self.model.solver.initial_increment) if stage + 1 < len(self.model.stages) else size
        ahead = is_over and stage + 1 < len(self.model.stages)
        for follower in self.followers:
            follower.follow(self.state, trial, step, stage + 1 if ahead else None)
        self.state = trial
        return is_over

    def count_work(self, state_n: State, trial: State, step: Step) -> None:
        """Add the work of an increment to that of its completed trial state."""
        stage_n = step.stage - 1 if step.fraction_n == 0.0 and step.stage > 0 else step.stage
        fixed = self.interactions.supports.fixed
        add_external_work(state_n, trial, fixed(stage_n), fixed(step.stage))
        for interaction in self.interactions.all:
            add_work(trial, interaction.work(state_n, trial))
        trial[Work].plastic_work += self.mechanics.plastic_work(state_n, trial, step.dt)
        trial[Work].thermal_work += find_thermal_work(self.model, state_n, trial)

    def evolve(self, state_n: State, trial: State, step: Step) -> None:
        """Bring what laws of evolution follow up to date at the end of an increment."""
        heat = self.heat or self.sheet_heat
        temperatures = find_temperatures(self.mechanics, heat.at_points if heat else None, state_n, trial)
        self.evolution.advance(state_n, trial, step.dt, temperatures)

    def end_stage(self, state: State, next_stage: int) -> None:
        """Prepare a converged state for the next stage."""
        for interaction in self.interactions.all:
            interaction.end_stage(state, next_stage)

    def energy_balance(self) -> dict[str, float]:
        """Return the balance of energy.balance for the converged state [N mm, per cent]."""
        stored = sum(i.stored(self.state) for i in self.interactions.all)
        return balance(self.state, self.mechanics.elastic_energy(self.state), stored)
