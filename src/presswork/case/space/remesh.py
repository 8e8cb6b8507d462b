# SPDX-License-Identifier: Apache-2.0
"""Meshing a body in space anew in the run: the keys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import Field

from presswork import model
from presswork.case.names import Name
from presswork.case.plane.bodies import WORKPIECE
from presswork.case.settings import Whole
from presswork.case.sizes_of_cells import SizesOfCells
from presswork.case.units import Number
from presswork.mesh.joined import split_mesh

if TYPE_CHECKING:
    pass


class SpaceBodyRemesh(SizesOfCells):
    """When and how finely a body of tetrahedra is meshed anew in the run."""

    max_cells: Whole = Field(
        default=60_000, ge=50, description="largest number of cells; where more would be needed all become larger"
    )
    quality: Number = Field(
        default=0.2,
        gt=0,
        lt=0.4,
        description="quality (mean ratio) of the worst cell, expected after the next increment, below which the "
        "workpiece is meshed anew; a regular tetrahedron has 1",
    )

    def build(self, mesh: model.Mesh) -> model.Remeshing:
        """Return the Model's settings for a body's first mesh."""
        return model.Remeshing(*self.find_sizes(mesh), self.max_cells, self.quality)


class SpaceRemesh(SpaceBodyRemesh):
    """When and how finely bodies of tetrahedra are meshed anew in the run: keys of the workpiece, and of further
    bodies.
    """

    every: Number = Field(
        default=0.0, ge=0, le=1, description="part of a stage after which it is meshed anew in any case; 0: never"
    )
    enabled: bool = Field(default=True, description="false: the first mesh stays, whatever becomes of it")

    bodies: dict[Name, SpaceBodyRemesh] = Field(
        default={}, description="sizes and triggers of further bodies by name; without them: as without keys"
    )

    def of_bodies(
        self, mesh: model.Mesh, bodies: Sequence[model.Body]
    ) -> dict[str, tuple[SpaceBodyRemesh, model.Mesh]]:
        """Return every body's keys and first mesh by its name, the workpiece first."""
        if not bodies:
            return {WORKPIECE: (self, mesh)}
        keys = [self, *(self.bodies.get(body.name, SpaceBodyRemesh()) for body in bodies[1:])]
        names = [body.name for body in bodies]
        return dict(zip(names, zip(keys, split_mesh(mesh, bodies), strict=True), strict=True))

    def build_all(self, mesh: model.Mesh, bodies: Sequence[model.Body]) -> model.Remeshing:
        """Return the Model's settings of all bodies."""
        (_, first), *others = ((name, keys.build(own)) for name, (keys, own) in self.of_bodies(mesh, bodies).items())
        return replace(first, every=self.every, bodies=dict(others))
