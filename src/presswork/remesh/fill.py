# SPDX-License-Identifier: Apache-2.0
"""Quadrilaterals inside a closed line whose nodes are given.

1. Every second node of the line is a vertex of a triangulation with cells of twice the size. Rows of inner vertices
   follow the line; in thin metal they share its thickness. Inside the rows vertices are points of square lattices whose
   spacings differ by the root of two: a point is taken from the lattice whose spacing is nearest to the size asked for.
2. Delaunay's triangulation (Qhull) of both; inner vertices move to the middle of their neighbours a few times.
3. Pairs of triangles that make a good quadrilateral are joined, the best ones first.
4. Every quadrilateral is split into four, every triangle left over into three, at the middles of their sides; on the
   line these are the nodes left out at first.
5. Inner nodes move to the middle of their neighbours, but where this would make the worst cell round them worse.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import scipy

from presswork import _core
from presswork.geometry.polygon import contains, measure_distance
from presswork.mesh.checks import MeshError, corner_jacobians
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, find_cell
from presswork.remesh.forced_sides import force_sides

SizeField = Callable[[FloatArray], FloatArray]
"""Edge length of cells [mm] at points (n, 2)."""
LAYERS = 2
"""Rows of vertices that follow the line."""
_OFF_LINE, _OFF_ROWS = 0.7, 0.8
"""Distance of rows from the line, and of the lattice from both, over the size of the triangles."""
_TRIANGLE_ROUNDS, _QUAD_ROUNDS = 4, 12
_RETREATS, _GOOD = 8, 0.5
"""Most retreats of nodes where cells worse than good ones would become worse still, and quality of a good cell."""
_ACROSS_STRIP = 4.0
"""Vertices across a strip of cells in the order in which they are numbered."""
_LEAST_JOINED = 0.35
"""Least sine of the corners of two triangles joined."""


def close_loops(lengths: Sequence[int]) -> IndexArray:
    """Return the number of the node that follows each of closed loops of so many nodes (k,)."""
    firsts = np.cumsum([0, *lengths])[:-1].tolist()
    return np.concatenate([first + np.roll(np.arange(n), -1) for first, n in zip(firsts, lengths, strict=True)])


def fill_with_quadrilaterals(
    line: FloatArray, size: SizeField, after: IndexArray | None = None, *, has_slits: bool = False
) -> tuple[FloatArray, IndexArray]:
    """Return points (n, 2) and quadrilaterals (m, 4), counter-clockwise, inside a closed line.

    line: nodes (k, 2) [mm], counter-clockwise, the first not repeated; loops round holes, clockwise, come behind it.
    They come first among the points, as they are. Corners belong at even places, every loop has an even number. after:
    the node that follows each (k,); None: there are no holes. has_slits: gaps narrower than their sides are meant to
    be. Raises MeshError where the line is too coarse.
    """
    if len(line) % 2 or len(line) < 8:
        raise MeshError(f"a boundary of {len(line)} nodes", "an even number of them, at least eight")
    after = close_loops([len(line)]) if after is None else after
    coarse = line[::2]
    along = after[after[::2]] // 2
    vertices, triangles = _triangulate(coarse, along, lambda p: 2.0 * size(p), has_slits)
    points, cells = _split(vertices, triangles, _join(vertices, triangles), line, along)
    points = _smooth(points, cells, len(line))
    worst = measure_quality(points, cells)
    if worst.min() <= 0.0:
        x, y = points[cells[int(np.argmin(worst))]].mean(axis=0)
        raise MeshError(f"no cell fits inside the boundary near ({x:.4g}, {y:.4g})", "smaller cells there")
    return points, cells


def measure_quality(points: FloatArray, cells: IndexArray) -> FloatArray:
    """Return the quality of quadrilaterals (n,): 1 for a square, at most 0 for one that is not convex.

    The least Jacobian at a corner over the mean square of all sides; of triangles so that an even-sided one has 1.
    """
    if find_cell(2, cells).is_simplex:
        return _measure_triangles(points, cells)
    x, y = points.T
    (xa, xb, xc, xd), (ya, yb, yc, yd) = x[cells.T], y[cells.T]
    sides = (xb - xa, yb - ya), (xc - xb, yc - yb), (xd - xc, yd - yc), (xa - xd, ya - yd)
    least = np.full(len(cells), np.inf)
    square = np.zeros(len(cells))
    for (u, v), (p, q) in zip(sides, (sides[3], *sides[:3]), strict=True):
        np.minimum(least, p * v - q * u, out=least)
        square += u * u + v * v
    return np.asarray(4.0 * least / square)


def _measure_triangles(points: FloatArray, cells: IndexArray) -> FloatArray:
    """Return the quality of triangles (n,): twice the area over the mean square of the sides, times 2 / sqrt(3)."""
    corners = points[cells]
    sides = np.roll(corners, -1, axis=1) - corners
    double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return np.asarray(2.0 / np.sqrt(3.0) * double / (sides**2).sum(axis=(1, 2)) * 3.0)


def _list_sides(line: FloatArray, after: IndexArray) -> FloatArray:
    """Return the sides of loops (k, 2, 2): start and end."""
    return np.stack([line, line[after]], axis=1)


def _triangulate(
    line: FloatArray, after: IndexArray, size: SizeField, has_slits: bool
) -> tuple[FloatArray, IndexArray]:
    """Return vertices, those of the line first, and triangles counter-clockwise that fill it."""
    inner = _place_vertices(line, after, size)
    sides, wanted = _list_sides(line, after), np.column_stack([np.arange(len(line)), after])
    whole: tuple[IntArray, IntArray] | None = None
    triangles = np.zeros((0, 3), dtype=np.intp)
    for round_ in range(_TRIANGLE_ROUNDS + 1):
        points = np.concatenate([line, inner])
        whole = _core.restore_delaunay(points, *whole) if whole is not None else None
        whole = whole or _triangulate_anew(points)
        found = whole[0].astype(np.intp)
        found = force_sides(points, found, wanted) if has_slits else found
        between = (found < len(line)).all(axis=1)  # others have a vertex inside
        inside = np.asarray(~between)
        inside[between] = contains(sides, points[found[between]].mean(axis=1))
        triangles = found[inside]
        a, b, c = points[triangles].transpose(1, 0, 2)
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        triangles = triangles[np.abs(area) > 1e-12 * np.abs(area).max()]
        if round_ < _TRIANGLE_ROUNDS:
            inner = _relax(points, triangles, len(line))
    _check_sides(line, after, triangles)
    return points, triangles


def _triangulate_anew(points: FloatArray) -> tuple[IntArray, IntArray]:
    """Return Delaunay's triangles, counter-clockwise (n, 3), and the one opposite to each corner, or -1 (n, 3)."""
    try:
        found = scipy.spatial.Delaunay(points)
    except scipy.spatial.QhullError as error:
        raise MeshError("the boundary has no inside", "another shape") from error
    corners, beside = found.simplices.astype(np.int32), found.neighbors.astype(np.int32)
    a, b, c = points[corners].transpose(1, 0, 2)
    clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    for rows in (corners, beside):
        rows[clockwise] = rows[clockwise][:, ::-1]
    return corners, beside


