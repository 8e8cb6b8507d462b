# SPDX-License-Identifier: Apache-2.0
"""Forming and impacts of solids by explicit dynamics: stages in intervals of cycles, between rigid tools.

What depends on the dimension is its domain (solids_in_plane.py, solids_in_space.py). It knows nothing of files:
recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.law_window import LawWindow
from presswork.explicit.device import name_device
from presswork.explicit.dynamics import Dynamics
from presswork.explicit.energy import EnergyBalance
from presswork.explicit.input_checks import ExplicitError, check_damping
from presswork.explicit.motion import EvenMotion, Motion
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.fields.instant import Instant
from presswork.fields.solid_fields import effective_stress
from presswork.fields.table import compute_fields
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.model import Blow, Drive, ExplicitSolid, FloatArray, Model, Support, ToolMotion
from presswork.observe.contract import Evolved, Metal, Row, ToolGaps
from presswork.observe.heat import show_dies
from presswork.process.explicit.contacts import ContactsOfRun, find_touching
from presswork.process.explicit.heat.of_solids import HeatOfSolids, heat_by_itself
from presswork.process.explicit.intervals import (
    LAST_COLUMNS,
    IntervalReport,
    IntervalRun,
    weigh_nodes,
)
from presswork.process.explicit.loose_rows import LooseRows, find_held_by_wall, is_pressed
from presswork.process.explicit.point_history import BlockPoints, PointHistory
from presswork.process.explicit.progress import IntervalProgress
from presswork.process.explicit.shear_friction import find_coefficient
from presswork.process.explicit.solid_domain import SolidDomain, Solids, WallOfRun
from presswork.process.explicit.solid_fields import find_flow_stress, find_metal, show_solids
from presswork.process.explicit.solid_summary import summarise_solids
from presswork.process.explicit.stage_motion import find_motion
from presswork.process.model_run import NamedArrays
from presswork.process.run import Snapshot
from presswork.process.tool_quantities import describe_plane, tool_columns
from presswork.threads import available_threads

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity

STEPS_OF_A_ROW = 10  # in each of which the ram of a blow keeps its speed
TRIES_WITH_CRACKS = 6
"""How often a row that fails is computed again on another mesh, where cracks make poor cells."""
PARTS = (1, 2, 4, 8)
"""Into how many parts a row is divided that fails all the same, each with a new mesh."""
EXTENTS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
"""Extents of the workpiece [mm]; the last two in space."""


class ExplicitForming(IntervalRun):
    """A Model with `explicit` at work."""

    settings: ExplicitSolid
    heat: HeatOfSolids | None
    _pores: NonlocalPorosity | None = None
    _reaction: FloatArray
    """Mean force of what holds nodes over the last row (n_nodes, dimension) [N]."""

    def __init__(self, model: Model, domain: SolidDomain, *, threads: int = 0) -> None:
        assert isinstance(model.explicit, ExplicitSolid)
        super().__init__(model, threads, IntervalProgress(model.output.rows))
        self.settings, self.domain = model.explicit, domain
        self._threads = threads or available_threads()
        self.laws = [SolidMaterial.from_model(heat_by_itself(model, material)) for material in model.materials]
        self.heat = None
        self.points = PointHistory(model.materials, [b.material for b in model.mesh.blocks], is_solid=True)
        self.make_run({})
        self.solids.set_velocity(np.arange(len(model.mesh.points)), self.settings.velocity)
        for body, velocity in zip(model.bodies[1:], self.settings.velocity_of_others, strict=False):
            self.solids.set_velocity(np.asarray(body.points), velocity)
        self._force = np.zeros((len(domain.walls), model.dimension))
        """Mean force of each tool over the last row [N]."""
        if self.settings.target_step is not None and self.solids.dt < self.settings.target_step:
            self._progress.added_mass = self.solids.scale_mass(self.settings.target_step).percent
        check_damping(self.settings.damping, self.solids.dt)
        self.heat = self.domain.make_heat(model, self.contacts, self._threads) if model.heat else None
        self.points.start(self._find_points())
        velocities = (self.settings.velocity, *self.settings.velocity_of_others)
        self.loose = None if np.any(np.ravel(velocities)) or model.gravity else LooseRows(model)
        """Loose bodies; None where bodies are meant to fly or fall."""
        self.begin_stage()

    @property
    def solids(self) -> Solids:
        """The solids at work."""
        return self.domain.solids

    @property
    def has_pores(self) -> bool:
        """Whether pores grow in a material."""
        return self._pores is not None

    @property
    def walls(self) -> Sequence[WallOfRun]:
        """The tools at work."""
        return self.domain.walls

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make solids and walls for the present mesh; epoch: of a checkpoint."""
        model = self.model
        touching = find_touching(model)
        density = np.broadcast_to(np.asarray(epoch.get("density", 1.0)), len(model.mesh.blocks))
        self.domain.make(model, density, touching, is_at_start=not epoch)
        self.solids.safety = self.settings.safety
        if model.gravity:
            self.solids.force = weigh_nodes(self.solids.mass, model.gravity, self.solids.force.shape[1])
        self.contacts = ContactsOfRun(model, touching, self.solids)
        self.domain.check_device()
        self._reaction = np.zeros((len(model.mesh.points), model.dimension))
        if any(material.gtn for material in model.materials):
            from presswork.evolution.porosity import NonlocalPorosity  # loads scipy, which dense metals do without

            self._pores = NonlocalPorosity(model, self.mesh.points)
        if epoch:
            self.heat = self.heat and self.domain.make_heat(model, self.contacts, self._threads)
            self.points.start(self._find_points())

    # --- the way through ---------------------------------------------------------------------------------------------

    def _compute_interval(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        if not self.mesh_changes:
            return self._compute_cycles(number, row)
        begin = self.to_arrays()
        for change in self.mesh_changes:
            change.look()
        for left in range(self._most_tries(), -1, -1):
            before = self.to_arrays()
            try:
                found = self._compute_cycles(number, row)
                break
            except ExplicitError as error:
                self.load_arrays(before)
                if left and any(change.look(str(error)) for change in self.mesh_changes):
                    continue
                self.load_arrays(begin)
                found = self._compute_in_parts(number, row, error)
                break
        for change in self.mesh_changes:
            change.end_step()
        return found

    def _most_tries(self) -> int:
        """Return how often a row that fails is computed again on another mesh."""
        return 1 if self.model.separation is None else TRIES_WITH_CRACKS

    def _compute_in_parts(self, number: int, row: int, error: ExplicitError) -> tuple[int, float, EnergyBalance]:
        """Compute a row that fails on any one mesh on several, as _compute_interval does; error: of the last try.

        It begins without the cracks that have grown before it: these may be what makes the meshes poor.
        """
        begin = self.to_arrays()
        for parts in PARTS:
            cycles, force = 0, np.zeros_like(self._force)
            try:
                for part in range(parts):
                    if not any(change.look(str(error)) for change in self.mesh_changes):
                        raise error
                    done, _, energies = self._compute_cycles(number, row, (part, parts))
                    if part + 1 < parts:
                        for change in self.mesh_changes:
                            change.end_step()
                    cycles, force = cycles + done, force + self._force / parts
            except ExplicitError as again:
                error = again
                self.load_arrays(begin)
                continue
            self._force = force
            self.notes.append(f"row {number * self.model.output.rows + row + 1} took {parts} meshes")
            return cycles, self.model.stages[number].duration / self.model.output.rows / cycles, energies
        raise error

    def _compute_cycles(
        self, number: int, row: int, part: tuple[int, int] = (0, 1)
    ) -> tuple[int, float, EnergyBalance]:
        """Compute a row of a stage, or one of its equal parts, on the present mesh, as _compute_interval does.

        part: number of the part, from 0, and how many there are.
        """
        stage, rows = self.model.stages[number], self.model.output.rows
        self.domain.begin_row(self, number, is_first=row == 0 and part[0] == 0)
        begin = self._begin_of(number)
        cycle, time = self.solids.cycle, self.solids.time
        impulse = [wall.impulse for wall in self.walls]
        if self.points.is_needed:
            self.points.begin_row(self._find_points())
        self.solids.reset_reaction()
        self.contacts.begin_row()
        if self.heat is not None:
            self.heat.begin_row()
        to = begin + stage.duration * (row + (part[0] + 1) / part[1]) / rows
        if stage.drive is not None and isinstance(stage.drive.motion, Blow):
            self._strike(number, stage.drive, to)
        else:
            self._run_to(to, find_motion(stage, begin))
        for i, wall in enumerate(self.walls):
            self._force[i] = (wall.impulse - impulse[i]) / (self.solids.time - time)
        self._reaction = self.solids.reaction_impulse / (self.solids.time - time)
        self.contacts.end_row(self.solids.time - time)
        if self._pores is not None:
            self.solids.average_pores(self._pores, self.domain.measure_volumes(self.model))
        if self.heat is not None:
            self.heat.advance()
        if self.points.is_needed:
            hardens = self.points.end_row(self._find_points(), self.solids.time - time)
            if self.points.softens:
                self.solids.recover(np.concatenate(hardens)[:, 0])
        if self.loose is not None:
            walls = zip(self.walls, self.model.tools, strict=True)
            held = [find_held_by_wall(wall.nodal_force, find_coefficient(tool.friction)) for wall, tool in walls]
            pressed = is_pressed(np.vstack([*self._force, self._reaction.sum(axis=0)]))
            self.loose.end_row(self.model, number, self.solids, self.solids.mass, held, self.contacts, pressed=pressed)
        self.domain.end_row(self, is_last=row + 1 == rows and part[0] + 1 == part[1])
        energies = self.solids.energies()
        self._progress.added_mass = self.solids.added_mass().percent
        cycles = self.solids.cycle - cycle
        return cycles, stage.duration / rows / cycles, energies

    def _begin_of(self, number: int) -> float:
        """Return when a stage begins [s]."""
        return float(sum(stage.duration for stage in self.model.stages[:number]))

    def _run_to(self, to: float, motion: Motion | None) -> None:
        settings = self.settings
        self.domain.limit_shear(self)
        if self.contacts.limits_shear:
            self.contacts.set_limits(np.maximum(find_flow_stress(self), effective_stress(self.solids.stress)))
        self.solids.run_to(to, damping=settings.damping, target_step=settings.target_step, motion=motion)

    def _strike(self, number: int, drive: Drive, to: float) -> None:
        """Run to a time [s] with a ram whose speed follows in steps from the energy that is left."""
        for end in np.linspace(self.solids.time, to, STEPS_OF_A_ROW + 1)[1:]:
            dt, impulse = end - self.solids.time, [wall.impulse for wall in self.walls]
            left = max(drive.travel - self._progress.stage_way, 0.0)
            speed = min(self._find_ram_speed(drive, 0.0), left / dt)
            self._run_to(float(end), EvenMotion(speed * drive.duration / drive.travel))  # walls have the mean velocity
            forces = np.array([(wall.impulse - i) / dt for wall, i in zip(self.walls, impulse, strict=True)])
            self._add_ram_work(number, forces.reshape(-1, self.model.dimension), speed * dt)

    def tool_forces(self) -> FloatArray:
        """Return the mean forces on the tools in the last row (n_tools, 2 | 3) [N]."""
        return self._force

    def begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe: the mean velocity of each motion over the stage."""
        number = self._progress.stage
        if self.heat is not None and self._progress.row == 0:
            self.heat.begin_stage()
        if number == len(self.model.stages):
            self._prescribe(self.solids)
            return
        stage = self.model.stages[number]
        self._prescribe(self.solids, stage.duration)
        for t, wall in enumerate(self.walls):
            self.domain.move(t, stage.tool_motion.get(wall.name, ToolMotion()), stage)

    def _prescribe(self, run: Dynamics, over: float = 1.0) -> None:
        super()._prescribe(run, over)
        self.domain.fix_axis()

    def _hold(self, run: Dynamics, support: Support) -> None:
        if support.normal is None:
            super()._hold(run, support)
        else:
            assert isinstance(self.solids, ExplicitSpaceSolids)
            self.solids.fix_normal(self.model.mesh.node_sets[support.node_set], support.normal)

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        first = ["time", "stage", "increment", "cycles", *tool_columns(self.model)]
        first += self.contacts.columns
        return [*first, *self.observers.columns(self), *self.extents, *LAST_COLUMNS]

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
            + "".join(change.begin_log() for change in self.mesh_changes)
        )

    def progress_text(self, report: IntervalReport) -> str:
        """Name stage, cycle and time."""
        return f"{report.stage}: cycle {self.solids.cycle}, {1e6 * report.time:.4g} us"

    def row(self, report: IntervalReport) -> Row:
        """Return the row of the history; forces are means over it."""
        row: Row = {"time": report.time, "stage": report.stage, "increment": report.number, "cycles": self.solids.cycle}
        for t, mean in enumerate(self._force):
            row |= self.domain.measure(self, t, mean)
        row |= self.contacts.row()
        row |= self.observers.row(self)
        low, high = self.solids.position.min(axis=0), self.solids.position.max(axis=0)
        extent = (float(v) for v in np.column_stack([low, high]).ravel())
        return {**row, **dict(zip(self.extents, extent, strict=True)), **self._end_row(report)}

    @property
    def extents(self) -> tuple[str, ...]:
        """Names of the workpiece's extents in the history."""
        return EXTENTS[: 2 * self.model.dimension]

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

    def law_window(self) -> LawWindow:
        """Return what the materials have been through."""
        return self.points.window

    def warn_of_loose(self) -> list[str]:
        """Return what a user should know of bodies that nothing holds."""
        return self.loose.warn(self.model) if self.loose else []

    def evolved(self) -> Evolved:
        """Return the damage of the cells."""
        return Evolved(self.solids.damage, self.solids.critical_damage())

    def metal(self) -> list[Metal]:
        """Return the cells."""
        return [find_metal(self)]

    def tool_gaps(self) -> ToolGaps:
        """Return where the tools are."""
        return self.domain.tool_gaps(self.model)

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from; a cell has one point."""
        now = show_solids(self)
        self.observers.show(self, now)
        return now

    def split(self, of_cells: FloatArray) -> list[FloatArray]:
        """Return the parts of values of cells (n_cells, ...) that each block has."""
        return np.split(of_cells, np.cumsum([len(block.connectivity) for block in self.mesh.blocks])[:-1])

    def _find_points(self) -> list[BlockPoints]:
        """Return stress, plastic strain and temperature of each block, whose cells have one point each."""
        solids, blocks = self.solids, self.mesh.blocks
        found = solids.stress.copy(), solids.equivalent_plastic_strain.copy(), solids.temperature.copy()
        parts = zip(blocks, *(self.split(values[:, None]) for values in found), strict=True)
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
            dies=show_dies(self.heat.forming, self.heat.arrays) if self.heat else {},
            tool_displacement={wall.name: wall.displacement for wall in self.walls},
            **self.domain.show_tools(model),
            info={**describe_plane(model), **self.observers.info(self)},
        )

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        return summarise_solids(self, history)

    # --- checkpoints --------------------------------------------------------------------------------------------------

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        return self.solids.keep()

    def _state_arrays(self) -> NamedArrays:
        return {**self._arrays_beside_run(), **self.solids.dump()}

    def _arrays_beside_run(self) -> NamedArrays:
        heat = self.heat.arrays.to_arrays() if self.heat else {}
        loose = self.loose.to_arrays() if self.loose else {}
        return {**self._progress.to_arrays(), **self.points.to_arrays(), **heat, **loose, **self.domain.arrays()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        self.points.load_arrays(arrays)
        if self.loose is not None:
            self.loose.load_arrays(arrays)
        self.solids.restore(arrays)
        if self.heat is not None:
            self.heat.restore(arrays)
        self.begin_stage()
        self.domain.load_arrays(arrays)
