# SPDX-License-Identifier: Apache-2.0
"""Solids in the plane and in axisymmetry between walls, as an explicit run of them depends on their dimension."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.explicit.body_contacts import TouchingSurfaces
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.geometry.pose import ToolPose, place_segments, start_centre, start_profile
from presswork.model import ELEMENTS, ExplicitSolid, FloatArray, Model, Stage, ToolMotion
from presswork.observe.contract import Row, ToolGaps
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.process.explicit.heat.of_solids import HeatOfSolids, heat_by_itself
from presswork.process.explicit.heat.of_solids_in_plane import HeatOfSolidsInPlane
from presswork.process.explicit.shear_friction import find_coefficient
from presswork.process.explicit.solid_domain import measure_tool
from presswork.process.model_run import NamedArrays
from presswork.ranks.world import World

if TYPE_CHECKING:
    from presswork.process.explicit.forming import ExplicitForming


class SolidsInPlane:
    """The solids of a run, and its tools as walls."""

    solids: ExplicitSolids

    def __init__(self, settings: ExplicitSolid, world: World | None = None) -> None:
        """world: ranks that share the cycles."""
        self._settings, self._world = settings, world

    def make(
        self, model: Model, density: FloatArray, touching: Sequence[TouchingSurfaces], *, is_at_start: bool
    ) -> None:
        """Make solids and walls of a model.

        density: factor on the material's of each block (n_blocks,), the same for all. touching: surfaces that touch.
        """
        materials = [SolidMaterial.from_model(heat_by_itself(model, material)) for material in model.materials]
        factor = float(density[0])
        self.solids = ExplicitSolids(
            model.mesh,
            [replace(material, density=factor * material.density) for material in materials],
            axisymmetric=model.analysis == "axisymmetric",
            depth=model.depth,
            hourglass_fraction=self._settings.hourglass_stiffness,
            world=self._world,
            touching=touching,
        )
        self.walls = [
            self.solids.add_wall(t.name, start_profile(t), mu=find_coefficient(t.friction), is_at_start=is_at_start)
            for t in model.tools
        ]

    def make_heat(self, model: Model, contacts: ContactsOfRun, threads: int) -> HeatOfSolids:
        """Return what conducts heat in the solids and to the walls."""
        return HeatOfSolidsInPlane(model, self.solids, self.walls, contacts, threads)

    def check_device(self) -> None:
        """Check nothing: sections are computed on the processor."""

    def fix_axis(self) -> None:
        """Hold nothing: supports hold the axis."""

    def move(self, number: int, motion: ToolMotion, stage: Stage) -> None:
        """Let a tool, by its number, move as a stage has it."""
        self.walls[number].velocity = motion.move[0] / stage.duration, motion.move[1] / stage.duration

    def begin_row(self, run: ExplicitForming, number: int, *, is_first: bool) -> None:
        """Place nothing: tools in the plane only move."""

    def limit_shear(self, run: ExplicitForming) -> None:
        """Limit nothing: friction in the plane is Coulomb's."""

    def end_row(self, run: ExplicitForming, *, is_last: bool) -> None:
        """Measure nothing: tools in the plane do not turn."""

    def measure(self, run: ExplicitForming, number: int, mean: FloatArray) -> Row:
        """Return what the history has of a tool, by its number. mean: force on what is modelled of it (2,) [N]."""
        return measure_tool(run.model, run.model.tools[number], self.walls[number], mean)

    def tool_gaps(self, model: Model) -> ToolGaps:
        """Return where the tools are."""
        placed = {
            tool.name: place_segments(start_profile(tool), ToolPose(np.zeros(2), wall.displacement, 0.0))
            for tool, wall in zip(model.tools, self.walls, strict=True)
        }
        return ToolGaps(list(placed), placed, lambda places: self._find_gaps(model, places))

    def _find_gaps(self, model: Model, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, 2) from each wall (n_walls, n) [mm]."""
        gaps = [
            _core.touch_profile(start_profile(tool), np.ascontiguousarray(places - wall.displacement))[0]
            for tool, wall in zip(model.tools, self.walls, strict=True)
        ]
        return np.array(gaps).reshape(len(gaps), len(places))

    def measure_volumes(self, model: Model) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]."""
        position = self.solids.position
        volumes = [
            _core.lump_volumes(
                ELEMENTS[block.element].cell, np.ascontiguousarray(block.connectivity, dtype=np.int32), position,
                axisymmetric=model.analysis == "axisymmetric", depth=model.depth,
            )
            for block in model.mesh.blocks
        ]  # fmt: skip
        return [np.sum(of, axis=1) for of in volumes]

    def show_tools(self, model: Model) -> dict[str, Any]:
        """Return what a Snapshot has of the tools."""
        return {
            "tools": {t.name: start_profile(t) for t in model.plane_tools},
            "tool_centre": {t.name: start_centre(t) for t in model.plane_tools},
            "tool_angle": {t.name: 0.0 for t in model.plane_tools},
        }

    def arrays(self) -> NamedArrays:
        """Return nothing beside the state of the solids."""
        return {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up nothing."""
