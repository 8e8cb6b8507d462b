# SPDX-License-Identifier: Apache-2.0
"""Impacts and other fast motions of a solid by explicit dynamics: stages in rows of cycles, between rigid walls.

It knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.explicit.device import name_device
from presswork.explicit.energy import EnergyBalance, warn_of_energies
from presswork.explicit.input_checks import check_damping
from presswork.explicit.motion import EvenMotion, Motion
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.fields.instant import Instant, SolidPoints
from presswork.fields.solid_fields import add_bodies, effective_stress
from presswork.fields.table import compute_fields
from presswork.geometry.pose import ToolPose, place_segments, start_centre, start_profile
from presswork.model import ELEMENTS, Blow, Drive, ExplicitSolid, FloatArray, Mesh, Model, Stage, Tool, ToolMotion
from presswork.process.contacts_of_rows import ContactsOfRows, find_touching
from presswork.process.die_fill import make_die_fill
from presswork.process.epochs import NamedArrays
from presswork.process.heat_of_rows import HeatOfRows, heat_by_itself, names_of_heat
from presswork.process.heat_quantities import show_dies, warn_of_tables
from presswork.process.limits import Measure, Watched, measure_hydrostatic_stress, measure_mean_pressure
from presswork.process.marked_points import MarkedPoints
from presswork.process.peaks import find_peaks, peak_columns, peak_row
from presswork.process.penetration import Penetration
from presswork.process.press_quantities import RAM_COLUMNS, has_ram, summarise_ram, warn_of_ram
from presswork.process.reactions import Reactions
from presswork.process.recording import Row, Snapshot, find_never_touched
from presswork.process.row_history import BlockPoints, RowHistory
from presswork.process.rows import LAST_COLUMNS, ROW, STAGE, STAGE_WAY, RowRecording, RowReport, last_energies
from presswork.process.shear_friction import find_coefficient
from presswork.process.stage_motion import find_motion
from presswork.process.tool_quantities import describe_plane, find_way, force_on_whole, size_of_force, tool_columns
from presswork.ranks.world import World
from presswork.threads import available_threads

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity

ADDED_MASS = 2  # of the progress, after stage and row
STEPS_OF_A_ROW = 10  # in each of which the ram of a blow keeps its speed
EXTENTS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
"""Of the workpiece [mm]; the last two in space."""
ADVICE = {
    "kinetic": "inertia counts: make the tools slower, or add less mass",
    "hourglass": "refine the mesh, or set explicit.hourglass_stiffness higher",
    "error": "refine the mesh where cells are crushed",
}


class ExplicitImpact(RowRecording):
    """A Model with `explicit` at work."""

    model: Model
    solids: Any
    """ExplicitSolids, in space ExplicitSpaceSolids; and what it has for walls."""
    walls: Sequence[Any]
    contacts: ContactsOfRows
    own_arrays: Sequence[str] = ()
    """Names in a checkpoint of what is neither of the loop nor of points and heat."""
    _pores: NonlocalPorosity | None = None

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        """world: ranks that share the cycles."""
        assert isinstance(model.explicit, ExplicitSolid)
        super().__init__(model, threads, 4)
        self.settings, self._world = model.explicit, world
        self._materials = [SolidMaterial.from_model(heat_by_itself(model, material)) for material in model.materials]
        self._make_run({})
        self.solids.set_velocity(np.arange(len(model.mesh.points)), self.settings.velocity)
        for body, velocity in zip(model.bodies[1:], self.settings.velocity_of_others, strict=False):
            self.solids.set_velocity(np.asarray(body.points), velocity)
        self._force = np.zeros((len(self.walls), model.dimension))
        taken = [t.name for t in model.tools] + [c.name for c in model.contacts]
        self.reactions = Reactions(model, model.dimension, taken)
        self.marked, self.fill = MarkedPoints(model), make_die_fill(model)
        if self.settings.target_step is not None and self.solids.dt < self.settings.target_step:
            self._progress[ADDED_MASS] = self.solids.scale_mass(self.settings.target_step).percent
        check_damping(self.settings.damping, self.solids.dt)
        self.heat = self._make_heat(threads or available_threads()) if model.heat else None
        self.points = RowHistory(model.materials, [b.material for b in model.mesh.blocks], is_solid=True)
        self.points.start(self._find_points())
        self._begin_stage()

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        model, density = self.model, float(np.ravel(epoch.get("density", 1.0))[0])
        touching = find_touching(model)
        self.solids = ExplicitSolids(
            model.mesh,
            [replace(material, density=density * material.density) for material in self._materials],
            axisymmetric=model.analysis == "axisymmetric",
            depth=model.depth,
            hourglass_fraction=self.settings.hourglass_stiffness,
            world=self._world,
            touching=touching,
        )
        self.walls = [
            self.solids.add_wall(t.name, start_profile(t), mu=find_coefficient(t.friction), is_at_start=not epoch)
            for t in model.tools
        ]
        self.contacts = ContactsOfRows(model, touching, self.solids)
        self._reaction = np.zeros((len(model.mesh.points), 2))
        self._find_neighbourhoods()

    def _find_neighbourhoods(self) -> None:
        """Find the neighbourhoods over which pores are averaged."""
        if any(material.gtn for material in self.model.materials):
            from presswork.evolution.porosity import NonlocalPorosity  # loads scipy, which dense metals do without

            self._pores = NonlocalPorosity(self.model, self.mesh.points)

    def _make_heat(self, threads: int) -> HeatOfRows:
        return HeatOfRows(self.model, self.solids, self.walls, self.contacts, threads)

    # --- the way through ---------------------------------------------------------------------------------------------

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        stage, rows = self.model.stages[number], self.model.output.rows
        begin = self._begin_of(number)
        cycle, time = self.solids.cycle, self.solids.time
        impulse = [wall.impulse for wall in self.walls]
        if self.points.is_needed:
            self.points.begin_row(self._find_points())
        self.solids.reset_reaction()
        self.contacts.begin_row()
        if self.heat is not None:
            self.heat.begin_row()
        to = begin + stage.duration * (row + 1) / rows
        if stage.drive is not None and isinstance(stage.drive.motion, Blow):
            self._strike(number, stage.drive, to)
        else:
            self._run_to(to, find_motion(stage, begin))
        for i, wall in enumerate(self.walls):
            self._force[i] = (wall.impulse - impulse[i]) / (self.solids.time - time)
        self._reaction = self.solids.reaction_impulse / (self.solids.time - time)
        self.contacts.end_row(self.solids.time - time)
        if self._pores is not None:
            self.solids.average_pores(self._pores, self._measure_volumes())
        if self.heat is not None:
            self.heat.advance()
        if self.points.is_needed:
            hardens = self.points.end_row(self._find_points(), self.solids.time - time)
            if self.points.softens:
                self.solids.recover(np.concatenate(hardens)[:, 0])
        energies = self.solids.energies()
        self._progress[ADDED_MASS] = self.solids.added_mass().percent
        cycles = self.solids.cycle - cycle
        return cycles, stage.duration / rows / cycles, energies

    def _begin_of(self, number: int) -> float:
        """Return when a stage begins [s]."""
        return float(sum(stage.duration for stage in self.model.stages[:number]))

    def _run_to(self, to: float, motion: Motion | None) -> None:
        settings = self.settings
        if self.contacts.limits_shear:
            self.contacts.set_limits(np.maximum(self._flow_stress(), effective_stress(self.solids.stress)))
        self.solids.run_to(to, damping=settings.damping, target_step=settings.target_step, motion=motion)

    def _strike(self, number: int, drive: Drive, to: float) -> None:
        """Run to a time [s] with a ram whose speed follows in steps from the energy that is left."""
        for end in np.linspace(self.solids.time, to, STEPS_OF_A_ROW + 1)[1:]:
            dt, impulse = end - self.solids.time, [wall.impulse for wall in self.walls]
            left = max(drive.travel - float(self._progress[STAGE_WAY]), 0.0)
            speed = min(self._find_ram_speed(drive, 0.0), left / dt)
            self._run_to(float(end), EvenMotion(speed * drive.duration / drive.travel))  # walls have the mean velocity
            forces = np.array([(wall.impulse - i) / dt for wall, i in zip(self.walls, impulse, strict=True)])
            self._add_ram_work(number, forces.reshape(-1, self.model.dimension), speed * dt)

    def _tool_forces(self) -> FloatArray:
        return self._force

    def _begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe: the mean velocity of each motion over the stage."""
        number = int(self._progress[STAGE])
        if self.heat is not None and self._progress[ROW] == 0:
            self.heat.begin_stage()
        if number == len(self.model.stages):
            self._prescribe(self.solids)
            return
        stage = self.model.stages[number]
        self._prescribe(self.solids, stage.duration)
        for wall in self.walls:
            self._move(wall, stage.tool_motion.get(wall.name, ToolMotion()), stage)

    def _move(self, wall: Any, motion: ToolMotion, stage: Stage) -> None:
        """Let a tool move as a stage has it."""
        wall.velocity = tuple(way / stage.duration for way in motion.move[: self.model.dimension])

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        first = ["time", "stage", "increment", "cycles", *tool_columns(self.model)]
        ram = RAM_COLUMNS if has_ram(self.model) else ()
        peaks = peak_columns(self.solids.damage)
        first += self.heat.columns if self.heat else []
        points = [*self.fill.columns, *self.marked.columns(self.show())]
        first += self.contacts.columns
        return [*first, *peaks, *ram, *self.reactions.columns, *points, *self._extents, *LAST_COLUMNS]

    @property
    def time(self) -> float:
        """[s]"""
        return float(self.solids.time)

    @property
    def added_mass(self) -> float:
        """Per cent of the true mass."""
        return float(self._progress[ADDED_MASS])

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
        row |= self.heat.row() if self.heat else {}
        row |= self._ram_row(report)
        row |= peak_row(self.solids.damage)
        displacement = self.moved(self.solids.position - self.model.mesh.points)
        row |= self.reactions.measure(self.mesh, self._stage_of_row(), self._reaction, displacement)
        row |= self.fill.measure(*self._find_dies())
        row |= self.marked.measure(self.show()) if self.model.points else {}
        low, high = self.solids.position.min(axis=0), self.solids.position.max(axis=0)
        extent = (float(v) for v in np.column_stack([low, high]).ravel())
        return {**row, **dict(zip(self._extents, extent, strict=True)), **self._end_row(report)}

    @property
    def _extents(self) -> tuple[str, ...]:
        return EXTENTS[: 2 * self.model.dimension]

    def _measure(self, tool: Tool, wall: Any, mean: FloatArray) -> Row:
        """Return stroke and force of the workpiece on the whole tool, as tool_quantities does."""
        force = force_on_whole(tool, mean)
        way = find_way(self.model, tool)
        stroke, against = (
            (0.0, size_of_force(self.model, force)) if way is None else (wall.displacement @ way, -force @ way)
        )
        x, y, z = (*force, 0.0)[:3]
        values = {"stroke": stroke, "force": against, "force_x": x, "force_y": y, "force_z": z}
        return {f"{tool.name}.{name}": float(value) for name, value in values.items()}

    def _find_dies(self) -> tuple[Mesh, FloatArray, dict[str, FloatArray]]:
        """Return the mesh, where its nodes are, and how far the tools have moved (2,) [mm]."""
        return self.model.mesh, self.solids.position, {wall.name: wall.displacement for wall in self.walls}

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
        peaks = find_peaks(mesh, self.solids.position, self.solids.damage, self.solids.critical_damage())
        return Watched(
            (hydrostatic, *self._measure_pressure(mean, flow), *([deepest] if deepest else [])), damage=peaks
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
                user=[kept[:, None] for kept in solids.state_variables] if self._pores is not None else (),
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
            info={**describe_plane(model), **self.reactions.gauges(model)},
        )

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        return self.solids.keep()  # type: ignore[no-any-return]

    def _state_arrays(self) -> NamedArrays:
        return {**self._arrays_beside_run(), **self.solids.dump()}

    def _arrays_beside_run(self) -> NamedArrays:
        heat = self.heat.arrays.to_arrays() if self.heat else {}
        return {"progress": self._progress.copy(), **self.points.to_arrays(), **heat}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        self.points.load_arrays(arrays)
        own = {*self.points.to_arrays(), *names_of_heat(arrays), *self.own_arrays}
        self.solids.restore({name: np.asarray(values) for name, values in arrays.items() if name not in own})
        if self.heat is not None:
            self.heat.restore(arrays)
        self._begin_stage()

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        fields = {name: values for name, values in compute_fields(self.show())[1].items() if values.ndim == 1}
        mass = self.solids.added_mass()
        speed = self.solids.mass @ self.solids.velocity / self.solids.mass.sum()
        if self.model.analysis == "axisymmetric":
            speed[0] = 0.0  # of the whole ring
        flies = any(self.settings.velocity)
        advice = {name: text for name, text in ADVICE.items() if not (flies and name == "kinetic")}
        names = [t.name for t in self.model.tools]
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
            **(self.heat.summarise() if self.heat else {}),
            **self.fill.summarise(*self._find_dies()),
            **summarise_ram(self.model, history),
            **self.points.window.summarise(self.model.materials),
            "warnings": [
                *self.points.window.warnings(self.model.materials),
                *(f"the tool {name} never touched the workpiece" for name in find_never_touched(names, history)),
                *warn_of_energies(history, advice),
                *(warn_of_tables(self.model, history) if self.heat else ()),
                *(warn_of_ram(self.model, history, np.ones(len(self.model.stages))) if has_ram(self.model) else ()),
            ],
        }
