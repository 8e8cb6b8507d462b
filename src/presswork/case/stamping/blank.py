# SPDX-License-Identifier: Apache-2.0
"""The blank of a stamping: outline, thickness, mesh size, material and rolling direction. Units as in schema.py."""

from __future__ import annotations

from math import pi
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.units import Angle, Length, Point, Sides, fault
from presswork.case.zones.schema import OneSheet, Zoned

_SECTION = model.Section(1.0)


class Refine(Part):
    """Shells that are split in four where the sheet is bent, or about to be."""

    levels: int = Field(strict=True, ge=1, le=4, description="how often a shell may be split: 1 to 4")
    angle: Angle = Field(
        default=10.0,
        gt=0,
        le=90,
        description="angle from a shell to its neighbour, or of a tool along it, above which it is split [degree]",
    )


class _Blank(Part):
    """What blanks of any outline have."""

    material: FileName = Field(
        description='name of one of the [materials], or of the library, or "my_steel.toml", a material file of your own'
    )
    points: int = Field(
        default=_SECTION.points, strict=True, ge=2, le=51, description="points through the thickness, 2 to 51"
    )
    rule: Literal["gauss", "lobatto"] = Field(default="gauss", description="gauss; lobatto has points on both faces")
    rolling_direction: Angle = Field(default=0.0, description="angle of the rolling direction from x [degree]")
    symmetry: tuple[Literal["x", "y"], ...] = Field(
        default=(),
        description='planes through the origin that cut the part: ["x", "y"] computes the quarter x, y >= 0; sizes and '
        "forces stay those of the whole part",
    )
    refine: Refine | None = Field(
        default=None,
        description="explicit: splits shells in four where the sheet is bent, e.g. {levels = 2}; without it: none",
    )


class _MeshedBlank(_Blank):
    """A blank that is meshed by the program."""

    cells: Literal["quadrilaterals", "triangles"] = Field(
        default="quadrilaterals", description="triangles: each quadrilateral is cut by both diagonals"
    )


class RectangularBlank(Zoned, _MeshedBlank):
    """A rectangle about the origin."""

    shape: Literal["rectangle"] = Field(description="a rectangle about the origin")
    size: Point = Field(description="length along x and y of the whole blank [mm]")
    element_size: Sides = Field(description="largest side of an element, or [x, y], along each of them [mm]")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if min(self.size) <= 0:
            raise fault("expected two values > 0", "give [x, y], both positive", key="size")
        if min(self.element_size) <= 0:
            raise fault("expected a value > 0, or two", "give one, or [x, y], both positive", key="element_size")
        return self

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.size[0], 0.5 * self.size[1]


class CircularBlank(Zoned, _MeshedBlank):
    """A circle about the origin."""

    shape: Literal["circle"] = Field(description="a circle about the origin")
    diameter: Length = Field(gt=0, description="diameter of the whole blank [mm]")
    element_size: Length = Field(gt=0, description="largest side of an element, about [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.diameter, 0.5 * self.diameter


class TubeBlank(OneSheet, _MeshedBlank):
    """A straight tube about the axis x."""

    shape: Literal["tube"] = Field(description="a straight tube about the axis x, in place of a sheet")
    diameter: Length = Field(gt=0, description="outside diameter [mm]")
    length: Length = Field(gt=0, description="length of the whole tube [mm]")
    element_size: Length = Field(gt=0, description="largest side of an element, about [mm]")

    @model_validator(mode="after")
    def _check_bore(self) -> Self:
        if 2.0 * self.thickness >= self.diameter:
            fault_text = f"a wall of {self.thickness:g} mm leaves no bore in a tube of {self.diameter:g} mm"
            raise fault(fault_text, "give the outside diameter, and the thickness of the wall", key="thickness")
        if self.length < self.thickness:
            fault_text = f"a tube of {self.length:g} mm is shorter than its wall is thick, {self.thickness:g} mm"
            raise fault(fault_text, "give the length of the whole tube; plain numbers are mm", key="length")
        return self

    def half_size(self) -> tuple[float, float]:
        """Return half the length, and half the way round [mm]."""
        return 0.5 * self.length, 0.5 * pi * self.diameter


class OutlinedBlank(Zoned, _MeshedBlank):
    """What lies inside an outline from a file; of a part with symmetry planes the file has the whole outline."""

    shape: Literal["outline"] = Field(description="what lies inside an outline from a file")
    path: FileName = Field(
        description="a DXF drawing, or a text file with the corners of a polygon (with columns loop, x_mm, y_mm: its "
        "first loop); relative to the case file"
    )
    unit: str | None = Field(
        default=None, description="length unit of its coordinates; without it a drawing's own, or mm"
    )
    layer: str | None = Field(default=None, description="of a drawing: the layer that it is on; without it: all layers")
    element_size: Length = Field(gt=0, description="largest side of an element, about [mm]")


class BlankFile(Zoned, _Blank):
    """A mesh of quadrilaterals or triangles from a file; with symmetry planes it is the part at x, y >= 0."""

    shape: Literal["file"] = Field(description="a mesh of quadrilaterals or triangles from a file")
    path: FileName = Field(description="the mesh file, relative to the case file")
    unit: str = Field(default="mm", description="length unit of the file's coordinates, e.g. mm, m, inch")


Blank = Annotated[
    RectangularBlank | CircularBlank | TubeBlank | OutlinedBlank | BlankFile, Field(discriminator="shape")
]
