# SPDX-License-Identifier: Apache-2.0
"""Meshing a body in space anew in the run: the keys, and what they go with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import Field

from presswork import model
from presswork.case.errors import Problem
from presswork.case.settings import Whole
from presswork.case.sizes_of_cells import SizesOfCells
from presswork.case.units import Number
from presswork.model import ELEMENTS

if TYPE_CHECKING:
    from presswork.case.space.schema import SpaceCase


class SpaceRemesh(SizesOfCells):
    """When and how finely a body of tetrahedra is meshed anew in the run."""

    max_cells: Whole = Field(default=60_000, ge=50, description="budget of cells: beyond it all become larger")
    quality: Number = Field(
        default=0.2,
        gt=0,
        lt=0.4,
        description="quality (mean ratio) of the worst cell, expected after the next increment, below which the "
        "workpiece is meshed anew; a regular tetrahedron has 1",
    )
    every: Number = Field(
        default=0.0, ge=0, le=1, description="part of a stage after which it is meshed anew in any case; 0: never"
    )
    enabled: bool = Field(default=True, description="false: the first mesh stays, whatever becomes of it")

    def build(self, mesh: model.Mesh) -> model.Remeshing:
        """Return the Model's settings for the first mesh of a body."""
        return model.Remeshing(*self.find_sizes(mesh), self.max_cells, self.quality, self.every)


def check_space_remesh(case: SpaceCase, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of a case that asks for new meshes."""
    if case.remesh is None or not case.remesh.enabled:
        return []
    if not _is_of_tetrahedra(case):
        fault = f"cells of {case.workpiece.element} keep their mesh: new ones are made of tetrahedra"
        return [Problem("remesh", fault, 'take element = "tet4_mini", or leave out [remesh]')]
    remedy = "remove it, or leave out [remesh]"
    problems = [
        Problem(key, "does not go together with [remesh]", remedy)
        for key, is_so in _find_obstacles(case).items()
        if is_so
    ]
    return problems + case.remesh.check_sizes(mesh, "remesh")


def build_space_remeshing(case: SpaceCase, mesh: model.Mesh) -> model.Remeshing | None:
    """Return when and how finely the body is meshed anew; None where it never is.

    Without keys, a body of tetrahedra that meets tools keeps its first mesh until it fails.
    """
    if case.remesh is not None:
        return case.remesh.build(mesh) if case.remesh.enabled else None
    if not case.tools or not _is_of_tetrahedra(case) or case.solver.displacements == "small" or case.bodies:
        return None
    n_cells = sum(len(block.connectivity) for block in mesh.blocks)
    settings = SpaceRemesh(max_cells=max(SpaceRemesh().max_cells, 2 * n_cells)).build(mesh)
    obstacles = [f"{key} does not go together with new meshes" for key, is_so in _find_obstacles(case).items() if is_so]
    return replace(settings, keeps_first=True, obstacle="; ".join(obstacles))


def _is_of_tetrahedra(case: SpaceCase) -> bool:
    return bool(ELEMENTS[case.workpiece.element].cell == "tet4")


def _find_obstacles(case: SpaceCase) -> dict[str, bool]:
    """Return which keys of a case do not go together with new meshes."""
    return {
        "bodies": bool(case.bodies),
        "contacts": bool(case.contacts),
        "boundary cyclic": any(entry.cyclic is not None for entry in case.boundary.values()),
        "solver.inertia": case.solver.inertia > 0.0,
        "solver.displacements": case.solver.displacements == "small",
    }
