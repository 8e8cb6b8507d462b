# SPDX-License-Identifier: Apache-2.0
"""Punch, die and holder for a part: its mid-surface offset to either side.

The die lies below the part, half a thickness under the flange and half a thickness and the clearance under all else.
The punch lies half a thickness above what is inside the die's shoulder, and goes up straight from there. The holder
lies half a thickness above the flange. Die and holder reach as far as the blank. The shoulder is what gets steeper from
the flange on, cell by cell; where it ceases to, the wall begins.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from presswork.mesh.make.surface_offset import find_offsets, unit_normals
from presswork.mesh.triangles import double_areas, find_rims, find_triangle_parts, pair_triangles, split_quads
from presswork.model import BoolArray, FloatArray, IntArray, OneStepModel, ToolKind, Triangulation
from presswork.onestep.flange import find_flange, find_outline, list_neighbours, measure_width, spread_over
from presswork.onestep.solve import mirror_part

CLEARANCE = 0.1
"""What is left between punch and die beside the sheet, on each side, over the thickness."""
STEEPER = np.radians(0.5)
"""Change of slope of the die's shoulder over a triangle, at least [rad]."""
ISLAND = 0.02
"""Part of the area inside the shoulder that a piece of the punch has at least."""
_FREE = 5.0
"""Thicknesses by which tools reach beyond an end of the part that is no flange."""
_LARGE = 20_000
"""Corners of a flat piece that is a plane of the part, not a chord of a radius."""
_ROLL, _ROLLED = 2.0, 6
"""Radius of the holder's inner edge over the thickness, and the number of chords of its quarter circle."""


@dataclass(frozen=True)
class OffsetTools:
    """The tools of a part."""

    faces: Mapping[ToolKind, Triangulation]
    """Faces of punch and die, and of a holder if there is a level flange, wound as seen from the sheet."""
    stroke: float
    """Stroke of the punch from where both touch the flat blank to the finished part [mm]."""
    smallest_radius: float
    """Smallest radius of the mid-surface [mm]."""
    is_binder_curved: bool
    """Whether the blank, flat, does not lie all along the flange."""
    notes: tuple[str, ...]


def offset_tools(model: OneStepModel, blank_reach: float, clearance: float = CLEARANCE) -> OffsetTools:
    """Return the tools of a part.

    blank_reach: farthest point of the blank from the part's middle, from above [mm]; clearance: over the thickness.
    """
    points, triangles = _whole_part(model)
    thickness, reach = model.thickness, 1.2 * blank_reach
    up = unit_normals(points, triangles)[:, 2]
    neighbours = list_neighbours(triangles)
    flange = find_flange(points, triangles, up, thickness, neighbours)
    inside = _without_islands(points, triangles, ~_find_shoulder(points, triangles, flange, neighbours), neighbours)
    outside = ~_without_pinches(triangles, inside)
    flange = _without_pinches(triangles, flange)
    under_flange = np.zeros(len(points), dtype=bool)
    under_flange[triangles[flange]] = True
    below = points - find_offsets(points, triangles, thickness * (0.5 + np.where(under_flange, 0.0, clearance)))
    above = points + find_offsets(points, triangles, np.full(len(points), 0.5 * thickness))
    die = _extend(below, triangles, flange, reach, thickness)[:2]
    points_above, face, beyond = _extend(above, triangles, flange, reach, thickness, keep=~outside)
    stroke = thickness + _highest(*die) - _lowest(points_above, face)
    punch = _raise_rim(points_above, face, beyond, stroke)
    faces: dict[ToolKind, Triangulation] = {"punch": _compact(*_turned(*punch)), "die": _compact(*die)}
    if flange.any():
        over = points + 0.5 * thickness * _find_own_normals(points, triangles[flange])
        points_level, face, beyond = _extend(over, triangles, flange, reach, thickness, keep=flange)
        room = _distance_between(over[triangles[flange]], above[triangles[~outside]])
        holder = _roll_rim(points_level, face, beyond, min(_ROLL * thickness, 0.4 * room))
        faces["holder"] = _compact(*_turned(*holder))
    notes = _find_faults(points, triangles, below, above, bool(flange.any()))
    is_curved = bool(flange.any()) and float(np.ptp(points[under_flange, 2])) > thickness
    return OffsetTools(faces, stroke, _smallest_radius(points, triangles), is_curved, notes)


