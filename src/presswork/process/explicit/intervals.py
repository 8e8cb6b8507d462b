# SPDX-License-Identifier: Apache-2.0
"""A process that is computed in rows of cycles: as many in every stage, each a row of the history."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.body.law_window import LawWindow
from presswork.explicit.dynamics import Dynamics
from presswork.explicit.energy import ENERGIES, EnergyBalance
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.motion import DrivenStroke
from presswork.fields.instant import Instant
from presswork.implicit.ram import SPENT
from presswork.model import Blow, Drive, FloatArray, Model, Stage, Support
from presswork.observe.contract import Evolved, Observed, Ram, Row
from presswork.observe.ram import force_on_ram
from presswork.outcome import GaveUpError
from presswork.process.explicit.progress import IntervalProgress
from presswork.process.model_run import ModelRun, NamedArrays
from presswork.process.observed_run import ObservedRun
from presswork.threads import available_threads
from presswork.timing import Timing

DWELL_SHARE = 0.05
"""Share of a dwell in the progress display, over the time that forming takes to compute."""
LAST_COLUMNS = ("time_step", "added_mass_percent", *(f"{e}_energy" for e in ENERGIES), "energy_error_percent")


@dataclass(frozen=True)
class IntervalReport:
    """A row of cycles that has been computed."""

    number: int
    stage: str
    fraction: float
    """Fraction of the stage, at the end of the row."""
    time: float
    cycles: int
    step: float
    """Mean time step [s]."""
    energies: EnergyBalance
    is_save_point: bool


class IntervalRun(ObservedRun, ModelRun, ABC):
    """An explicit procedure at work on a model."""

    def __init__(
        self, model: Model, threads: int, progress: IntervalProgress, phases: Sequence[str] = ("cycles",)
    ) -> None:
        _core.set_threads(threads or available_threads())
        super().__init__(model)
        self.begin_observing()
        self.timing = Timing(*phases)
        self._progress = progress

    def at_work(self) -> Observed:
        """Return the run itself."""
        return self

    def files(self) -> dict[str, str]:
        """Return the files of the observers."""
        return self.observers.files(self)

    @property
    @abstractmethod
    def time(self) -> float:
        """[s]"""

    @property
    def added_mass(self) -> float:
        """Return the added mass in per cent of the true mass."""
        return self._progress.added_mass

    @abstractmethod
    def positions(self) -> FloatArray:
        """Return where the nodes are (n_points, 2 | 3) [mm]."""

    @abstractmethod
    def displacements(self) -> FloatArray:
        """Return displacements since the run began (n_points, freedoms) [mm, rad]."""

    @abstractmethod
    def reactions(self) -> FloatArray:
        """Return the mean forces of what holds nodes over the last row (n_points, freedoms) [N, N mm]."""

    @abstractmethod
    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (2 | 3,) [mm]."""

    @abstractmethod
    def evolved(self) -> Evolved:
        """Return what evolution laws keep at the points of the material."""

    @abstractmethod
    def law_window(self) -> LawWindow:
        """Return what the materials have been through."""

    @abstractmethod
    def warn_of_loose(self) -> list[str]:
        """Return what a user should know of bodies that nothing holds."""

    @abstractmethod
    def show(self) -> Instant:
        """Return what fields are computed from."""

    @abstractmethod
    def _compute_interval(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        """Compute a row of a stage; return its cycles, their time step [s], and the energies at its end."""

    def _add_time(self, started: float) -> None:
        """Give the time since `started` to the phases."""
        self.timing.add("cycles", started)

    @abstractmethod
    def begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe."""

    def _prescribe(self, run: Dynamics, over: float = 1.0) -> None:
        """Find what supports and the present stage prescribe on the present mesh, its values over a time [s]."""
        run.release()
        sets, number = self.model.mesh.node_sets, self._progress.stage
        for support in self.model.supports_in(min(number, len(self.model.stages) - 1)):
            self._hold(run, support)
        if number < len(self.model.stages):
            for p in self.model.stages[number].prescribed:
                run.fix(sets[p.node_set], run.FREEDOMS[p.component], p.value / over)

    def _hold(self, run: Dynamics, support: Support) -> None:
        """Hold what a support holds on the present mesh."""
        held = "".join(letter for letter, is_held in zip(run.FREEDOMS, support.fix, strict=False) if is_held)
        run.fix(self.model.mesh.node_sets[support.node_set], held)

    def advance(self) -> Iterator[IntervalReport]:
        """Compute row after row. Raises GaveUpError, with the state of the last row, where the motion breaks down."""
        while self._progress.stage < len(self.model.stages):
            before = self._keep()
            try:
                report = self._next_row()
            except (ExplicitError, KeyboardInterrupt) as error:
                self.load_arrays(before())
                if isinstance(error, KeyboardInterrupt):
                    raise
                raise GaveUpError(str(error)) from error
            yield report

    def _keep(self) -> Callable[[], NamedArrays]:
        """Keep the present state, on the device where the run is there; return what gives it."""
        run = self._keep_run()
        if run is None:
            arrays = self.to_arrays()
            return lambda: arrays
        others = self._describe_epoch() | self._arrays_beside_run()
        return lambda: {**others, **run()}

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        """Keep the state of the loop on its device; return what gives it, or None where there is no device."""
        return None

    @abstractmethod
    def _arrays_beside_run(self) -> NamedArrays:
        """Return the part of the state that the loop does not have."""

    def _next_row(self) -> IntervalReport:
        started = perf_counter()
        number, row = self._progress.stage, self._progress.row
        stage, rows, steps = self.model.stages[number], self.model.output.rows, self.model.output.steps
        if row == 0:
            self._progress.stage_work = self._progress.stage_way = 0.0
        cycles, step, energies = self._compute_interval(number, row)
        if stage.drive is not None and not isinstance(stage.drive.motion, Blow):
            travel = stage.drive.travel * np.diff(DrivenStroke(stage.drive).position(self._times(stage, row)))
            self._add_ram_work(number, self.tool_forces(), float(travel[0]))
        self._progress.row = row + 1
        if row + 1 == rows:
            self._progress.stage, self._progress.row = number + 1, 0
            self.begin_stage()
        self._add_time(started)
        return IntervalReport(
            number=number * rows + row + 1,
            stage=stage.name,
            fraction=(row + 1) / rows,
            time=self.time,
            cycles=cycles,
            step=step,
            energies=energies,
            is_save_point=(row + 1) * steps // rows > row * steps // rows,
        )

    @abstractmethod
    def tool_forces(self) -> FloatArray:
        """Return the mean forces on the tools in the last row (n_tools, 2 | 3) [N]."""

    def _add_ram_work(self, number: int, forces: FloatArray, travel: float) -> None:
        """Count the work of a stage's ram over a travel [mm], by the mean forces on the tools (n_tools, 2 | 3) [N]."""
        work = float(force_on_ram(self.model, number, forces) * travel)
        self._progress.ram_work += work
        self._progress.stage_work += work
        self._progress.stage_way += travel

    def _find_ram_speed(self, drive: Drive, fraction: float) -> float:
        """Return the speed of the ram [mm/s] at a fraction of its stage's time."""
        if not isinstance(drive.motion, Blow):
            return drive.speed_at(drive.part_at(fraction * drive.duration))
        spent, travel = self._progress.stage_work, self._progress.stage_way
        is_over = drive.motion.energy - spent <= SPENT * drive.motion.energy or travel >= drive.travel * (1 - 1e-12)
        return 0.0 if is_over else drive.motion.speed_with(drive.motion.energy - spent)

    def _times(self, stage: Stage, row: int) -> FloatArray:
        """Return when a row begins and ends, since the stage began (2,) [s]."""
        return stage.duration * np.array([row, row + 1]) / self.model.output.rows

    def ram(self) -> Ram:
        """Return the ram: its speed at the end of the last row, and the mean force over that."""
        number, work = self.current_stage(), self._progress.ram_work
        drive = self.model.stages[number].drive
        if drive is None:
            return Ram(0.0, 0.0, work, 0)
        row, rows = self._progress.row, self.model.output.rows
        speed = self._find_ram_speed(drive, row / rows if row else 1.0)
        blow = drive.motion.number if isinstance(drive.motion, Blow) else 0
        return Ram(speed, force_on_ram(self.model, number, self.tool_forces()), work, blow)

    def plastic_shares(self) -> FloatArray:
        """Return ones: all work of the ram counts as plastic."""
        return np.ones(len(self.model.stages))

    @property
    def next_stage(self) -> int:
        """The stage of the next row; the number of stages after the last."""
        return self._progress.stage

    @property
    def row_of_stage(self) -> int:
        """The next row, counted in its stage from 0."""
        return self._progress.row

    def current_stage(self) -> int:
        """Return the stage that the last row belongs to."""
        return max(self._progress.stage - (self._progress.row == 0), 0)

    def _take_up(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up the progress in these arrays. Raises ValueError if they belong to another model."""
        own = self._state_arrays()
        if set(own) != set(arrays) or any(own[k].shape != arrays[k].shape for k in own):
            raise ValueError("the checkpoint belongs to another case: its arrays do not fit this mesh")
        found, wanted = arrays[f"{IntervalProgress.owner}.rows"], self.model.output.rows
        if found != wanted:
            raise ValueError(f"the checkpoint is of a run with output.rows = {found:g}, on which its steps depend")
        self._progress.load_arrays(arrays)

    def _epoch_arrays(self) -> NamedArrays:
        return self.observers.arrays()

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self.observers.load_arrays(epoch)

    def remaining(self) -> float:
        """Return the part of the whole process still to be computed, counted in stage durations."""
        now = self._progress
        return remaining_in_rows(weigh_stages(self.model.stages), now.stage, now.row, self.model.output.rows)

    @property
    def number(self) -> int:
        """Rows so far."""
        return self._progress.stage * self.model.output.rows + self._progress.row

    def log_lines(self, report: IntervalReport) -> list[str]:
        """Describe where the row ended."""
        e = report.energies
        return [
            *self.take_notes(),
            f"row {report.number}, stage {report.stage} at {report.fraction:.4f}, {report.cycles} cycles of "
            f"{report.step:.4g} s, kinetic {e.kinetic:.3g}, internal {e.internal:.3g}, hourglass {e.hourglass:.3g} "
            f"N mm, balance off by {e.error_percent:.2g} %",
        ]

    def _end_row(self, report: IntervalReport) -> Row:
        """Return the LAST_COLUMNS of the history."""
        return {
            "time_step": report.step,
            "added_mass_percent": self.added_mass,
            **{f"{e}_energy": getattr(report.energies, e) for e in ENERGIES},
            "energy_error_percent": report.energies.error_percent,
        }


def weigh_nodes(mass: FloatArray, gravity: Sequence[float], freedoms: int) -> FloatArray:
    """Return the weight of nodes (n_nodes, freedoms) [N] by their masses before any is added (n_nodes,) [t].

    >>> weigh_nodes(np.array([2.0]), (0.0, 0.0, -10.0), 6).tolist()
    [[0.0, 0.0, -20.0, 0.0, 0.0, 0.0]]
    """
    weight = np.zeros((len(mass), freedoms))
    weight[:, : len(gravity)] = mass[:, None] * np.asarray(gravity)
    return weight


def process_time(stages: Sequence[Stage], time: float) -> float:
    """Return the time in the press [s] by the time that is computed [s]."""
    past = 0.0
    for stage in stages:
        past += min(max(time, 0.0), stage.duration) * stage.slower
        time -= stage.duration
    return past


def last_energies(history: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Return the ENERGIES at the end of a history [N mm]; none of an empty one."""
    return {e: float(history[f"{e}_energy"][-1]) for e in ENERGIES} if len(history["time"]) else {}


def weigh_stages(stages: Sequence[Stage]) -> list[float]:
    """Return the durations of the stages [s], of a dwell the share of what is formed that it costs."""
    formed = sum(stage.duration for stage in stages if stage.dwell is None) or 1.0
    return [stage.duration if stage.dwell is None else DWELL_SHARE * formed for stage in stages]


def remaining_in_rows(durations: Sequence[float], stage: int, row: int, rows: int) -> float:
    """Return the part of a process that is left after so many rows of a stage, by the durations of its stages.

    >>> remaining_in_rows([1.0, 3.0], stage=1, row=5, rows=10)
    0.375
    """
    if stage == len(durations):
        return 0.0
    return 1.0 - (sum(durations[:stage]) + durations[stage] * row / rows) / sum(durations)
