# SPDX-License-Identifier: Apache-2.0
"""The mid-surface of a finished part from a file, checked for one step back to its blank."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.checks import MeshError, check_size
from presswork.mesh.files.raw import RawMesh
from presswork.mesh.files.readers import read_raw
from presswork.mesh.make.addendum import widen
from presswork.mesh.make.remesh import POOR, RIM, SURFACE, mend_slivers
from presswork.mesh.triangles import (
    double_areas,
    find_crowded_edges,
    find_flat,
    find_rims,
    find_triangle_parts,
    find_turned,
    flip_caps,
    merge_points,
    pair_triangles,
    triangle_quality,
)
from presswork.model import CELLS, BoolArray, FloatArray, IntArray, find_cell, take_corners

STEEPEST = 1.0
"""Degrees by which a wall may lean over the vertical before it is an undercut."""
DEAD = 0.02
"""Quality below which slivers are collapsed before long edges are halved."""
MOST_TRIANGLES = 1_000_000
"""Largest number of triangles to which a part is refined."""
_FEW_EDGES = 6
"""Most edges of a hole that is reported, since a gap in the model has few; a pierced hole has more."""


class UndercutError(MeshError):
    """A part that cannot be drawn along the direction, and where."""

    def __init__(self, fault: str, remedy: str, points: FloatArray, triangles: IntArray, over: BoolArray) -> None:
        super().__init__(fault, remedy)
        self.points = points
        """Points in the axes of the press (n_points, 3) [mm]."""
        self.triangles = triangles
        """(n, 3), of quadrilaterals two each."""
        self.over = over
        """Mask of those that lie under the part (n,)."""


@dataclass(frozen=True)
class PartMesh:
    """A part's mid-surface in the press's axes: z against the punch's motion, so that the part hangs down."""

    points: FloatArray
    """(n_points, 3) [mm]."""
    triangles: IntArray
    """(n, 3)."""
    quadrilaterals: IntArray
    """(m, 4)."""
    rims: tuple[IntArray, ...]
    """Loops of open edges, the longest first, which is the part's outline."""


def read_part(
    path: Path,
    *,
    scale: float = 1.0,
    draw_direction: str = "-z",
    element_size: float | None = None,
    addendum: float = 0.0,
    symmetry: tuple[bool, bool] = (False, False),
) -> tuple[PartMesh, tuple[str, ...]]:
    """Read a part; return it and notes on what was changed.

    scale: factor of the file's coordinates to mm. draw_direction: the punch's direction in the file's axes, as "-z".
    element_size: edges of triangles that are longer are cut in halves [mm], slivers collapsed; quadrilaterals stay.
    addendum: width of a level flange that is added round the part [mm], but for symmetry planes x = 0 | y = 0.
    Points that coincide are merged, cells without area dropped, cells wound against most of the part turned over.
    Raises MeshError for what is no single open sheet, and for undercuts.
    """
    raw = read_raw(path)
    notes: list[str] = []
    points, cells = _take_cells(raw, scale)
    size = float(np.linalg.norm(np.ptp(points[np.concatenate([c.ravel() for c in cells])], axis=0)))
    check_size("part", size, scale)
    points, cells = _merge(points, cells, 1e-6 * size)
    cells = _drop_flat(points, cells, 1e-7 * size, notes)
    cells = _wind_alike(points, cells, notes)
    points = _turn_to_press(points, draw_direction)
    cells = _face_up(points, cells)
    _check_undercut(points, cells)
    points, cells = _drop_unused(points, cells)
    if addendum:
        points, cells = _widen(points, cells, addendum, symmetry)
        notes.append(f"a level flange {addendum:.4g} mm wide was added to the part's outline")
    for rim in _sorted_rims(points, cells)[1:]:
        if len(rim) <= _FEW_EDGES:
            notes.append(
                f"a hole of {len(rim)} edges near {place(points[rim].mean(axis=0))} is kept: are triangles missing?"
            )
    if element_size is not None:
        points, cells = _refine(points, cells, element_size, notes)
    return PartMesh(points, *cells, _sorted_rims(points, cells)), tuple(notes)


Cells = tuple[IntArray, IntArray]
"""Triangles (n, 3) and quadrilaterals (m, 4)."""


