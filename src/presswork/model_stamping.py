# SPDX-License-Identifier: Apache-2.0
"""The Model of a stamping: a blank between rigid tools in space. Frozen data; units mm, s, t, N, MPa.

The blank lies about z = 0; tools move along z. Forces and strokes are those of the whole tool, whatever symmetry planes
cut away.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from presswork.model import (
    ExplicitElement,
    FloatArray,
    IntArray,
    Limits,
    Material,
    Mesh,
    Model,
    PrescribedDisplacement,
    Section,
    SheetBead,
    SolverSettings,
    Support,
)

if TYPE_CHECKING:
    from presswork.geometry.swept_tool import SweptTool
    from presswork.mesh.tool_file import TriangulatedTool

ToolKind = Literal["punch", "die", "holder"]


@dataclass(frozen=True)
class StampingTool:
    """A rigid tool."""

    name: str
    kind: ToolKind
    shape: SweptTool | TriangulatedTool
    position: tuple[float, float, float]
    """Of its own origin at the start [mm]."""
    mu: float
    """Coefficient of friction."""
    way: tuple[float, float, float]
    """Unit vector along which it works: strokes and forces count along it."""


@dataclass(frozen=True)
class StampingBead:
    """A drawbead between die and holder."""

    line: SheetBead
    """As much of it as lies on what is modelled."""
    stages: tuple[str, ...]
    """Names of those in which die and holder are closed on it."""
    closing_force: float = 0.0
    """Per length [N/mm], taken off the force of a pushed holder."""


@dataclass(frozen=True)
class ToolAction:
    """What a tool does over a stage: it moves along its way, or pushes along it."""

    stroke: float = 0.0
    """[mm]"""
    force: FloatArray | None = None
    """Instead of a stroke: rows of part of the stage's way (0 to 1) and force [N] (n, 2); linear between them."""


@dataclass(frozen=True)
class StampingStage:
    """A part of the process: all that moves starts and stops smoothly with it."""

    name: str
    duration: float
    """[s]"""
    ramp: float
    """Time of the smooth start, and of the smooth end [s]; at most half the duration."""
    actions: Mapping[str, ToolAction] = field(default_factory=dict)
    """By tool; a tool not named stands still, or goes on pushing."""
    prescribed: tuple[PrescribedDisplacement, ...] = ()
    """Of nodes of the blank, over the stage."""


@dataclass(frozen=True)
class ExplicitSettings:
    """How the explicit procedure computes shells and steps through time."""

    element: ExplicitElement = "shell4_1pt"
    """Of the blank."""
    target_step: float | None = None
    """Time step [s] that mass is added for; None: no mass is added, the step follows from the mesh."""
    safety: float = 0.9
    """Time step over the bound of the stable one."""
    damping: float = 0.0
    """Mass damping [1/s]."""
    precision: Literal["double", "single"] = "double"
    """Of shells and velocities; positions and energies are always double."""
    contact_points: Literal["nodes", "edges"] = "edges"
    """What of the blank touches tools: nodes alone, or where a tool is sharp the edges between them, too."""
    ironing: bool = True
    """Whether two tools squeeze the sheet thinner that leave it less room than it is thick."""


@dataclass(frozen=True)
class TrimLine:
    """A line that the formed part is cut along, seen along z."""

    name: str
    polygon: FloatArray
    """Its corners in turn (m, 2) [mm], closed by itself."""
    keep: Literal["inside", "outside"]


@dataclass(frozen=True)
class Refinement:
    """Where the explicit procedure splits shells of the blank in four as it is formed."""

    levels: int
    """How often a shell may be split."""
    angle: float
    """From a shell to its neighbour, or of a tool along it, above which it is split [rad]."""


@dataclass(frozen=True)
class Springback:
    """How the implicit procedure lets the formed part go."""

    increments: int = 5
    """In which the forces of the tools are taken away."""


@dataclass(frozen=True)
class StampingOutput:
    """What is saved, and when."""

    steps: int = 10
    """Saved steps of each stage."""
    rows: int = 200
    """Rows of the history of each stage."""
    checkpoint_every: int = 50
    """Rows between checkpoints."""


@dataclass(frozen=True)
class StampingModel:
    """A complete stamping."""

    title: str
    procedure: Literal["explicit", "implicit"]
    mesh: Mesh
    rolling_direction: tuple[float, float, float]
    """Unit vector."""
    materials: tuple[Material, ...]
    tools: tuple[StampingTool, ...]
    symmetry: tuple[bool, bool]
    """Whether the planes x = 0 and y = 0 cut the whole part."""
    supports: tuple[Support, ...]
    stages: tuple[StampingStage, ...]
    explicit: ExplicitSettings
    implicit: SolverSettings
    output: StampingOutput
    beads: tuple[StampingBead, ...] = ()
    trim: tuple[TrimLine, ...] = ()
    """After the last stage."""
    springback: Springback | None = None
    """After the last stage and the trimming; None: the part stays as it is."""
    refinement: Refinement | None = None
    """None: the mesh stays as it is."""
    limits: Limits = field(default_factory=Limits)
    case_text: str = ""

    @property
    def cells(self) -> IntArray:
        """Connectivity of the blank (n, 4), block after block, a triangle with its last node twice."""
        return np.concatenate(
            [b.connectivity[:, [0, 1, 2, min(3, b.connectivity.shape[1] - 1)]] for b in self.mesh.blocks]
        )

    @property
    def sheet(self) -> tuple[Section, Material]:
        """Section and material of the blank."""
        block = self.mesh.blocks[0]
        assert block.section is not None
        return block.section, self.materials[block.material]

    @property
    def whole(self) -> int:
        """How many times what is modelled the whole part is."""
        return int(2 ** sum(self.symmetry))


AnyModel = Model | StampingModel
