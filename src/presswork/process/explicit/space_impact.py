# SPDX-License-Identifier: Apache-2.0
"""Forming and impacts of a solid in space by explicit dynamics, between rigid tools: what differs from the plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.laws_of_solids import make_law
from presswork.evolution.damage import make_damage
from presswork.explicit.body_contacts import TouchingSurfaces
from presswork.explicit.dynamics import Dynamics
from presswork.explicit.energy import EnergyBalance
from presswork.explicit.motion import Motion
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids, TiedFaces
from presswork.explicit.space_walls import SpaceWall, WallStart
from presswork.fields.solid_fields import effective_stress
from presswork.geometry.pose import find_axis, find_space_pose, start_centre_in_space, turn_about
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.placing import share_modelled
from presswork.interaction.space.space_tools import check_clear, find_way_to_touch
from presswork.interaction.space.space_touch import PlacedSurface
from presswork.interaction.tool_course import find_turning
from presswork.mesh.make.box import node_volumes
from presswork.mesh.space.cyclic import pair_faces
from presswork.model import FloatArray, Model, Stage, Support, Tool, ToolMotion, find_direction
from presswork.observe.contract import Row
from presswork.observe.limits import Watched, measure_hydrostatic_stress
from presswork.observe.penetration import Penetration
from presswork.observe.working_direction import find_working_direction
from presswork.process.explicit.contacts_of_rows import ContactsOfRows, find_touching
from presswork.process.explicit.heat_of_rows import HeatOfRows, heat_by_itself
from presswork.process.explicit.heat_of_space_rows import HeatOfSpaceRows
from presswork.process.explicit.impact import ExplicitImpact
from presswork.process.explicit.shear_friction import ShearFriction, find_coefficient
from presswork.process.explicit.stage_motion import find_pushes
from presswork.process.model_recording import NamedArrays
from presswork.process.recording import Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.tool_quantities import force_on_whole
from presswork.ranks.world import World

PLACED, FORCE_START = "placed_tools.displacement", "placed_tools.force_start"
"""Names in a checkpoint."""


class ExplicitSpaceImpact(ExplicitImpact):
    """A Model of a solid in space with `explicit` at work."""

    walls: list[SpaceWall]
    solids: ExplicitSpaceSolids

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        tools = len(model.space_tools)
        self._placed = np.zeros((tools, 3))
        """Displacement at which a stage last placed each tool, from which its stroke counts [mm]."""
        self._force_start = np.zeros((tools, 3))
        """Of the workpiece on each tool, as modelled, when the stage began [N]."""
        self._moment = np.zeros(tools)
        self._share = share_modelled(model.space_tools)
        self._surfaces = [make_surface(tool.surface, smooth=True) for tool in model.space_tools]
        super().__init__(model, threads=threads, world=world)

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        model = self.model
        touching = find_touching(model)
        turning = find_turning(model.space_tools, model.stages)
        density = np.broadcast_to(epoch.get("density", 1.0), len(model.mesh.blocks))
        self.solids = self._make_solids(model, density, touching, self._world)
        self.walls = [
            self.solids.add_wall(
                tool.name,
                surface,
                position=tool.position,
                mu=find_coefficient(tool.friction),
                start=_find_start(tool, turning),
                is_at_start=not epoch,
            )
            for tool, surface in zip(model.space_tools, self._surfaces, strict=True)
        ]
        self.contacts = ContactsOfRows(model, touching, self.solids)
        self.solids.check_device()
        self._reaction = np.zeros(model.mesh.points.shape)
        self._shear = ShearFriction(model.space_tools, model.mesh)
        self._find_neighbourhoods()

    def _make_solids(
        self, model: Model, density: FloatArray, touching: Sequence[TouchingSurfaces], world: World | None = None
    ) -> ExplicitSpaceSolids:
        """Return the bodies of a model without tools; density: factor on the material's of each block (n_blocks,);
        touching: as find_touching has them; world: ranks that share the cycles.
        """
        self._axis, tied = np.zeros(0, dtype=np.int32), None
        if model.cyclic is not None:
            pairs = np.column_stack(pair_faces(model.cyclic, model.mesh))
            on_axis = pairs[:, 0] == pairs[:, 1]
            self._axis = pairs[on_axis, 0]
            tied = TiedFaces(pairs[~on_axis], 2.0 * np.pi / model.cyclic.sectors)
        blocks = zip(model.mesh.blocks, density.tolist(), strict=True)
        return ExplicitSpaceSolids(
            model.mesh,
            [self._make_material(block.material, factor) for block, factor in blocks],
            hourglass_fraction=self.settings.hourglass_stiffness,
            tied=tied,
            device=self.settings.device,
            world=world,
            touching=touching,
        )

    def _make_material(self, number: int, density: float) -> SpaceMaterial:
        """Return what a block of one of the materials is made of; density: factor on the material's."""
        model = self.model
        material = heat_by_itself(model, model.materials[number])
        return SpaceMaterial(
            law=make_law(material, model.solver, 6),  # type: ignore[arg-type]
            density=density * material.density,
            elastic=(material.young, material.poisson),
            rolling=material.rolling_direction,
            porosity=material.gtn.initial if material.gtn else None,
            damage=make_damage(material.damage, material.umat, is_solid=True),
            start=material.heating.start if material.heating else 20.0,
        )

    def _make_heat(self, threads: int) -> HeatOfRows:
        return HeatOfSpaceRows(self.model, self.solids, self.walls, self.contacts, threads, place_tool=self._surface_of)

    # --- what holds and moves ----------------------------------------------------------------------------------------

    def _prescribe(self, run: Dynamics, over: float = 1.0) -> None:
        super()._prescribe(run, over)
        if len(self._axis):
            run.fix(self._axis, "uv")

    def _hold(self, run: Dynamics, support: Support) -> None:
        if support.normal is None:
            super()._hold(run, support)
        else:
            self.solids.fix_normal(self.model.mesh.node_sets[support.node_set], support.normal)

    def _move(self, wall: SpaceWall, motion: ToolMotion, stage: Stage) -> None:
        super()._move(wall, motion, stage)
        wall.spin = motion.turn / stage.duration

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        if row == 0:
            self._place_tools(number)
        self._float_tools(number)
        time, moment = self.solids.time, [wall.impulse_of_moment for wall in self.walls]
        found = super()._compute_row(number, row)
        for i, wall in enumerate(self.walls):
            self._moment[i] = (wall.impulse_of_moment - moment[i]) / (self.solids.time - time)
        if row + 1 == self.model.output.rows:
            self._force_start = self._force.copy()
        return found

    def _place_tools(self, number: int) -> None:
        """Put tools where a stage has them when it begins."""
        for t, (tool, wall) in enumerate(zip(self.model.space_tools, self.walls, strict=True)):
            motion = self.model.stages[number].tool_motion.get(tool.name, ToolMotion())
            if motion.start is None:
                continue
            if isinstance(motion.start, str):
                target = wall.displacement + self._way_to_touch(t, motion)
            else:
                target = np.subtract(motion.start, tool.position)
            if motion.start != "touch_again":
                self._placed[t] = target
            wall.place(target)
            self._force_start[t] = 0.0
            outer = np.unique(self.model.mesh.boundary_faces)
            check_clear(tool.name, self.solids.position[outer], self._surface_of(t).nearest)

    def _way_to_touch(self, t: int, motion: ToolMotion) -> FloatArray:
        """Return how far a tool goes along its way until it touches the workpiece (3,) [mm]."""
        if self._force_start[t].any():
            return np.zeros(3)
        outer = np.unique(self.model.mesh.boundary_faces)
        return find_way_to_touch(
            self.model.space_tools[t].name,
            self._surface_of(t).nearest,
            self.solids.position[outer],
            find_direction(motion),
        )

    def _float_tools(self, number: int) -> None:
        """Let forces and springs place tools in a stage; the body's mass, as it is now, makes them stable."""
        stage = self.model.stages[number]
        mass = float(self.solids.mass.sum())
        step = max(self.solids.dt, self.settings.target_step or 0.0)
        for t, (tool, wall) in enumerate(zip(self.model.space_tools, self.walls, strict=True)):
            motion, share = stage.tool_motion.get(tool.name, ToolMotion()), float(self._share[t])
            if motion.push is not None:
                start = -float(self._force_start[t] @ np.asarray(motion.push.direction))
                table = find_pushes(motion.push.force * (1.0, share), start, stage, self._begin_of(number))
                wall.push(motion.push.direction, table, mass=mass, drag=self.settings.damping)
            elif tool.spring is not None:
                of, k = tool.spring, tool.spring.stiffness * share
                wall.rest_on_spring(of.direction, k, of.preload * share, mass=max(mass, 2.0 * k * step**2))
            else:
                wall.hold()

    def _run_to(self, to: float, motion: Motion | None) -> None:
        if self._shear.is_needed:
            strength = np.maximum(self._flow_stress(), effective_stress(self.solids.stress))
            self._shear.set(self.walls, self.solids.position, strength)
        super()._run_to(to, motion)

    # --- what is recorded --------------------------------------------------------------------------------------------

    def _measure(self, tool: Tool, wall: SpaceWall, mean: FloatArray) -> Row:
        """Return what tool_quantities tells of a tool in space."""
        row, t = super()._measure(tool, wall, mean), self.walls.index(wall)
        if tool.spring is not None:
            row[f"{tool.name}.stroke"] = wall.travel
            row[f"{tool.name}.force"] = float(force_on_whole(tool, mean) @ np.asarray(tool.spring.direction))
        elif (way := find_working_direction(self.model, tool)) is not None:
            row[f"{tool.name}.stroke"] = float((wall.displacement - self._placed[t]) @ way)
        if tool.name in find_turning([tool], self.model.stages):
            motion = self.model.stages[self.current_stage()].tool_motion.get(tool.name, ToolMotion())
            row[f"{tool.name}.angle"] = float(np.degrees(wall.angle))
            against = 1.0 if motion.turn < 0 else -1.0
            row[f"{tool.name}.torque"] = against * float(self._moment[t]) / float(self._share[t])
        return row

    def watch(self) -> Watched:
        """Return how far the present state is towards its limits."""
        model, solids = self.model, self.solids
        names = [tool.name for tool in model.space_tools]
        deepest = Penetration().note_in_space(model.mesh, solids.position, names, self._find_gaps)
        stress, flow = solids.stress, self._flow_stress()
        mean = stress[:, :3].mean(axis=1)
        centres = np.concatenate([solids.position[b.connectivity].mean(axis=1) for b in model.mesh.blocks])
        hydrostatic = measure_hydrostatic_stress(mean, flow, centres)
        return Watched(
            (hydrostatic, *self._measure_pressure(mean, flow), *([deepest] if deepest else [])),
            damage=self.find_peaks(),
        )

    def _measure_volumes(self) -> list[FloatArray]:
        return [node_volumes(self.solids.position, block.connectivity).sum(axis=1) for block in self.model.mesh.blocks]

    def _find_gaps(self, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, 3) from each tool (n_tools, n) [mm]; infinity far off it."""
        gaps = [self._surface_of(t).nearest(places, 0.0)[0] for t in range(len(self.walls))]
        return np.array(gaps).reshape(-1, len(places))

    def _surface_of(self, t: int) -> PlacedSurface:
        """Return the surface of a tool as it stands."""
        wall = self.walls[t]
        return PlacedSurface(
            self._surfaces[t], find_space_pose(self.model.space_tools[t], wall.displacement, wall.angle)
        )

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""
        tools = self.model.space_tools
        return replace(
            super().snapshot(),
            surfaces=cut_tools(self.model),
            tool_centre={tool.name: start_centre_in_space(tool) for tool in tools},
            tool_rotation={
                tool.name: wall.angle * find_axis(tool) for tool, wall in zip(tools, self.walls, strict=True)
            },
        )

    def _arrays_beside_run(self) -> NamedArrays:
        return {**super()._arrays_beside_run(), PLACED: self._placed.copy(), FORCE_START: self._force_start.copy()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        super()._load_state(arrays)
        self._placed, self._force_start = np.array(arrays[PLACED]), np.array(arrays[FORCE_START])


def _find_start(tool: Tool, turning: list[str]) -> WallStart:
    """Return how a tool stands at the start, and about what it turns in its stages."""
    rotation = turn_about(np.array(tool.rotation))
    turns = tool.name in turning or any(tool.rotation)
    return WallStart(rotation.tolist(), start_centre_in_space(tool).tolist(), find_axis(tool).tolist(), turns)
