# SPDX-License-Identifier: Apache-2.0
"""Springback of a stamping, and what is measured of the released part. Units as in schema.py."""

from __future__ import annotations

from math import atan2, hypot, radians
from typing import Annotated, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.names import Name
from presswork.case.part import Part
from presswork.case.units import Angle, Length, Point, fault

_DEFAULT = model.Springback()
FEWEST_CLAMPS = 3
_STRAIGHT = 1e-6
"""Area over the clamps' extent squared below which the clamps lie on a line."""


class Section(Part):
    """A section by an upright plane, from a point to another, or through a point at an angle.

    Coordinates are those of the part in its closed tools, seen along z.
    """

    point: Point = Field(description="[x, y] where the section begins, or through which it runs [mm]")
    to: Point | None = Field(default=None, description="[x, y] where it ends [mm]; with it no angle")
    angle: Angle | None = Field(
        default=None,
        description="instead of `to`: direction from x; the section runs as far as there is sheet [degree]",
    )

    @model_validator(mode="after")
    def _check_one(self) -> Self:
        if (self.to is None) == (self.angle is None):
            raise fault("a section has a second point or an angle", "give `to` or `angle`", key="angle")
        if self.to == self.point:
            raise fault("is where the section begins", "give another point", key="to")
        return self

    def build(self, name: str) -> model.PartSection:
        """Return the Model's."""
        if self.to is None:
            return model.PartSection(name, self.point, radians(self.angle or 0.0))
        across, up = self.to[0] - self.point[0], self.to[1] - self.point[1]
        return model.PartSection(name, self.point, atan2(up, across), hypot(across, up))


class Gauge(Part):
    """A gauge of the shape that the part has in its tools; clamps hold the released part on it, as a rigid body."""

    clamps: tuple[Point, ...] = Field(
        min_length=FEWEST_CLAMPS,
        description="[x, y] of each clamp on the part in its closed tools: three lie on the gauge, of more the squares "
        "of their distances are least [mm]",
    )
    points: dict[Name, Point] = Field(
        default={}, description="[x, y] of points that are measured, by name, along the part's normal [mm]"
    )

    @model_validator(mode="after")
    def _check_clamps(self) -> Self:
        (x, y), rest = self.clamps[0], self.clamps[1:]
        arms = [(a - x, b - y) for a, b in rest]
        size = max(a * a + b * b for a, b in arms)
        if max(abs(a * d - b * c) for a, b in arms for c, d in arms) <= _STRAIGHT * size:
            raise fault("the clamps lie in one line, about which the part turns", "move one aside", key="clamps")
        return self

    def build(self) -> model.Gauge:
        """Return the Model's."""
        return model.Gauge(self.clamps, tuple(self.points.items()))


class Springback(Part):
    """The formed part is released after the last stage: tools and boundaries away, symmetry planes kept."""

    increments: Annotated[int, Field(strict=True, ge=1)] = Field(
        default=_DEFAULT.increments, description="number of increments in which the tools' forces are taken away"
    )
    sections: dict[Name, Section] = Field(
        default={},
        description="sections that the summary measures, by name; without any: through the middle along x and y",
    )
    gauge: Gauge | None = Field(default=None, description="gauge that the part is measured in; without it: best fit")
    tolerance: tuple[Length, Length] | None = Field(
        default=None, description="least and largest deviation from the shape in the tools that is allowed [mm]"
    )

    @model_validator(mode="after")
    def _check_tolerance(self) -> Self:
        if self.tolerance is not None and not self.tolerance[0] < self.tolerance[1]:
            raise fault("no band: the first is not below the second", "for instance [-0.5, 0.5]", key="tolerance")
        return self

    def build(self) -> model.Springback:
        """Return the Model's."""
        return model.Springback(
            increments=self.increments,
            sections=tuple(section.build(name) for name, section in self.sections.items()),
            gauge=self.gauge.build() if self.gauge else None,
            tolerance=self.tolerance,
        )
