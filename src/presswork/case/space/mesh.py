# SPDX-License-Identifier: Apache-2.0
"""The keys of a case for the mesh of a solid in space. Units as in case/units.py."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.plane.workpiece import Count, MeshFile
from presswork.case.units import Angle, Length, Number, Point, Point3, fault, refuse_no_body

Sector = Annotated[Angle, Field(gt=0, le=360)]
_ANGLE = "angle of the sector that is meshed, from the x axis towards y [degrees]; 90 is a quarter, 360 the whole"
_AROUND = "number of cells [radial, around, along]"


class Box(Part):
    """A box meshed by the program; its sets are left, right (x), bottom, top (y), back, front (z) and all."""

    kind: Literal["box"] = Field(default="box", description="a box meshed by the program")
    origin: Point3 = Field(default=(0.0, 0.0, 0.0), description="lowest corner [x, y, z] [mm]")
    size: Point3 = Field(description="extent along x, y and z [mm]")
    cells: tuple[Count, Count, Count] = Field(description="number of cells along x, y and z")
    grading: tuple[Number, Number, Number] = Field(
        default=(1.0, 1.0, 1.0), description="size of the last cell over the first along x, y and z"
    )

    @model_validator(mode="after")
    def _check_positive(self) -> Self:
        for name in ("size", "grading"):
            if min(getattr(self, name)) <= 0:
                raise fault("expected three values > 0", "give [x, y, z], all positive", key=name)
        refuse_no_body(self.size)
        return self


def assume_box(mesh: object) -> object:
    """Take a mesh without `kind` for a box, unless it names a file."""
    if isinstance(mesh, dict) and "kind" not in mesh:
        return {"kind": "file" if "path" in mesh else "box", **mesh}
    return mesh


class Cylinder(Part):
    """A cylinder about z, whole or a sector; its sets are those of a box, rim, first_plane and last_plane."""

    kind: Literal["cylinder"] = Field(description="a cylinder about z, whole or a sector of it")
    origin: Point3 = Field(default=(0.0, 0.0, 0.0), description="middle of the lower end [x, y, z] [mm]")
    radius: Length = Field(gt=0, description="radius [mm]")
    height: Length = Field(gt=0, description="height along z [mm]")
    angle: Sector = Field(default=360.0, description=_ANGLE)
    cells: tuple[Count, Count, Count] = Field(description=f"{_AROUND}; around: an even number in each 90 degrees")
    grading: Number = Field(default=1.0, gt=0, description="size of the last cell over the first along z")

    @model_validator(mode="after")
    def _check_body(self) -> Self:
        refuse_no_body((self.radius, self.height), key="height")
        return self


class Ring(Part):
    """A ring about z, whole or a sector; its sets are those of a box, rim, hole, first_plane and last_plane."""

    kind: Literal["ring"] = Field(description="a ring about z, whole or a sector of it")
    origin: Point3 = Field(default=(0.0, 0.0, 0.0), description="middle of the lower end [x, y, z] [mm]")
    inner_radius: Length = Field(gt=0, description="radius of the hole [mm]")
    outer_radius: Length = Field(gt=0, description="outer radius [mm]")
    height: Length = Field(gt=0, description="height along z [mm]")
    angle: Sector = Field(default=360.0, description=_ANGLE)
    cells: tuple[Count, Count, Count] = Field(description=_AROUND)
    grading: Number = Field(default=1.0, gt=0, description="size of the last cell over the first along z")

    @model_validator(mode="after")
    def _check_radii(self) -> Self:
        if self.inner_radius >= self.outer_radius:
            raise fault(f"expected a value < outer_radius = {self.outer_radius:g}", "swap them", key="inner_radius")
        refuse_no_body((self.outer_radius - self.inner_radius, self.outer_radius, self.height), key="height")
        return self


class Turned(Part):
    """A body turned about z, whole or a sector; its sets are those of a box, rim, hole, first_plane and last_plane."""

    kind: Literal["turned"] = Field(description="a body turned about z, with a radius at every height")
    origin: Point3 = Field(default=(0.0, 0.0, 0.0), description="where the profile's origin lies [x, y, z] [mm]")
    profile: tuple[Point, ...] = Field(
        min_length=2, description="points [r, z] of the outer line from the lowest to the highest [mm]"
    )
    hole: Length = Field(default=0.0, ge=0, description="radius of a hole along the axis [mm]; 0: none")
    angle: Sector = Field(default=360.0, description=_ANGLE)
    cells: tuple[Count, Count, Count] = Field(
        description=f"{_AROUND}; around: an even number in each 90 degrees where there is no hole; along: at least one "
        "for each line of the profile"
    )

    @model_validator(mode="after")
    def _check_profile(self) -> Self:
        for (r, z), (_, after) in zip(self.profile, (*self.profile[1:], (0.0, float("inf"))), strict=True):
            if r <= self.hole:
                raise fault(
                    f"the radius {r:g} leaves no metal round a hole of {self.hole:g}", "make it larger", "profile"
                )
            if after <= z:
                remedy = "every point lies above the one before; a step or an undercut needs a mesh file"
                raise fault(f"z = {after:g} follows z = {z:g}", remedy, "profile")
        lines = len(self.profile) - 1
        if self.cells[2] < lines:
            raise fault(f"{self.cells[2]} cells along {lines} lines of the profile", f"give at least {lines}", "cells")
        return self


class Revolved(Part):
    """A plane mesh turned about z; its sets are those of a box, first_plane, last_plane and the file's groups."""

    kind: Literal["revolved"] = Field(description="a plane mesh of quadrilaterals, turned about z")
    path: FileName = Field(
        description="file of the half section, x its radius and y its height: .msh, .inp, .vtk, .vtu or .unv; relative "
        "to the case file"
    )
    unit: str = Field(default="mm", description="length unit of the file")
    angle: Sector = Field(default=360.0, description=_ANGLE)
    around: Count = Field(
        description="number of cells around; of a body with an axis a multiple of 2 in each 90 degrees"
    )


