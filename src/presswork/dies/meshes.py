# SPDX-License-Identifier: Apache-2.0
"""Meshes of a die's parts: the metal between its profile and an outer contour, and the rings round it.

Cells are quadrilaterals of eight nodes whose middles lie on the arcs of the profile. Two parts that touch have the same
nodes along the side that they share.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from presswork.dies.profile_nodes import divide_profile
from presswork.geometry.polygon import measure_distance as measure_to_sides
from presswork.geometry.polygon import polygon_area
from presswork.geometry.segments import measure_distance, reverse_segments
from presswork.mesh import MeshError
from presswork.mesh.make.block_behind import GRADATION, crosses, divide_side
from presswork.mesh.topology import edge_keys, list_cell_edges
from presswork.model import CELLS, DieBody, DiePart, FloatArray, IntArray
from presswork.remesh.fill import SizeField, fill_with_quadrilaterals

Divide = Callable[[FloatArray, FloatArray], FloatArray]
"""Makes the nodes between two points."""
COARSEST = 16
"""Cells along the longer side of a body, at least."""
THROUGH = 3
"""Cells through the wall of a ring, at least."""
SAME = 1e-7
"""Distance of nodes that are one, over the extent of the part."""


@dataclass(frozen=True)
class PartMesh:
    """A part of a die."""

    points: FloatArray
    """Nodes (n, 2) [mm] where the tool starts."""
    cells: IntArray
    """Corners, then middles of the sides (m, 8)."""
    boundary: IntArray
    """Nodes of its boundary (k,)."""
    profile: IntArray
    """Nodes along the tool's profile in order, corners and middles in turn; of a ring none."""

    def find_side(self, side: str) -> IntArray:
        """Return the nodes of the boundary farthest to a side, without those inside the profile."""
        axis, sign = (1 if side in ("bottom", "top") else 0), (1.0 if side in ("top", "right") else -1.0)
        nodes = np.setdiff1d(self.boundary, self.profile[1:-1])
        reach = sign * self.points[nodes, axis]
        return np.asarray(nodes[reach > reach.max() - SAME * self.extent], dtype=np.int32)

    @property
    def extent(self) -> float:
        """Return the longer side of the box round it [mm]."""
        return float(np.ptp(self.points, axis=0).max())


@dataclass(frozen=True)
class _Ring:
    """Where the rectangle of a ring is, or the outer side of the part that holds the profile [mm]."""

    bore: float
    outer: float
    low: float
    high: float


def mesh_body(segments: FloatArray, body: DieBody) -> list[PartMesh]:
    """Return the meshes of a body behind a tool's profile (n, 7), as in model.Profile, with metal on its right.

    Raises MeshError where the outline does not match the profile.
    """
    core, *rings = body.parts
    walked = reverse_segments(segments)  # metal on the left
    profile = divide_profile(walked, body.size)
    if np.allclose(profile[0], profile[-1], atol=SAME * max(1.0, float(np.ptp(profile)))):
        if core.outer is not None or core.corners or rings:
            raise MeshError("the profile is closed, so it is the whole outline", "leave outer, corners and rings out")
        return [_fill(profile[:-1], len(profile), segments)]
    if core.outer is None and not core.corners:
        raise MeshError("the profile is open", "give outer, or corners")
    corners = _find_corners(profile, core)
    places = _place_rings(corners, rings)
    coarse = _find_coarsest(np.concatenate([profile, corners]), places, body.size)

    def divide(a: FloatArray, b: FloatArray) -> FloatArray:
        return divide_side(a, b, profile, body.size, coarse)

    meshes = []
    for number, place in enumerate(places):
        levels = [level for ring in places[number + 1 : number + 2] for level in (ring.low, ring.high)]
        if number == 0:
            stations = [profile[-1], *corners, profile[0]]
            line = [profile]
        else:
            inside = places[number - 1]
            inner = _list_levels(place.low, place.high, (inside.low, inside.high))
            stations = [np.array([place.bore, y]) for y in inner[::-1]]
            stations += [np.array([place.outer, y]) for y in (place.low, place.high)] + stations[:1]
            line = [stations[0][None]]
        for a, b in itertools.pairwise(stations):
            line.append(_divide_levels(a, b, place.outer, levels, divide)[1:])
        meshes.append(_fill(np.concatenate(line)[:-1], len(profile) if number == 0 else 0, segments))
    return meshes


