# SPDX-License-Identifier: Apache-2.0
"""What touches the workpiece: tools in the plane and in space, drawbeads, other bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from presswork import _core
from presswork.model.arrays import BoolArray, FloatArray, IntArray

ContactLaw = Literal["frictionless", "sticking", "shear", "coulomb", "coulomb_capped"]


@dataclass(frozen=True)
class Spring:
    """A spring behind a tool, which rests against a stop until the workpiece pushes it with more than the preload."""

    stiffness: float
    """[N/mm] of the whole tool."""
    preload: float
    """[N] on the whole tool."""
    direction: tuple[float, float]
    """Unit vector along which the tool gives way."""


@dataclass(frozen=True)
class Tool:
    """A rigid profile that moves without deforming."""

    name: str
    segments: FloatArray
    """Shape (n_segments, 7): x0, y0, x1, y1, centre x, centre y, turn; turn is 0 for a line, +1 for an arc that runs
    counter-clockwise, -1 clockwise. Directed so that the tool's metal is on the right, the workpiece on the left."""
    contact: ContactLaw
    m: FloatArray
    """Friction factor of "shear" and "coulomb_capped" by segment (n_segments,), 0 to 1: tau = m k, k the shear flow
    stress."""
    mu: FloatArray
    """Coefficient of friction of "coulomb" and "coulomb_capped" by segment (n_segments,)."""
    mirrored_across: tuple[bool, bool] = (False, False)
    """Plane strain: whether the whole tool is twice what is modelled, mirrored by a symmetry plane normal to x | y."""
    centre: tuple[float, float] = (0.0, 0.0)
    """About which it turns, and its torque is taken [mm]."""
    spring: Spring | None = None
    """On which it rests; its stages move the spring's foot."""
    origin: tuple[float, float] = (0.0, 0.0)
    """Where the origin of its drawing is at the start [mm]."""


class ToolShape(Protocol):
    """The shape of a tool in space, as data in the tool's own frame."""

    def surface(self, depth: float = ..., *, smooth: bool = ...) -> _core.ToolSurface:
        """Return the surface that contact asks.

        depth: penetrations deeper than this are not found [mm]. smooth: normals do not jump from facet to facet.
        """


@dataclass(frozen=True)
class SheetTool:
    """A rigid tool in space, with Coulomb's friction, for shells."""

    name: str
    shape: ToolShape
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of its frame at the start [mm]."""
    mu: float = 0.0


@dataclass(frozen=True)
class SheetBead:
    """A drawbead: a line in the plan x, y, cut into points, that holds a shell back from flowing across it."""

    name: str
    place: FloatArray
    """Of its points in the plan (n, 2) [mm]."""
    across: FloatArray
    """Unit normals of the line there (n, 2)."""
    length: FloatArray
    """Of the line that each point stands for (n,) [mm]."""
    force: float
    """Restraining force per length [N/mm]."""
    tool: str | None = None
    """That it moves with; None: it stands still."""


@dataclass(frozen=True)
class Body:
    """A body of its own: a run of the mesh's points and cell blocks that no other body uses."""

    name: str
    points: range
    blocks: range

    def owns(self, edges: IntArray) -> BoolArray:
        """Say which edges (n, 2 | 3) belong to the body, shape (n,)."""
        return np.asarray((edges[:, 0] >= self.points.start) & (edges[:, 0] < self.points.stop), dtype=bool)


@dataclass(frozen=True)
class BodyContact:
    """Contact between two bodies, or of a body with itself where both are the same."""

    name: str
    between: tuple[int, int]
    """Indices into Model.bodies, as the case names them."""
    slave: int
    """Index of the body whose nodes carry the pressure: one of the two."""
    contact: ContactLaw
    m: float = 0.0
    mu: float = 0.0

    @property
    def master(self) -> int:
        """The other body, or the same."""
        return self.between[1] if self.slave == self.between[0] else self.between[0]
