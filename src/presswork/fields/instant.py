# SPDX-License-Identifier: Apache-2.0
"""State of any procedure at one instant, from which the fields are computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from presswork.formability import Formability, Judged
from presswork.law.history import History
from presswork.model import FloatArray


@dataclass(frozen=True)
class SolidPoints:
    """Integration points of solids: an array for each block of cells, c cells with q points each."""

    stress: Sequence[FloatArray]
    """xx, yy, zz, xy (c, q, 4), in space also yz, xz (c, q, 6) [MPa]."""
    eqps: Sequence[FloatArray]
    """Equivalent plastic strain (c, q)."""
    volume: Sequence[FloatArray]
    """Weights of the points in a cell's mean (c, q)."""
    user: Sequence[FloatArray] = ()
    """State variables of laws from libraries (c, q, n)."""
    kept: Sequence[History] = ()
    """Their names."""
    temperature: FloatArray | None = None
    """Temperature of the cells of all blocks (n_cells,) [degrees C]."""


@dataclass(frozen=True)
class NodalContact:
    """Contact of solids at the nodes, zero where there is none."""

    gap: FloatArray
    """Distance from the nearest tool (n_points,) [mm]; NaN inside the body and where there is no tool."""
    status: FloatArray
    """0 apart, 1 held along the normal, 2 held in both directions (n_points,)."""
    pressure: FloatArray
    """Positive in compression (n_points,) [MPa]."""
    shear: FloatArray
    """(n_points,) [MPa]."""
    friction_limit: FloatArray
    """Largest shear that the tools' laws of friction allow (n_points,) [MPa]."""
    traction: Mapping[str, FloatArray]
    """Contact stress of each tool on the workpiece (n_points, 3) [MPa]."""
    total_traction: FloatArray
    """Contact stress of all tools (n_points, 3) [MPa]."""
    force: FloatArray
    """Contact forces of tools and bodies (n_points, 3) [N]."""


@dataclass
class Instant:
    """One instant of a run. What is None, or empty, the procedure does not have.

    Functions are called when the first field asks for what they return, and once at most.
    """

    model: Any
    """The model that is computed."""
    displacement: FloatArray
    """(n_points, 2 | 3) [mm]."""
    state: Any = None
    """The State of an implicit procedure; fields from outside this package may need what no other entry has."""
    velocity: FloatArray | None = None
    """(n_points, 2 | 3) [mm/s]."""
    reaction: FloatArray | None = None
    """Reactions of supports and moved sets: forces (n_points, 2 | 3) [N]; shells have moments too (n_points, 6)."""
    tool_force: FloatArray | None = None
    """Forces of the tools on the nodes (n_points, 2 | 3) [N]."""
    springback: FloatArray | None = None
    """Displacement of springback (n_points, 3) [mm]."""
    deviation: FloatArray | None = None
    """Distance from the shape that the part had in its tools (n_points,) [mm]."""
    temperature: FloatArray | None = None
    """Temperature of bodies that conduct heat (n_points,) [degrees C]; of a sheet the mean through its thickness."""
    heated: Mapping[str, FloatArray] = field(default_factory=dict)
    """Temperatures of a sheet that conducts heat at bottom, middle and top, and its phases, hardness and cooling rate,
    by the names of their fields (n_points,)."""
    points: SolidPoints | None = None
    initial_position: FloatArray | None = None
    """Where the material at the nodes was when the run began, if its mesh may change (n_points, 2) [mm]."""
    laps: FloatArray | None = None
    """1 at nodes where the surface has folded onto itself, 0 elsewhere (n_points,)."""
    evolved: Mapping[str, Sequence[FloatArray]] = field(default_factory=dict)
    """What evolution laws keep at the points, by quantity and block (n_cells, p); no rows where there is no law."""
    find_contact: Callable[[], NodalContact] | None = None
    find_sheet: Callable[[], Mapping[str, FloatArray]] | None = None
    """Returns thickness, strains and stresses of a sheet's cells by the names of their fields (n_cells,) or
    (n_cells, k): they are computed together, from the metric of every layer."""
    judged: Judged = ((Formability(), 0),)
    """Forming limits by which the strains of a sheet are judged."""

    @cached_property
    def contact(self) -> NodalContact | None:
        """Contact of solids with tools and with each other."""
        return self.find_contact() if self.find_contact else None

    @cached_property
    def sheet(self) -> Mapping[str, FloatArray]:
        """Quantities of a sheet's cells by name; empty for solids."""
        return self.find_sheet() if self.find_sheet else {}

    @cached_property
    def forming(self) -> Mapping[str, FloatArray]:
        """Quantities of formability of a sheet's cells by name; empty for solids."""
        from presswork.fields.formability_fields import formability_fields

        return formability_fields(self.sheet, self.judged)

    @cached_property
    def surface(self) -> Mapping[str, FloatArray]:
        """Defects of a sheet's surface in its cells by name; empty for solids and sheets without bending."""
        from presswork.fields.surface_defects import NEEDED, surface_fields

        if not self.sheet.keys() >= NEEDED:
            return {}
        mesh = self.model.mesh
        points = mesh.points + self.displacement
        return surface_fields(self.sheet, mesh.blocks, points, self.tool_force, self.model.symmetry)
