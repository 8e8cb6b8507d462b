# SPDX-License-Identifier: Apache-2.0
"""Meshing a body in space anew in the run: the keys, and what they go with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import Field

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.names import Name
from presswork.case.settings import Whole
from presswork.case.sizes_of_cells import SizesOfCells
from presswork.case.solid.bodies import WORKPIECE
from presswork.case.units import Number
from presswork.mesh.joined import split_mesh
from presswork.model import ELEMENTS

if TYPE_CHECKING:
    from presswork.case.space.schema import SpaceCase


class SpaceBodyRemesh(SizesOfCells):
    """When and how finely a body of tetrahedra is meshed anew in the run."""

    max_cells: Whole = Field(default=60_000, ge=50, description="budget of cells: beyond it all become larger")
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


def check_space_remesh(case: SpaceCase, mesh: model.Mesh, bodies: Sequence[model.Body]) -> list[Problem]:
    """Return the problems of a case that asks for new meshes."""
    if case.remesh is None or not case.remesh.enabled:
        return []
    if not _is_of_tetrahedra(case):
        fault = f"cells of {case.workpiece.element} keep their mesh: new ones are made of tetrahedra"
        tetrahedra = "tet4_nodal" if case.procedure == "explicit" else "tet4_mini"
        return [Problem("remesh", fault, f'take element = "{tetrahedra}", or leave out [remesh]')]
    remedy = "remove it, or leave out [remesh]"
    problems = [
        Problem(key, "does not go together with [remesh]", remedy)
        for key, is_so in _find_obstacles(case).items()
        if is_so
    ]
    problems += [
        Problem(f"remesh.bodies.{name}", "no such body", suggest(name, case.bodies, "bodies"))
        for name in case.remesh.bodies
        if name not in case.bodies
    ]
    for name, (keys, own) in case.remesh.of_bodies(mesh, bodies).items():
        problems += keys.check_sizes(own, "remesh" if name == WORKPIECE else f"remesh.bodies.{name}")
    return problems


def build_space_remeshing(case: SpaceCase, mesh: model.Mesh, bodies: Sequence[model.Body]) -> model.Remeshing | None:
    """Return when and how finely bodies are meshed anew; None where they never are.

    Without keys, bodies of tetrahedra that meet tools keep their first mesh until it fails.
    """
    if case.remesh is not None:
        return case.remesh.build_all(mesh, bodies) if case.remesh.enabled else None
    if not case.tools or not _is_of_tetrahedra(case) or case.solver.displacements == "small":
        return None
    of_body = {name: _allow_for(own) for name, (_, own) in SpaceRemesh().of_bodies(mesh, bodies).items()}
    budget = of_body.pop(WORKPIECE).max_cells
    settings = SpaceRemesh(max_cells=budget, bodies=of_body).build_all(mesh, bodies)
    obstacles = [f"{key} does not go together with new meshes" for key, is_so in _find_obstacles(case).items() if is_so]
    return replace(settings, keeps_first=True, obstacle="; ".join(obstacles))


def _allow_for(mesh: model.Mesh) -> SpaceBodyRemesh:
    """Return the keys of a body whose first mesh may exceed the usual budget."""
    n_cells = sum(len(block.connectivity) for block in mesh.blocks)
    return SpaceBodyRemesh(max_cells=max(SpaceBodyRemesh().max_cells, 2 * n_cells))


def _is_of_tetrahedra(case: SpaceCase) -> bool:
    return bool(ELEMENTS[case.workpiece.element].cell == "tet4")


def _find_obstacles(case: SpaceCase) -> dict[str, bool]:
    """Return which keys of a case do not go together with new meshes."""
    explicit = case.procedure == "explicit"
    return {
        "contacts of a body with itself": explicit and any(len(set(c.between)) == 1 for c in case.contacts.values()),
        "boundary cyclic": any(entry.cyclic is not None for entry in case.boundary.values()),
        "solver.inertia": case.solver.inertia > 0.0,
        "solver.displacements": case.solver.displacements == "small",
    }
