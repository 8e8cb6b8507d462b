# SPDX-License-Identifier: Apache-2.0
"""The cells of a sheet that a pressure pushes, and along which of their normals."""

from __future__ import annotations

import numpy as np

from presswork.geometry.polygon import contains, list_sides
from presswork.model import Face, FloatArray, IndexArray, IntArray, Mesh, SheetPressure


def find_pressed_cells(points: FloatArray, cells: IntArray, pressure: SheetPressure) -> IndexArray:
    """Return the numbers of the cells whose middle lies in the pressure's region.

    points: undeformed (n_points, 3) [mm]; cells: corners (n, 4), a triangle with its last node twice.
    """
    if pressure.region is None:
        return np.arange(len(cells))
    inside = contains(list_sides(pressure.region.polygon), find_middles(points, cells)[:, :2])
    return np.flatnonzero(inside == (pressure.region.keep == "inside"))


def find_rim(mesh: Mesh) -> IntArray:
    """Return the edges of the rim of a sheet (n, 2), without those where a plane of symmetry cuts it."""
    cut = [mesh.node_sets[name] for name in ("symmetry_x", "symmetry_y") if name in mesh.node_sets]
    edges = mesh.boundary_edges[:, :2]
    is_cut = np.zeros(len(edges), dtype=bool)
    for nodes in cut:
        is_cut |= np.isin(edges, nodes).all(axis=1)
    return np.asarray(edges[~is_cut])


def find_middles(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the middles of cells (n, 4), a triangle with its last node twice (n, 3) [mm].

    >>> find_middles(np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]), np.array([[0, 1, 2, 2]])).tolist()
    [[1.0, 1.0, 0.0]]
    """
    weight = np.full(cells.shape, 0.25)
    weight[cells[:, 2] == cells[:, 3]] = (1 / 3, 1 / 3, 1 / 3, 0.0)
    return np.asarray(np.einsum("ca,cai->ci", weight, points[cells]))


def find_side(points: FloatArray, cells: IntArray, face: Face) -> float:
    """Return 1 where a pressure on a face pushes along the normals of cells (n, 4), -1 where it pushes against them.

    The normals are those of the order of the corners, which runs one way round in all cells of a sheet. The upper face
    is that to which z points where the undeformed sheet, points (n_points, 3), is seen from above; the outer face is
    turned away from the mean of its points.
    """
    if face in ("top", "bottom"):
        along = 1.0 if measure_rise(points, cells) >= 0.0 else -1.0
        return -along if face == "top" else along
    along = 1.0 if measure_bulge(points, cells) >= 0.0 else -1.0
    return along if face == "inside" else -along


def measure_rise(points: FloatArray, cells: IntArray) -> float:
    """Return the area of a sheet seen from above over its area, with a sign; 0 where it has no upper face.

    >>> measure_rise(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2, 3]]))
    1.0
    """
    area = find_area_vectors(points[cells]).sum(axis=1)
    return float(area[:, 2].sum() / np.linalg.norm(area, axis=1).sum())


def measure_bulge(points: FloatArray, cells: IntArray) -> float:
    """Return how far a sheet lies off the mean of its points along its normals, over its size; 0 where it is flat.

    1 of a whole sphere, with its sign by the way the cells run round.
    """
    area, away = find_area_vectors(points[cells]).sum(axis=1), find_middles(points, cells) - points.mean(axis=0)
    size = (np.linalg.norm(area, axis=1) * np.linalg.norm(away, axis=1)).sum()
    return float((area * away).sum() / size)


def find_area_vectors(corners: FloatArray) -> FloatArray:
    """Return the area vectors of the corners of cells (n, 4, 3) [mm2]: what a pressure of 1 gives them, exactly.

    corners: positions (n, 4, 3) [mm], of a triangle the last twice. A bilinear cell m + xi b1 + eta b2 + xi eta h has
    b1 x b2 + xi_a/3 b1 x h + eta_a/3 h x b2 at its corner a.

    >>> find_area_vectors(np.array([[[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]]))[0, :, 2].tolist()
    [1.0, 1.0, 1.0, 1.0]
    """
    xi, eta = np.array([-1.0, 1.0, 1.0, -1.0]), np.array([-1.0, -1.0, 1.0, 1.0])
    first, second, twist = (0.25 * np.einsum("a,cai->ci", each, corners) for each in (xi, eta, xi * eta))
    along, across = np.cross(first, twist) / 3.0, np.cross(twist, second) / 3.0
    area = np.cross(first, second)[:, None] + xi[:, None] * along[:, None] + eta[:, None] * across[:, None]
    triangles = (corners[:, 2] == corners[:, 3]).all(axis=1)
    x = corners[triangles]
    area[triangles] = (np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) / 6.0)[:, None] * [[1.0], [1.0], [1.0], [0.0]]
    return np.asarray(area)


def find_swept_volume(start: FloatArray, now: FloatArray, cells: IntArray) -> float:
    """Return the volume that cells (n, 4) sweep along their normals on straight paths [mm3].

    start, now: positions of the nodes (n_points, 3) [mm]. The area vectors are quadratic along the path, so that
    Simpson's rule is exact; where the rim of the cells rests, any other path gives the same volume.
    """
    first, last = start[cells], now[cells]
    mean = find_area_vectors(first) + 4.0 * find_area_vectors(0.5 * (first + last)) + find_area_vectors(last)
    return float((mean * (last - first)).sum()) / 6.0