def _whole_part(model: OneStepModel) -> tuple[FloatArray, IntArray]:
    """Return points and triangles of the whole part, wound counter-clockwise from above, its holes filled."""
    quads = model.quadrilaterals.reshape(-1, 4)
    triangles = np.concatenate([model.triangles.reshape(-1, 3), split_quads(model.points, quads)])
    points = model.points
    if double_areas(points, triangles)[:, 2].sum() < 0.0:
        triangles = triangles[:, ::-1]
    for axis, wanted in enumerate(model.symmetry):
        if wanted:
            points, triangles = mirror_part(points, triangles, axis)
    rims = sorted(find_rims(points, triangles), key=lambda rim: -measure_width(points, rim))
    for hole in rims[1:]:
        middle = len(points)
        points = np.vstack([points, points[hole].mean(axis=0)])
        fan = np.stack([np.roll(hole, -1), hole, np.full(len(hole), middle)], axis=1)
        triangles = np.concatenate([triangles, fan])
    return points, np.ascontiguousarray(triangles, dtype=np.int32)


def _distance_between(one: FloatArray, other: FloatArray) -> float:
    """Return the least distance of two sets of points (..., 3), seen from above [mm]."""
    return float(cKDTree(one.reshape(-1, 3)[:, :2]).query(other.reshape(-1, 3)[:, :2])[0].min())


def _highest(points: FloatArray, triangles: IntArray) -> float:
    return float(points[triangles, 2].max())


def _lowest(points: FloatArray, triangles: IntArray) -> float:
    return float(points[triangles, 2].min())


def _turned(points: FloatArray, triangles: IntArray) -> tuple[FloatArray, IntArray]:
    return points, triangles[:, ::-1]


def _find_shoulder(
    points: FloatArray, triangles: IntArray, flange: BoolArray, neighbours: list[list[int]]
) -> BoolArray:
    """Return the flange, and the triangles that go on from it and get steeper downwards, by nodal normals (n,)."""
    slope = np.arccos(np.clip(_find_own_normals(points, triangles)[:, 2], -1.0, 1.0))[triangles]
    height = points[triangles, 2]
    falls = ((slope - slope.mean(axis=1, keepdims=True)) * (height - height.mean(axis=1, keepdims=True))).sum(axis=1)
    bends = (np.ptp(slope, axis=1) > STEEPER) & (falls < 0.0)
    return spread_over(flange, neighbours, lambda _, there: bool(bends[there]))


