# SPDX-License-Identifier: Apache-2.0
"""A part in its tools and after springback, and how far it lies off the shape that is wanted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from presswork.geometry.best_fit import fit_rigidly
from presswork.geometry.foot_on_triangles import find_feet
from presswork.mesh.triangles import split_quads
from presswork.model import FloatArray, IntArray
from presswork.post.springback import find_formed_step
from presswork.results import Result, ResultError, ResultMesh

_CELLS_NEAR = 4
"""Cells whose strain counts at a node."""


@dataclass(frozen=True)
class ReleasedPart:
    """Middle of a sheet as formed and after springback."""

    formed: FloatArray
    """Formed part in its closed tools (n_points, 3) [mm]."""
    free: FloatArray
    """The same nodes after springback (n_points, 3) [mm]."""
    triangles: IntArray
    """Shape (n, 3)."""


@dataclass(frozen=True)
class Misfit:
    """How far a part lies off the wanted shape after the best fit."""

    off: FloatArray
    """Distance from each wanted place to where the part has come to (n, 3) [mm]."""
    deviation: FloatArray
    """Distance of the part from each wanted place along its own normal (n,) [mm]; positive above the sheet's face."""
    free: FloatArray
    """Nodes of the part after the fit (n_points, 3) [mm]."""


def read_released(result: Result) -> tuple[ReleasedPart, FloatArray, IntArray]:
    """Return the part at the end of a run, and points (n, 3) and triangles of the sheet before it was trimmed.

    Raises ResultError if nothing has sprung back.
    """
    step = find_formed_step(result)
    mesh = result.mesh_at(step)
    part = ReleasedPart(result.points(step), result.points(-1), triangulate_mesh(mesh, result.points(step)))
    if not np.isfinite(part.free).all():
        raise ResultError(f"{result.folder}: the part after springback has places that are not finite numbers")
    before = step
    while before > 0 and result.mesh_at(before) is mesh and result.mesh_at(before - 1) is mesh:
        before -= 1
    if before > 0 and _is_cut(mesh, result.mesh_at(before - 1)):
        whole, points = result.mesh_at(before - 1), result.points(before - 1)
        return part, points, triangulate_mesh(whole, points)
    return part, part.formed, part.triangles


def read_face_strain(result: Result, points: FloatArray) -> FloatArray:
    """Return the equivalent plastic strain at places of the formed part (n,), mean of both faces and of cells near."""
    step = find_formed_step(result)
    mesh, nodes = result.mesh_at(step), result.points(step)
    middles = np.concatenate([nodes[block.connectivity].mean(axis=1) for block in mesh.blocks])
    faces = [np.asarray(result.field(f"equivalent_plastic_strain_{side}", step)) for side in ("top", "bottom")]
    _, near = cKDTree(middles).query(points, k=min(_CELLS_NEAR, len(middles)))
    return np.asarray(0.5 * (faces[0] + faces[1])[near].reshape(len(points), -1).mean(axis=1))


def _is_cut(mesh: ResultMesh, before: ResultMesh) -> bool:
    """Return whether a mesh covers less of the blank than the one before."""
    areas = []
    for each in (mesh, before):
        a, b, c = each.points[triangulate_mesh(each, each.points)].transpose(1, 0, 2)
        areas.append(float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()))
    return areas[0] < (1.0 - 1e-6) * areas[1]


def triangulate_mesh(mesh: ResultMesh, points: FloatArray) -> IntArray:
    """Return the cells of a sheet as triangles (n, 3)."""
    parts = []
    for block in mesh.blocks:
        parts.append(split_quads(points, block.connectivity.astype(np.int32)))
    return np.concatenate(parts).astype(np.int32)


def measure_misfit(
    part: ReleasedPart, place: FloatArray, wanted: FloatArray, weight: FloatArray, planes: tuple[bool, bool]
) -> Misfit:
    """Return how far places of a part lie off where they are wanted, after the best rigid alignment.

    place: where each is in the closed tools (n, 3) [mm]; wanted: where it should come to rest (n, 3); weight: in the
    fit (n,); planes: symmetry planes, as in fit_rigidly. A place beyond the edge goes with the triangle there.
    """
    feet = find_feet(place, part.formed, part.triangles)
    start, goal = (_frames(x[part.triangles[feet.triangle]]) for x in (part.formed, part.free))
    beyond = place - feet.interpolate(part.formed, part.triangles)
    along = np.einsum("nji,nj->ni", start, beyond)
    along[:, 2] = 0.0  # a sheet that lies off its tool is as far off the shape
    come = feet.interpolate(part.free, part.triangles) + np.einsum("nij,nj->ni", goal, along)
    count = len(place)
    fitted = fit_rigidly(
        np.concatenate([come, part.free]),
        np.concatenate([wanted, np.zeros_like(part.free)]),
        np.concatenate([weight, np.zeros(len(part.free))]),
        planes,
    )
    free = fitted[count:]
    feet = find_feet(wanted, free, part.triangles)
    normal = _frames(free[part.triangles[feet.triangle]])[:, :, 2]
    deviation = ((feet.interpolate(free, part.triangles) - wanted) * normal).sum(axis=1)
    return Misfit(fitted[:count] - wanted, np.asarray(deviation), free)


def _frames(corners: FloatArray) -> FloatArray:
    """Return axes of triangles (n, 3, 3) as columns: along the first edge, across it, normal."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(first, second)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    first = first / np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    return np.stack([first, np.cross(normal, first), normal], axis=2)
