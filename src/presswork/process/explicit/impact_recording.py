# SPDX-License-Identifier: Apache-2.0
"""What is recorded of the explicit forming or impact of a solid: rows, limits, fields and the summary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.explicit.device import name_device
from presswork.explicit.energy import warn_of_energies
from presswork.explicit.solid_material import SolidMaterial
from presswork.fields.instant import Instant, SolidPoints
from presswork.fields.solid_fields import add_bodies, effective_stress
from presswork.fields.table import compute_fields
from presswork.geometry.pose import ToolPose, place_segments, start_centre, start_profile
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.model import ELEMENTS, ExplicitSolid, FloatArray, Model, Tool
from presswork.observe.contract import Evolved, Row
from presswork.observe.heat import show_dies
from presswork.observe.limits import Measure, Watched, measure_hydrostatic_stress, measure_mean_pressure
from presswork.observe.penetration import Penetration
from presswork.observe.reactions import Reactions
from presswork.observe.working_direction import find_working_direction
from presswork.process.explicit.contacts_of_rows import ContactsOfRows
from presswork.process.explicit.heat_of_rows import HeatOfRows
from presswork.process.explicit.loose_rows import LooseRows
from presswork.process.explicit.row_history import BlockPoints, RowHistory
from presswork.process.explicit.rows import LAST_COLUMNS, RowRecording, RowReport, last_energies
from presswork.process.recording import Snapshot
from presswork.process.tool_quantities import describe_plane, force_on_whole, size_of_force, tool_columns

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity

EXTENTS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
"""Of the workpiece [mm]; the last two in space."""
ADVICE = {
    "kinetic": "inertia counts: make the tools slower, or add less mass",
    "hourglass": "refine the mesh, or set explicit.hourglass_stiffness higher",
    "error": "refine the mesh where cells are crushed",
}


class ImpactRecording(RowRecording):
    """An explicit run of a solid whose rows and fields are recorded; who forms it sets what it is made of."""

    model: Model
    solids: Any
    """ExplicitSolids, in space ExplicitSpaceSolids; and what it has for walls."""
    walls: Sequence[Any]
    contacts: ContactsOfRows
    heat: HeatOfRows | None
    points: RowHistory
    loose: LooseRows | None
    """None where bodies are meant to fly."""
    settings: ExplicitSolid
    _materials: list[SolidMaterial]
    _pores: NonlocalPorosity | None = None
    _force: FloatArray
    """Mean force of each tool over the last row (n_walls, dimension) [N]."""
    _reaction: FloatArray
    """Mean force of what holds nodes over it (n_nodes, dimension) [N]."""

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        first = ["time", "stage", "increment", "cycles", *tool_columns(self.model)]
        first += self.contacts.columns
        return [*first, *self.observers.columns(self), *self._extents, *LAST_COLUMNS]

    @property
    def time(self) -> float:
        """[s]"""
        return float(self.solids.time)

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        obstacle = self.model.remeshing.obstacle if self.model.remeshing else ""
        device = name_device(self.settings.device)
        return (
            f"explicit: {len(self.solids.equivalent_plastic_strain)} cells{device}, stable step "
            f"{self.solids.stable_step():.3g} s, added mass {self.added_mass:.3g} %"
            + (f"; no new meshes: {obstacle}" if obstacle else "")
        )

    def progress_text(self, report: RowReport) -> str:
        """Name stage, cycle and time."""
        return f"{report.stage}: cycle {self.solids.cycle}, {1e6 * report.time:.4g} us"

    def row(self, report: RowReport) -> Row:
        """Return the row of the history; forces are means over it."""
        row: Row = {"time": report.time, "stage": report.stage, "increment": report.number, "cycles": self.solids.cycle}
        for tool, wall, mean in zip(self.model.tools, self.walls, self._force, strict=True):
            row |= self._measure(tool, wall, mean)
        row |= self.contacts.row()
        row |= self.observers.row(self)
        low, high = self.solids.position.min(axis=0), self.solids.position.max(axis=0)
        extent = (float(v) for v in np.column_stack([low, high]).ravel())
        return {**row, **dict(zip(self._extents, extent, strict=True)), **self._end_row(report)}

    @property
    def _extents(self) -> tuple[str, ...]:
        return EXTENTS[: 2 * self.model.dimension]

    def _measure(self, tool: Tool, wall: Any, mean: FloatArray) -> Row:
        """Return stroke and force of the workpiece on the whole tool, as tool_quantities does."""
        force = force_on_whole(tool, mean)
        way = find_working_direction(self.model, tool)
        stroke, against = (
            (0.0, size_of_force(self.model, force)) if way is None else (wall.displacement @ way, -force @ way)
        )
        x, y, z = (*force, 0.0)[:3]
        values = {"stroke": stroke, "force": against, "force_x": x, "force_y": y, "force_z": z}
        return {f"{tool.name}.{name}": float(value) for name, value in values.items()}

    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (2 | 3,) [mm]."""
        return {wall.name: wall.displacement for wall in self.walls}

    def positions(self) -> FloatArray:
        """Return where the nodes are (n_points, 2 | 3) [mm]."""
        return np.asarray(self.solids.position)

    def displacements(self) -> FloatArray:
        """Return displacements since the run began (n_points, 2 | 3) [mm]."""
        return self.moved(self.solids.position - self.model.mesh.points)

    def reactions(self) -> FloatArray:
        """Return the mean forces of what holds nodes over the last row (n_points, 2 | 3) [N]."""
        return self._reaction

    def body_heat(self) -> tuple[HeatOfForming, HeatArrays] | None:
        """Return the heat of the workpiece, if it has any."""
        return None if self.heat is None else (self.heat.forming, self.heat.arrays)

    def evolved(self) -> Evolved:
        """Return the damage of the cells."""
        return Evolved(self.solids.damage, self.solids.critical_damage())

    def watch(self) -> Watched:
        """Return how far the present state is towards its limits."""
        mesh, walls = self.model.mesh, zip(self.model.tools, self.walls, strict=True)
        placed = {
            tool.name: place_segments(start_profile(tool), ToolPose(np.zeros(2), wall.displacement, 0.0))
            for tool, wall in walls
        }
        deepest = Penetration().note(mesh, self.solids.position, placed, self._find_gaps)
        stress, flow = self.solids.stress, self._flow_stress()
        centres = np.concatenate([self.solids.position[b.connectivity].mean(axis=1) for b in mesh.blocks])
        mean = stress[:, :3].mean(axis=1)
        hydrostatic = measure_hydrostatic_stress(mean, flow, centres)
        return Watched(
            (hydrostatic, *self._measure_pressure(mean, flow), *([deepest] if deepest else [])),
            damage=self.find_peaks(),
        )

    def _measure_pressure(self, stress: FloatArray, flow_stress: FloatArray) -> list[Measure]:
        """Return the mean pressure in the metal; none without tools or with UMATs. Both (n,) [MPa]."""
        model = self.model
        if not model.tools or any(material.umat for material in model.materials):
            return []
        volume = np.concatenate(self._measure_volumes())
        return [measure_mean_pressure("workpiece", stress, flow_stress, volume)]

    def _measure_volumes(self) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]."""
        model, position = self.model, self.solids.position
        volumes = [
            _core.lump_volumes(
                ELEMENTS[block.element].cell, np.ascontiguousarray(block.connectivity, dtype=np.int32), position,
                axisymmetric=model.analysis == "axisymmetric", depth=model.depth,
            )
            for block in model.mesh.blocks
        ]  # fmt: skip
        return [np.sum(of, axis=1) for of in volumes]

    def _flow_stress(self) -> FloatArray:
        """Return the flow stress of the cells (n_cells,) [MPa], as SolidMaterial has it; effective stress of a UMAT."""
        solids = self.solids
        found = (solids.equivalent_plastic_strain, solids.temperature, effective_stress(solids.stress))
        parts = zip(self.mesh.blocks, *(self._split(values) for values in found), strict=True)
        return np.concatenate(
            [
                effective if self.model.materials[b.material].umat else self._materials[b.material].flow_stress(eqps, t)
                for b, eqps, t, effective in parts
            ]
        )

    def _find_gaps(self, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, 2) from each wall (n_walls, n) [mm]."""
        gaps = [
            _core.touch_profile(start_profile(tool), np.ascontiguousarray(places - wall.displacement))[0]
            for tool, wall in zip(self.model.tools, self.walls, strict=True)
        ]
        return np.array(gaps).reshape(len(gaps), len(places))

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from; a cell has one point."""
        solids, model = self.solids, self.model
        heats = self.heat is not None or any(material.heating for material in model.materials)
        by_tools = sum((wall.nodal_force for wall in self.walls), start=np.zeros_like(model.mesh.points))
        between = self.contacts.find_traction(by_tools)
        return Instant(
            model,
            solids.position - model.mesh.points,
            velocity=solids.velocity,
            reaction=self._reaction,
            tool_force=by_tools,
            find_contact=partial(add_bodies, None, between) if between else None,
            points=SolidPoints(
                stress=self._split(solids.stress[:, None]),
                eqps=self._split(solids.equivalent_plastic_strain[:, None]),
                volume=self._split(np.ones((len(solids.stress), 1))),
                user=solids.points if self._pores is not None else (),
                kept=solids.kept,
                temperature=solids.temperature if heats else None,
            ),
            evolved={**solids.damage, **self.points.values},
            temperature=self.heat.arrays.temperature if self.heat else None,
        )

    def _split(self, of_cells: FloatArray) -> list[FloatArray]:
        """Return the parts of values of cells (n_cells, ...) that each block has."""
        return np.split(of_cells, np.cumsum([len(block.connectivity) for block in self.mesh.blocks])[:-1])

    def _find_points(self) -> list[BlockPoints]:
        """Return stress, plastic strain and temperature of each block, whose cells have one point each."""
        solids, blocks = self.solids, self.mesh.blocks
        found = solids.stress.copy(), solids.equivalent_plastic_strain.copy(), solids.temperature.copy()
        parts = zip(blocks, *(self._split(values[:, None]) for values in found), strict=True)
        heats = [self.heat is not None or material.heating is not None for material in self.model.materials]
        return [BlockPoints(stress, eqps, t if heats[b.material] else None) for b, stress, eqps, t in parts]

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""
        solids, model = self.solids, self.model
        points, cells = compute_fields(self.show())
        points = {**points, "displacement": self.moved(points["displacement"])}
        return Snapshot(
            time=solids.time,
            point_data=points,
            cell_data=cells,
            tools={t.name: start_profile(t) for t in model.plane_tools},
            dies=show_dies(self.heat.forming, self.heat.arrays) if self.heat else {},
            tool_centre={t.name: start_centre(t) for t in model.plane_tools},
            tool_displacement={wall.name: wall.displacement for wall in self.walls},
            tool_angle={t.name: 0.0 for t in model.plane_tools},
            info={**describe_plane(model), **self.observers.find(Reactions).gauges(model)},
        )

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        fields = {name: values for name, values in compute_fields(self.show())[1].items() if values.ndim == 1}
        mass = self.solids.added_mass()
        speed = self.solids.mass @ self.solids.velocity / self.solids.mass.sum()
        if self.model.analysis == "axisymmetric":
            speed[0] = 0.0  # of the whole ring
        flies = any(self.settings.velocity)
        advice = {name: text for name, text in ADVICE.items() if not (flies and name == "kinetic")}
        n_cells = len(fields["effective_stress"])
        return {
            "increments": self.number,
            "cycles": self.solids.cycle,
            "work": f"{self.solids.cycle} cycles of {n_cells} cells",
            "freedoms": self.model.mesh.points.size,
            "extremes": {name: [float(v.min()), float(v.max())] for name, v in fields.items()},
            "extent_mm": {name: float(history[name][-1]) for name in self._extents} if len(history["time"]) else {},
            "centre_velocity_mm_s": [float(v) for v in speed],
            "mass": {"workpiece_t": mass.mass, "added_percent": mass.percent},
            "energy": last_energies(history),
            "time_simulated": self.solids.time,
            **self.observers.summary(self, history),
            **self.points.window.summarise(self.model.materials),
            "warnings": [
                *(self.loose.warn(self.model) if self.loose else ()),
                *self.points.window.warnings(self.model.materials),
                *warn_of_energies(history, advice),
                *self.observers.warnings(self, history),
            ],
        }