def _take_cells(raw: RawMesh, scale: float) -> tuple[FloatArray, Cells]:
    if not raw.cells:
        others = f" (it has {', '.join(sorted(raw.other_kinds))})" if raw.other_kinds else ""
        raise MeshError(f"the file has no triangles or quadrilaterals{others}", "save the part's mid-surface")
    if raw.points.shape[1] != 3 or not np.isfinite(raw.points).all():
        raise MeshError("some coordinates are not finite numbers, or not three", "write it again from the CAD program")
    found = {kind: [np.zeros((0, CELLS[kind].nodes), dtype=np.int32)] for kind in ("tri3", "quad4")}
    for blocks in raw.cells.values():
        cells = np.concatenate(blocks)
        if cells.min() < 0 or cells.max() >= len(raw.points):
            raise MeshError("cells use points that the file does not have", "the file is cut short; write it again")
        corners = take_corners(cells).astype(np.int32)
        found[find_cell(2, corners).name].append(corners)
    return raw.points * scale, (np.concatenate(found["tri3"]), np.concatenate(found["quad4"]))


def _merge(points: FloatArray, cells: Cells, tolerance: float) -> tuple[FloatArray, Cells]:
    flat = np.concatenate([c.ravel() for c in cells])
    merged, found = merge_points(points, flat.reshape(-1, 1), tolerance)
    first = np.full(len(merged), len(points))
    np.minimum.at(first, found.ravel(), flat)
    order = np.argsort(first)  # points keep the order of the file
    numbers = np.argsort(order).astype(np.int32)[found.ravel()]
    merged = merged[order]
    split = 3 * len(cells[0])
    return merged, (numbers[:split].reshape(-1, 3), numbers[split:].reshape(-1, 4))


def _as_triangles(cells: Cells) -> IntArray:
    """Return the triangles, then the two halves of each quadrilateral, one after the other."""
    halves = cells[1][:, CELLS["quad4"].simplices].reshape(-1, 3)
    return np.concatenate([cells[0], halves])


def _drop_flat(points: FloatArray, cells: Cells, tolerance: float, notes: list[str]) -> Cells:
    flat = find_flat(points, cells[0], tolerance)
    ends = np.sort(cells[0], axis=1)
    in_line = flat & (ends[:, 1:] != ends[:, :-1]).all(axis=1)
    if in_line.any() and not (flat & ~in_line).any():  # left out, they would leave a slit between their neighbours
        cells = flip_caps(points, cells[0], tolerance), cells[1]
        flat = find_flat(points, cells[0], tolerance)
        if in_line.sum() > flat.sum():
            notes.append(f"{int(in_line.sum() - flat.sum())} triangles with their corners in line: diagonals flipped")
    q = cells[1]
    corners = np.sort(q, axis=1)
    if (corners[:, 1:] == corners[:, :-1]).any() or find_flat(
        points, _as_triangles((cells[0][:0], q)), tolerance
    ).any():
        raise MeshError("a quadrilateral has three corners in line", "give it a triangle instead")
    if not flat.any():
        return cells
    first = int(np.flatnonzero(flat)[0])
    where = place(points[cells[0][first]].mean(axis=0))
    notes.append(f"{int(flat.sum())} triangles have no area, the first is number {first + 1} near {where}: left out")
    kept = cells[0][~flat]
    if not len(kept) and not len(q):
        raise MeshError("no triangle has an area", "write the file again from the CAD program")
    return kept, q


def _wind_alike(points: FloatArray, cells: Cells, notes: list[str]) -> Cells:
    """Return the cells wound alike. Raises MeshError for several parts and for edges of more than two cells."""
    triangles = _as_triangles(cells)
    crowded, count = find_crowded_edges(triangles)
    if len(crowded):
        where = place(points[crowded[0]].mean(axis=0))
        raise MeshError(
            f"{len(crowded)} edges belong to more than two cells, the first to {count[0]} near {where}",
            "keep the mid-surface alone, without ribs or a second face",
        )
    edges = pair_triangles(triangles)
    n_parts, part = find_triangle_parts(len(triangles), edges)
    if n_parts > 1:
        boxes = []
        for index in np.argsort(-np.bincount(part))[:3]:
            corners = points[triangles[part == index].reshape(-1)]
            spans = zip("xyz", corners.min(axis=0), corners.max(axis=0), strict=True)
            boxes.append(", ".join(f"{axis} {low:.4g} to {high:.4g}" for axis, low, high in spans))
        raise MeshError(
            f"the file holds {n_parts} parts that share no edge ({'; '.join(boxes)})", "give one part a file"
        )
    turned, bad = find_turned(len(triangles), edges, part)
    if bad.any():
        where = place(points[triangles[edges.triangles[np.argmax(bad), 0]]].mean(axis=0))
        raise MeshError(f"the surface has one side only, like a twisted band, near {where}", "mend it in CAD")
    n = len(cells[0])
    over = (turned[:n], turned[n::2])
    total = int(over[0].sum() + over[1].sum())
    if total:
        notes.append(f"{total} of {n + len(cells[1])} cells are wound against their neighbours: turned over")
    return _turn(cells[0], over[0]), _turn(cells[1], over[1])


