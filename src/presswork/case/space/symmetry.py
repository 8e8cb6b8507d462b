# SPDX-License-Identifier: Apache-2.0
"""Supports and symmetry planes of a solid in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.space.cyclic import find_cyclic
from presswork.case.space.schema import AXES, SpaceCase
from presswork.model import FloatArray

FLAT = 1e-6
"""How far the nodes of a plane may lie off it, over the size of the body."""


@dataclass(frozen=True)
class Symmetry:
    """What is modelled of the whole."""

    planes: tuple[FloatArray, ...]
    """Positions [mm] of the symmetry planes normal to x, y and z."""
    sectors: float
    """Number of sectors like the one modelled round z; 1: there is no plane that is normal to none of them."""


def build_supports(case: SpaceCase, mesh: model.Mesh) -> tuple[tuple[model.Support, ...], list[Problem]]:
    """Return the Model's supports, and the problems of those that hold the normal of no plane."""
    supports, problems = [], []
    for name, entry in case.boundary.items():
        if entry.cyclic is not None:
            continue
        if "normal" not in entry.fix:
            supports.append(model.Support(entry.set, tuple(axis in entry.fix for axis in AXES), name))
            continue
        if mesh.blocks[0].element == "tet4_mini":
            fault = "tetrahedra are held along x, y and z alone"
            problems.append(Problem(f"boundary.{name}.fix", fault, "take a quarter or a half", ["normal"]))
            continue
        normal = _find_normal(mesh, entry.set)
        if normal is None:
            fault = f"the nodes of `{entry.set}` lie in no plane"
            problems.append(Problem(f"boundary.{name}.fix", fault, "name a flat side, or give x, y, z", ["normal"]))
        else:
            x, y, z = normal.tolist()
            axis = int(np.argmax(np.abs(normal)))
            if abs(normal[axis]) > 1.0 - 1e-9:
                supports.append(model.Support(entry.set, tuple(i == axis for i in range(3)), name))
            else:
                supports.append(model.Support(entry.set, (True, True, True), name, normal=(x, y, z)))
    return tuple(supports), problems


def _find_normal(mesh: model.Mesh, name: str) -> FloatArray | None:
    """Return the unit normal (3,) of the plane that the nodes of a set lie in; None: they lie in none, or in many."""
    points = mesh.points[mesh.node_sets[name]]
    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    _, spread, directions = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if len(points) < 3 or spread[1] < FLAT * size:
        return None
    normal = directions[2]
    return normal if np.abs((points - points.mean(axis=0)) @ normal).max() < FLAT * size else None


def find_symmetry(
    case: SpaceCase, mesh: model.Mesh, bodies: tuple[model.Body, ...], supports: tuple[model.Support, ...]
) -> Symmetry:
    """Return the symmetry planes of a case whose entries have no problem."""
    held = {support.name: support for support in supports}
    slanted = {name: held[name].normal for name in case.boundary if name in held and held[name].normal is not None}
    planes: tuple[list[float], ...] = ([], [], [])
    upright = []  # normals of those that stand along z
    for name, entry in case.boundary.items():
        if name not in held or entry.symmetry is False or entry.stages is not None:
            continue
        if name in slanted:
            upright.append(np.array(slanted[name]))
        elif sum(held[name].fix) == 1 and is_whole_side(mesh, bodies, entry.set, held[name].fix.index(True)):
            axis = held[name].fix.index(True)
            planes[axis].append(float(mesh.points[mesh.node_sets[entry.set], axis].mean()))
    if not upright:
        cyclic = find_cyclic(case, mesh)
        return Symmetry(tuple(np.unique(of_axis) for of_axis in planes), cyclic.sectors if cyclic else 1.0)
    upright += [np.eye(3)[axis] for axis in range(2) for _ in planes[axis]]
    upright = _leave_out_same(upright)
    sectors = _count_sectors(mesh, upright)
    return Symmetry((np.zeros(0), np.zeros(0), np.unique(planes[2])), sectors)


def _leave_out_same(normals: list[FloatArray]) -> list[FloatArray]:
    """Return unit normals of planes through z, one for each of several bodies' sides in the same plane."""
    kept: list[FloatArray] = []
    for normal in normals:
        if all(abs(normal @ other) < 1.0 - 1e-9 for other in kept):
            kept.append(normal)
    return kept


def _count_sectors(mesh: model.Mesh, normals: list[FloatArray]) -> float:
    """Return 360 degrees over the angle that the body fills between two planes through z."""
    if len(normals) != 2 or any(abs(normal[2]) > 1e-9 for normal in normals):
        return 1.0
    along = [np.cross(normal, (0.0, 0.0, 1.0)) for normal in normals]
    middle = mesh.points[:, :2].mean(axis=0)
    along = [direction if direction[:2] @ middle > 0 else -direction for direction in along]
    angle = float(np.degrees(np.arccos(np.clip(along[0] @ along[1], -1.0, 1.0))))
    return 360.0 / angle


def is_whole_side(mesh: model.Mesh, bodies: tuple[model.Body, ...], name: str, axis: int) -> bool:
    """Whether a set is the whole of an outermost flat side of a body normal to an axis."""
    nodes = mesh.node_sets[name]
    own = next((list(body.points) for body in bodies if nodes[0] in body.points), slice(None))
    points = mesh.points[own]
    low, high = points.min(axis=0), points.max(axis=0)
    tolerance = FLAT * float(np.linalg.norm(high - low))
    at = mesh.points[nodes, axis]
    outermost = min(at.min() - low[axis], high[axis] - at.max()) < tolerance
    is_whole = int((np.abs(points[:, axis] - at[0]) < tolerance).sum()) == len(nodes)
    return bool(np.ptp(at) < tolerance and outermost and is_whole)


def check_symmetry(case: SpaceCase, mesh: model.Mesh, bodies: tuple[model.Body, ...]) -> list[Problem]:
    """Return the problems of entries that are declared as symmetry planes, but are none."""
    problems = []
    for name, entry in case.boundary.items():
        components = sorted(set(entry.fix))
        if not entry.symmetry or components == ["normal"]:
            continue
        if (
            len(components) > 1
            or entry.stages is not None
            or not is_whole_side(mesh, bodies, entry.set, AXES.index(components[0]))
        ):
            fault = f"the set `{entry.set}` with fix = {components} is not a symmetry plane of the workpiece"
            remedy = (
                "fix one component in all stages, on the whole of an outermost flat side normal to it, or leave "
                "symmetry out"
            )
            problems.append(Problem(f"boundary.{name}.symmetry", fault, remedy, True))
    return problems
