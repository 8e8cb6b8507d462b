# SPDX-License-Identifier: Apache-2.0
"""The Model itself: all of a forming problem in one piece."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from presswork.model.contact import Body, BodyContact, SheetBead, SheetTool, Tool
from presswork.model.limits import Limits
from presswork.model.material import Material
from presswork.model.mesh import Mesh
from presswork.model.settings import ExplicitSolid, OutputSettings, SolverSettings
from presswork.model.stage import Stage, Support

Analysis = Literal["axisymmetric", "plane_strain", "solid", "shell"]


@dataclass(frozen=True)
class Model:
    """A complete forming problem."""

    title: str
    analysis: Analysis
    depth: float
    """Plane strain: extent normal to the plane [mm]; 1 in axisymmetry."""
    mesh: Mesh
    materials: tuple[Material, ...]
    tools: tuple[Tool, ...]
    supports: tuple[Support, ...]
    stages: tuple[Stage, ...]
    solver: SolverSettings
    output: OutputSettings
    bodies: tuple[Body, ...] = ()
    """The workpiece first; empty stands for a single body."""
    sheet_tools: tuple[SheetTool, ...] = ()
    """Tools that a shell touches; `tools` are those of solids in the plane."""
    sheet_beads: tuple[SheetBead, ...] = ()
    """Drawbeads of a shell."""
    contacts: tuple[BodyContact, ...] = ()
    rolling_direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Of a shell: unit vector that, laid into the sheet, is x of its laws."""
    explicit: ExplicitSolid | None = None
    """Of a solid by the explicit procedure; None: the implicit one."""
    limits: Limits = field(default_factory=Limits)
    case_text: str = ""
    """The case file as read, kept with the results."""

    @property
    def dimension(self) -> int:
        """How many coordinates a point has: 2 in the plane and in axisymmetry, else 3."""
        return 3 if self.analysis in ("solid", "shell") else 2

    @property
    def freedoms(self) -> int:
        """How many freedoms a node has: its displacement, of a shell its rotation too."""
        return 6 if self.analysis == "shell" else self.dimension
