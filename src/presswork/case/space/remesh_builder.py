# SPDX-License-Identifier: Apache-2.0
"""When bodies in space get new meshes: what the keys go with, and the Model's settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.plane.bodies import WORKPIECE
from presswork.case.space.remesh import SpaceBodyRemesh, SpaceRemesh
from presswork.model import ELEMENTS

if TYPE_CHECKING:
    from presswork.case.space.schema import SpaceCase


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
