# SPDX-License-Identifier: Apache-2.0
"""Meshing anew in the run: the keys, and what they go with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import model
from presswork.case.names import Name
from presswork.case.part import Part
from presswork.case.settings import Whole
from presswork.case.sizes_of_cells import SizesOfCells
from presswork.case.units import Length, Number, fault
from presswork.mesh.joined import split_mesh

if TYPE_CHECKING:
    pass

OF_RADIUS = 0.5
"""Smallest proposed size over the least radius of a tool."""
OF_SMALLEST = 0.5
"""Radius that sharp corners of tools get where they point into the metal, over the smallest size."""


class BodyRemesh(SizesOfCells):
    """When and how finely a body is meshed anew in the run."""

    max_cells: Whole = Field(
        default=20_000, ge=50, description="largest number of cells; where more would be needed all become larger"
    )
    quality: Number = Field(
        default=0.2,
        gt=0,
        lt=0.6,
        description="quality of the worst cell, expected after the next increment, below which the workpiece is meshed "
        "anew; a square has 1",
    )

    def build(self, mesh: model.Mesh) -> model.Remeshing:
        """Return the Model's settings for a body's first mesh."""
        return model.Remeshing(*self.find_sizes(mesh), self.max_cells, self.quality)


class Window(Part):
    """A rectangle, fixed in space, in which cells are small."""

    box: tuple[Length, Length, Length, Length] = Field(description="least x, least y, largest x, largest y [mm]")
    size: Length = Field(gt=0, description="largest edge of cells in it [mm]")

    @model_validator(mode="after")
    def _check_box(self) -> Self:
        if self.box[0] >= self.box[2] or self.box[1] >= self.box[3]:
            raise fault("is empty", "give least x, least y, largest x, largest y", key="box")
        return self


class Remesh(BodyRemesh):
    """When and how finely bodies are meshed anew in the run: keys of the workpiece, and of further bodies."""

    every: Number = Field(
        default=0.0, ge=0, le=1, description="part of a stage after which it is meshed anew in any case; 0: never"
    )

    enabled: bool = Field(default=True, description="false: the first mesh stays, whatever becomes of it")
    windows: tuple[Window, ...] = Field(default=(), description="rectangles in which cells are small")
    tools: dict[Name, Annotated[Length, Field(gt=0)]] = Field(
        default={}, description="largest edge of cells on tools by name [mm], from a few cells ahead of contact on"
    )
    error: Number = Field(
        default=0.0,
        ge=0,
        lt=1,
        description="part of the stress power that cells may miss, by which their size is chosen; 0: it is not, 0.1 is "
        "usual",
    )
    bodies: dict[Name, BodyRemesh] = Field(
        default={}, description="sizes and triggers of further bodies by name; without them: as without keys"
    )

    def of_bodies(self, mesh: model.Mesh, bodies: Sequence[model.Body]) -> dict[str, tuple[BodyRemesh, model.Mesh]]:
        """Return every body's keys and first mesh by its name, the workpiece first."""
        keys = [self, *(self.bodies.get(body.name, BodyRemesh()) for body in bodies[1:])]
        names = [body.name for body in bodies]
        return dict(zip(names, zip(keys, split_mesh(mesh, bodies), strict=True), strict=True))

    def build_all(self, mesh: model.Mesh, bodies: Sequence[model.Body], tools: Sequence[model.Tool]) -> model.Remeshing:
        """Return the Model's settings of all bodies."""
        windows = tuple(model.SizeWindow(window.box, window.size) for window in self.windows)
        tool_sizes = tuple(self.tools.get(tool.name, np.inf) for tool in tools)
        (_, workpiece), *others = (
            (name, replace(keys.build(own), windows=windows, tool_sizes=tool_sizes, error=self.error))
            for name, (keys, own) in self.of_bodies(mesh, bodies).items()
        )
        return replace(workpiece, every=self.every, bodies=dict(others))
