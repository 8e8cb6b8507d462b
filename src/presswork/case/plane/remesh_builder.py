# SPDX-License-Identifier: Apache-2.0
"""When sections get new meshes: what the keys go with, and the Model's settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.plane.remesh import OF_RADIUS, BodyRemesh, Remesh
from presswork.geometry.pose import start_profile
from presswork.geometry.profile_path import ProfilePath

if TYPE_CHECKING:
    from presswork.case.plane.schema import Case


def check_remesh(case: Case) -> list[Problem]:
    """Return the problems of a case that asks for new meshes with what cannot be carried to them."""
    if case.remesh is None or not case.remesh.enabled:
        return []
    remedy, found = "remove it, or leave out [remesh]", _find_obstacles(case)
    problems = [Problem(key, "does not go together with [remesh]", remedy) for key, is_so in found.items() if is_so]
    problems += [
        Problem(f"remesh.bodies.{name}", "no such body", suggest(name, case.bodies, "bodies"))
        for name in case.remesh.bodies
        if name not in case.bodies
    ]
    return problems + [
        Problem(f"remesh.tools.{name}", "no such tool", suggest(name, case.tools, "tools"))
        for name in case.remesh.tools
        if name not in case.tools
    ]


def _find_obstacles(case: Case) -> dict[str, bool]:
    """Return which keys of a case do not go together with new meshes."""
    explicit = case.procedure == "explicit"
    return {
        "bodies": explicit and bool(case.bodies),
        "contacts": explicit and bool(case.contacts),
        "solver.inertia": case.solver.inertia > 0.0,
        "solver.control": case.solver.control == "arc_length",
        "solver.displacements": case.solver.displacements == "small",
    }


def check_places(case: Case, mesh: model.Mesh, bodies: Sequence[model.Body]) -> list[Problem]:
    """Return the problems of sets that new meshes cannot keep: with nodes inside, and of bodies of mixed cells."""
    named = {f"boundary.{name}.set": entry.set for name, entry in case.boundary.items()}
    for number, stage in enumerate(case.stages):
        for key in ("displacement", "force"):
            named |= {f"stages.{number}.{key}.{i}.set": entry.set for i, entry in enumerate(getattr(stage, key))}
    surface, problems = np.unique(mesh.boundary_edges), []
    for key, name in named.items():
        inner = int((~np.isin(mesh.node_sets[name], surface)).sum())
        if inner and len(mesh.node_sets[name]) < len(mesh.points):
            fault = f"{inner} nodes of {name} lie inside: new meshes keep places on the boundary alone"
            problems.append(Problem(key, fault, "name a set of the boundary, or leave out [remesh]"))
    for body in bodies:
        if len(body.blocks) > 1:
            key = "workpiece.mesh" if body is bodies[0] else f"bodies.{body.name}.mesh"
            fault = "cells of several kinds cannot be meshed anew together"
            problems.append(Problem(key, fault, "give a mesh of triangles or of quadrilaterals alone"))
    return problems


def build_remeshing(
    case: Case, mesh: model.Mesh, bodies: Sequence[model.Body], tools: Sequence[model.Tool]
) -> model.Remeshing | None:
    """Return when and how finely the bodies are meshed anew; None where they never are.

    Without keys, bodies that meet tools keep their first mesh until it fails.
    """
    if case.remesh is not None:
        return case.remesh.build_all(mesh, bodies, tools) if case.remesh.enabled else None
    if not tools or case.solver.displacements == "small":
        return None
    keys = Remesh()
    of_body = {name: _allow_for(own) for name, (_, own) in keys.of_bodies(mesh, bodies).items()}
    workpiece, *others = of_body.values()
    keys = Remesh(max_cells=workpiece.max_cells, bodies=dict(zip(list(of_body)[1:], others, strict=True)))
    return replace(keys.build_all(mesh, bodies, tools), keeps_first=True, obstacle=_explain(case, mesh, bodies))


def _allow_for(mesh: model.Mesh) -> BodyRemesh:
    """Return the keys of a body whose first mesh (of it alone) may exceed the usual budget."""
    n_cells = sum(len(block.connectivity) for block in mesh.blocks)
    return BodyRemesh(max_cells=max(BodyRemesh().max_cells, 2 * n_cells))


def _explain(case: Case, mesh: model.Mesh, bodies: Sequence[model.Body]) -> str:
    """Explain what prevents new meshes; empty if nothing does."""
    keys = [f"{key} does not go together with new meshes" for key, is_so in _find_obstacles(case).items() if is_so]
    places = [f"{problem.key}: {problem.expected}" for problem in check_places(case, mesh, bodies)]
    return "; ".join(keys + places)


def check_tools(remesh: Remesh, mesh: model.Mesh, tools: Sequence[model.Tool]) -> list[Problem]:
    """Return the problems of sizes with which the tools cannot be followed, and of windows below the smallest size."""
    problems, smallest = [], remesh.build(mesh).smallest_size
    key = "remesh.smallest_size" if remesh.smallest_size is not None else "remesh.size"
    for tool in tools if remesh.smallest_size is not None or remesh.size is not None else ():
        radius = float(ProfilePath(start_profile(tool)).radius.min())
        if smallest > radius:
            fault_text = f"cells of {smallest:.3g} mm cannot follow the radius of {radius:.3g} mm of {tool.name}"
            problems.append(Problem(key, fault_text, f"give smallest_size = {OF_RADIUS * radius:.2g} or less"))
    sizes = {f"remesh.windows.{i}.size": window.size for i, window in enumerate(remesh.windows)}
    sizes |= {f"remesh.tools.{name}": size for name, size in remesh.tools.items()}
    for key, size in sizes.items():
        if size < smallest:
            remedy = f"give a larger size, or smallest_size = {size:g}"
            problems.append(Problem(key, f"is below the smallest size of cells, {smallest:.3g} mm", remedy, size))
    return problems


def check_sizes(remesh: Remesh, mesh: model.Mesh, bodies: Sequence[model.Body]) -> list[Problem]:
    """Return the problems of sizes that do not fit each other or their bodies."""
    return [
        problem
        for number, (name, (keys, own)) in enumerate(remesh.of_bodies(mesh, bodies).items())
        for problem in _check_sizes(keys, own, f"remesh.bodies.{name}" if number else "remesh")
    ]


def _check_sizes(remesh: BodyRemesh, mesh: model.Mesh, key: str) -> list[Problem]:
    size, problems = remesh.find_size(mesh), remesh.check_sizes(mesh, key)
    edges = mesh.points[mesh.boundary_edges[:, :2]]
    round_it = float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum())
    if round_it > 10 * size * remesh.max_cells:
        fault = f"size ({size:g} mm) is too small for max_cells = {remesh.max_cells}: the boundary has {round_it:g} mm"
        problems.append(Problem(f"{key}.size", fault, "make it larger, or leave it out"))
    return problems
