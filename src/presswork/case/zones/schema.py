# SPDX-License-Identifier: Apache-2.0
"""Zones of a welded blank, and the thickness of a rolled one. Units as in schema.py of the stamping."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Protocol, Self

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from presswork.case.names import FileName, Name
from presswork.case.part import Part
from presswork.case.stamping.plan_line import PlanLine
from presswork.case.units import LENGTH, Angle, Length, Point, fault, to_number, to_pair
from presswork.model import FloatArray

Line = Annotated[PlanLine, Field(discriminator="shape")]
PLACES = ("line", "inside", "outside", "set")
"""Keys for the place of a zone; it takes one of them."""


def _to_thickness(value: object) -> float | tuple[tuple[float, float], ...]:
    """Convert one thickness, or a table [[distance, thickness], ...], each a number or a string with a unit."""
    if not isinstance(value, list | tuple):
        found = to_number(value, LENGTH)
        if not found > 0:
            raise fault("expected a value > 0", "plain numbers are mm: 0.8")
        return found
    remedy = "give [[distance, thickness], ...] with distances that grow, e.g. [[-50, 1.0], [50, 1.6]]"
    if len(value) < 2 or not all(isinstance(row, list | tuple) for row in value):
        raise fault("expected one thickness, or a table of two or more rows", remedy)
    rows = tuple(to_pair(row, LENGTH) for row in value)
    x, t = np.array(rows).T
    if (np.diff(x) <= 0).any():
        at = int(np.argmax(np.diff(x) <= 0))
        raise fault(f"distance {x[at + 1]:g} mm follows {x[at]:g} mm", remedy)
    if (t <= 0).any():
        raise fault(f"the thickness {t.min():g} mm is not above 0", remedy)
    return rows


_LENGTH: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string", "examples": [LENGTH.example]}]}
_PAIR = {"type": "array", "items": _LENGTH, "minItems": 2, "maxItems": 2}
Thickness = Annotated[
    float | tuple[tuple[float, float], ...],
    BeforeValidator(_to_thickness),
    WithJsonSchema({"anyOf": [*_LENGTH["anyOf"], {"type": "array", "items": _PAIR, "minItems": 2}]}),
]


class BlankZone(Part):
    """A part of a welded blank that differs from the rest in thickness, material or rolling direction.

    The weld is a line of shared nodes, as strong as the sheet beside it.
    """

    name: Name = Field(description="name of the zone, for summary and pictures")
    line: tuple[Point, Point] | None = Field(
        default=None, description="two points [[x, y], [x, y]] of a straight weld line through the whole blank [mm]"
    )
    side: Literal["left", "right"] | None = Field(
        default=None, description="side of line that the zone lies on, looking from its first point to its second"
    )
    inside: Line | None = Field(
        default=None, description="instead of line: a closed line on the undeformed blank inside which the zone lies"
    )
    outside: Line | None = Field(default=None, description="instead: a closed line outside which it lies")
    set: str | None = Field(
        default=None,
        description="instead, of a mesh file: name of a group of cells or nodes; the zone has the cells all nodes of "
        "which are in it",
    )
    thickness: Length | None = Field(default=None, gt=0, description="thickness [mm]; without it the blank's")
    material: FileName | None = Field(
        default=None,
        description="name of one of the [materials], or of the library, or a material file; without it the blank's",
    )
    rolling_direction: Angle | None = Field(
        default=None, description="angle of the rolling direction from x [degree]; without it the blank's"
    )

    @model_validator(mode="after")
    def _check_place(self) -> Self:
        given = [key for key in PLACES if getattr(self, key) is not None]
        if len(given) != 1:
            text = f"a zone lies in one place, and {' and '.join(given) or 'none'} is given"
            raise fault(text, "give line with side, inside, outside or set", key=given[1] if given else "line")
        if (self.side is None) == (self.line is not None):
            text = "a line has a side, and nothing else has"
            raise fault(text, 'give line and side = "left" or "right"', key="side")
        if self.line is not None and np.hypot(*np.subtract(*self.line)) < 1e-3:
            raise fault("both points are the same", "give two points of the weld line, in mm", key="line")
        return self

    @model_validator(mode="after")
    def _check_differs(self) -> Self:
        if self.thickness is None and self.material is None and self.rolling_direction is None:
            text = "the zone differs from the blank in nothing"
            raise fault(text, "give its thickness, material or rolling_direction, or leave the zone out", key="name")
        return self


class ZonedPart(Protocol):
    """A sheet of a case that may have zones."""

    @property
    def material(self) -> str: ...
    @property
    def mean_thickness(self) -> float: ...
    @property
    def zones(self) -> tuple[BlankZone, ...]: ...
    def find_thickness(self, places: FloatArray) -> FloatArray | None:
        """Return the thickness at places (n, 2) (n,) [mm]; None: one for all."""


class OneSheet(Part):
    """The thickness of a blank without zones."""

    thickness: Length = Field(gt=0, description="thickness [mm]")

    zones: ClassVar[tuple[BlankZone, ...]] = ()
    relief: ClassVar[bool] = True
    is_uniform: ClassVar[bool] = True

    @property
    def thickest(self) -> float:
        """Its thickness [mm]."""
        return self.thickness

    @property
    def mean_thickness(self) -> float:
        """Its thickness [mm]."""
        return self.thickness

    def find_thickness(self, places: FloatArray) -> None:
        """Return nothing: it has one thickness."""


class Zoned(Part):
    """Thickness and zones of a flat blank."""

    thickness: Thickness = Field(
        description="thickness [mm]; of a rolled blank a table [[distance, thickness], ...], linear between its rows"
    )
    thickness_direction: Angle = Field(
        default=0.0,
        description="of a table of thickness: angle from x of the direction along which distances from the origin are "
        "measured [degree]",
    )
    zones: tuple[BlankZone, ...] = Field(default=(), description="zones of a welded blank, which do not overlap")
    relief: bool = Field(
        default=True,
        description="whether tools are stepped where the blank is thinner than at its thickest, by half of the "
        "difference on each face, so that they hold it everywhere; the steps move with the sheet. false: tools are as "
        "drawn, and hold the thickest part alone",
    )

    @property
    def thickest(self) -> float:
        """Largest thickness of the blank [mm]."""
        own = [self.thickness] if isinstance(self.thickness, float) else [t for _, t in self.thickness]
        return max([*own, *(zone.thickness for zone in self.zones if zone.thickness is not None)])

    @property
    def mean_thickness(self) -> float:
        """Thickness of the blank beside its zones, of a rolled one the mean of its table over distance [mm]."""
        if isinstance(self.thickness, float):
            return self.thickness
        x, t = np.array(self.thickness).T
        return float(np.trapezoid(t, x) / (x[-1] - x[0]))

    @property
    def is_uniform(self) -> bool:
        """Whether the blank is one sheet of one thickness."""
        return isinstance(self.thickness, float) and not self.zones

    def find_thickness(self, places: FloatArray) -> FloatArray | None:
        """Return the thickness of a rolled blank at places (n, 2) (n,) [mm]; None: it is one for all."""
        if isinstance(self.thickness, float):
            return None
        angle = np.radians(self.thickness_direction)
        x, t = np.array(self.thickness).T
        return np.asarray(np.interp(places @ [np.cos(angle), np.sin(angle)], x, t))
