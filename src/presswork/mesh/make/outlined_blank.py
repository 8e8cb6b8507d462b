# SPDX-License-Identifier: Apache-2.0
"""Quadrilaterals within any outline: a grid of squares inside, and one row of cells between it and the outline.

Schneiders 1996 (the grid-based approach): squares far enough inside the outline are kept; every node of their rim gets
a partner on the outline, every side of their rim so becomes a cell; then nodes move to the middle of their neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.polygon import contains, list_sides, polygon_area
from presswork.mesh.checks import MeshError, corner_jacobians
from presswork.mesh.make.blanks import name_sets
from presswork.mesh.topology import chain_edges, drop_unused_points, find_boundary_edges
from presswork.model import BoolArray, FloatArray, IntArray, Mesh

_INSIDE = 0.45
"""Distance from the outline over element_size from which squares are kept: the outer cells are then about as large."""
_CORNER = 35.0
"""Degrees by which an outline turns at a point that a node has to lie on."""
_ROUNDS = 30
"""Number of smoothing passes; the effect reaches about their square root in cells."""
_FLATTEST, _GOOD = 0.1, 0.4
"""Least sine of a cell's corners that is taken, and that from which on no smaller cells are tried."""
_SMALLER = (1.0, 0.95, 0.9, 0.85)
"""Cells over element_size that are tried."""
Keys = NDArray[np.intp]


def mesh_outlined_blank(
    outline: FloatArray, element_size: float, symmetry: Sequence[bool], *, triangles: bool = False
) -> Mesh:
    """Mesh a blank within a closed outline (n, 2) [mm], the first point not repeated.

    symmetry: whether the planes x = 0 and y = 0 cut it; then the part at x, y >= 0 is meshed. Corners of the outline
    below about 45 degrees leave cells as sharp, tongues and slots narrower than three elements may not be met: smaller
    cells are tried then. Raises MeshError for an outline that crosses a plane more than twice, and for one too narrow.
    """
    area = polygon_area(outline)
    if len(outline) < 3 or abs(area) < element_size**2:
        raise MeshError(
            f"an outline of {len(outline)} points around {abs(area):.3g} mm2", "smaller elements, or a closed outline"
        )
    outline = outline if area > 0 else outline[::-1]
    for axis, is_cut in enumerate(symmetry):
        outline = _cut_at_plane(outline, axis) if is_cut else outline
    line = _Line(outline, symmetry)
    best, failure = None, _too_narrow(element_size)
    for part in _SMALLER:
        try:
            points, cells = _fill(line, part * element_size, symmetry)
        except MeshError as error:
            failure = error
            continue
        sine, place = _find_flattest(points, cells)
        if best is None or sine > best[0]:
            best = sine, place, points, cells
        if sine > _GOOD:
            break
    if best is None:
        raise failure
    sine, (x, y), points, cells = best
    if sine < _FLATTEST:
        raise MeshError(f"the outline cannot be meshed near ({x:.4g}, {y:.4g})", "smooth it, or use smaller elements")
    return name_sets(points, [cells], symmetry, triangles)


def _fill(line: _Line, element_size: float, symmetry: Sequence[bool]) -> tuple[FloatArray, IntArray]:
    """Return points (n, 2) and cells within an outline."""
    points, cells = _keep_squares(line, element_size, symmetry)
    boundary = find_boundary_edges([cells])
    at_plane = [is_cut & (np.abs(points[:, axis]) < 1e-9 * element_size) for axis, is_cut in enumerate(symmetry)]
    free = ~np.any([mask[boundary].all(axis=1) for mask in at_plane], axis=0)
    chain = chain_edges(boundary[free], points)
    if (chain[1:, 0] != chain[:-1, 1]).any():
        raise _too_narrow(element_size)
    nodes = chain[:, 0] if line.is_closed else np.append(chain[:, 0], chain[-1, 1])
    places = line.spread(points[nodes], 0.75 * element_size)
    partners = len(points) + np.arange(len(nodes))
    after, partner_after = (np.roll(n, -1) if line.is_closed else n[1:] for n in (nodes, partners))
    n_rim = len(after)
    rim = np.stack([nodes[:n_rim], partners[:n_rim], partner_after, after], axis=1)
    cells = np.concatenate([cells, rim]).astype(np.int32)
    points = np.concatenate([points, places])
    return _smooth(points, cells, partners, symmetry), cells


def _cut_at_plane(outline: FloatArray, axis: int) -> FloatArray:
    """Return the part of a polygon where the coordinate is >= 0, closed along the plane."""
    size = float(np.ptp(outline, axis=0).max())
    outline = outline.copy()
    outline[np.abs(outline[:, axis]) < 1e-6 * size, axis] = 0.0
    after = np.roll(outline, -1, axis=0)
    x, x_after = outline[:, axis], after[:, axis]
    kept: list[FloatArray] = []
    crossings = 0
    for here, there, a, b in zip(outline, after, x.tolist(), x_after.tolist(), strict=True):
        if a >= 0.0:
            kept.append(here)
        if a * b < 0.0:
            kept.append(here + (there - here) * (a / (a - b)))
            kept[-1][axis] = 0.0
        crossings += (a >= 0.0) != (b >= 0.0)
    if crossings > 2:
        raise MeshError(
            f"the outline crosses the symmetry plane {'xy'[axis]} = 0 more than twice", "leave symmetry out"
        )
    found = np.array(kept).reshape(-1, 2)
    if len(found) < 3 or (np.abs(found[:, axis]) == 0.0).sum() < 2:
        raise MeshError(
            f"the outline does not reach the symmetry plane {'xy'[axis]} = 0", "centre it there, or leave symmetry out"
        )
    return found


