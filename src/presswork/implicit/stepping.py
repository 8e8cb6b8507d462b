# SPDX-License-Identifier: Apache-2.0
"""The implicit quasi-static procedure: stages, automatic increments, cut-backs.

It advances the converged State an increment at a time and knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from presswork import _core
from presswork.body.solids import make_mechanics
from presswork.implicit.energy import add_external_work, add_work_of_inertia, balance
from presswork.implicit.newton import Equilibrium
from presswork.interaction.supports import NotHeldError, check_shell_held, check_solid_held
from presswork.interaction.tool_contact import Contact
from presswork.model import Body, BoolArray, FloatArray, Model, Stage, ToolMotion
from presswork.outcome import Converged, Failed, GaveUpError, IterationLog, Step
from presswork.state import EXTERNAL, FRICTION, PLASTIC, State
from presswork.threads import available_threads
from presswork.timing import Timing

GROWTH = 1.5
SMALLEST = 10.0
"""Times min_increment: increments that converge slowly are made no smaller, or the end would never come."""
ENOUGH_FOR_THREADS = 10_000
"""Freedoms below which waking a second thread costs more than it gives."""
TIME, STAGE, FRACTION, INCREMENTS, LAST, SIZE, ITERATIONS, CUTBACKS = range(8)


@dataclass(frozen=True)
class IncrementReport:
    """One converged increment."""

    number: int
    stage: str
    fraction: float
    """Of the stage, at the end of the increment."""
    time: float
    log: IterationLog
    cutbacks: list[str] = field(default_factory=list)
    """Why each earlier attempt at this increment was cut back."""
    is_save_point: bool = False


class ImplicitProcedure:
    """Advances one model through its stages."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        freedoms = model.freedoms * len(model.mesh.points)
        threads = threads or (available_threads() if freedoms > ENOUGH_FOR_THREADS else 1)
        _core.set_threads(threads)
        self.model = model
        self.timing = Timing("assembly", "contact", "analysis", "solve")
        self.mechanics = make_mechanics(model, self.timing)
        self.contact = Contact(model)
        self.equilibrium = Equilibrium(model, self.mechanics, self.contact, self.timing, threads)
        self.state = self.mechanics.at_rest(len(self.contact.nodes), self.equilibrium.bodies.n_slots)
        self.state.progress[SIZE] = model.solver.initial_increment
        self.contact.begin(self.state, self.equilibrium.fixed(0))
        self._check_held()
        self.mechanics.evaluate(self.state, self.state, self.state.increment, with_stiffness=False)
        self.initial_volume = self.volume()

    def _check_held(self) -> None:
        """Refuse bodies that the first increment would push away."""
        if self.equilibrium.inertia.is_needed:
            return
        if self.model.analysis == "shell":
            sheet = self.equilibrium.sheet
            touched = sheet.held_directions(self.state) if sheet else None
            check_shell_held(self.model, self.equilibrium.fixed(0), touched)
            return
        if self.model.analysis == "solid":
            check_solid_held(self.model, self.equilibrium.fixed(0))
            return
        whole = Body("workpiece", range(len(self.model.mesh.points)), range(len(self.model.mesh.blocks)))
        bodies = self.model.bodies or (whole,)
        touching = self.equilibrium.bodies.touching(self.state)
        for number, body in enumerate(bodies):
            held = self._held_by_tools(body)
            for contact, directions in touching:
                if number in contact.between and contact.between[0] != contact.between[1]:
                    held |= (np.abs(directions) > 0.1).any(axis=0)
            if not held.all():
                free = " and ".join(axis for axis, is_held in zip("xy", held, strict=True) if not is_held)
                name = f"the {body.name}" if number == 0 else f"the body {body.name!r}"
                others = " and no other body" if self.model.contacts else ""
                raise NotHeldError(
                    f"nothing holds {name} in {free}: no boundary or displacement fixes a point there, and no tool "
                    f"that holds its place{others} touches it at the start. Add a [boundary] entry, or let a tool "
                    "touch it"
                )
        self._check_pushed(0)

    def _held_by_tools(self, body: Body) -> BoolArray:
        """Say for x and y whether supports, or tools that touch it at the start, hold a body."""
        held: BoolArray = np.asarray(self.equilibrium.fixed(0)[body.points.start : body.points.stop].any(axis=0))
        held[0] |= self.model.analysis == "axisymmetric"  # a ring resists its growth
        pushed = self.equilibrium.floating_tools.pushed(0)
        own = np.isin(self.contact.nodes, body.points)
        for t, tool in enumerate(self.model.tools):
            face, place = np.nonzero(self.state.contact[2 * t : 2 * t + 2] * own)
            along = self.contact.normal[2 * t + face, place]
            if tool.contact != "frictionless":
                along = np.concatenate([along, along[:, ::-1] * (-1, 1)])
            if t in pushed:  # it holds only across its way
                direction, _ = pushed[t]
                along = along - (along @ direction)[:, None] * direction
            held |= (np.abs(along) > 0.1).any(axis=0)
        return held

    def _check_pushed(self, stage: int) -> None:
        """Refuse a tool that a force pushes at nothing."""
        for t, (direction, _) in self.equilibrium.floating_tools.pushed(stage).items():
            face, place = np.nonzero(self.state.contact[2 * t : 2 * t + 2])
            if not (self.contact.normal[2 * t + face, place] @ direction > 0.1).any():
                name, where = self.model.tools[t].name, self.model.stages[stage].name
                raise NotHeldError(
                    f"the tool {name!r} is pushed by a force in stage {where!r}, but nothing lies before it that would "
                    "stop it: it does not touch the workpiece there when the stage begins. Bring it there first by a "
                    "stage with a stroke, or put it on a spring"
                )

    def contact_forces(self) -> dict[str, FloatArray]:
        """Return what the first body of each contact does to the second (2,) [N], as modelled."""
        return self.equilibrium.bodies.total_forces(self.state)

    def interface_stress(self) -> tuple[FloatArray, FloatArray] | None:
        """Return pressure and shear of the bodies on each other (n_points,) [MPa], if bodies touch each other."""
        return self.equilibrium.bodies.nodal_stress(self.state) if self.model.contacts else None

    def volume(self) -> float:
        """Volume of the workpiece as modelled [mm3]."""
        return float(sum(v.sum() for v in self.state.volume))

    def tool_base(self, stage: int) -> FloatArray:
        """Prescribed displacement [mm] and angle [rad] of the tools at the start of a stage (n_tools, 3)."""
        base = np.zeros((len(self.model.tools), 3))
        for earlier in self.model.stages[:stage]:
            base += self._motion(earlier)
        return base

    def _motion(self, stage: Stage) -> FloatArray:
        motions = [stage.tool_motion.get(t.name, ToolMotion()) for t in self.model.tools]
        return np.array([(*m.move, m.turn) for m in motions]).reshape(-1, 3)

    def save_points(self, stage: int) -> FloatArray:
        """Stage fractions at which an increment must end and fields are saved; the last is 1.

        Saved steps that lie closer together than the largest increment end none: they would make it smaller.
        """
        output = self.model.output
        end_increments = output.every == 0 and not output.is_closer_than(self.model.solver.max_increment)
        points = list(np.linspace(0, 1, output.steps + 1)[1:]) if end_increments else []
        if stage == len(self.model.stages) - 1:
            points += output.at
        return np.unique(np.round([*points, 1.0], 12))

    def remaining(self) -> float:
        """Part of the whole process still to be computed, counted in stage durations."""
        stage, fraction = int(self.state.progress[STAGE]), self.state.progress[FRACTION]
        durations = np.array([s.duration for s in self.model.stages])
        done = durations[:stage].sum() + (durations[stage] * fraction if stage < len(durations) else 0.0)
        return float(1.0 - done / durations.sum())

    def advance(self) -> Iterator[IncrementReport]:
        """Compute increment after increment; self.state is converged at each yield. Raises GaveUpError."""
        while int(self.state.progress[STAGE]) < len(self.model.stages):
            yield self._next_increment()

    def _next_increment(self) -> IncrementReport:
        progress = self.state.progress
        stage, fraction_n = int(progress[STAGE]), float(progress[FRACTION])
        settings = self.model.solver
        points = self.save_points(stage)
        target = float(points[np.searchsorted(points, fraction_n + 1e-12)])
        size = float(progress[SIZE])
        cutbacks: list[str] = []
        if fraction_n == 0.0 and stage > 0:
            try:
                self._check_pushed(stage)
            except NotHeldError as error:
                raise GaveUpError(str(error)) from error
        while True:
            step = min(size, target - fraction_n)
            if step * (1 + 1e-9) < target - fraction_n < 2 * step:
                step = 0.5 * (target - fraction_n)
            fraction = target if step >= (target - fraction_n) * (1 - 1e-9) else fraction_n + step
            trial, outcome = self._attempt(stage, fraction_n, fraction)
            if isinstance(outcome, Failed) and self.equilibrium.friction.is_needed:
                trial, outcome = self._attempt(stage, fraction_n, fraction, gently=True)
            if isinstance(outcome, Failed) and self._may_turn:
                trial, outcome = self._attempt(stage, fraction_n, fraction, from_rest=True)
            if not isinstance(outcome, Failed):
                break
            cutbacks.append(f"{step:.3g} of the stage: {outcome.reason}")
            size = step * outcome.factor
            if size < settings.min_increment:
                where = f"stage {self.model.stages[stage].name!r} at {fraction_n:.2%}"
                raise GaveUpError(
                    f"{where}: even an increment of {step:.1e} of the stage finds no equilibrium ({outcome.reason}). "
                    "Try a finer mesh where cells are most distorted, or look at the last saved step for folded cells"
                )
        self._commit(trial, stage, fraction_n, fraction, size, outcome.log, len(cutbacks))
        return IncrementReport(
            number=int(self.state.progress[INCREMENTS]),
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=float(self.state.progress[TIME]),
            log=outcome.log,
            cutbacks=cutbacks,
            is_save_point=self._is_save_point(fraction_n, fraction, fraction == target),
        )

    def _is_save_point(self, fraction_n: float, fraction: float, at_target: bool) -> bool:
        """Say whether an increment of a stage is saved: every so many, or what passes one of the equal steps."""
        output = self.model.output
        if output.every:
            return at_target or int(self.state.progress[INCREMENTS]) % output.every == 0
        before, now = (np.floor(f * output.steps * (1 + 1e-12)) for f in (fraction_n, fraction))
        return at_target or bool(now != before)

    @property
    def _may_turn(self) -> bool:
        """Say whether the next increment may go another way than the last: shells that buckle, snap or collapse."""
        return self.model.analysis == "shell" and bool(self.state.increment.any())

    def _attempt(
        self, stage: int, fraction_n: float, fraction: float, *, gently: bool = False, from_rest: bool = False
    ) -> tuple[State, Converged | Failed]:
        """Try an increment, from the last one scaled or from where the sheet is (from_rest)."""
        trial = self.state.duplicate()
        last = float(self.state.progress[LAST])
        ratio = (fraction - fraction_n) / last if last > 0 and not from_rest else 0.0
        guess = self.state.increment * ratio
        pose = self.tool_base(stage) + fraction * self._motion(self.model.stages[stage])
        floats = (trial.tool_gives > 0) | np.isin(
            np.arange(len(pose)), list(self.equilibrium.floating_tools.pushed(stage))
        )
        trial.tool_travel += ratio * self.state.tool_travel_increment * floats[:, None]
        trial.tool_displacement, trial.tool_angle = pose[:, :2] + trial.tool_travel, pose[:, 2]
        if self.equilibrium.sheet:
            pushed = self.equilibrium.pushed_sheet_tools.numbers(stage)
            trial.sheet_tool_travel[pushed] += ratio * self.state.sheet_tool_travel_increment[pushed]
            trial.sheet_tool_move = self.equilibrium.sheet.move(stage, fraction) + trial.sheet_tool_travel
        outcome = self.equilibrium.solve(self.state, trial, Step(stage, fraction_n, fraction), guess, gently=gently)
        return trial, outcome

    def _commit(
        self,
        trial: State,
        stage: int,
        fraction_n: float,
        fraction: float,
        size: float,
        log: IterationLog,
        cutbacks: int,
    ) -> None:
        """Make the trial state the converged one."""
        settings = self.model.solver
        self.contact.settle(trial)
        self.mechanics.settle(self.state, trial)
        trial.tool_travel_increment = trial.tool_travel - self.state.tool_travel
        trial.sheet_tool_travel_increment = trial.sheet_tool_travel - self.state.sheet_tool_travel
        dt = self.model.stages[stage].time_between(fraction_n, fraction)
        stage_n = stage - 1 if fraction_n == 0.0 and stage > 0 else stage
        fixed = self.equilibrium.fixed(stage)
        forces, torques = self.contact.tool_forces(trial, fixed)
        trial.tool_force = np.column_stack([forces, torques])
        add_external_work(self.state, trial, self.equilibrium.fixed(stage_n), fixed)
        if self.equilibrium.sheet:
            of_tools, lost = self.equilibrium.sheet.work(self.state, trial)
            trial.work[EXTERNAL] += of_tools
            trial.work[FRICTION] += lost
        if self.equilibrium.inertia.is_needed:
            add_work_of_inertia(self.state, trial)
        trial.work[PLASTIC] += self.mechanics.plastic_work(self.state, trial, dt)
        p = trial.progress
        p[TIME] += dt
        p[INCREMENTS] += 1
        p[ITERATIONS] += len(log)
        p[CUTBACKS] += cutbacks
        p[LAST] = fraction - fraction_n
        if len(log) <= settings.target_iterations and not cutbacks:
            size = min(size * GROWTH, settings.max_increment)
        elif log.smooth_iterations > settings.target_iterations + 4:
            size = max(0.7 * size, SMALLEST * settings.min_increment)
        p[SIZE] = size
        p[STAGE], p[FRACTION] = stage, fraction
        if fraction == 1.0:
            p[STAGE], p[FRACTION], p[LAST] = stage + 1, 0.0, 0.0
            if stage + 1 < len(self.model.stages):
                self.mechanics.end_stage(trial, stage + 1)
            trial.tool_force_start = forces
            p[SIZE] = min(size, settings.initial_increment) if stage + 1 < len(self.model.stages) else size
        self.state = trial

    def energy_balance(self) -> dict[str, float]:
        """Return what energy.balance says of the converged state [N mm, per cent]."""
        return balance(self.state, self.mechanics.elastic_energy(self.state))