def _place_vertices(line: FloatArray, after: IndexArray, size: SizeField) -> FloatArray:
    """Return inner vertices: rows that follow the line, and square lattices inside them."""
    rows = _place_rows(line, after, size)
    inner = np.concatenate([rows, _place_lattice(np.concatenate([line, rows]), _list_sides(line, after), size)])
    return _thin(inner, size)


def _place_rows(line: FloatArray, after: IndexArray, size: SizeField) -> FloatArray:
    """Return vertices in rows along the line, LAYERS deep, in thin metal as many as fit between its walls."""
    before = np.argsort(after)
    along = line[after] - line[before]
    inwards = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    side = line[after] - line
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    lean = np.sqrt(np.maximum(0.5 * (1.0 + (side * side[before]).sum(axis=1)), 0.25))
    thickness = measure_thickness(_list_sides(line, after), line, inwards)
    step = size(line)
    count = np.maximum(np.floor(thickness / step + 0.75), 1.0)  # three rows of cells from 2.5 sizes on
    thin = count <= 2 * LAYERS + 1
    step[thin] = thickness[thin] / count[thin]
    step /= lean
    sides, rows = _list_sides(line, after), [np.zeros((0, 2))]
    for layer in range(1, LAYERS + 1):
        own = layer * lean < 0.5 * count + 0.25
        place = line[own] + layer * (step[own, None] * inwards[own])
        depth = measure_distance(sides, place)
        rows.append(place[contains(sides, place) & (depth > _OFF_LINE * layer * step[own] * lean[own])])
    return np.concatenate(rows)


def _place_lattice(taken: FloatArray, sides: FloatArray, size: SizeField) -> FloatArray:
    """Return vertices on square lattices of spacings that differ by the root of two, off those that are taken."""
    line, tree = sides[:, 0], scipy.spatial.cKDTree(taken)
    low, high = line.min(axis=0), line.max(axis=0)
    least = float(size(line).min())
    most = float(np.linalg.norm(high - low))
    kept: list[FloatArray] = []
    spacing, turned = least, False
    while spacing < most:
        lattice = _lattice(low, high, spacing, turned)
        wanted = size(lattice)
        own = (wanted >= spacing * 2**-0.25) & (wanted < spacing * 2**0.25)
        lattice, wanted = lattice[own], wanted[own]
        if len(lattice):
            near, _ = tree.query(lattice)
            lattice = lattice[(near > _OFF_ROWS * wanted) & contains(sides, lattice)]
            kept.append(lattice)
        spacing, turned = spacing * 2**0.5, not turned
    return np.concatenate(kept) if kept else np.zeros((0, 2))


