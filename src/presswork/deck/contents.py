# SPDX-License-Identifier: Apache-2.0
"""What a deck holds, in its own numbers and units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from presswork.deck.units import Units
from presswork.keyword_file import Place
from presswork.model import FloatArray, IndexArray


@dataclass(frozen=True)
class Shells:
    """Shells of three and four nodes, all parts together."""

    part: IndexArray
    """Number of each one's part (n,)."""
    nodes: IndexArray
    """Labels of their nodes (n, 4); a triangle has its last one twice."""
    thickness: FloatArray
    """Thickness of each shell itself, NaN where the section sets it (n,)."""
    labels: IndexArray | None = None
    """Labels of the shells (n,), where the sheet may have a past."""
    angle: FloatArray | None = None
    """Angle from the first side of each shell to x of the material (n,) [degree]; None: 0."""


@dataclass(frozen=True)
class PartCard:
    """A part: its title, section and material."""

    title: str
    section: int
    material: int
    place: Place
    keyword: str = "*PART"


@dataclass(frozen=True)
class SectionCard:
    """A section of shells."""

    thickness: float
    n_points: int
    is_full: bool
    """Whether shells have more than one point in their plane."""
    place: Place
    keyword: str = "*SECTION_SHELL"
    offset: float = 0.0
    """Offset of the nodes from the middle, along the shells' normals, in thicknesses."""


@dataclass(frozen=True)
class Hardening:
    """Flow stress against plastic strain: a law of presswork with its parameters, or a curve."""

    law: Literal["linear", "swift", "ludwik", "voce", "table"]
    parameters: dict[str, float] = field(default_factory=dict)
    curve: int = 0
    curve_scale: float = 1.0
    ends_flat: bool = False
    """Whether the stress of the last row holds beyond it; otherwise its last slope goes on."""


@dataclass(frozen=True)
class MaterialCard:
    """A material; rigid ones have no hardening."""

    keyword: str
    density: float
    young: float
    poisson: float
    place: Place
    is_rigid: bool = False
    hardening: Hardening | None = None
    yield_function: dict[str, object] | None = None
    """Yield function as in a case, its numbers without unit."""
    cowper_symonds: tuple[float, float] | None = None
    """C and P."""
    johnson_cook: tuple[float, float] | None = None
    """Sensitivity to the rate, and the rate of the hardening law."""
    young_decrease: tuple[float, float] | None = None
    """Young's modulus after large plastic strain, and the rate of its decrease."""
    rolling: tuple[float, float, float] | Literal["cell"] | None = None
    """Direction; or along the first side of each cell; None: x, or it does not matter."""


@dataclass(frozen=True)
class Motion:
    """A prescribed motion of a part along an axis."""

    part: int
    axis: int
    """0 to 2; 3 to 5: a rotation."""
    kind: Literal["velocity", "acceleration", "displacement"]
    curve: int
    scale: float
    begin: float
    end: float
    place: Place
    keyword: str


@dataclass(frozen=True)
class Push:
    """A force on a part along an axis."""

    part: int
    axis: int
    curve: int
    scale: float
    place: Place
    keyword: str


@dataclass(frozen=True)
class Contact:
    """Two groups of parts that touch."""

    parts: tuple[tuple[int, ...], tuple[int, ...]]
    friction: tuple[float, float]
    """Static and dynamic."""
    place: Place
    keyword: str
    thickness: tuple[tuple[float, float], tuple[float, float]] | None = None
    """Thickness with which rigid bodies touch on each side, and a factor; 0: the thickness of their section.

    None: the mesh of a rigid body is its face.
    """


@dataclass(frozen=True, eq=False)
class Held:
    """Nodes some of whose displacements and rotations are held."""

    nodes: IndexArray
    fixed: tuple[bool, ...]
    """Displacements along x, y, z, rotations about them."""
    place: Place
    keyword: str


@dataclass
class Deck:
    """All that was read."""

    title: str = ""
    units: Units | None = None
    """Where the deck names them."""
    end: float | None = None
    end_place: Place | None = None
    breaks: list[float] = field(default_factory=list)
    """Times at which the deck itself ends a step."""
    node_place: Place | None = None
    """Place in the deck of the first nodes."""
    labels: IndexArray = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    points: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    shells: Shells | None = None
    parts: dict[int, PartCard] = field(default_factory=dict)
    sections: dict[int, SectionCard] = field(default_factory=dict)
    materials: dict[int, MaterialCard] = field(default_factory=dict)
    curves: dict[int, FloatArray] = field(default_factory=dict)
    curve_lines: dict[int, tuple[Place, str]] = field(default_factory=dict)
    """Where a curve stands, and its keyword, by its number; of some none."""
    motions: list[Motion] = field(default_factory=list)
    pushes: list[Push] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)
    held: list[Held] = field(default_factory=list)
    part_sets: dict[int, tuple[int, ...]] = field(default_factory=dict)
    node_sets: dict[int, IndexArray] = field(default_factory=dict)
    layers: dict[int, FloatArray] = field(default_factory=dict)
    """Height, six stresses in space and plastic strain of each layer, bottom first (k, 8), by the label of a shell."""
    strains: dict[int, FloatArray] = field(default_factory=dict)
    """Strain of the middle surface in space (6,), by the label of a shell."""
    levels: int = 0
    """How often a shell may be split."""
    springs_back: bool = False