class _Line:
    """An outline without its stretches in symmetry planes, by the distance along it."""

    def __init__(self, polygon: FloatArray, symmetry: Sequence[bool]) -> None:
        after = np.roll(polygon, -1, axis=0)
        long = np.linalg.norm(after - polygon, axis=1) > 1e-9 * float(np.ptp(polygon, axis=0).max())
        polygon = polygon[long]
        after = np.roll(polygon, -1, axis=0)
        in_plane = np.zeros(len(polygon), dtype=bool)
        for axis, is_cut in enumerate(symmetry):
            in_plane |= is_cut & (polygon[:, axis] == 0.0) & (after[:, axis] == 0.0)
        self.polygon = polygon
        self.is_closed = not in_plane.any()
        if self.is_closed:
            self.points = np.concatenate([polygon, polygon[:1]])
        else:
            begin = np.flatnonzero(in_plane & ~np.roll(in_plane, -1))
            if len(begin) != 1:
                raise MeshError("the symmetry planes cut the outline into pieces", "leave symmetry out")
            turned = np.roll(np.arange(len(polygon)), -(int(begin[0]) + 1))
            self.points = polygon[turned[: int((~in_plane).sum()) + 1]]
        sides = np.diff(self.points, axis=0)
        self.length_at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(sides, axis=1))])
        is_corner = self._turns(sides) > _CORNER
        self.corners = self.length_at[:-1][is_corner]
        unit = sides / np.linalg.norm(sides, axis=1, keepdims=True)
        along = (unit + np.roll(unit, 1, axis=0))[is_corner]
        self.inwards = np.stack([-along[:, 1], along[:, 0]], axis=1)

    def _turns(self, sides: FloatArray) -> FloatArray:
        """Return by how much the line turns at the beginning of each side [degree]; at open ends by nothing."""
        before = np.roll(sides, 1, axis=0)
        cross = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
        turns = np.abs(np.degrees(np.arctan2(cross, (before * sides).sum(axis=1))))
        if not self.is_closed:
            turns[0] = 0.0
        return np.asarray(turns, dtype=float)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far points lie from the line, and the distance along it to the nearest place (n,) [mm]."""
        best, along = np.full(len(points), np.inf), np.zeros(len(points))
        for a, b, start in zip(self.points[:-1], self.points[1:], self.length_at[:-1], strict=True):
            side = b - a
            t = np.clip((points - a) @ side / (side @ side), 0.0, 1.0)
            distance = np.linalg.norm(points - a - t[:, None] * side, axis=1)
            nearer = distance < best
            best[nearer], along[nearer] = distance[nearer], (start + t * np.linalg.norm(side))[nearer]
        return best, along

    def at(self, along: FloatArray) -> FloatArray:
        """Return the places at a distance along the line (n, 2)."""
        return np.stack([np.interp(along, self.length_at, self.points[:, axis]) for axis in (0, 1)], axis=1)

    def spread(self, points: FloatArray, near: float) -> FloatArray:
        """Return a place on the line for each of a chain of points, in their order and evenly.

        A corner gets the point that lies most along its bisector, of those not farther along the line than the nearest
        by `near` [mm]: before a hollow corner several are equally near.
        """
        length = float(self.length_at[-1])
        _, along = self.nearest(points)
        n = len(along)
        if self.is_closed:
            along = along[0] + np.concatenate(
                [[0.0], np.cumsum((np.diff(along) + 0.5 * length) % length - 0.5 * length)]
            )
            turns = length
        else:
            along[0], along[-1], turns = 0.0, length, 0.0
        along = np.maximum.accumulate(along)
        held = np.zeros(n, dtype=bool)
        if not self.is_closed:
            held[[0, -1]] = True
        for corner, inwards, place in zip(self.corners.tolist(), self.inwards, self.at(self.corners), strict=True):
            apart = (along - corner + 0.5 * length) % length - 0.5 * length if self.is_closed else along - corner
            off = np.where(held, np.inf, np.abs(apart))
            away = points - place
            cosine = (away @ inwards) / np.linalg.norm(away, axis=1)
            chosen = int(np.argmax(np.where(off <= off.min() + near, cosine, -np.inf)))
            along[chosen] -= apart[chosen]
            held[chosen] = True
        for _ in range(_ROUNDS):
            before, after = np.roll(along, 1), np.roll(along, -1)
            before[0] -= turns
            after[-1] += turns
            along = np.where(held, along, 0.5 * along + 0.25 * (before + after))
        if (np.diff(along) <= 0.0).any():
            raise MeshError("the outline turns back on itself too sharply", "smooth it, or use smaller elements")
        return self.at(along % length if self.is_closed else along)


def _keep_squares(line: _Line, size: float, symmetry: Sequence[bool]) -> tuple[FloatArray, IntArray]:
    """Return the points and cells of the grid's squares that lie well inside, in one piece without thin spots."""
    polygon, grid = line.polygon, []
    for axis, is_cut in enumerate(symmetry):
        low, high = float(polygon[:, axis].min()), float(polygon[:, axis].max())
        begin = 0.0 if is_cut else 0.5 * (low + high) - size * np.ceil(0.5 * (high - low) / size)
        grid.append(begin + size * np.arange(int(np.ceil((high - begin) / size)) + 1))
    x, y = np.meshgrid(*grid, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    distance, _ = line.nearest(points)
    # a little inwards, for nodes in symmetry planes lie on the polygon
    shifted = points + 1e-9 * size * (polygon.mean(axis=0) - points) / np.ptp(polygon, axis=0).max()
    good = ((distance >= _INSIDE * size) & contains(list_sides(polygon), shifted)).reshape(x.shape)
    kept = _drop_thin(good[:-1, :-1] & good[1:, :-1] & good[1:, 1:] & good[:-1, 1:], symmetry)
    if not kept.any():
        raise _too_narrow(size)
    number = np.arange(x.size).reshape(x.shape)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    cells = np.stack([c[kept] for c in corners], axis=1)
    points, renumbered = drop_unused_points(points, [cells.astype(np.int32)])
    return points, renumbered[cells].astype(np.int32)


def _drop_thin(kept: BoolArray, symmetry: Sequence[bool]) -> BoolArray:
    """Return the largest piece of a map of squares, without squares that hang on one side, or on corners alone."""
    from scipy.ndimage import label  # here, for most cases do without it

    # beyond a symmetry plane the squares' mirror images count as neighbours
    mode = [(1, 1), (1, 1)]
    while True:
        parts, n = label(kept)
        if n == 0:
            return kept
        kept = np.asarray(parts == 1 + np.argmax(np.bincount(parts.ravel())[1:]))
        wide = np.pad(kept, mode)
        for axis, is_cut in enumerate(symmetry):
            if is_cut:
                first, second = [slice(None)] * 2, [slice(None)] * 2
                first[axis], second[axis] = slice(0, 1), slice(1, 2)
                wide[tuple(first)] = wide[tuple(second)]
        across = wide[:-2, 1:-1] & wide[2:, 1:-1], wide[1:-1, :-2] & wide[1:-1, 2:]
        count = sum(w.astype(int) for w in (wide[:-2, 1:-1], wide[2:, 1:-1], wide[1:-1, :-2], wide[1:-1, 2:]))
        thin = kept & ((count < 2) | ((count == 2) & (across[0] | across[1])))
        a, b, c, d = wide[:-1, :-1], wide[1:, :-1], wide[1:, 1:], wide[:-1, 1:]
        crossed = (a & c & ~b & ~d) | (b & d & ~a & ~c)
        corner = crossed[:-1, :-1] | crossed[1:, :-1] | crossed[1:, 1:] | crossed[:-1, 1:]
        thin |= kept & corner
        if not thin.any():
            return kept
        kept = kept & ~thin


def _smooth(points: FloatArray, cells: IntArray, held: Keys, symmetry: Sequence[bool]) -> FloatArray:
    """Move nodes to the middle of those that share a side with them; held ones stay, those on planes stay there."""
    sides = np.unique(np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1), axis=0)
    ends = np.concatenate([sides, sides[:, ::-1]])
    weight = np.ones(len(ends))
    free = np.ones((len(points), 2), dtype=bool)
    free[held] = False
    scale = float(np.ptp(points, axis=0).max())
    for axis, is_cut in enumerate(symmetry):
        if is_cut:
            in_plane = np.abs(points[:, axis]) < 1e-9 * scale
            free[in_plane, axis] = False
            weight[in_plane[ends[:, 0]] & ~in_plane[ends[:, 1]]] *= 2.0  # the mirror image pulls as well
    total = np.bincount(ends[:, 0], weight, len(points))
    for _ in range(_ROUNDS):
        mean = np.stack([np.bincount(ends[:, 0], weight * points[ends[:, 1], k], len(points)) for k in (0, 1)], axis=1)
        points = np.where(free, 0.5 * (points + mean / total[:, None]), points)
    return points


def _find_flattest(points: FloatArray, cells: IntArray) -> tuple[float, FloatArray]:
    """Return the least sine of the cells' corners, below zero where a cell is turned over, and that cell's middle."""
    corners = points[cells]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    sines = (corner_jacobians(points, cells) / (sides * np.roll(sides, 1, axis=1))).min(axis=1)
    worst = int(np.argmin(sines))
    return float(sines[worst]), corners[worst].mean(axis=0)


def _too_narrow(element_size: float) -> MeshError:
    return MeshError(
        f"the blank is too narrow somewhere for elements of {element_size:g} mm", "choose a smaller element_size"
    )
