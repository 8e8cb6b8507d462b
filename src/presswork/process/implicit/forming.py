# SPDX-License-Identifier: Apache-2.0
"""What is recorded of an implicit run: rows, fields and the summary."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.solids import Mechanics
from presswork.fields.instant import Instant
from presswork.fields.solid_fields import add_bodies
from presswork.fields.table import compute_fields
from presswork.geometry.pose import (
    ToolPose,
    find_axis,
    place_segments,
    start_centre,
    start_centre_in_space,
    start_profile,
)
from presswork.implicit.arc_length import ArcLengthProcedure
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.space.solid_contact import SolidContact
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.interaction.tool_course import find_turning
from presswork.model import FloatArray, IntArray, Model
from presswork.observe.contract import Metal, Row, ToolGaps
from presswork.observe.heat import show_dies
from presswork.process.implicit.held_surface import measure_held_part
from presswork.process.implicit.increments import IncrementRun
from presswork.process.implicit.tool_ends import explain_passed_ends
from presswork.process.run import Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.tool_quantities import ToolQuantities, describe_plane, measure_tools
from presswork.ranks.world import World
from presswork.results import history_columns

NEW_MESHES = "the mesh stays as it is: with [remesh] in the case it is made anew where it fails"


class ImplicitForming(IncrementRun):
    """An implicit procedure at work on solids, or on shells under loads."""

    model: Model

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        """world: ranks that share the cells of solids."""
        procedure = (
            ArcLengthProcedure(model, threads=threads)
            if model.solver.control == "arc_length"
            else ImplicitProcedure(model, threads=threads, world=world)
        )
        super().__init__(model, procedure)
        self.turning = find_turning(model.tools, model.stages)
        self._tools: dict[str, ToolQuantities] = {}

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        tools = [t.name for t in self.model.tools]
        contacts = [c.name for c in self.model.contacts if not c.by_itself]
        first = history_columns(tools, self.turning, contacts, "xyz"[: self.model.dimension])
        return [*first, *self.observers.columns(self)]

    def begin_log(self) -> str:
        """Name the linear solver."""
        changes = "".join(change.begin_log() for change in self.mesh_changes)
        return f"linear solver: {self.procedure.equilibrium.solver.name}{changes}"

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Describe how the increment was found."""
        *cutbacks, found = super().log_lines(report)
        return [*cutbacks, f"{found}, contact changes {sum(report.log.contact_changes)}"]

    def progress_text(self, report: IncrementReport) -> str:
        """Name stage and increment, and the tools that have moved."""
        tools = "  ".join(
            f"{name} {tool.stroke:.2f} mm {tool.force / 1e3:.1f} kN"
            for name, tool in self._tools.items()
            if tool.stroke
        )
        return f"{report.stage}: increment {report.number}, {len(report.log)} iterations  {tools}"

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        self._tools = measure_tools(self.procedure, self.current_stage())
        row = self._begin_row(report)
        for name, tool in self._tools.items():
            row[f"{name}.stroke"], row[f"{name}.force"] = tool.stroke, tool.force
            row |= {f"{name}.force_{axis}": float(f) for axis, f in zip("xyz", tool.vector, strict=True)}
            if name in self.turning:
                row[f"{name}.angle"], row[f"{name}.torque"] = float(np.degrees(tool.angle)), tool.torque
        forces = self.procedure.contact_forces()
        for name in (c.name for c in self.model.contacts if not c.by_itself):
            row |= {f"{name}.force_{axis}": float(f) for axis, f in zip("xyz", forces[name], strict=False)}
        return row | self.observers.row(self)

    def metal(self) -> list[Metal]:
        """Return the points of each block of solids whose flow stress is known."""
        procedure, model, state = self.procedure, self.model, self.procedure.state
        mechanics, points, found = procedure.mechanics, self.positions(), []
        for number, block in enumerate(model.mesh.blocks if isinstance(mechanics, Mechanics) else ()):
            if model.materials[block.material].umat is None:
                assert isinstance(mechanics, Mechanics)
                flow, mean = mechanics.flow_stress(number, state), state.cells.stress[number][..., :3].mean(axis=-1)
                centres = np.repeat(points[block.connectivity].mean(axis=1), mean.shape[1], axis=0)
                body = next((b.name for b in model.bodies if number in b.blocks), "workpiece")
                volume = state.cells.volume[number].ravel()
                found.append(Metal(body, mean.ravel(), flow.ravel(), centres, volume))
        return found

    def held_part(self) -> float:
        """Return the part of the surface that tools and supports hold."""
        return measure_held_part(self.procedure, self.current_stage(), self.positions())

    def tool_gaps(self) -> ToolGaps:
        """Return where tools are, and bodies in contact in the plane."""
        interactions, model, state = self.procedure.interactions, self.model, self.procedure.state
        contact, space = interactions.tools.contact, interactions.space_tools
        is_solid = model.analysis != "shell"
        between = {c.between for c in model.contacts if len(set(c.between)) == 2 and model.dimension == 2}
        pairs = []
        for pair in sorted(between):
            edges, bodies = model.mesh.boundary_edges, (model.bodies[number] for number in pair)
            pairs.append({body.name: edges[body.owns(edges)] for body in bodies})
        return ToolGaps(
            [tool.name for tool in model.space_tools] if is_solid else [],
            self._placed_profiles() if is_solid else {},
            functools.partial((space or interactions.tools).contact.find_gaps, state),
            pairs,
            contact.tolerance,
        )

    def sheet_fields(self, *, with_surface: bool) -> Mapping[str, FloatArray]:
        """Return the fields of shells, and of their surface."""
        if self.model.analysis != "shell":
            return {}
        now = self.procedure.mechanics.show(self.procedure.state)
        return {**now.sheet, **(now.surface if with_surface else {})}

    def _tool_places(self) -> list[tuple[FloatArray, float]]:
        """Return displacement (2,) [mm] and angle [rad] of each tool in the plane."""
        state = self.procedure.state
        if ToolArrays not in state:
            return []
        tools = state[ToolArrays]
        return [(moved, float(angle)) for moved, angle in zip(tools.displacement, tools.angle, strict=True)]

    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (2 | 3,) [mm]."""
        if self.model.space_tools:
            return self._surface_places()[0]
        moved = [displacement for displacement, _ in self._tool_places()]
        return dict(zip((tool.name for tool in self.model.plane_tools), moved, strict=False))

    def body_heat(self) -> tuple[HeatOfForming, HeatArrays] | None:
        """Return the heat of solids, if they have any."""
        heat = self.procedure.heat
        return None if heat is None else (heat.forming, self.procedure.state[HeatArrays])

    def _surface_places(self) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
        """Return how far each tool in space has moved (3,) [mm] and turned (3,) [rad] since the start, by its name."""
        tools = self.model.space_tools
        if SpaceToolArrays not in self.procedure.state:
            return {}, {}
        placed = self.procedure.state[SpaceToolArrays]
        moved = {tool.name: displacement.copy() for tool, displacement in zip(tools, placed.displacement, strict=True)}
        return moved, {t.name: angle * find_axis(t) for t, angle in zip(tools, placed.angle, strict=True)}

    def _placed_profiles(self) -> dict[str, FloatArray]:
        """Return the segments of each tool in the plane where it stands, by its name."""
        return {
            t.name: place_segments(start_profile(t), ToolPose(start_centre(t), moved, angle))
            for t, (moved, angle) in zip(self.model.plane_tools, self._tool_places(), strict=True)
        }

    def _find_hints(self) -> list[str]:
        """Report tools whose profiles end on the metal, dies that are full, and where new meshes would help."""
        kept = [NEW_MESHES] if self._keeps_its_mesh() else []
        return [*self._find_passed_ends(), *self.observers.hints(self), *kept, *super()._find_hints()]

    def _keeps_its_mesh(self) -> bool:
        """Whether the case could have new meshes, and does not ask for them."""
        model, solver = self.model, self.model.solver
        kinds = [len({model.mesh.blocks[i].element for i in body.blocks}) for body in model.bodies]
        one_kind = max(kinds, default=len(model.mesh.blocks)) == 1
        plain = solver.inertia == 0.0 and solver.control == "load" and solver.displacements == "large"
        return model.remeshing is None and model.dimension == 2 and one_kind and plain

    def _find_passed_ends(self) -> list[str]:
        mesh, state = self.model.mesh, self.procedure.state
        if not self.model.plane_tools:
            return []
        held = np.asarray(self.procedure.interactions.supports.fixed(self.current_stage()))[:, :2].any(axis=1)
        points = mesh.points + state.nodes.moved
        return explain_passed_ends(self._placed_profiles(), points, mesh.boundary_edges, np.asarray(held))

    def show(self) -> Instant:
        """Return what the fields of the converged state are computed from."""
        procedure = self.procedure
        state, interactions = procedure.state, procedure.interactions
        forces = interactions.tools.forces(state, self.current_stage())
        between = interactions.bodies.traction(state)
        now = procedure.mechanics.show(state, forces, between)
        if procedure.heat is not None:
            now.temperature = state[HeatArrays].temperature
        if interactions.space_tools is not None and isinstance(interactions.space_tools.contact, SolidContact):
            now.find_contact = functools.partial(interactions.space_tools.contact.show, state)
        has_fields = now.find_contact is not None or not all(c.by_itself for c in self.model.contacts)
        if self.model.dimension == 3 and between is not None and has_fields:  # fields do not come in the run
            now.find_contact = functools.partial(add_bodies, now.find_contact, between)
        self.observers.show(self, now)
        return now

    def snapshot(self) -> Snapshot:
        """Return the fields of the converged state."""
        model, state = self.model, self.procedure.state
        points, cells = compute_fields(self.show())
        points = {**points, "displacement": self.moved(points["displacement"])}
        places, (moved, rotation) = self._tool_places(), self._surface_places()
        return Snapshot(
            time=state[Progress].time,
            point_data=points,
            cell_data=cells,
            tools={t.name: start_profile(t) for t in model.plane_tools},
            dies=self._show_dies(),
            surfaces=cut_tools(model),
            tool_centre={t.name: start_centre(t) for t in model.plane_tools}
            | {t.name: start_centre_in_space(t) for t in model.space_tools},
            tool_displacement={
                t.name: displacement for t, (displacement, _) in zip(model.plane_tools, places, strict=True)
            }
            | moved,
            tool_angle={t.name: angle for t, (_, angle) in zip(model.plane_tools, places, strict=True)},
            tool_rotation=rotation,
            info={**describe_plane(model), **self.observers.info(self)},
        )

    def _show_dies(self) -> dict[str, tuple[FloatArray, IntArray, FloatArray]]:
        """Return the meshes of tools that conduct heat, and their temperatures."""
        heat = self.procedure.heat
        return show_dies(heat.forming, self.procedure.state[HeatArrays]) if heat else {}

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes, volume, contact and energies."""
        procedure = self.procedure
        state = procedure.state
        elastic_volume = procedure.mechanics.elastic_dilatation(state)
        volume, initial = procedure.volume(), procedure.initial_volume
        extremes = procedure.mechanics.extremes(state)
        return {
            **self._count_work(),
            "extremes": {name: [float(v.min()), float(v.max())] for name, v in extremes.items()},
            "volume": {
                "initial_mm3": initial,
                "final_mm3": volume,
                "change_percent": 100 * (volume / initial - 1),
                "elastic_part_percent": 100 * elastic_volume / initial,
            },
            "energy": procedure.energy_balance(),
            **self.observers.summary(self, history),
            "linear_solver": procedure.equilibrium.solver.name,
            "warnings": self.observers.warnings(self, history),
        }
