# SPDX-License-Identifier: Apache-2.0
"""Stamping by explicit dynamics: stages in rows of cycles, tools that move smoothly, energies watched.

It knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import stop
from presswork.body.law_window import LawWindow
from presswork.evolution.damage import make_damage
from presswork.explicit.device import name_device
from presswork.explicit.energy import YIELD_OFFSET, EnergyBalance, MassScaling
from presswork.explicit.input_checks import check_damping
from presswork.explicit.mesh_step import MeshStep
from presswork.explicit.shells import PHASES, SAFETY
from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.law.elastic_plastic import first_flow_stress
from presswork.model import ExplicitSheet, FloatArray, IntArray, Model, Stage
from presswork.observe.contract import Evolved, Row
from presswork.process.explicit.blank_shells import find_precision, make_shells
from presswork.process.explicit.heat.of_sheet import HeatOfShells
from presswork.process.explicit.intervals import LAST_COLUMNS, IntervalReport, IntervalRun, process_time
from presswork.process.explicit.loose_rows import LooseRows, is_pressed
from presswork.process.explicit.progress import SheetProgress
from presswork.process.explicit.refined_sheet import RefinedSheet
from presswork.process.explicit.sheet_fields import SheetFields
from presswork.process.explicit.sheet_history import SheetHistory
from presswork.process.explicit.sheet_summary import summarise_sheet
from presswork.process.line.laying import find_sag
from presswork.process.mesh_change.transfer import SheetState, ShellStart, fill_layers, keep_heated, sheet_of_explicit
from presswork.process.model_run import NamedArrays
from presswork.process.run import Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.stamping_tools import StampingTools, describe_stamping, mean_speeds
from presswork.ranks.world import World

ELEMENT_CYCLES_A_CALL = {"cpu": 2_000_000, "host": 2_000_000, "cuda": 200_000_000}
"""Cycles of elements between two looks at the keyboard: about a second."""
SAMPLES = 10
"""Least number of samples of the tools' forces in a row; single cycles are noisy."""
LOOKS = 50
"""A stage, at shells that may have to be split, and at the step of the mesh: once in 2 % of it."""