def _turn(cells: IntArray, which: BoolArray) -> IntArray:
    return np.ascontiguousarray(np.where(which[:, None], cells[:, ::-1], cells), dtype=np.int32)


def _turn_to_press(points: FloatArray, direction: str) -> FloatArray:
    """Turn the file's axes so that the punch moves along -z, keeping their hand."""
    sign = -1.0 if direction.startswith("-") else 1.0
    axis = "xyz".index(direction[-1])
    down = sign * np.eye(3)[axis]
    x = np.eye(3)[(axis + 1) % 3]
    return np.ascontiguousarray(points @ np.stack([x, np.cross(-down, x), -down], axis=1))


def _face_up(points: FloatArray, cells: Cells) -> Cells:
    """Turn the whole part so that its normals point up on the whole."""
    upwards = double_areas(points, _as_triangles(cells))[:, 2].sum()
    if upwards < 0.0:
        return _turn(cells[0], np.ones(len(cells[0]), dtype=bool)), _turn(cells[1], np.ones(len(cells[1]), dtype=bool))
    return cells


def _check_undercut(points: FloatArray, cells: Cells) -> None:
    triangles = _as_triangles(cells)
    areas = double_areas(points, triangles)
    size = np.linalg.norm(areas, axis=1)
    over = areas[:, 2] < -np.sin(np.radians(STEEPEST)) * size
    if over.any():
        worst = int(np.argmin(areas[:, 2] / size))
        lean = float(np.degrees(np.arcsin(-areas[worst, 2] / size[worst])))
        share = 100.0 * float(size[over].sum() / size.sum())
        raise UndercutError(
            f"{share:.3g} % of the part is an undercut: seen along the draw direction it lies under itself, most near "
            f"{place(points[triangles[worst]].mean(axis=0))} (in the press's axes), where it leans {lean:.0f} degrees "
            "over the vertical",
            "choose another draw direction, or unfold what a later stage bends",
            points,
            triangles,
            over,
        )


def _drop_unused(points: FloatArray, cells: Cells) -> tuple[FloatArray, Cells]:
    used, numbers = np.unique(np.concatenate([c.ravel() for c in cells]), return_inverse=True)
    split = 3 * len(cells[0])
    renumbered: IntArray = numbers.astype(np.int32)
    return points[used], (renumbered[:split].reshape(-1, 3), renumbered[split:].reshape(-1, 4))


def _sorted_rims(points: FloatArray, cells: Cells) -> tuple[IntArray, ...]:
    """Return the loops of open edges, the longest first. Raises MeshError if there is none."""
    rims = find_rims(points, _as_triangles(cells))
    if not rims:
        raise MeshError("the part is a closed body", "give its mid-surface, or one face of it")
    return tuple(sorted(rims, key=lambda rim: -_length(points[rim])))


def _widen(points: FloatArray, cells: Cells, width: float, symmetry: tuple[bool, bool]) -> tuple[FloatArray, Cells]:
    """Add a flange, of triangles to a part of triangles alone."""
    points, flange = widen(points, _sorted_rims(points, cells)[0], width, symmetry)
    if len(cells[1]):
        return points, (cells[0], np.concatenate([cells[1], flange]))
    return points, (_as_triangles((cells[0], flange)), cells[1])


