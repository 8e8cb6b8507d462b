# SPDX-License-Identifier: Apache-2.0
"""Solids in space between rigid tools, as an explicit run of them depends on their dimension."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.laws_of_solids import make_law
from presswork.evolution.damage import make_damage
from presswork.explicit.body_contacts import TouchingSurfaces
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids, TiedFaces
from presswork.explicit.space_walls import WallStart
from presswork.fields.solid_fields import effective_stress
from presswork.geometry.pose import find_axis, find_space_pose, start_centre_in_space, turn_about
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.placing import share_modelled
from presswork.interaction.space.space_tools import check_clear, find_travel_to_touch
from presswork.interaction.space.space_touch import PlacedSurface
from presswork.interaction.tool_course import find_turning
from presswork.mesh.make.box import node_volumes
from presswork.mesh.space.cyclic import pair_faces
from presswork.model import ExplicitSolid, FloatArray, Model, Stage, Tool, ToolMotion, find_direction
from presswork.observe.contract import Row, ToolGaps
from presswork.observe.working_direction import find_working_direction
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.process.explicit.heat.of_solids import HeatOfSolids, heat_by_itself
from presswork.process.explicit.heat.of_solids_in_space import HeatOfSolidsInSpace
from presswork.process.explicit.shear_friction import ShearFriction, find_coefficient
from presswork.process.explicit.solid_domain import measure_tool
from presswork.process.explicit.solid_fields import find_flow_stress
from presswork.process.explicit.stage_motion import find_pushes
from presswork.process.model_run import NamedArrays
from presswork.process.space_surfaces import cut_tools
from presswork.process.tool_quantities import force_on_whole
from presswork.ranks.world import World

if TYPE_CHECKING:
    from presswork.process.explicit.forming import ExplicitForming

PLACED, FORCE_START = "placed_tools.displacement", "placed_tools.force_start"
"""Names in a checkpoint."""


class SolidsInSpace:
    """The solids of a run, and its tools as walls, which may be placed, pushed, carried by springs, and turn."""

    solids: ExplicitSpaceSolids

    def __init__(self, model: Model, settings: ExplicitSolid, world: World | None = None) -> None:
        """world: ranks that share the cycles."""
        self._settings, self._world, tools = settings, world, model.space_tools
        self._placed = np.zeros((len(tools), 3))
        """Displacement at which a stage last placed each tool, from which its stroke counts [mm]."""
        self._force_start = np.zeros((len(tools), 3))
        """Force of the workpiece on each tool, as modelled, when the stage began [N]."""
        self._moment = np.zeros(len(tools))
        """Moment about the axis of each tool in the last interval [N mm]."""
        self._impulse_n, self._time_n = np.zeros(len(tools)), 0.0
        self._tools, self._share = tools, share_modelled(tools)
        self._surfaces = [make_surface(tool.surface, smooth=True) for tool in tools]

    def make(
        self, model: Model, density: FloatArray, touching: Sequence[TouchingSurfaces], *, is_at_start: bool
    ) -> None:
        """Make solids and walls of a model.

        density: factor on the material's of each block (n_blocks,). touching: surfaces that touch.
        """
        turning = find_turning(self._tools, model.stages)
        self.solids = self.make_solids(model, density, touching, self._world)
        self.walls = [
            self.solids.add_wall(
                tool.name,
                surface,
                position=tool.position,
                mu=find_coefficient(tool.friction),
                start=_find_start(tool, turning),
                is_at_start=is_at_start,
            )
            for tool, surface in zip(self._tools, self._surfaces, strict=True)
        ]
        self._shear = ShearFriction(self._tools, model.mesh)

    def make_solids(
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
            [_make_material(model, block.material, factor) for block, factor in blocks],
            hourglass_fraction=self._settings.hourglass_stiffness,
            tied=tied,
            device=self._settings.device,
            world=world,
            touching=touching,
        )

    def make_heat(self, model: Model, contacts: ContactsOfRun, threads: int) -> HeatOfSolids:
        """Return what conducts heat in the solids and to the walls."""
        return HeatOfSolidsInSpace(model, self.solids, self.walls, contacts, threads, place_tool=self.surface_of)

    def check_device(self) -> None:
        """Raise ExplicitError where the device does not have what the solids ask for, contacts included."""
        self.solids.check_device()

    # --- what holds and moves ----------------------------------------------------------------------------------------

    def fix_axis(self) -> None:
        """Hold the axis of a sector."""
        if len(self._axis):
            self.solids.fix(self._axis, "uv")

    def move(self, number: int, motion: ToolMotion, stage: Stage) -> None:
        """Let a tool, by its number, move and turn as a stage has it."""
        wall = self.walls[number]
        wall.velocity = tuple(travel / stage.duration for travel in motion.move)
        wall.spin = motion.turn / stage.duration

    def begin_row(self, run: ExplicitForming, number: int, *, is_first: bool) -> None:
        """Place tools before an interval, the first of a stage or a later one."""
        if is_first:
            self._place_tools(run.model, number)
        self._float_tools(run.model, number)
        self._time_n = self.solids.time
        self._impulse_n = np.array([wall.impulse_of_moment for wall in self.walls])

    def end_row(self, run: ExplicitForming, *, is_last: bool) -> None:
        """Measure the moments of the tools after an interval, the last of a stage or an earlier one."""
        impulse = np.array([wall.impulse_of_moment for wall in self.walls])
        self._moment = (impulse - self._impulse_n) / (self.solids.time - self._time_n)
        if is_last:
            self._force_start = run.tool_forces().copy()

    def _place_tools(self, model: Model, number: int) -> None:
        """Put tools where a stage has them when it begins."""
        for t, (tool, wall) in enumerate(zip(self._tools, self.walls, strict=True)):
            motion = model.stages[number].tool_motion.get(tool.name, ToolMotion())
            if motion.start is None:
                continue
            if isinstance(motion.start, str):
                target = wall.displacement + self._find_travel_to_touch(model, t, motion)
            else:
                target = np.subtract(motion.start, tool.position)
            if motion.start != "touch_again":
                self._placed[t] = target
            wall.place(target)
            self._force_start[t] = 0.0
            outer = np.unique(model.mesh.boundary_faces)
            check_clear(tool.name, self.solids.position[outer], self.surface_of(t).nearest)

    def _find_travel_to_touch(self, model: Model, t: int, motion: ToolMotion) -> FloatArray:
        """Return how far a tool goes until it touches the workpiece (3,) [mm]."""
        if self._force_start[t].any():
            return np.zeros(3)
        outer = np.unique(model.mesh.boundary_faces)
        return find_travel_to_touch(
            self._tools[t].name,
            self.surface_of(t).nearest,
            self.solids.position[outer],
            find_direction(motion),
        )

    def _float_tools(self, model: Model, number: int) -> None:
        """Let forces and springs place tools in a stage; the body's mass, as it is now, makes them stable."""
        stage, begin = model.stages[number], float(sum(s.duration for s in model.stages[:number]))
        mass = float(self.solids.mass.sum())
        step = max(self.solids.dt, self._settings.target_step or 0.0)
        for t, (tool, wall) in enumerate(zip(self._tools, self.walls, strict=True)):
            motion, share = stage.tool_motion.get(tool.name, ToolMotion()), float(self._share[t])
            if motion.push is not None:
                start = -float(self._force_start[t] @ np.asarray(motion.push.direction))
                table = find_pushes(motion.push.force * (1.0, share), start, stage, begin)
                wall.push(motion.push.direction, table, mass=mass, drag=self._settings.damping)
            elif tool.spring is not None:
                of, k = tool.spring, tool.spring.stiffness * share
                wall.rest_on_spring(of.direction, k, of.preload * share, mass=max(mass, 2.0 * k * step**2))
            else:
                wall.hold()

    def limit_shear(self, run: ExplicitForming) -> None:
        """Limit the shear stress of friction by the strength of the metal."""
        if self._shear.is_needed:
            strength = np.maximum(find_flow_stress(run), effective_stress(self.solids.stress))
            self._shear.set(self.walls, self.solids.position, strength)

    # --- what is measured --------------------------------------------------------------------------------------------

    def measure(self, run: ExplicitForming, number: int, mean: FloatArray) -> Row:
        """Return what the history has of a tool, by its number. mean: force on what is modelled of it (3,) [N]."""
        model, wall = run.model, self.walls[number]
        tool = model.tools[number]
        row = measure_tool(model, tool, wall, mean)
        if tool.spring is not None:
            row[f"{tool.name}.stroke"] = wall.travel
            row[f"{tool.name}.force"] = float(force_on_whole(tool, mean) @ np.asarray(tool.spring.direction))
        elif (direction := find_working_direction(model, tool)) is not None:
            row[f"{tool.name}.stroke"] = float((wall.displacement - self._placed[number]) @ direction)
        if tool.name in find_turning([tool], model.stages):
            motion = model.stages[run.current_stage()].tool_motion.get(tool.name, ToolMotion())
            row[f"{tool.name}.angle"] = float(np.degrees(wall.angle))
            against = 1.0 if motion.turn < 0 else -1.0
            row[f"{tool.name}.torque"] = against * float(self._moment[number]) / float(self._share[number])
        return row

    def tool_gaps(self, model: Model) -> ToolGaps:
        """Return where the tools are."""
        return ToolGaps([tool.name for tool in self._tools], {}, self._find_gaps)

    def _find_gaps(self, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, 3) from each tool (n_tools, n) [mm]; infinity far off it."""
        gaps = [self.surface_of(t).nearest(places, 0.0)[0] for t in range(len(self.walls))]
        return np.array(gaps).reshape(-1, len(places))

    def surface_of(self, t: int) -> PlacedSurface:
        """Return the surface of a tool where it stands."""
        wall = self.walls[t]
        return PlacedSurface(self._surfaces[t], find_space_pose(self._tools[t], wall.displacement, wall.angle))

    def measure_volumes(self, model: Model) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]."""
        return [node_volumes(self.solids.position, block.connectivity).sum(axis=1) for block in model.mesh.blocks]

    def show_tools(self, model: Model) -> dict[str, Any]:
        """Return what a Snapshot has of the tools."""
        turned = {t.name: wall.angle * find_axis(t) for t, wall in zip(self._tools, self.walls, strict=True)}
        return {
            "surfaces": cut_tools(model),
            "tool_centre": {tool.name: start_centre_in_space(tool) for tool in self._tools},
            "tool_rotation": turned,
        }

    def arrays(self) -> NamedArrays:
        """Return where stages have placed the tools, and the forces on them then."""
        return {PLACED: self._placed.copy(), FORCE_START: self._force_start.copy()}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._placed, self._force_start = np.array(arrays[PLACED]), np.array(arrays[FORCE_START])


def _make_material(model: Model, number: int, density: float) -> SpaceMaterial:
    """Return what a block of one of the materials is made of; density: factor on the material's."""
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


def _find_start(tool: Tool, turning: list[str]) -> WallStart:
    """Return how a tool stands at the start, and about what it turns in its stages."""
    rotation = turn_about(np.array(tool.rotation))
    turns = tool.name in turning or any(tool.rotation)
    return WallStart(rotation.tolist(), start_centre_in_space(tool).tolist(), find_axis(tool).tolist(), turns)