class ExplicitStamping(IntervalRun):
    """A stamping at work."""

    model: Model

    def __init__(
        self,
        model: Model,
        *,
        threads: int = 0,
        begin: SheetState | None = None,
        level: int = 0,
        world: World | None = None,
    ) -> None:
        """begin: the sheet that an operation before has left, on the model's mesh; None: the blank.

        level: how often its shells have been split by then. world: ranks that share the cycles.
        """
        self._world = world
        assert isinstance(model.explicit, ExplicitSheet)
        self.progress = SheetProgress(model.output.rows)
        super().__init__(model, threads, self.progress, (*PHASES, "rest"))
        self.settings = model.explicit
        self.begins_flat = begin is None
        self.refined = RefinedSheet(self, None if begin is None else ShellStart.of(begin), level)
        self.add_mesh_change(self.refined)
        self._precision = find_precision(model)
        self.shells = make_shells(model, self.refined.start, self.refined.find_hanging(), world)
        self._mesh_step: MeshStep | None = None
        if begin is not None:
            fill_layers(self.shells, begin)
        self.blank_mass = float(self.shells.mass[:, 0].sum())
        self._reaction = np.zeros((len(model.mesh.points), 6))
        each = model.sheet_materials
        self._formed = min(YIELD_OFFSET * first_flow_stress(m) * self.blank_mass / m.density for m in each)
        if self.settings.target_step is not None:
            self._scale_mass(self.settings.target_step)
        check_damping(self.settings.damping, self._longest_step())
        if model.self_contact is not None:
            self.shells.touch_itself(mu=model.self_contact.mu, undeformed=model.mesh.points)
        sag = 0.0 if begin is None else float(np.linalg.norm(find_sag(begin)[1], axis=1).max())
        self.tools = StampingTools(model, self.shells, sag=sag)
        self.heat = HeatOfShells(model, self.shells, self.tools.at_work) if model.heat else None
        self.layers = SheetHistory(model, self.shells)
        self._fields = SheetFields(model, self.shells, self.layers, begins_flat=self.begins_flat)
        if begin is not None:
            self.layers.take(begin.blocks, self.shells)
        self.loose = LooseRows(model)
        self.begin_stage()
        self.shells.find_contact()

    def _compute_interval(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        stage, rows = self.model.stages[number], self.model.output.rows
        if row % max(1, rows // LOOKS) == 0:
            for change in self.mesh_changes:
                change.look()
            if self.settings.step_bound == "mesh":
                self._mesh_step = self._mesh_step or MeshStep(self.shells, self._precision)
                last = self.progress.mesh_factor
                self.progress.mesh_factor = float(self._mesh_step.find_factor(self.shells, last))
        begin, end = (stage.duration * r / rows for r in (row, row + 1))
        if self.heat is not None:
            self.heat.begin_row()
        self.layers.begin_row(self.shells)
        found = self._compute_cycles(stage, begin, end)
        self.layers.end_row(self.shells, stage.slower * (end - begin))
        return found

    def _compute_cycles(self, stage: Stage, begin: float, end: float) -> tuple[int, float, EnergyBalance]:
        """Compute cycles, or a dwell, from one time of a stage to another [s]; return as _compute_interval."""
        n_shells = len(self.model.cells)
        if stage.dwell is not None:
            return self._compute_dwell(stage, end - begin)
        n = int(np.ceil((end - begin) / self._longest_step() * (1 - 1e-12)))
        self.shells.dt = (end - begin) / n
        every, most = max(1, n // SAMPLES), max(1, ELEMENT_CYCLES_A_CALL[self.settings.device] // n_shells)
        self.tools.begin_row()
        self.shells.reset_reaction()
        self._seconds_n = self.shells.seconds
        for part in np.split(mean_speeds(stage, begin, end, n), range(every, n, every)):
            for speeds in np.split(part, range(most, len(part), most)):
                self.shells.advance(len(speeds), velocity_scale=speeds, damping=self.settings.damping)
            self.tools.sample()
            if self.heat is not None:
                self.heat.sample()
            stop.look()
        self._reaction = self.shells.reaction_impulse / (end - begin)
        if self.tools.hold_sheet:
            self.loose.hold(self.progress.stage, pressed=is_pressed(self.tools.forces()))
        elif not self.model.gravity:
            self.loose.end_row(self.model, self.progress.stage, self.shells, self.shells.mass[:, 0])
        energies = self._energies(stage, end)
        self.progress.cycles += n
        self.progress.shell_cycles += n * n_shells
        if self.heat is not None:
            self.heat.advance(stage.slower * (end - begin), None)
        return n, self.shells.dt, energies

    def _compute_dwell(self, stage: Stage, dt: float) -> tuple[int, float, EnergyBalance]:
        """Let heat alone flow for a row of dt [s]; shells and tools stay as they are."""
        assert self.heat is not None
        assert stage.dwell is not None
        self.tools.begin_row()
        self.tools.sample()
        self._seconds_n = self.shells.seconds
        self._reaction = np.zeros_like(self._reaction)
        self.heat.advance(dt, stage.dwell)
        self.shells.time += dt
        return 0, dt, self.shells.energies(damping=self.settings.damping, velocity_scale=0.0)

    def _add_time(self, started: float) -> None:
        """Share out the time since `started`, by the readings of the shells' clock then and now."""
        spent = {phase: now - self._seconds_n[phase] for phase, now in self.shells.seconds.items()}
        for phase, seconds in spent.items():
            self.timing.add_seconds(phase, seconds)
        self.timing.add_seconds("rest", perf_counter() - started - sum(spent.values()))

    @property
    def level(self) -> int:
        """How often the shells that were split most have been split."""
        return self.refined.level

    def make_shells_again(self) -> None:
        """Make shells and tools anew for the present mesh; pushed tools keep their masses."""
        start, hanging = self.refined.start, self.refined.find_hanging()
        self.shells = make_shells(self.model, start, hanging, self._world)
        self._mesh_step = None
        self.progress.mesh_factor = 0.0
        self._reaction = np.zeros((len(self.mesh.points), 6))
        self.tools = StampingTools(self.model, self.shells, self.tools)
        self._fields = SheetFields(self.model, self.shells, self.layers, begins_flat=self.begins_flat)
        self.list_observers()

    def _longest_step(self) -> float:
        """Return the time step allowed now; add mass where the target asks for it."""
        settings, bound = self.settings, self.shells.stable_step() * max(1.0, self.progress.mesh_factor)
        if settings.target_step is None:
            return settings.safety * bound
        if settings.safety * bound < settings.target_step * (1 - 1e-9):
            self._scale_mass(settings.target_step)
        return settings.target_step

    def _scale_mass(self, target: float) -> MassScaling:
        """Add mass so that the target is `safety` times the stable step."""
        scaling = self.shells.scale_mass(target * SAFETY / self.settings.safety)
        self.progress.added_mass = scaling.percent
        return scaling

    def tool_forces(self) -> FloatArray:
        """Return the mean forces on the tools in the last row (n_tools, 3) [N]."""
        return self.tools.forces()

    def begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe."""
        number = self.progress.stage
        self._prescribe(self.shells)
        self.tools.begin_stage(number)
        if number < len(self.model.stages):
            self.shells.set_slower(self.model.stages[number].slower)

    def _energies(self, stage: Stage, time: float) -> EnergyBalance:
        """Return the energies; the next half step goes on with the present speed."""
        dt = self.shells.dt
        speed = float(mean_speeds(stage, time - dt, time, 1)[0])
        return self.shells.energies(damping=self.settings.damping, velocity_scale=speed)

    def sheet(self) -> SheetState:
        """Return the present state of the sheet."""
        return replace(
            sheet_of_explicit(self.shells, self.layers.find_values(self.shells)), heated=keep_heated(self.show())
        )

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        first = ["time", "stage", "increment", "cycles", *self.tools.row()]
        if self.heat is not None:
            first += ["process_time"]
        return [*first, *self.observers.columns(self), *LAST_COLUMNS]

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        return (
            f"explicit: {len(self.model.cells)} shells in {self._precision} precision"
            f"{name_device(self.settings.device)}, stable step "
            f"{self.shells.stable_step():.3g} s, added mass {self.added_mass:.3g} %"
            + "".join(change.begin_log() for change in self.mesh_changes)
        )

    def log_lines(self, report: IntervalReport) -> list[str]:
        """Describe where the row ended, and which energies are beyond their limits."""
        return [*super().log_lines(report), *(f"warning: {each}" for each in report.energies.warnings(self._formed))]

    def progress_text(self, report: IntervalReport) -> str:
        """Name stage, tools and cycle: what a narrow terminal cuts off comes last."""
        return "  ".join(t for t in (f"{report.stage}:", self.tools.text(), f"cycle {self.progress.cycles}") if t)

    def row(self, report: IntervalReport) -> Row:
        """Return the row of the history."""
        return {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "cycles": self.progress.cycles,
            **self.tools.row(),
            **({"process_time": process_time(self.model.stages, self.shells.time)} if self.heat else {}),
            **self.observers.row(self),
            **self._end_row(report),
        }

    def sheet_pressures(self) -> dict[str, float]:
        """Return the pressures on the sheet by their names [MPa]."""
        return {name: self.shells.find_pressure(name) for name in self.shells.pressures}

    def sheet_heat(self) -> tuple[HeatOfSheet, SheetHeatArrays] | None:
        """Return the heat of the sheet, if it has any."""
        return None if self.heat is None else (self.heat.sheet, self.heat.arrays)

    def positions(self) -> FloatArray:
        """Return where the nodes are (n_points, 3) [mm]."""
        return self.shells.position

    def displacements(self) -> FloatArray:
        """Return displacements since the run began; rotations are not kept (n_points, 6) [mm]."""
        moved = np.zeros((len(self.model.mesh.points), 6))
        moved[:, :3] = self.shells.position - self.model.mesh.points
        return moved

    def reactions(self) -> FloatArray:
        """Return the mean forces of what holds nodes over the last row (n_points, 6) [N, N mm]."""
        return self._reaction

    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (3,) [mm]."""
        return self.tools.displacement()

    def overlap(self) -> float:
        """Return by how much the sheet overlaps itself [mm]."""
        return float(self.shells.find_overlap()[0])

    def law_window(self) -> LawWindow:
        """Return what the sheet's material has been through."""
        return self.layers.window

    def warn_of_loose(self) -> list[str]:
        """Return what a user should know of a sheet that nothing holds."""
        return self.loose.warn(self.model)

    def evolved(self) -> Evolved:
        """Return what evolution laws keep at the layers."""
        blocks = [self.model.materials[block.material] for block in self.model.mesh.blocks]
        laws = [make_damage(material.damage, material.umat, is_solid=False) for material in blocks]
        critical = {
            name: [law.critical.get(name) for of in laws for law in of if law.name == name]
            for name in self.shells.damage
        }
        return Evolved(self._fields.find_evolved(), critical)

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from."""
        now = Instant(
            self.model,
            self.shells.position - self.model.mesh.points,
            reaction=self._reaction,
            tool_force=self.shells.contact_force,
            find_sheet=self._fields.find,
            evolved=self._fields.find_evolved(),
            judged=self.model.judged,
            **(self.heat.show() if self.heat else {}),
        )
        self.observers.show(self, now)
        return now

    def snapshot(self, now: Instant | None = None) -> Snapshot:
        """Return the fields of the present state. now: what they are computed from, of `show`."""
        points, cells = compute_fields(now or self.show())
        return Snapshot(
            time=self.shells.time,
            point_data=points,
            cell_data=cells,
            info=describe_stamping(self.model),
            surfaces=self._tool_surfaces,
            tool_displacement=self.tools.displacement(),
        )

    @cached_property
    def _tool_surfaces(self) -> dict[str, tuple[FloatArray, IntArray]]:
        """Triangles of the tools where they start; files keep those of the first step."""
        return cut_tools(self.model)

    def tool_depths(self) -> dict[str, float]:
        """Return how deep each tool is in the surface of the sheet [mm]."""
        return {tool.name: tool.penetration for tool in self.shells.tools.values()}

    def sheet_fields(self, *, with_surface: bool) -> Mapping[str, FloatArray]:
        """Return the strains of the middle of the shells, or all fields of the shells with those of their surface."""
        if not with_surface:
            return self._fields.find_middle_strains()
        now = self.show()
        return {**now.sheet, **now.surface}

    @property
    def time(self) -> float:
        """[s]"""
        return self.shells.time

    def row_at_rest(self) -> Row:
        """Return the row of the history once the part is released: strokes, and what the energies have come to."""
        energies = self.shells.energies(damping=self.settings.damping, velocity_scale=0.0)
        report = IntervalReport(self.number, "", 1.0, self.time, 0, self.shells.dt, energies, is_save_point=True)
        gone = {
            f"{t.name}.{force}": 0.0 for t in self.model.tools for force in ("force", "force_x", "force_y", "force_z")
        }
        return self.row(report) | gone | self.observers.row(self, is_released=True) | {"kinetic_energy": 0.0}

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        return summarise_sheet(self, history)

    # --- checkpoints --------------------------------------------------------------------------------------------------

    def _epoch_arrays(self) -> NamedArrays:
        return {**self.refined.epoch_arrays(), **super()._epoch_arrays()}

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make shells and tools for the present mesh; epoch: of a checkpoint."""
        self.refined.begin_epoch(epoch)
        self.make_shells_again()
        self.layers.start(self.shells)

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        return self.shells.keep()

    def _state_arrays(self) -> NamedArrays:
        return self._arrays_beside_run() | self.shells.dump()

    def _arrays_beside_run(self) -> NamedArrays:
        heat = self.heat.dump() if self.heat else {}
        return {**self.progress.to_arrays(), **self.layers.dump(), **heat, **self.loose.to_arrays()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        self.layers.restore(arrays)
        self.loose.load_arrays(arrays)
        self.shells.restore(arrays)
        if self.heat is not None:
            self.heat.restore(arrays)
        self.begin_stage()
