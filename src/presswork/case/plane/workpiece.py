# SPDX-License-Identifier: Apache-2.0
"""The part of a case that describes a body: its mesh, its element and its material."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.heat.quantities import Temperature
from presswork.case.names import FileName
from presswork.case.part import Part, ShortForm
from presswork.case.units import Direction, Length, Number, Point, VelocityVector, fault, refuse_no_body

Pattern = Literal["quad", "crossed", "left", "right"]
Count = Annotated[int, Field(strict=True, ge=1, le=100_000)]


class Zone(ShortForm):
    """A run of cells along one direction; short form [length, cells, ratio]."""

    short_form = ("length", "cells", "ratio")

    length: Length = Field(gt=0, description="length of the zone [mm]")
    cells: Count = Field(description="number of cells along the zone")
    ratio: Number = Field(default=1.0, gt=0, description="size of the zone's last cell over its first")


class Rectangle(Part):
    """A rectangle meshed by the program; its sets are left, right, bottom, top, all, boundary and the corners."""

    kind: Literal["rectangle"] = Field(default="rectangle", description="a rectangle meshed by the program")
    origin: Point = Field(default=(0.0, 0.0), description="lower left corner [x, y] [mm]")
    size: Point | None = Field(default=None, description="width and height [mm]")
    cells: tuple[Count, Count] | None = Field(default=None, description="number of cells along x and y")
    grading: Direction = Field(default=(1.0, 1.0), description="size of the last cell over the first along x and y")
    zones_x: tuple[Zone, ...] | None = Field(
        default=None, description="instead of size, cells and grading: zones [length, cells, ratio] from left to right"
    )
    zones_y: tuple[Zone, ...] | None = Field(
        default=None, description="instead of size, cells and grading: zones [length, cells, ratio] from bottom to top"
    )
    pattern: Pattern | None = Field(
        default=None,
        description="quad, or how each quad is cut into triangles: crossed (by both diagonals), left or right (by the "
        "diagonal that leans so); without it: crossed for triangles, quad for quadrilaterals",
    )

    @model_validator(mode="after")
    def _check_single_size(self) -> Self:
        zones = [name for name in ("zones_x", "zones_y") if getattr(self, name) is not None]
        sizes = [name for name in ("size", "cells") if getattr(self, name) is not None]
        if zones and (len(zones) == 1 or sizes):
            raise fault(
                f"{' and '.join(zones + sizes)} do not describe one mesh",
                "give size and cells, or zones_x and zones_y; one zone is [[length, cells, 1]]",
                key=(sizes or zones)[0],
            )
        for name in () if zones else ("size", "cells"):
            if name not in sizes:
                raise fault("missing key", "give size and cells, or zones_x and zones_y", key=name)
        for name in ("size", "grading"):
            value = getattr(self, name)
            if value is not None and min(value) <= 0:
                raise fault("expected two values > 0", "give [x, y], both positive", key=name)
        if self.size is not None:
            refuse_no_body(self.size)
        for name in zones:
            if not getattr(self, name):
                raise fault("expected at least one zone", "give [[length, cells, 1]]", key=name)
        return self


class MeshFile(Part):
    """A mesh from a file: gmsh .msh, Abaqus/CalculiX .inp, VTK .vtk and .vtu, I-DEAS .unv."""

    kind: Literal["file"] = Field(default="file", description="a mesh from a file")
    path: FileName = Field(description="the mesh file, relative to the case file")
    unit: str = Field(default="mm", description="length unit of the file's coordinates, e.g. mm, m, inch")


def assume_rectangle(mesh: object) -> object:
    """Take a mesh without `kind` for a rectangle, unless it names a file."""
    if isinstance(mesh, dict) and "kind" not in mesh:
        return {"kind": "file" if "path" in mesh else "rectangle", **mesh}
    return mesh


EXPLICIT: model.SolidElement = "quad4_1pt"
"""Element of the explicit procedure where a case names none."""


class Workpiece(Part):
    """The body that is formed."""

    material: FileName = Field(
        description='name of one of the [materials], or of the library, or "my_steel.toml", a material file of your own'
    )
    element: model.SolidElement = Field(
        default="quad4_fbar",
        description="element formulation; without it quad4_fbar, which locks neither in volume nor in a neck, and "
        "quad4_1pt where the procedure is explicit",
    )
    mesh: Annotated[Rectangle | MeshFile, Field(discriminator="kind"), BeforeValidator(assume_rectangle)] = Field(
        description="the mesh of the workpiece"
    )
    velocity: VelocityVector | None = Field(
        default=None, description="explicit: velocity [x, y] of the whole workpiece at the start [mm/s]"
    )
    initial_temperature: Temperature | None = Field(
        default=None, description="temperature at the start [degrees C]; without it that of [heat]"
    )


def take_explicit_element(data: dict[str, Any]) -> dict[str, Any]:
    """Return a case as data in which bodies of the explicit procedure have its quadrilateral where none is named."""
    if data.get("procedure") != "explicit":
        return data

    def name_element(body: Any) -> Any:
        return {"element": EXPLICIT, **body} if isinstance(body, dict) else body

    taken = {key: name_element(data[key]) for key in ("workpiece",) if key in data}
    if isinstance(bodies := data.get("bodies"), dict):
        taken["bodies"] = {name: name_element(body) for name, body in bodies.items()}
    return {**data, **taken}
