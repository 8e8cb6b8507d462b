# SPDX-License-Identifier: Apache-2.0
"""The contract of the domain of an explicit run of solids, in the plane or in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from numpy.typing import NDArray

from presswork.explicit.body_contacts import TouchingSurfaces
from presswork.explicit.solids import ExplicitSolids
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.explicit.space_walls import SpaceWall
from presswork.explicit.walls import Wall
from presswork.model import FloatArray, Model, Stage, Tool, ToolMotion
from presswork.observe.contract import Row, ToolGaps
from presswork.observe.working_direction import find_working_direction
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.process.explicit.heat.of_solids import HeatOfSolids
from presswork.process.model_run import NamedArrays
from presswork.process.tool_quantities import force_on_whole, size_of_force

if TYPE_CHECKING:
    from presswork.process.explicit.forming import ExplicitForming


Solids = ExplicitSolids | ExplicitSpaceSolids
WallOfRun = Wall | SpaceWall


class SolidDomain(Protocol):
    """The solids of a run, its tools as walls, and all that depends on their dimension."""

    @property
    def solids(self) -> Solids:
        """ExplicitSolids, in space ExplicitSpaceSolids."""

    @property
    def walls(self) -> Sequence[WallOfRun]:
        """The tools, in their order."""

    def make(
        self, model: Model, density: FloatArray, touching: Sequence[TouchingSurfaces], *, is_at_start: bool
    ) -> None:
        """Make solids and walls of a model.

        density: factor on the material's of each block (n_blocks,). touching: surfaces that touch.
        """

    def make_heat(self, model: Model, contacts: ContactsOfRun, threads: int) -> HeatOfSolids:
        """Return what conducts heat in the solids and to the walls."""

    def check_device(self) -> None:
        """Raise ExplicitError where the device does not have what the solids ask for, contacts included."""

    def fix_axis(self) -> None:
        """Hold the axis of a sector."""

    def move(self, number: int, motion: ToolMotion, stage: Stage) -> None:
        """Let a tool, by its number, move as a stage has it."""

    def begin_row(self, run: ExplicitForming, number: int, *, is_first: bool) -> None:
        """Place tools before an interval, the first of a stage or a later one."""

    def limit_shear(self, run: ExplicitForming) -> None:
        """Limit the shear stress of friction by the strength of the metal."""

    def end_row(self, run: ExplicitForming, *, is_last: bool) -> None:
        """Measure the tools after an interval, the last of a stage or an earlier one."""

    def measure(self, run: ExplicitForming, number: int, mean: FloatArray) -> Row:
        """Return what the history has of a tool, by its number. mean: force on what is modelled of it (d,) [N]."""

    def tool_gaps(self, model: Model) -> ToolGaps:
        """Return where the tools are."""

    def measure_volumes(self, model: Model) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]."""

    def show_tools(self, model: Model) -> dict[str, Any]:
        """Return what a Snapshot has of the tools."""

    def arrays(self) -> NamedArrays:
        """Return what a checkpoint keeps beside the state of the solids."""

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""


def measure_tool(model: Model, tool: Tool, wall: WallOfRun, mean: FloatArray) -> Row:
    """Return stroke and force of the workpiece on the whole tool, as tool_quantities does."""
    force = force_on_whole(tool, mean)
    direction = find_working_direction(model, tool)
    stroke, against = (
        (0.0, size_of_force(model, force)) if direction is None else (wall.displacement @ direction, -force @ direction)
    )
    x, y, z = (*force, 0.0)[:3]
    values = {"stroke": stroke, "force": against, "force_x": x, "force_y": y, "force_z": z}
    return {f"{tool.name}.{name}": float(value) for name, value in values.items()}
