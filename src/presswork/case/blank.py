# SPDX-License-Identifier: Apache-2.0
"""The blank of a stamping: outline, thickness, mesh size, material and rolling direction. Units as in schema.py."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Angle, Length, Point, fault

_SECTION = model.Section(1.0)


class _Blank(Part):
    """What blanks of any outline have."""

    thickness: Length = Field(gt=0, description="thickness [mm]")
    material: str = Field(description="name of one of the [materials], or of the library")
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


class _MeshedBlank(_Blank):
    """A blank that is meshed by the program."""

    element_size: Length = Field(gt=0, description="largest side of an element, about [mm]")


class RectangularBlank(_MeshedBlank):
    """A rectangle about the origin."""

    shape: Literal["rectangle"] = Field(description="a rectangle about the origin")
    size: Point = Field(description="length along x and y of the whole blank [mm]")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if min(self.size) <= 0:
            raise fault("expected two values > 0", "give [x, y], both positive", key="size")
        return self

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.size[0], 0.5 * self.size[1]


class CircularBlank(_MeshedBlank):
    """A circle about the origin."""

    shape: Literal["circle"] = Field(description="a circle about the origin")
    diameter: Length = Field(gt=0, description="diameter of the whole blank [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.diameter, 0.5 * self.diameter


class OutlinedBlank(_MeshedBlank):
    """A blank within an outline from a file: a DXF drawing, or points as CSV."""

    shape: Literal["outline"] = Field(description="within a closed outline from a file, meshed with quadrilaterals")
    path: str = Field(
        description="DXF, or CSV with columns x_mm and y_mm (a column loop: its first is taken), relative to the case "
        "file; of a part with symmetry planes the whole outline"
    )
    unit: str | None = Field(
        default=None,
        description="length unit of the file's coordinates; without it mm, or what a drawing says of itself",
    )


class BlankFile(_Blank):
    """A mesh of quadrilaterals from a file; with symmetry planes it is the part at x, y >= 0."""

    shape: Literal["file"] = Field(description="a mesh of quadrilaterals from a file")
    path: str = Field(description="the mesh file, relative to the case file")
    unit: str = Field(default="mm", description="length unit of the file's coordinates, e.g. mm, m, inch")


Blank = Annotated[RectangularBlank | CircularBlank | OutlinedBlank | BlankFile, Field(discriminator="shape")]
