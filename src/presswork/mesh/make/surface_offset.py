# SPDX-License-Identifier: Apache-2.0
"""Surfaces of triangles moved along their normals, and cut along a line in the plan."""

from __future__ import annotations

import numpy as np

from presswork.geometry.polygon import contains, list_sides, measure_distance
from presswork.mesh.checks import MeshError
from presswork.mesh.triangles import double_areas
from presswork.model import FloatArray, IntArray, Triangulation

_LONGEST = 2.5
"""Offset of a node over that of its facets, at most: at sharp corners it is longer."""
_SINGULAR = 0.02
"""Part of the largest singular value of a node's normals below which they fix nothing."""
_TURNED = 1e-3
"""Part of the surface that may turn over as it is moved: slivers and corners of facets."""
_ON_LINE = 1e-5
"""Part of the extent within which a point lies on a line."""


def unit_normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the unit normals of triangles (n, 3)."""
    normals = double_areas(points, triangles)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def find_offsets(points: FloatArray, triangles: IntArray, distance: FloatArray) -> FloatArray:
    """Return the displacement of each node (n_points, 3) [mm] by which its triangles move by its distance (n_points,).

    Least squares over the triangles round a node, weighted by their angles there; where they lie almost in a plane,
    along their mean normal alone.
    """
    normals = unit_normals(points, triangles)
    corners = points[triangles]
    matrix, right = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    for k in range(3):
        one, other = (corners[:, (k + i) % 3] - corners[:, k] for i in (1, 2))
        cosine = (one * other).sum(axis=1) / np.maximum(
            np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1), 1e-300
        )
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        np.add.at(matrix, triangles[:, k], angle[:, None, None] * normals[:, :, None] * normals[:, None, :])
        np.add.at(right, triangles[:, k], angle[:, None] * normals)
    offset = np.einsum("nij,nj->ni", np.linalg.pinv(matrix, rcond=_SINGULAR, hermitian=True), right)
    length = np.linalg.norm(offset, axis=1)
    offset *= (np.minimum(length, _LONGEST) / np.maximum(length, 1e-300))[:, None]
    return np.asarray(offset * distance[:, None])


def move_surface(surface: Triangulation, distance: float) -> Triangulation:
    """Return a surface whose triangles lie by a distance [mm] farther along their normals.

    Raises MeshError where it is bent more tightly than that, so that it would turn over.
    """
    points, triangles = surface.points, surface.triangles
    moved = points + find_offsets(points, triangles, np.full(len(points), distance))
    before, after = double_areas(points, triangles), double_areas(moved, triangles)
    turned = (before * after).sum(axis=1) < 0.0
    area = np.linalg.norm(before, axis=1)
    if area[turned].sum() > _TURNED * area.sum():
        worst = int(np.argmax(np.where(turned, area, 0.0)))
        x, y, z = points[triangles[worst]].mean(axis=0)
        raise MeshError(
            f"moved by {abs(distance):g} mm the surface turns over, first near ({x:.4g}, {y:.4g}, {z:.4g}): a radius "
            "there is smaller than that",
            "enlarge the radius in the CAD program, or take a smaller offset",
        )
    return Triangulation(moved, triangles, surface.is_closed)


def cut_surface(surface: Triangulation, polygon: FloatArray, *, inside: bool) -> Triangulation:
    """Return what of a surface lies inside or outside of a polygon (m, 2) in the plan, cut along it.

    Raises MeshError where nothing is left, or nothing cut off.
    """
    points, sides = surface.points, list_sides(polygon)
    tolerance = _ON_LINE * float(np.ptp(points, axis=0).max())
    corners = points[surface.triangles][..., :2]
    size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    near = measure_distance(sides, corners.mean(axis=1)) < 2.0 * size.max()
    triangles = surface.triangles[near]
    for start, end in sides:
        points, triangles = _split_along(points, triangles, start, end, tolerance)
    triangles = np.concatenate([surface.triangles[~near], triangles])
    kept = contains(sides, points[triangles].mean(axis=1)[:, :2]) == inside
    if not kept.any() or kept.all():
        side = "inside" if inside else "outside"
        fault = f"nothing of the surface lies {side} of the line" if not kept.any() else "the line cuts nothing off"
        (low, high) = (surface.points.min(axis=0), surface.points.max(axis=0))
        fault += f": it lies in x {low[0]:.4g} to {high[0]:.4g} mm, y {low[1]:.4g} to {high[1]:.4g} mm"
        raise MeshError(fault, "move the line, or see to its unit and to keep")
    used, numbers = np.unique(triangles[kept], return_inverse=True)
    return Triangulation(points[used], numbers.reshape(-1, 3).astype(np.int32), is_closed=False)


def _split_along(
    points: FloatArray, triangles: IntArray, start: FloatArray, end: FloatArray, tolerance: float
) -> tuple[FloatArray, IntArray]:
    """Split the triangles that a side of a polygon crosses in the plan along the line on which it lies."""
    along = (end - start) / np.linalg.norm(end - start)
    away = points[:, :2] - start
    height = along[0] * away[:, 1] - along[1] * away[:, 0]
    height[np.abs(height) < tolerance] = 0.0
    reach = (away @ along)[triangles]
    h = height[triangles]
    near = (reach.max(axis=1) > -tolerance) & (reach.min(axis=1) < np.linalg.norm(end - start) + tolerance)
    met = (h.min(axis=1) < 0.0) & (h.max(axis=1) > 0.0)
    crossed = near & met
    if not crossed.any():
        return points, triangles
    new: list[FloatArray] = []
    numbers: dict[tuple[int, int], int] = {}

    def meet(a: int, b: int) -> int:
        """Return the point where the edge from a to b meets the line; the same for both triangles beside it."""
        low, high = min(a, b), max(a, b)
        if (low, high) not in numbers:
            part = height[low] / (height[low] - height[high])
            numbers[low, high] = len(points) + len(new)
            new.append(points[low] + part * (points[high] - points[low]))
        return numbers[low, high]

    parts: list[tuple[int, int, int]] = []
    for corners in triangles[crossed].tolist():
        on_line = [k for k in range(3) if height[corners[k]] == 0.0]
        alone = on_line[0] if on_line else _find_alone([height[c] > 0.0 for c in corners])
        a, b, c = corners[alone], corners[(alone + 1) % 3], corners[(alone + 2) % 3]
        if on_line:
            p = meet(b, c)
            parts += [(a, b, p), (a, p, c)]
        else:
            p, q = meet(a, b), meet(a, c)
            parts += [(a, p, q), (p, b, c), (p, c, q)]
    keys = np.array([low * len(points) + high for low, high in numbers])
    beside = np.flatnonzero(~near & met)  # beyond the ends of the side, some share an edge that was split
    ends = np.stack([triangles[beside], np.roll(triangles[beside], -1, axis=1)], axis=2).astype(np.int64)
    shares = np.isin(ends.min(axis=2) * len(points) + ends.max(axis=2), keys).any(axis=1)
    kept = ~crossed
    kept[beside[shares]] = False
    left = triangles[beside[shares]].tolist()
    while left:
        corners = left.pop()
        edges = (tuple(sorted((corners[k], corners[(k + 1) % 3]))) for k in range(3))
        split = next((k for k, edge in enumerate(edges) if edge in numbers), None)
        if split is None:
            parts.append(tuple(corners))
            continue
        a, b, c = corners[split], corners[(split + 1) % 3], corners[(split + 2) % 3]
        p = meet(a, b)
        left += [[a, p, c], [p, b, c]]
    whole = np.concatenate([triangles[kept], np.array(parts, dtype=triangles.dtype)])
    return np.vstack([points, *new]), whole


def _find_alone(is_above: list[bool]) -> int:
    """Return which of three corners lies on a side of the line by itself."""
    return is_above.index(sum(is_above) == 1)