def _find_own_normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the mean unit normal of some triangles at each node (n, 3); 0 where there are none of them."""
    nodal = np.zeros_like(points)
    for k in range(3):
        np.add.at(nodal, triangles[:, k], double_areas(points, triangles))
    return np.asarray(nodal / np.maximum(np.linalg.norm(nodal, axis=1, keepdims=True), 1e-300))


def _without_pinches(triangles: IntArray, kept: BoolArray) -> BoolArray:
    """Return the kept triangles (n,) less those at nodes where their rim would meet itself."""
    kept = kept.copy()
    while True:
        rim = _inner_rim(triangles[kept], triangles[~kept]) if kept.any() else np.zeros((0, 2), dtype=int)
        pinched = np.bincount(rim.ravel(), minlength=1) > 2
        if not pinched.any():
            return kept
        kept &= ~np.isin(triangles, np.flatnonzero(pinched)).any(axis=1)


def _without_islands(
    points: FloatArray, triangles: IntArray, kept: BoolArray, neighbours: list[list[int]]
) -> BoolArray:
    """Return the kept triangles (n,) less pieces of a small part of their area: facets of a shoulder that happen to be
    flat, on which no punch works.
    """
    area = np.linalg.norm(double_areas(points, triangles), axis=1)
    found, left = np.zeros_like(kept), kept.copy()
    while left.any():
        start = np.zeros_like(kept)
        start[np.argmax(left)] = True
        piece = spread_over(start, neighbours, lambda _, there: bool(kept[there]))
        left &= ~piece
        if area[piece].sum() > ISLAND * area[kept].sum():
            found |= piece
    return found


def _extend(
    points: FloatArray,
    triangles: IntArray,
    flange: BoolArray,
    reach: float,
    thickness: float,
    *,
    keep: BoolArray | None = None,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return a tool's face, of the triangles kept, drawn out beyond the part's outline: flanges as far as the blank.

    reach: of what is drawn out from the part's middle [mm]. Points, the face, and the triangles that it lacks.
    """
    kept = np.ones(len(triangles), dtype=bool) if keep is None else keep
    rim, after, owner = find_outline(points, triangles)
    out = np.cross(points[after] - points[rim], unit_normals(points, triangles[owner]))
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-300)
    at_node = out + np.roll(out, 1, axis=0)
    at_node /= np.maximum(np.linalg.norm(at_node, axis=1, keepdims=True), 0.3)
    middle = 0.5 * (points[:, :2].min(axis=0) + points[:, :2].max(axis=0))
    on_flange = flange[owner] | np.roll(flange[owner], 1)
    away = np.maximum(reach - np.linalg.norm(points[rim, :2] - middle, axis=1), 0.0)
    far = _FREE * thickness + np.where(on_flange, away, 0.0)
    new = len(points) + np.arange(len(rim))
    strip = np.stack([after, rim, new, after, new, np.roll(new, -1)], axis=1)
    drawn = points[rim] + far[:, None] * at_node
    face, others = (
        np.concatenate([triangles[those], strip[those[owner]].reshape(-1, 3)]).astype(np.int32)
        for those in (kept, ~kept)
    )
    return np.vstack([points, drawn]), face, others


def _inner_rim(face: IntArray, others: IntArray) -> IntArray:
    """Return the edges (n, 2) of a tool's face, wound as it is, beyond which lie triangles that it lacks."""
    ends, beyond = (
        np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]).astype(np.int64)
        for cells in (face, others)
    )
    n = int(max(ends.max(), beyond.max(initial=0))) + 1
    return np.asarray(ends[np.isin(ends[:, 0] * n + ends[:, 1], beyond[:, 1] * n + beyond[:, 0])])


def _raise_rim(points: FloatArray, face: IntArray, others: IntArray, height: float) -> tuple[FloatArray, IntArray]:
    """Return the punch with a wall straight up from where the shoulder, which it lacks, begins."""
    rim = _inner_rim(face, others)
    lower = np.unique(rim)
    top = points[lower].copy()
    top[:, 2] += float(np.ptp(points[:, 2])) + height  # a rim that steps up a wall has walls that step, too
    return _add_rings(points, face, rim, lower, [top])


def _roll_rim(points: FloatArray, face: IntArray, others: IntArray, radius: float) -> tuple[FloatArray, IntArray]:
    """Return the holder, level, with its inner edge rolled up over a quarter of a circle."""
    rim = _inner_rim(face, others)
    lower, index = np.unique(rim, return_inverse=True)
    along = points[rim[:, 1]] - points[rim[:, 0]]
    out = np.zeros((len(lower), 3))
    for end in index.reshape(-1, 2).T:
        np.add.at(out, end, np.stack([along[:, 1], -along[:, 0], np.zeros(len(along))], axis=1))
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-300)
    up = np.array([0.0, 0.0, 1.0])
    rings = [
        points[lower] + radius * (np.sin(angle) * out + (1.0 - np.cos(angle)) * up)
        for angle in np.linspace(0.0, 0.5 * np.pi, _ROLLED + 1)[1:]
    ]
    return _add_rings(points, face, rim, lower, rings)


