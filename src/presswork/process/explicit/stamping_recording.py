# SPDX-License-Identifier: Apache-2.0
"""What is recorded of an explicit stamping: rows, fields and the summary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from presswork.evolution.damage import DamageLaw
from presswork.explicit.device import name_device
from presswork.explicit.energy import warn_of_energies
from presswork.explicit.shells import ExplicitShells, Precision
from presswork.fields.evolved_layers import find_path_margins
from presswork.fields.explicit_fields import OnePointFields
from presswork.fields.formability_fields import FormingVerdict, judge_fields
from presswork.fields.instant import Instant
from presswork.fields.shell_fields import state_variable_field, temperature_field
from presswork.fields.table import compute_fields
from presswork.formability import Formability
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.law.history import EQPS
from presswork.model import ExplicitSheet, FloatArray, IntArray, Model
from presswork.observe.contract import Evolved, Row
from presswork.observe.limits import Watched, measure_overlap, measure_sheet_penetration, watch_sheet
from presswork.process.explicit.explicit_heat import ExplicitHeat
from presswork.process.explicit.loose_rows import LooseRows
from presswork.process.explicit.rows import (
    LAST_COLUMNS,
    RowProgress,
    RowRecording,
    RowReport,
    last_energies,
    process_time,
)
from presswork.process.explicit.sheet_history import SheetHistory
from presswork.process.held_flange import summarise_holders, warn_of_holders
from presswork.process.mesh_change.transfer import ShellStart, law_axes
from presswork.process.recording import Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.stamping_tools import StampingTools, describe_stamping
from presswork.state import ANEW, RUN, OnNewMesh


@dataclass
class SheetProgress(RowProgress):
    """The same of a stamping."""

    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        **RowProgress.on_new_mesh,
        "cycles": RUN,
        "shell_cycles": RUN,
        "mesh_factor": ANEW,
    }
    cycles: int = 0
    """So far."""
    shell_cycles: int = 0
    """Sum over them of the number of shells."""
    mesh_factor: float = 0.0
    """Stable step of the mesh over that of its shells; 0 until found."""


class StampingRecording(RowRecording):
    """An explicit stamping whose rows and fields are recorded; who forms it sets what it is made of."""

    model: Model
    shells: ExplicitShells
    tools: StampingTools
    heat: ExplicitHeat | None
    layers: SheetHistory
    loose: LooseRows
    settings: ExplicitSheet
    _precision: Precision
    _cells: IntArray
    _fields: OnePointFields
    _judged: Formability
    _progress: SheetProgress
    _damage_laws: tuple[DamageLaw, ...]
    _reaction: FloatArray
    _mass: float
    _formed: float
    _start: ShellStart | None
    """What the shells of a later operation start from; None: the blank."""

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        first = ["time", "stage", "increment", "cycles", *self.tools.row()]
        first += ["shells"] if self.model.refinement else []
        if self.heat is not None:
            first += ["process_time"]
        return [*first, *self.observers.columns(self), *LAST_COLUMNS]

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        return (
            f"explicit: {len(self._cells)} shells in {self._precision} precision"
            f"{name_device(self.settings.device)}, stable step "
            f"{self.shells.stable_step():.3g} s, added mass {self.added_mass:.3g} %"
        )

    def log_lines(self, report: RowReport) -> list[str]:
        """Say where the row ended, and which energies are beyond their limits."""
        return [*super().log_lines(report), *(f"warning: {each}" for each in report.energies.warnings(self._formed))]

    def progress_text(self, report: RowReport) -> str:
        """Name stage, tools and cycle: what a narrow terminal cuts off comes last."""
        return "  ".join(t for t in (f"{report.stage}:", self.tools.text(), f"cycle {self._progress.cycles}") if t)

    def row(self, report: RowReport) -> Row:
        """Return the row of the history."""
        return {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "cycles": self._progress.cycles,
            **self.tools.row(),
            **({"shells": len(self._cells)} if self.model.refinement else {}),
            **({"process_time": process_time(self.model.stages, self.shells.time)} if self.heat else {}),
            **self.observers.row(self),
            **self._end_row(report),
        }

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

    def evolved(self) -> Evolved:
        """Return what evolution laws keep at the layers."""
        n = len(self.model.mesh.blocks)
        return Evolved(self._evolved(), {law.name: [law.critical.get(law.name)] * n for law in self._damage_laws})

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from."""
        return Instant(
            self.model,
            self.shells.position - self.model.mesh.points,
            reaction=self._reaction,
            tool_force=self.shells.contact_force,
            find_sheet=self._cell_fields,
            evolved=self._evolved(),
            judged=self._judged,
            **(self.heat.show() if self.heat else {}),
        )

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

    def _cell_fields(self) -> dict[str, FloatArray]:
        shells, history = self.shells, self.shells.history_at_points
        kept = shells.kept_in_layers
        fields = self._fields.cell_fields(
            shells.position,
            shells.thickness,
            shells.flow_stress_at_points,
            shells.pressure_at_points,
            kept.of(EQPS, history),
            axis=None if self._start is None else law_axes(shells),
        )
        material = self.model.sheet[1]
        degrees = temperature_field(material, kept, history, self.shells.given_temperature)
        of_layers = find_path_margins(self.model.mesh.blocks, self._evolved())
        return fields | degrees | state_variable_field(material, history) | of_layers

    def _evolved(self) -> dict[str, list[FloatArray]]:
        """Return what evolution laws keep at the layers by quantity and block of the mesh (n_cells, q k)."""
        return self.layers.show(self.shells, self.model.mesh)

    def _judge(self, fields: Mapping[str, FloatArray]) -> FormingVerdict:
        """Return the verdict on the sheet by its cell fields."""
        model = self.model
        verdict = judge_fields(fields, model.mesh.blocks, self.shells.position, self._judged, model.symmetry)
        assert verdict is not None, "shells have principal strains"
        return verdict

    def watch(self) -> Watched:
        """Return how far the present state is towards its limits."""
        thickness = self.model.sheet[0].thickness
        depths = [measure_sheet_penetration(t.name, t.penetration, thickness) for t in self.shells.tools.values()]
        if self.model.self_contact:
            depths.append(measure_overlap(self.overlap(), thickness))
        strained = watch_sheet(self._judge(self._fields.middle_strains(self.shells.position, self.shells.thickness)))
        return Watched((*strained.measures, *depths), strained.margin, self.find_peaks())

    @property
    def time(self) -> float:
        """[s]"""
        return self.shells.time

    def row_at_rest(self) -> Row:
        """Return the row of the history once the part is released: strokes, and what the energies have come to."""
        energies = self.shells.energies(damping=self.settings.damping, velocity_scale=0.0)
        report = RowReport(self.number, "", 1.0, self.time, 0, self.shells.dt, energies, is_save_point=True)
        gone = {
            f"{t.name}.{force}": 0.0 for t in self.model.tools for force in ("force", "force_x", "force_y", "force_z")
        }
        return self.row(report) | gone | self.observers.row(self, is_released=True) | {"kinetic_energy": 0.0}

    def _warn_of_holders(self, history: Mapping[str, NDArray[Any]], thickest: float) -> list[str]:
        """Return warnings of holders on a flat blank."""
        return list(warn_of_holders(self.model, history, thickest)) if self._start is None else []

    def _summarise_holders(self, history: Mapping[str, NDArray[Any]], thickest: float) -> dict[str, dict[str, float]]:
        """Return the height of wrinkles under holders on a flat blank."""
        return summarise_holders(self.model, history, thickest) if self._start is None else {}

    def judge(self) -> FormingVerdict:
        """Return the verdict on the present sheet."""
        now = self.show()
        return self._judge({**now.sheet, **now.surface})

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        shells = self.shells
        now = self.show()
        fields = now.sheet
        verdict = self._judge({**fields, **now.surface})
        names = ("equivalent_plastic_strain", "effective_stress", "thickness", "thickness_strain")
        cycles = self._progress.cycles
        return {
            "increments": self.number,
            "cycles": cycles,
            "work": f"{cycles} cycles of {self._progress.shell_cycles / max(cycles, 1):.0f} shells",
            "freedoms": 6 * len(self.model.mesh.points),
            "extremes": {name: [float(fields[name].min()), float(fields[name].max())] for name in names},
            "mass": {"blank_t": self._mass, "added_percent": self.added_mass},
            "energy": last_energies(history),
            "time_simulated": shells.time,
            **self.observers.summary(self, history),
            **self.layers.summarise(),
            "formability": verdict.to_summary(),
            **self._summarise_holders(history, float(fields["thickness"].max())),
            "warnings": [
                *self.loose.warn(self.model),
                *self.observers.warnings(self, history),
                *self._warn_of_holders(history, float(fields["thickness"].max())),
                *warn_of_energies(history),
                *verdict.warnings(),
                *self.layers.warnings(),
            ],
        }