def _find_corners(profile: FloatArray, core: DiePart) -> FloatArray:
    """Return the corners (n, 2) of the outline from the end of a profile (k, 2) round to its start."""
    start, end = profile[0], profile[-1]
    if core.corners:
        given = np.array(core.corners, dtype=np.float64)
        choices = [given, given[::-1]]
    else:
        assert core.outer is not None
        bottom, top = core.bottom, core.top
        levels = [(bottom, top), (top, bottom)]
        choices = [_square_off(end, start, core.outer, *pair) for pair in levels]
    near = SAME * float(np.ptp(profile, axis=0).max())
    fitting = [c for c in choices if not crosses(np.concatenate([profile, c])) and _clears(profile, c, near)]
    if not fitting:
        text = "the outline of the body does not match the profile: it crosses it, or lies on its free side"
        raise MeshError(text, "give outer beyond the profile, bottom or top behind it, or other corners")
    return max(fitting, key=lambda c: polygon_area(np.concatenate([profile, c])))


def _clears(profile: FloatArray, corners: FloatArray, near: float) -> bool:
    """Return whether the sides over corners (n, 2) touch a profile at its ends alone."""
    line = np.concatenate([profile[-1:], corners, profile[:1]])
    sides = np.stack([line[:-1], line[1:]], axis=1)
    return len(profile) < 3 or bool(measure_to_sides(sides, profile[1:-1]).min() > near)


def _square_off(
    end: FloatArray, start: FloatArray, outer: float, of_end: float | None, of_start: float | None
) -> FloatArray:
    """Return the corners from the end of a profile to x = outer and back to its start, over levels of y if given."""
    corners: list[tuple[float, float]] = []
    for place, level in ((end, of_end), (start, of_start)):
        own = [(float(place[0]), level)] if level is not None and level != place[1] else []
        own.append((outer, float(place[1]) if level is None else level))
        corners += own if place is end else own[::-1]
    kept = [c for c in corners if not any(np.allclose(c, p, atol=1e-9) for p in (end, start))]
    return np.array(kept, dtype=np.float64).reshape(-1, 2)


def _place_rings(corners: FloatArray, rings: Sequence[DiePart]) -> list[_Ring]:
    """Return the outer side of the part with the profile, and the rectangles of the rings."""
    bore = float(corners[:, 0].max())
    on_side = corners[corners[:, 0] == bore]
    places = [_Ring(0.0, bore, float(on_side[:, 1].min()), float(on_side[:, 1].max()))]
    if rings and places[0].low == places[0].high:
        raise MeshError("a ring needs a straight side to sit on", "give the outline two corners at its largest x")
    for ring in rings:
        last = places[-1]
        assert ring.outer is not None
        low, high = (own if own is not None else of for own, of in ((ring.bottom, last.low), (ring.top, last.high)))
        if ring.outer <= last.outer:
            raise MeshError(f"a ring of outer = {ring.outer:g} mm sits on x = {last.outer:g} mm", "give a larger outer")
        if min(high, last.high) <= max(low, last.low):
            text = (
                f"a ring from y = {low:g} to {high:g} mm does not touch the part inside, {last.low:g} to {last.high:g}"
            )
            raise MeshError(text, "give bottom < top that overlap it")
        places.append(_Ring(last.outer, ring.outer, low, high))
    return places


