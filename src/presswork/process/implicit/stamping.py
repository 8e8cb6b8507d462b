# SPDX-License-Identifier: Apache-2.0
"""Stamping by the implicit procedure: the same case as by explicit dynamics, turned into a shell between tools.

Strokes and prescribed displacements grow in proportion over a stage; forces, and time, follow the completed part of the
travel, as they do in the explicit procedure. Time only matters to laws with a strain rate and to inertia.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.shell_arrays import ShellArrays
from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.formability import find_thinning
from presswork.implicit.held import check_held
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.interaction.sheet_pressure import PressureArrays
from presswork.interaction.space.sheet_contact import SheetContact
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import Drive, FloatArray, Model, OutputSettings, Push, Stage, Tool, ToolMotion
from presswork.observe.contract import Row
from presswork.process.held_flange import summarise_holders, warn_of_holders
from presswork.process.implicit.increments import IncrementRun
from presswork.process.mesh_change.transfer import SheetState, begin_with, keep_heated, sheet_of_implicit
from presswork.process.run import Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.stamping_tools import (
    bead_columns,
    by_stage,
    describe_stamping,
    find_stops,
    is_pushed,
    make_whole,
    sample_over_travel,
    share_pressures,
    stroke_of,
    tabulate_force,
    tabulate_share,
    tool_columns,
    tool_text,
    working_direction_of,
)
from presswork.ranks.world import World

CLOCK_TIMES = 1000
"""Number of times in each stage at which the smooth motion is tabulated."""
WORTH_A_WARNING = 5.0
"""Limits in per cent: error of the energies over the external work, and inertia over the internal energy."""
THINNING = "max_thinning_percent"
"""Column of the history: that of the thinnest cell."""
ENERGIES = ("external_work", "elastic_energy", "plastic_work", "friction_work", "inertia_work")


def make_shell_model(model: Model) -> Model:
    """Return the Model of a shell between tools in space that does what the stamping does."""
    pushes = {t.name: _push_by_stage(model, t) for t in model.tools if is_pushed(model, t)}
    shares = {b.name: by_stage(model, *tabulate_share(model, b)) for b in model.beads}
    stages = tuple(
        Stage(
            name=stage.name,
            duration=stage.duration * stage.slower,
            clock=None if stage.drive is not None or stage.dwell is not None or _holds_rate(stage) else _clock(stage),
            drive=_drive_what_is_modelled(model, stage),
            tool_motion={name: motion for name, motion in stage.tool_motion.items() if name not in pushes}
            | {name: ToolMotion(push=of_stages[number]) for name, of_stages in pushes.items()},
            bead_share={name: of_stages[number] for name, of_stages in shares.items()},
            pressure_course=sample_over_travel(model, stage),
            prescribed=stage.prescribed,
            released=stage.released,
            dwell=stage.dwell,
        )
        for number, stage in enumerate(model.stages)
    )
    return Model(
        title=model.title,
        analysis="shell",
        mesh=model.mesh,
        zones=model.zones,
        is_relieved=model.is_relieved,
        materials=model.materials,
        supports=model.supports,
        stages=stages,
        solver=model.solver,
        output=OutputSettings(steps=model.output.steps, checkpoint_every=model.output.checkpoint_every),
        tools=model.tools,
        beads=model.beads,
        sheet_pressures=share_pressures(model),
        rolling_direction=model.rolling_direction,
        self_contact=model.self_contact,
        heat=model.heat,
        gravity=model.gravity,
    )


def _drive_what_is_modelled(model: Model, stage: Stage) -> Drive | None:
    """Return the ram of a stage; its work is that of the whole part."""
    return None if stage.drive is None else replace(stage.drive, whole=float(model.whole))


def _holds_rate(stage: Stage) -> bool:
    """Return whether a pressure holds a strain rate in a stage, which then goes on evenly in time."""
    return any(course.held is not None for course in stage.pressure_course.values())


def _clock(stage: Stage) -> FloatArray:
    """Return the time in the press at each completed part of a stage's travel, as in the explicit procedure (n, 2)."""
    times = np.linspace(0.0, stage.duration, CLOCK_TIMES + 1)
    return np.column_stack([stroke_of(stage).position(times), stage.slower * times])