def _refine(points: FloatArray, cells: Cells, size: float, notes: list[str]) -> tuple[FloatArray, Cells]:
    """Halve long edges, and mend slivers in a part of triangles alone: the dead ones first, lest they be halved."""
    triangles, quads = cells
    if len(quads):
        if not len(triangles) or _longest_edges(points, triangles).max() <= size * (1.0 + 1e-9):
            return points, cells
        raise MeshError("a mesh of triangles and quadrilaterals cannot be refined", "leave element_size out")
    count = count_refined(points, triangles, size)
    if count > MOST_TRIANGLES:
        raise MeshError(
            f"edges of {size:.4g} mm would make about {count:.2g} triangles, more than {MOST_TRIANGLES:,}",
            "choose a larger element_size",
        )
    points, triangles, *dead = mend_slivers(points, triangles, size, below=DEAD, may_cut=False)
    before = len(triangles)
    points, triangles = refine_edges(points, triangles, size)
    if len(triangles) > before:
        notes.append(f"edges over {size:.4g} mm were halved: {before} triangles became {len(triangles)}")
    points, triangles, *poor = mend_slivers(points, triangles, size)
    collapsed, flipped = dead[0] + poor[0], dead[1] + poor[1]
    if collapsed or flipped:
        left = int((triangle_quality(points, triangles) < POOR).sum())
        notes.append(
            f"slivers: {collapsed} collapsed, {flipped} diagonals flipped, at most {SURFACE * size:.2g} mm off the "
            f"surface and {RIM * size:.2g} mm off its rims; {len(triangles)} triangles, {left or 'none'} a sliver"
        )
    return points, (triangles, quads)


def count_refined(points: FloatArray, triangles: IntArray, size: float) -> float:
    """Return about how many triangles refine_edges makes, at least: each as large as those with three edges of size
    [mm], and along each edge as many as it is longer than size.
    """
    longest = _longest_edges(points, triangles)
    size = max(size, 1e-9 * float(longest.max()))  # lest the count overflow
    area = 0.5 * np.linalg.norm(double_areas(points, triangles), axis=1)
    return float(np.maximum(np.maximum(area / (0.25 * np.sqrt(3.0)) / size**2, longest / size), 1.0).sum())


def _longest_edges(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the length of each triangle's longest edge (n,) [mm]."""
    along = points[triangles] - points[np.roll(triangles, -1, axis=1)]
    return np.asarray(np.linalg.norm(along, axis=2).max(axis=1))


def refine_edges(points: FloatArray, triangles: IntArray, size: float) -> tuple[FloatArray, IntArray]:
    """Halve every edge longer than size [mm], again and again: triangles with one, two or three such edges are cut
    into two, three or four. Returns points and triangles; the surface stays as it was.
    """
    while True:
        a, b = triangles, np.roll(triangles, -1, axis=1)
        low, high = np.minimum(a, b).astype(np.int64), np.maximum(a, b).astype(np.int64)
        is_long = np.linalg.norm(points[a] - points[b], axis=2) > size * (1.0 + 1e-9)
        if not is_long.any():
            return points, triangles
        keys, inverse = np.unique((low * len(points) + high)[is_long], return_inverse=True)
        middle: NDArray[np.int64] = np.full(triangles.shape, -1, dtype=np.int64)
        middle[is_long] = len(points) + inverse
        points = np.concatenate([points, 0.5 * (points[keys // len(points)] + points[keys % len(points)])])
        triangles = _cut(points, triangles, middle)


def _cut(points: FloatArray, triangles: IntArray, middle: NDArray[np.int64]) -> IntArray:
    """Cut triangles at the middles of their edges 01, 12, 20 (n, 3); -1 where an edge is whole."""
    count = (middle >= 0).sum(axis=1)
    parts = [triangles[count == 0]]
    for wanted in (1, 2, 3):
        rows = count == wanted
        if not rows.any():
            continue
        t, m = triangles[rows], middle[rows]
        # turn so that: one long edge is 01; of two the whole one is 20
        first = np.argmax(m >= 0, axis=1) if wanted == 1 else (np.argmin(m, axis=1) + 1) % 3
        order = (first[:, None] + np.arange(3)) % 3
        (a, b, c), (ab, bc, ca) = np.take_along_axis(t, order, 1).T, np.take_along_axis(m, order, 1).T
        if wanted == 1:
            parts += [np.stack([a, ab, c], 1), np.stack([ab, b, c], 1)]
        elif wanted == 3:
            parts += [np.stack(s, 1) for s in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        else:
            parts.append(np.stack([ab, b, bc], 1))
            along = np.linalg.norm(points[a] - points[bc], axis=1) < np.linalg.norm(points[ab] - points[c], axis=1)
            parts.append(np.where(along[:, None], np.stack([a, bc, c], 1), np.stack([ab, bc, c], 1)))
            parts.append(np.where(along[:, None], np.stack([a, ab, bc], 1), np.stack([a, ab, c], 1)))
    return np.ascontiguousarray(np.concatenate(parts), dtype=np.int32)


def _length(loop: FloatArray) -> float:
    return float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum())


def place(x: FloatArray) -> str:
    """Write a point for a message."""
    return f"({', '.join(f'{value:.4g}' for value in x)})"
