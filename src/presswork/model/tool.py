# SPDX-License-Identifier: Apache-2.0
"""Rigid tools and drawbeads: shape, place, friction. The stage holds what a tool does in it (stage.py)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswork.model.arrays import FloatArray, IntArray
from presswork.model.die_body import ToolWear

ContactLaw = Literal["frictionless", "sticking", "shear", "coulomb", "coulomb_capped"]
ToolContactLaw = ContactLaw | Literal["wanheim_bay", "levanov"]
FRICTION_KEYS: Mapping[str, tuple[str, ...]] = {
    "shear": ("m",), "coulomb": ("mu",), "coulomb_capped": ("m", "mu"), "wanheim_bay": ("m",), "levanov": ("m",),
}  # fmt: skip
"""What laws of friction ask for."""
BY_PRESSURE = ("coulomb", "coulomb_capped", "wanheim_bay", "levanov")
"""Laws whose friction depends on the pressure, so that the tangent is not symmetric."""
ToolKind = Literal["punch", "die", "holder"]


@dataclass(frozen=True)
class Profile:
    """A profile in the plane."""

    segments: FloatArray
    """Shape (n_segments, 7): x0, y0, x1, y1, centre x, centre y, turn; turn is 0 for a line, +1 for an arc that runs
    counter-clockwise, -1 clockwise. Directed so that the tool's metal is on the right, the workpiece on the left."""


@dataclass(frozen=True)
class SweptProfile:
    """A profile of lines and arcs carried round a rectangle with rounded corners about the origin."""

    half_widths: tuple[float, float]
    """Half widths of the plan along x and y [mm]; one may be infinite: a strip."""
    corner_radius: float
    """Radius of the plan's corners [mm]; for a circle both half widths; unused for a strip."""
    segments: FloatArray
    """Shape (n, 7) as in Profile, x and y meaning s, outwards from the plan's curve, and z."""


@dataclass(frozen=True)
class Triangulation:
    """Triangles wound alike, counter-clockwise as seen from free space."""

    points: FloatArray
    """Shape (n_points, 3) [mm]."""
    triangles: IntArray
    """Shape (n, 3)."""
    is_closed: bool


@dataclass(frozen=True)
class Plane:
    """A plane without end through the origin of the tool's frame."""

    normal: tuple[float, float, float]
    """Unit vector out of the metal."""


Surface = SweptProfile | Triangulation | Plane
"""The shape of a tool in space."""


@dataclass(frozen=True)
class FrictionFactors:
    """What m and mu of a tool are multiplied by: rows of a quantity and its factor (n, 2), the quantity ascending."""

    pressure: FloatArray | None = None
    """Rows of the contact pressure [MPa]."""
    speed: FloatArray | None = None
    """Rows of the speed of sliding [mm/s]."""
    temperature: FloatArray | None = None
    """Rows of the temperature of the workpiece at the surface [degrees C]."""
    path: FloatArray | None = None
    """Rows of the path that the surface of the workpiece has slid on tools [mm]."""
    exponent: float = 1.0
    """Another factor, (p / reference)^(exponent - 1)."""
    reference: float = 1.0
    """Pressure at which m and mu hold [MPa]."""


@dataclass(frozen=True)
class Friction:
    """What a tool's surface does along itself to the workpiece. Tools of sheets have "coulomb"."""

    law: ToolContactLaw = "coulomb"
    m: float | FloatArray = 0.0
    """Friction factor of "shear", "coulomb_capped", "wanheim_bay" and "levanov", 0 to 1: tau = m k at most, k the shear
    flow stress; one, or one for each segment of a profile (n_segments,)."""
    mu: float | FloatArray = 0.0
    """Coefficient of friction of "coulomb" and "coulomb_capped", in the same form."""
    factors: FrictionFactors | None = None
    """How m and mu depend on the state; None: they are constant."""


@dataclass(frozen=True)
class Spring:
    """A spring behind a tool, which rests against a stop until the workpiece pushes it with more than the preload."""

    stiffness: float
    """[N/mm] of the whole tool."""
    preload: float
    """[N] on the whole tool."""
    direction: tuple[float, ...]
    """Unit vector along which the workpiece pushes the tool back."""


@dataclass(frozen=True)
class Tool:
    """A rigid tool."""

    name: str
    shape: Profile | Surface
    """Shape in the tool's own frame: a profile touches solids in the plane, a surface touches sheets."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where the origin of its frame is at the start [mm]; in the plane x and y count."""
    friction: Friction = Friction()
    kind: ToolKind | None = None
    """Stampings: what the tool is for."""
    working_direction: tuple[float, float, float] | None = None
    """Unit vector along which its stroke and its force count; None: that of its first motion or push."""
    centre: tuple[float, ...] = (0.0, 0.0)
    """Centre in its own frame: the point about which it turns and its torque is taken [mm]; in space a point of its
    axis."""
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """For a solid in space, in its own frame: unit vector about which the tool turns."""
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """For a solid in space: rotation about the origin of the tool's frame at the start, a vector along its axis with
    the angle as its length [rad]."""
    spring: Spring | None = None
    """For solids: the spring on which the tool rests; its stages move the spring's foot."""
    mirrored_across: tuple[bool, ...] = (False, False)
    """Plane strain, solids in space: whether the whole tool is twice what is modelled, mirrored by a symmetry plane
    normal to x | y | z."""
    wear: ToolWear | None = None
    """How the surface of a tool of solids wears; None: it is not followed."""
    sectors: float = 1.0
    """Solids in space: number of sectors like the one modelled that the whole tool has round z."""

    @property
    def profile(self) -> Profile:
        """The shape of a tool in the plane."""
        assert isinstance(self.shape, Profile), f"{self.name} has no profile"
        return self.shape

    @property
    def surface(self) -> Surface:
        """The shape of a tool in space."""
        assert not isinstance(self.shape, Profile), f"{self.name} has no surface in space"
        return self.shape

    def friction_by_segment(self) -> tuple[FloatArray, FloatArray]:
        """Return m and mu of each segment of its profile (n_segments,)."""
        n = len(self.profile.segments)
        return np.full(n, self.friction.m), np.full(n, self.friction.mu)


@dataclass(frozen=True)
class Drawbead:
    """A drawbead: a line in the plan x, y, cut into points, that restrains a shell from flowing across it."""

    name: str
    place: FloatArray
    """Positions of its points in the plan (n, 2) [mm]."""
    across: FloatArray
    """Unit normals of the line there (n, 2)."""
    length: FloatArray
    """Length of the line that each point stands for (n,) [mm]."""
    force: float
    """Restraining force per length [N/mm]."""
    tool: str | None = None
    """Name of the tool that it moves with; None: it stands still."""
    closing_force: float = 0.0
    """For a stamping: closing force per length [N/mm], taken off the force of a pushed holder."""
    is_sought: bool = False
    """Whether its forces are still to be found from its geometry: such a Model is described and drawn, not computed."""