def _add_rings(
    points: FloatArray, face: IntArray, rim: IntArray, lower: IntArray, rings: list[FloatArray]
) -> tuple[FloatArray, IntArray]:
    """Go on from the edges of a rim (n, 2) over rings of points, one for each of its points `lower`."""
    everything, cells = [points], [face]
    before = np.full(len(points), -1)
    before[lower] = lower
    count = len(points)
    for ring in rings:
        after = np.full(len(points), -1)
        after[lower] = count + np.arange(len(lower))
        count += len(lower)
        a, b = rim.T
        cells.append(np.stack([before[b], before[a], after[a]], axis=1))
        cells.append(np.stack([before[b], after[a], after[b]], axis=1))
        everything.append(ring)
        before = after
    return np.concatenate(everything), np.concatenate(cells).astype(np.int32)


def _compact(points: FloatArray, triangles: IntArray) -> Triangulation:
    """Return a face without points that no triangle uses."""
    used, index = np.unique(triangles, return_inverse=True)
    return Triangulation(points[used], index.reshape(-1, 3).astype(np.int32), is_closed=False)


def _smallest_radius(points: FloatArray, triangles: IntArray) -> float:
    """Return the radius of curvature that a hundredth of the bent edges fall below [mm]; infinite for a flat part.

    At an edge between two flat pieces that turn by theta it is the width of the narrower one over theta: pieces, not
    triangles, since long chords of a radius have been halved.
    """
    edges, normals = pair_triangles(triangles), unit_normals(points, triangles)
    pairs = edges.triangles
    turn = np.arccos(np.clip((normals[pairs[:, 0]] * normals[pairs[:, 1]]).sum(axis=1), -1.0, 1.0))
    bent = turn > np.radians(1.0)
    if not bent.any():
        return float("inf")
    _, piece = find_triangle_parts(len(triangles), replace(edges, triangles=pairs[~bent]))
    one, other = triangles[pairs[bent, 0]], triangles[pairs[bent, 1]]
    ends = points[one[(one[:, :, None] == other[:, None, :]).any(axis=2)].reshape(-1, 2)]
    widths = [_width_of_pieces(points, triangles, piece, normals, pairs[bent, side], ends) for side in (0, 1)]
    return float(np.quantile(np.minimum(*widths) / turn[bent], 0.01))


def _width_of_pieces(
    points: FloatArray, triangles: IntArray, piece: IntArray, normals: FloatArray, beside: IntArray, ends: FloatArray
) -> FloatArray:
    """Return how far flat pieces reach from edges of theirs, square to them (n,) [mm]; infinite of very large ones.

    piece: of each triangle; beside: a triangle at each edge (n,); ends: of the edges (n, 2, 3).
    """
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    across, middle = np.cross(normals[beside], along), ends.mean(axis=1)
    order = np.argsort(piece, kind="stable")
    first = np.searchsorted(piece[order], np.arange(piece.max() + 2))
    width = np.full(len(ends), np.inf)
    for number in np.unique(piece[beside]):
        own = triangles[order[first[number] : first[number + 1]]]
        corners = points[np.unique(own)]
        if len(corners) > _LARGE:
            continue
        at = np.flatnonzero(piece[beside] == number)
        away = np.abs(corners @ across[at].T - (middle[at] * across[at]).sum(axis=1))
        aside = np.abs(corners @ along[at].T - (middle[at] * along[at]).sum(axis=1))
        beside_edge = np.where(aside <= length[at], away, 0.0).max(axis=0)
        slanted = beside_edge < 1e-6 * length[at]  # a long triangle whose corner lies beyond the edge's ends
        width[at] = np.where(slanted, away.max(axis=0), beside_edge)
    return width


def _find_faults(
    points: FloatArray, triangles: IntArray, below: FloatArray, above: FloatArray, has_flange: bool
) -> tuple[str, ...]:
    """Describe what is doubtful about the tools."""
    notes = []
    before = double_areas(points, triangles)
    folded = [(before * double_areas(x, triangles)).sum(axis=1) < 0.0 for x in (below, above)]
    if (count := int(np.any(folded, axis=0).sum())) > 0:
        at = points[triangles[int(np.argmax(np.any(folded, axis=0)))]].mean(axis=0)
        where = ", ".join(f"{x:.4g}" for x in at)
        notes.append(f"{count} facets of the tools fold over, the first at ({where}): radii below half the thickness")
    if not has_flange:
        notes.append("the part has no level flange: it is pressed between punch and die without a holder")
    return tuple(notes)