def _find_coarsest(outline: FloatArray, places: Sequence[_Ring], size: float) -> float:
    """Return the size of the largest cells [mm]."""
    low = np.minimum(outline.min(axis=0), [np.inf, min(p.low for p in places)])
    high = np.maximum(outline.max(axis=0), [places[-1].outer, max(p.high for p in places)])
    walls = [(place.outer - place.bore) / THROUGH for place in places[1:]]
    return max(size, min(float((high - low).max()) / COARSEST, *walls, np.inf))


def _list_levels(low: float, high: float, levels: Sequence[float]) -> list[float]:
    """Return y of the ends of a side and of levels between them, upwards."""
    return [low, *sorted(level for level in set(levels) if low < level < high), high]


def _divide_levels(a: FloatArray, b: FloatArray, outer: float, levels: Sequence[float], divide: Divide) -> FloatArray:
    """Return the nodes from a to b; an upright side has nodes at levels, and the same ones from either end."""
    if a[0] != b[0]:
        return np.asarray(divide(a, b))
    low, high = sorted((float(a[1]), float(b[1])))
    stops = [np.array([a[0], y]) for y in _list_levels(low, high, levels if a[0] == outer else ())]
    parts = [divide(p, q) for p, q in itertools.pairwise(stops)]
    line = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
    return np.asarray(line if a[1] < b[1] else line[::-1])


def _fill(line: FloatArray, n_profile: int, segments: FloatArray) -> PartMesh:
    """Return the mesh inside a closed line (k, 2), the first n_profile nodes of which lie on the profile."""
    points, corners = fill_with_quadrilaterals(line, _size_from(line))
    points, cells = _add_middles(points, corners.astype(np.int32))
    sides = list_cell_edges(cells)
    middle_of = dict(zip(edge_keys(sides).tolist(), sides[:, 2].tolist(), strict=True))
    ring = np.arange(len(line), dtype=np.int32)
    edges = np.column_stack([ring, np.roll(ring, -1)])
    middles = np.array([middle_of[key] for key in edge_keys(edges).tolist()], dtype=np.int32)
    on_profile = edges[: n_profile - 1] if n_profile else edges[:0]
    chain = np.zeros(0, dtype=np.int32)
    if len(on_profile):
        own = middles[: len(on_profile)]
        found = measure_distance(points[own], segments)
        points[own] -= found.distance[:, None] * found.outwards
        chain = np.append(np.column_stack([on_profile[:, 0], own]).ravel(), on_profile[-1, 1]).astype(np.int32)
    return PartMesh(points, cells, np.concatenate([ring, middles]), chain)


def _size_from(line: FloatArray) -> SizeField:
    """Return the size of cells inside a line (k, 2): that of its nearest sides, growing with the distance."""
    after = np.roll(line, -1, axis=0)
    middle, length = 0.5 * (line + after), np.linalg.norm(after - line, axis=1)
    group = np.round(2.0 * np.log2(length)).astype(int)
    trees = [(float(length[group == g].mean()), cKDTree(middle[group == g])) for g in np.unique(group)]

    def find(places: FloatArray) -> FloatArray:
        found = np.full(len(places), np.inf)
        for size, tree in trees:
            found = np.minimum(found, size + GRADATION * tree.query(places)[0])
        return found

    return find


def _add_middles(points: FloatArray, corners: IntArray) -> tuple[FloatArray, IntArray]:
    """Return points and cells (m, 8) of cells of four corners, with a node in the middle of each side."""
    sides = list_cell_edges(corners)
    _, index, number = np.unique(edge_keys(sides), return_index=True, return_inverse=True)
    middles = points[sides[index]].mean(axis=1)
    own = (len(points) + number.reshape(len(corners), 4)).astype(np.int32)
    cells = np.concatenate([corners, own], axis=1)
    assert np.array_equal(CELLS["quad8"].edges[:, 2], np.arange(4, 8)), "middles follow the sides of four corners"
    return np.concatenate([points, middles]), np.ascontiguousarray(cells, dtype=np.int32)
