# SPDX-License-Identifier: Apache-2.0
"""New meshes of bodies in the plane, with the state that has come to them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.checks import MeshError
from presswork.mesh.joined import join_parts
from presswork.model import FloatArray, Mesh, Model
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier, Part
from presswork.remesh.old_section import OldSection
from presswork.remesh.section import NewSection
from presswork.state import State

Made = TypeVar("Made")


@dataclass(frozen=True)
class NewEpoch:
    """Equilibrium on a new mesh, with the tools at rest."""

    procedure: ImplicitProcedure
    origin: FloatArray
    """First places of the material at its nodes (n_points, 2) [mm]."""
    jump: float
    """Largest change of a tool's force, of the largest force."""
    iterations: int
    seams: Sequence[FloatArray]
    """Where folds were left out (m, 2 | 3) [mm], as process/mesh_change/seams.py takes them."""
    carrier: Carrier
    carried: State
    """Before equilibrium."""
    may_yield: bool
    """Whether the metal has followed its law during the transfer."""


def make_on_lead(world: World | None, remesh: Callable[..., Made], *given: object, part: float = 1.0) -> Made:
    """Return the new mesh that `remesh` makes of a body; of ranks the first makes it for all. Raises MeshError."""
    make = partial(remesh, *given, part=part)
    return make() if world is None else world.share(make, MeshError)


def join_sections(old: Sequence[OldSection], new: Sequence[NewSection | None]) -> tuple[Mesh, list[Part]]:
    """Return the mesh of all bodies, those without a new one as they lie now, and what becomes of each."""
    parts, meshes, first = [], [], 0
    for block, (before, made) in enumerate(zip(old, new, strict=True)):
        mesh = replace(before.mesh, points=before.position) if made is None else made.mesh
        points = range(first, first + len(mesh.points))
        surface = None if made is None else made.surface(before.points.start, first)
        parts.append(Part(before.points, points, block, surface, () if made is None else made.line.seams))
        meshes.append(mesh)
        first = points.stop
    return join_parts(meshes), parts


def keep_held(origin: FloatArray, model: Model) -> None:
    """Give material that supports have held ever since the run began its first coordinate back, in place.

    model: on the new mesh; origin: first places of the material at its nodes (n_points, 2 | 3) [mm].
    """
    mesh = model.mesh
    driven = {(p.node_set, p.component) for stage in model.stages for p in stage.prescribed}
    for support in model.lasting_supports:
        nodes = mesh.node_sets[support.node_set]
        for axis in range(mesh.points.shape[1]):
            if support.fix[axis] and (support.node_set, axis) not in driven:
                origin[nodes, axis] = mesh.points[nodes, axis]