def _lattice(low: FloatArray, high: FloatArray, spacing: float, turned: bool) -> FloatArray:
    """Return the points of a square lattice over a rectangle; turned by 45 degrees, every second one of a finer."""
    step = spacing / 2**0.5 if turned else spacing
    n = np.floor((high - low) / step).astype(int) + 2
    i, j = np.meshgrid(np.arange(n[0]), np.arange(n[1]), indexing="ij")
    ij = np.column_stack([i.ravel(), j.ravel()])
    if turned:
        ij = ij[ij.sum(axis=1) % 2 == 0]
    return low + step * (ij.astype(float) + 0.5 * (not turned))


def _thin(inner: FloatArray, size: SizeField) -> FloatArray:
    """Drop vertices, where two lattices meet, that lie too close to one before them."""
    if len(inner) < 2:
        return inner
    wanted = size(inner)
    pairs = scipy.spatial.cKDTree(inner).query_pairs(0.6 * float(wanted.max()), output_type="ndarray")
    apart = np.linalg.norm(inner[pairs[:, 0]] - inner[pairs[:, 1]], axis=1)
    close = pairs[apart < 0.6 * np.minimum(wanted[pairs[:, 0]], wanted[pairs[:, 1]])]
    dropped = np.zeros(len(inner), dtype=bool)
    for first, second in close[np.lexsort((close[:, 1], close[:, 0]))].tolist():
        if not dropped[first]:
            dropped[second] = True
    return inner[~dropped]