def _push_by_stage(model: Model, tool: Tool) -> list[Push]:
    """Return the force of a pushed tool on what is modelled, over the completed part of each stage's travel."""
    times, forces = tabulate_force(model, tool.name)
    stop, clearance = find_stops(model).get(tool.name, ("", math.inf))
    if any(t.name == stop and is_pushed(model, t) for t in model.tools):
        stop = ""
    return [
        Push(working_direction_of(tool), rows, stop, clearance) for rows in by_stage(model, times, forces / model.whole)
    ]


class ImplicitStamping(IncrementRun):
    """A stamping at work."""

    model: Model

    def __init__(
        self, model: Model, *, threads: int = 0, begin: SheetState | None = None, world: World | None = None
    ) -> None:
        """begin: the sheet that an operation before has left, on the model's mesh; None: the blank.

        world: ranks that share the shells.
        """
        self._begins_formed = begin is not None
        shells = make_shell_model(model)
        procedure = ImplicitProcedure(shells, threads=threads, begins_formed=self._begins_formed, world=world)
        super().__init__(model, procedure)
        if begin is not None:
            begin_with(begin, self.procedure)
            check_held(self.procedure.model, self.procedure.interactions, self.procedure.state)

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        first = ["time", "stage", "increment", "iterations", *self._tool_columns(), *self._bead_columns()]
        return [*first, *self.observers.columns(self), THINNING, *ENERGIES, "energy_error_percent"]

    def begin_log(self) -> str:
        """Name the procedure and the linear solver."""
        solver = self.procedure.equilibrium.solver.name
        changes = "".join(change.begin_log() for change in self.mesh_changes)
        return f"implicit: {len(self.model.cells)} shells, linear solver: {solver}{changes}"

    def progress_text(self, report: IncrementReport) -> str:
        """Name stage and increment, and the tools that have moved."""
        tools = tool_text(self.model, self._tool_columns())
        return f"{report.stage}: increment {report.number}, {len(report.log)} iterations  {tools}"

    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the start (3,) [mm]."""
        state = self.procedure.state
        if SpaceToolArrays not in state:
            return {}
        moved = state[SpaceToolArrays].displacement
        return {t.name: moved[i].copy() for i, t in enumerate(self.model.tools)}

    def _sheet(self) -> SheetContact | None:
        """Return the contact of the sheet with its tools."""
        tools = self.procedure.interactions.space_tools
        if tools is None:
            return None
        assert isinstance(tools.contact, SheetContact)
        return tools.contact

    def _tool_columns(self) -> Row:
        sheet = self._sheet()
        forces = sheet.tool_forces(self.procedure.state) if sheet else np.zeros((0, 3))
        return tool_columns(self.model, self.tool_displacements(), make_whole(self.model, forces))

    def _bead_columns(self) -> Row:
        sheet = self._sheet()
        forces = sheet.beads.restraints(self.procedure.state) if sheet else []
        return bead_columns(self.model, forces)

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        balance = self.procedure.energy_balance()
        return {
            **self._begin_row(report),
            **self._tool_columns(),
            **self._bead_columns(),
            **self.observers.row(self),
            THINNING: self._measure_thinning(),
            **{name: balance[name] for name in ENERGIES},
            "energy_error_percent": balance["error_percent"],
        }

    def _measure_thinning(self) -> float:
        """Return by how many per cent the thinnest cell is thinner than it was."""
        now = self.procedure.state[ShellArrays].thickness
        each = zip(now, self.model.mesh.blocks, strict=True)
        return max(float(find_thinning(np.log(t / b.thickness[:, None]).mean(axis=1)).max()) for t, b in each)

    def overlap(self) -> float:
        """Return by how much the sheet overlaps itself [mm]."""
        contact = self.procedure.interactions.self_contact
        return contact.find_overlap(self.procedure.state) if contact else 0.0

    def sheet_pressures(self) -> dict[str, float]:
        """Return the pressures on the sheet by their names [MPa]."""
        state = self.procedure.state
        if PressureArrays not in state:
            return {}
        each = zip(self.model.sheet_pressures, state[PressureArrays].value, strict=True)
        return {pressure.name: float(value) for pressure, value in each}

    def held_rates(self) -> dict[str, float]:
        """Return the strain rates that pressures hold by their names [1/s], or what has leaked off them [MPa]."""
        state = self.procedure.state
        if PressureArrays not in state:
            return {}
        each = zip(self.model.sheet_pressures, state[PressureArrays].rate, strict=True)
        return {pressure.name: float(rate) for pressure, rate in each}

    def sheet_heat(self) -> tuple[HeatOfSheet, SheetHeatArrays] | None:
        """Return the heat of the sheet, if it has any."""
        heat = self.procedure.sheet_heat
        return None if heat is None else (heat.sheet, self.procedure.state[SheetHeatArrays])

    def show(self) -> Instant:
        """Return what the fields of the converged state are computed from."""
        state = self.procedure.state
        now = self.procedure.mechanics.show(state)
        now.tool_force, now.judged = np.zeros_like(self.mesh.points), self.model.judged
        if SpaceToolArrays in state:
            now.tool_force = state[SpaceToolArrays].force.sum(axis=0)
        if (heat := self.procedure.sheet_heat) is not None:
            arrays = state[SheetHeatArrays]
            now.temperature, now.heated = heat.sheet.mean_at_nodes(arrays), heat.sheet.fields(arrays)
        self.observers.show(self, now)
        return now

    def snapshot(self, now: Instant | None = None) -> Snapshot:
        """Return the fields of the converged state. now: what they are computed from, of `show`."""
        state, model = self.procedure.state, self.model
        points, cells = compute_fields(now or self.show())
        return Snapshot(
            time=state[Progress].time,
            point_data=points,
            cell_data=cells,
            info=describe_stamping(model),
            surfaces=cut_tools(model),
            tool_displacement=self.tool_displacements(),
        )

    def tool_depths(self) -> dict[str, float]:
        """Return how deep each tool is in the surface of the sheet [mm]."""
        contact = self._sheet()
        depths = contact.depths(self.procedure.state) if contact else np.zeros(0)
        return {tool.name: float(depth) for tool, depth in zip(self.model.tools, depths, strict=True)}

    def sheet_fields(self, *, with_surface: bool) -> Mapping[str, FloatArray]:
        """Return the fields of the shells, and of their surface."""
        now = self.show()
        return {**now.sheet, **now.surface} if with_surface else now.sheet

    def sheet(self) -> SheetState:
        """Return the converged state of the sheet."""
        return replace(sheet_of_implicit(self.procedure), heated=keep_heated(self.show()))

    @property
    def time(self) -> float:
        """[s]"""
        return self.procedure.state[Progress].time

    def row_at_rest(self) -> Row:
        """Return the row of the history once the part is released: strokes, and what the energies have come to."""
        balance = self.procedure.energy_balance()
        tools = tool_columns(self.model, self.tool_displacements(), np.zeros((len(self.model.tools), 3)))
        energies = {name: balance[name] for name in ENERGIES}
        return {
            "time": self.time,
            "iterations": 0,
            **tools,
            **bead_columns(self.model, [0.0] * len(self.model.beads)),
            **self.observers.row(self, is_released=True),
            THINNING: self._measure_thinning(),
            **energies,
            "energy_error_percent": balance["error_percent"],
        }

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        state = self.procedure.state
        fields = self.show().sheet
        names = ("equivalent_plastic_strain", "effective_stress", "thickness", "thickness_strain")
        energy = self.procedure.energy_balance()
        warnings: list[str] = []
        held: dict[str, dict[str, float]] = {}
        if not self._begins_formed:
            thickest = float(fields["thickness"].max())
            warnings += warn_of_holders(self.model, history, thickest)
            held = summarise_holders(self.model, history, thickest)
        if abs(energy["error_percent"]) > WORTH_A_WARNING:
            error = f"the energy balance is off by {energy['error_percent']:.3g} %"
            warnings.append(f"{error}: set implicit.max_increment lower")
        internal = energy["elastic_energy"] + energy["plastic_work"]
        if abs(energy["inertia_work"]) > 1e-2 * WORTH_A_WARNING * internal:
            part = f"inertia took {100.0 * abs(energy['inertia_work']) / internal:.3g} % of the internal energy"
            warnings.append(f"{part}: set implicit.inertia lower, or the stages' velocity")
        return {
            **self._count_work(),
            "extremes": {name: [float(fields[name].min()), float(fields[name].max())] for name in names},
            "energy": energy,
            "time_simulated": state[Progress].time,
            **self.observers.summary(self, history),
            **held,
            "linear_solver": self.procedure.equilibrium.solver.name,
            "warnings": [*self.observers.warnings(self, history), *warnings],
        }
