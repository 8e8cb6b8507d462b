# SPDX-License-Identifier: Apache-2.0
"""Radius over which the mean of the damage decides, of metals that give none: a tenth of the body's thickness.

The thickness is the diameter of the largest ball that fits into the body before forming. Beyond the axis, symmetry
planes and the faces of a sector the body goes on. It belongs to the part and not to its mesh. A sheet is thinner than
its shells are long, so there the radius is two sizes of a shell (observe/neighbourhood.py).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray, Model

PART = 0.1
"""Length over which damage is averaged in a sheet, over the thickness."""
FLAT = 1e-6
"""How far nodes of a symmetry plane may lie off it, over the body's size."""


def find_lengths(model: Model) -> list[float | None]:
    """Return the radius in each block [mm], None in blocks of shells, of a model whose mesh is that before forming."""
    mesh = model.mesh
    faces = mesh.boundary_edges if model.dimension == 2 else mesh.boundary_faces
    free = faces[~_find_inside(model, faces)]
    lengths: list[float | None] = []
    for block in mesh.blocks:
        if block.section is not None:
            lengths.append(None)
            continue
        own = np.zeros(len(mesh.points), dtype=bool)
        own[block.connectivity] = True
        cells = mesh.points[block.connectivity]
        inside = np.concatenate([mesh.points[own], cells.mean(axis=1)])
        lengths.append(PART * _measure_thickness(inside, mesh.points, free[own[free].all(axis=1)]))
    return lengths


def _measure_thickness(inside: FloatArray, points: FloatArray, faces: IntArray) -> float:
    """Return twice the largest distance of places (n, d) from faces (m, k); the whole extent without faces [mm]."""
    from scipy.spatial import cKDTree

    if not len(faces):
        return float(np.ptp(inside, axis=0).max())
    skin = np.concatenate([points[np.unique(faces)], points[faces].mean(axis=1)])
    return float(2.0 * cKDTree(skin).query(inside)[0].max())


def _find_inside(model: Model, faces: IntArray) -> BoolArray:
    """Return which boundary faces (n, k) lie inside the whole body: on the axis or on a plane of symmetry."""
    points, inside = model.mesh.points, np.zeros(len(faces), dtype=bool)
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    for nodes in _list_planes(model, tolerance):
        on = np.zeros(len(points), dtype=bool)
        on[nodes] = True
        inside |= on[faces].all(axis=1)
    return inside


def _list_planes(model: Model, tolerance: float) -> Iterator[IntArray]:
    """Yield the nodes of the axis, of planes along whose normals supports hold them, and of the faces of a sector."""
    points, sets = model.mesh.points, model.mesh.node_sets
    if model.analysis == "axisymmetric":
        yield np.flatnonzero(points[:, 0] <= tolerance).astype(np.int32)
    if model.cyclic is not None:
        yield from (sets[model.cyclic.first], sets[model.cyclic.last])
    for support in model.lasting_supports:
        nodes = sets[support.node_set]
        held = np.flatnonzero(support.fix[: points.shape[1]])
        if support.normal is None and len(held) != 1:
            continue
        normal = np.eye(points.shape[1])[held[0]] if support.normal is None else np.array(support.normal)
        if len(nodes) and np.ptp(points[nodes] @ normal) <= tolerance:
            yield nodes