def _relax(points: FloatArray, triangles: IndexArray, n_line: int) -> FloatArray:
    """Return the inner vertices moved to the middle of their neighbours."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ends = np.concatenate([ends, ends[:, ::-1]])
    count = np.maximum(np.bincount(ends[:, 0], minlength=len(points)), 1)
    mean = np.stack([np.bincount(ends[:, 0], points[ends[:, 1], k], len(points)) / count for k in (0, 1)], axis=1)
    return np.asarray(0.5 * (points + mean)[n_line:])


def _check_sides(line: FloatArray, after: IndexArray, triangles: IndexArray) -> None:
    """Refuse a triangulation that does not hold every side of the line."""
    n = len(line)
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    number = ends[:, 0] * (n + triangles.max() + 1) + ends[:, 1]
    wanted = np.arange(n) * (n + triangles.max() + 1) + after
    missing = np.flatnonzero(~np.isin(wanted, number))
    if len(missing):
        x, y = line[missing[0]]
        raise MeshError(f"the boundary is too coarse for its shape near ({x:.4g}, {y:.4g})", "smaller cells there")


def _join(points: FloatArray, triangles: IndexArray) -> IndexArray:
    """Return which triangles to join (n_pairs, 2) and the quadrilaterals' corners (n_pairs, 4), side by side."""
    n = len(triangles)
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    key = np.sort(ends, axis=1) @ np.array([len(points), 1])
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    left, right = order[same], order[same + 1]
    apex = np.roll(triangles, 1, axis=1).reshape(-1)
    corners = np.stack([ends[left, 0], apex[right], ends[left, 1], apex[left]], axis=1)
    place = points[corners]
    sides = np.linalg.norm(np.roll(place, -1, axis=1) - place, axis=2)
    sine = (corner_jacobians(points, corners.astype(np.int32)) / (sides * np.roll(sides, 1, axis=1))).min(axis=1)
    best = np.argsort(-np.round(sine, 6), kind="stable")
    best = best[sine[best] >= _LEAST_JOINED]
    pairs = np.stack([left[best], right[best]], axis=1) // 3
    chosen = best[_choose_disjoint(pairs, n)]
    return np.concatenate([np.stack([left[chosen], right[chosen]], axis=1) // 3, corners[chosen]], axis=1)


def _choose_disjoint(pairs: IndexArray, n: int) -> IndexArray:
    """Return which of pairs of numbers below n (k, 2) are taken, the first ones first, each number once.

    In each round all pairs go that no earlier one shares a number with.
    """
    left = np.arange(len(pairs))
    taken: list[IndexArray] = []
    free = np.ones(n, dtype=bool)
    while len(left):
        own = pairs[left]
        first = np.full(n, len(pairs))
        np.minimum.at(first, own.ravel(), np.repeat(left, 2))
        goes = (first[own] == left[:, None]).all(axis=1)
        taken.append(left[goes])
        free[own[goes]] = False
        left = left[~goes]
        left = left[free[pairs[left]].all(axis=1)]
    return np.sort(np.concatenate(taken)) if taken else left


def _split(
    vertices: FloatArray, triangles: IndexArray, pairs: IndexArray, line: FloatArray, after: IndexArray
) -> tuple[FloatArray, IndexArray]:
    """Return points and cells: every quadrilateral in four, every triangle in three; the line's nodes come first."""
    joined = np.zeros(len(triangles), dtype=bool)
    joined[pairs[:, :2]] = True
    quads, alone = (_in_strips(vertices, cells) for cells in (pairs[:, 2:], triangles[~joined]))
    ends = np.concatenate(
        [np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2) for cells in (quads, alone)]
    )
    sides, number = _list_once(ends)
    n_coarse = len(line) // 2
    place = np.concatenate([np.arange(0, len(line), 2), len(line) + np.arange(len(vertices) - n_coarse)])
    follows = np.concatenate([after, np.full(len(vertices) - n_coarse, -1)])
    ahead, back = follows[sides[:, 0]] == sides[:, 1], follows[sides[:, 1]] == sides[:, 0]
    on_line = ahead | back
    first = np.where(ahead, sides[:, 0], sides[:, 1])
    n = len(line) + len(vertices) - n_coarse
    middle = np.where(on_line, 2 * first + 1, 0)
    middle[~on_line] = n + np.arange(int((~on_line).sum()))
    n += int((~on_line).sum())
    points = np.concatenate([line, vertices[n_coarse:], vertices[sides[~on_line]].mean(axis=1)])
    cells = []
    begin = 0
    for corners in (quads, alone):
        k = corners.shape[1]
        mid = middle[number[begin : begin + corners.size]].reshape(-1, k)
        begin += corners.size
        centre = n + np.arange(len(corners))
        n += len(corners)
        points = np.concatenate([points, points[mid].mean(axis=1)])
        before = np.roll(mid, 1, axis=1)
        cells.append(
            np.stack([place[corners], mid, np.broadcast_to(centre[:, None], mid.shape), before], axis=-1).reshape(-1, 4)
        )
    return points, np.concatenate(cells)


def _in_strips(points: FloatArray, cells: IndexArray) -> IndexArray:
    """Return cells (n, 3 | 4) strip after strip, so that those that follow each other are neighbours."""
    x, y = points[cells].mean(axis=1).T
    width = float(np.ptp(points[:, 0])) / max(1.0, np.sqrt(len(points)) / _ACROSS_STRIP)
    return cells[np.lexsort((y, np.floor(x / width)))]


def _list_once(ends: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Return each side of cells once (k, 2), its lower end first, and which of them each of (n, 2) ends is (n,)."""
    n = int(ends.max()) + 1
    sides, number = np.unique(ends.min(axis=1) * n + ends.max(axis=1), return_inverse=True)
    return np.stack(np.divmod(sides, n), axis=1), number.reshape(-1)


def _smooth(points: FloatArray, cells: IndexArray, n_line: int) -> FloatArray:
    """Move inner nodes to the middle of their neighbours where no cell round them becomes worse than it may."""
    corners = cells.astype(np.int32)
    return _core.smooth_cells(points, corners, n_line, most_rounds=_QUAD_ROUNDS, most_retreats=_RETREATS, good=_GOOD)


def measure_thickness(
    sides: FloatArray, places: FloatArray, inwards: FloatArray, doubled: BoolArray | None = None
) -> FloatArray:
    """Return the distance (n,) [mm] from places (n, 2) along unit directions (n, 2) to the opposite one of sides (k, 2,
    2).

    doubled (k,): sides up to which the distance counts twice. Infinite where no side lies opposite.
    """
    line, along = sides[:, 0], sides[:, 1] - sides[:, 0]
    length = np.linalg.norm(along, axis=1)
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    cross = inwards[:, None, 0] * along[None, :, 1] - inwards[:, None, 1] * along[None, :, 0]
    away = line[None] - places[:, None]
    safe = np.where(np.abs(cross) > 1e-12, cross, np.inf)
    distance = (away[..., 0] * along[None, :, 1] - away[..., 1] * along[None, :, 0]) / safe
    part = (away[..., 0] * inwards[:, None, 1] - away[..., 1] * inwards[:, None, 0]) / safe
    opposes = inwards @ normal.T < -0.5
    hit = (distance > 1e-9 * length[None]) & (part >= -1e-9) & (part <= 1 + 1e-9) & opposes & np.isfinite(safe)
    weight = np.ones(len(line)) if doubled is None else np.where(doubled, 2.0, 1.0)
    return np.asarray(np.where(hit, weight[None] * distance, np.inf).min(axis=1))