class Extruded(Part):
    """A body of one outline at every height; its sets are those of a box, and rim, all round."""

    kind: Literal["extruded"] = Field(description="an outline in x and y, drawn up along z")
    outline: tuple[Point, ...] | None = Field(default=None, description="corners [x, y] of a polygon [mm]")
    path: FileName | None = Field(
        default=None,
        description="instead: a DXF drawing or a text file of a polygon, or a plane mesh of quadrilaterals (.msh, "
        ".inp, .vtk, .vtu, .unv); relative to the case file",
    )
    unit: str | None = Field(default=None, description="length unit of the file; without it a drawing's own, or mm")
    layer: str | None = Field(default=None, description="of a drawing: the layer it is on; without it: all layers")
    symmetry: tuple[Literal["x", "y"], ...] = Field(
        default=(), description="planes x = 0 and y = 0 that cut the outline; the part at x, y >= 0 is meshed"
    )
    element_size: Length | None = Field(default=None, gt=0, description="side of a cell in the outline, about [mm]")
    bottom: Length = Field(default=0.0, description="z of the lower end [mm]")
    height: Length = Field(gt=0, description="height along z [mm]")
    cells: Count = Field(description="number of cells along z")
    grading: Number = Field(default=1.0, gt=0, description="size of the last cell over the first along z")

    @property
    def is_mesh(self) -> bool:
        """Whether the file has a plane mesh."""
        return self.path is not None and self.path.lower().endswith((".msh", ".inp", ".vtk", ".vtu", ".unv"))

    @model_validator(mode="after")
    def _check_one_outline(self) -> Self:
        if (self.outline is None) == (self.path is None):
            remedy = "for instance outline = [[0, 0], [10, 0], [10, 5], [0, 5]]"
            raise fault("give either outline or path", remedy, key="outline")
        if self.is_mesh:
            for name in ("element_size", "layer", "symmetry"):
                if getattr(self, name):
                    raise fault("has no meaning with a plane mesh", "leave it out", key=name)
        elif self.element_size is None:
            raise fault("missing key", "give the side of a cell in the outline", key="element_size")
        return self


class ClosedSurface(Part):
    """The inside of a closed surface, filled with tetrahedra; its sets are those of a box round it."""

    kind: Literal["surface"] = Field(description="the inside of a closed surface, filled with tetrahedra")
    path: FileName = Field(description="file of the surface: .stl, .step, .stp, .iges or .igs")
    unit: str = Field(default="mm", description="unit of the file's coordinates; STEP holds its own")
    size: Length = Field(gt=0, description="mean edge of cells [mm]; they are smaller at small features")


MadeMesh = Box | Cylinder | Ring | Turned | Revolved | Extruded | ClosedSurface
SpaceMesh = Annotated[MadeMesh | MeshFile, Field(discriminator="kind"), BeforeValidator(assume_box)]
"""The mesh of a solid in space."""
