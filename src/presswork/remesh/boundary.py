# SPDX-License-Identifier: Apache-2.0
"""A new boundary line: nodes on tools exactly on their profiles, free arcs on cubics, corners and planes kept.

A place on the old line is a number: the old node before it, and the fraction of the distance to the next one. On a tool
the distance follows its profile, on a free arc a cubic through the old nodes, in a plane the straight line. Hard places
become nodes at even places of the new line: corners of more than CORNER, ends of planes and of named sets, corners of
tools inside the contact. Between them nodes follow at equal distances over the size of cells; the nearest ones go to
the ends of contacts. Contact reaches half an edge beyond its last node, on the old line and on the new one. One offset
of all free nodes along their normals gives the volume back (volume.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.geometry.cubic_spline import CubicSpline
from presswork.geometry.polygon import list_sides
from presswork.geometry.profile_path import ProfilePath
from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.fill import SizeField
from presswork.remesh.volume import enclosed_volume, restore_volume

CORNER = np.radians(30.0)
VOID = 1.05
"""Way along an inner bend of a tool over its chord, from which on the metal is taken not to fill it."""
LONGEST_LAP = 12
"""Nodes of a loop in which the line crosses itself that are left out, however wide it is."""
THIN = 0.35
"""Mean width of a longer loop, over its edges, that is left out at most."""
MOST_LAPS = 8
"""Loops that one new line leaves out at most."""
_CLOSE = 0.35
"""Distance over the size of cells within which another hard place replaces a corner."""
_CLOSE_ON_CRACKS = 1.0
"""The same where there are cracks, which have many."""
_BULGE = 0.3
"""How far a cubic may leave an edge, over its chord; the edge stays straight where the cubic would leave it by more."""
_STEEP = 0.5
"""How far a node may lie off the tool and still be put on it, over its distance from the end of a contact."""
_SAMPLES = 16
FREE, PLANE_X, PLANE_Y, TOOL = -1, -2, -3, 0
"""Kinds of edges; from TOOL on the number of the tool."""


@dataclass(frozen=True)
class OldLine:
    """The boundary of the deformed mesh, closed, counter-clockwise."""

    points: FloatArray
    """(n, 2) [mm]."""
    on_tool: BoolArray
    """Which tools hold a node; a last row, if there is one more, marks nodes on other bodies (n_tools, n)."""
    in_plane: BoolArray
    """Which nodes supports hold along x and y (n, 2)."""
    kept: BoolArray
    """Nodes that stay nodes: ends of named sets (n,)."""
    profiles: Sequence[FloatArray]
    """Profiles of the tools where they stand, as model.Profile.segments."""
    ring: bool
    """Whether volumes are those of revolution about x = 0."""
    lost: float = 0.0
    """Part of the volume that the old meshes have lost, and the new line gives back."""
    is_cracked: bool = False
    """Whether its sides may cross each other in the new line: faces of cracks, which are parted later."""


@dataclass(frozen=True)
class NewLine:
    """The boundary of the new mesh, closed, counter-clockwise, with an even number of nodes."""

    points: FloatArray
    """(k, 2) [mm]."""
    place: FloatArray
    """Place on the old line (k,)."""
    is_free: BoolArray
    """Nodes that neither a tool nor a plane holds (k,)."""
    offset: float
    """Offset by which free nodes were moved outwards to give the volume back [mm]."""
    in_plane: BoolArray
    """Nodes that a plane holds (k,)."""
    seams: tuple[FloatArray, ...] = ()
    """Middles of the loops left out in which the line crossed itself, from the mouth to the end of each (m, 2) [mm]."""


def refuse_fold(sides: FloatArray) -> None:
    """Raise MeshError where sides (n, 2, 2) cross each other."""
    folds = find_folds(sides)
    if len(folds):
        raise _fold_error(sides[:, 0], folds)


def find_folds(sides: FloatArray) -> IndexArray:
    """Return the pairs of sides (n, 2, 2) that cross each other (m, 2)."""
    line, after = np.moveaxis(sides, 1, 0)
    first = _turn(line[:, None], after[:, None], line[None]) * _turn(line[:, None], after[:, None], after[None])
    crosses = (first < 0.0) & (first.T < 0.0)
    return np.argwhere(np.triu(crosses, 1))


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return twice the area of triangles."""
    return np.asarray(
        (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    )


def resample(old: OldLine, size: SizeField) -> NewLine:
    """Return a new line whose edges have the size asked for.

    Raises MeshError where its volume cannot be given back.
    """
    curve = _Curve(old)
    place, w = curve.measure(size)
    hard = _choose_hard(curve.hard_places(), place, w, _CLOSE_ON_CRACKS if old.is_cracked else _CLOSE)
    spread = [
        _spread(place, w, first, last, curve.soft_places())
        for first, last in zip(hard, [*hard[1:], hard[0] + len(old.points)], strict=True)
    ]
    places = np.mod(np.concatenate(spread), len(old.points))
    points, is_free = curve.at(places), curve.is_free(places)
    curve.extend_contact(places, points, is_free)
    target = enclosed_volume(old.points, ring=old.ring) * (1.0 + old.lost)
    points, is_free, offset = restore_volume(points, is_free, target, old.profiles, ring=old.ring)
    seams: list[FloatArray] = []
    for _ in range(0 if old.is_cracked else MOST_LAPS):
        folds = find_folds(list_sides(points))
        if not len(folds):
            break
        kept, seam = _close_lap(points, folds, is_free)
        seams.append(seam)
        places = places[kept]
        points, is_free, offset = restore_volume(points[kept], is_free[kept], target, old.profiles, ring=old.ring)
    else:
        if not old.is_cracked:
            refuse_fold(list_sides(points))
    return NewLine(points, places, is_free, offset, curve.in_plane(places), tuple(seams))


def _fold_error(points: FloatArray, folds: IndexArray) -> MeshError:
    x, y = points[folds[0, 0]]
    return MeshError(f"the boundary crosses itself near ({x:.4g}, {y:.4g})", "contact of the body with itself")


def _close_lap(points: FloatArray, folds: IndexArray, is_free: BoolArray) -> tuple[BoolArray, FloatArray]:
    """Mark the nodes that stay where a loop of free nodes between two crossing sides is left out (k,); its middle.

    The loop is short, or as thin as a fold that has closed; the longest such one between any two crossing sides. An
    even number of nodes goes, so that corners keep even places. Raises MeshError where loops are long and wide, or
    held.
    """
    n, kept, loop = len(points), np.ones(len(points), dtype=bool), points[:0]
    for first, last in folds.tolist():
        inner = np.arange(first + 1, last + 1)
        if len(inner) > n // 2:
            inner = np.arange(last + 1, first + 1 + n) % n
        own = points[inner]
        if len(inner) % 2:
            inner = np.append(inner, (inner[-1] + 1) % n)
        may_go = len(inner) <= LONGEST_LAP or _is_thin(points[inner])
        if may_go and len(inner) > (~kept).sum() and is_free[inner].all():
            kept[:] = True
            kept[inner] = False
            mouth = _find_crossing(points[[first, (first + 1) % n, last, (last + 1) % n]])
            loop = np.concatenate([mouth, own, mouth])
    if kept.all():
        raise _fold_error(points, folds)
    return kept, _find_middle(loop)


def _find_crossing(ends: FloatArray) -> FloatArray:
    """Return where two sides (4, 2) cross (1, 2)."""
    a, b, c, d = ends
    part = _turn(c, d, a) / (_turn(c, d, a) - _turn(c, d, b))
    return np.asarray((a + part * (b - a))[None])


def _find_middle(loop: FloatArray) -> FloatArray:
    """Return the line midway between the two sides of a loop (m, 2) that begins and ends at its mouth, to its end."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(loop, axis=0), axis=1))])
    at = np.linspace(0.0, 0.5 * along[-1], len(loop) + 1)
    sides = [np.column_stack([np.interp(x, along, axis) for axis in loop.T]) for x in (at, along[-1] - at)]
    return np.asarray(0.5 * (sides[0] + sides[1]))


def _is_thin(loop: FloatArray) -> bool:
    """Return whether a loop of nodes (m, 2) is on average narrower than THIN of its edges."""
    edges = np.linalg.norm(np.diff(loop, axis=0), axis=1)
    return abs(enclosed_volume(loop, ring=False)) < THIN * float(edges.mean()) * 0.5 * float(edges.sum())


class _Curve:
    """The old line as a curve: where its places are, and of which kind."""

    def __init__(self, old: OldLine) -> None:
        self.old, self.n = old, len(old.points)
        self._paths = [ProfilePath(profile) for profile in old.profiles]
        self._place = np.zeros((len(self._paths), self.n))
        for t, path in enumerate(self._paths):
            self._place[t] = path.find(old.points)[0]
        after = np.roll(old.points, -1, axis=0)
        self._chord = np.linalg.norm(after - old.points, axis=1)
        self.kind = self._find_kinds()
        out = (after - old.points) / self._chord[:, None]
        into = np.roll(out, 1, axis=0)
        turn = np.arctan2(into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0], (into * out).sum(axis=1))
        before = np.roll(self.kind, 1)
        plane_ends = (before != self.kind) & ((before <= PLANE_X) | (self.kind <= PLANE_X))
        self._firm = old.kept | plane_ends
        self._is_corner = np.abs(turn) > CORNER
        self._fit_cubics()

    def _find_kinds(self) -> IndexArray:
        """Return the kind of the edge after each node (n,)."""
        points, after = self.old.points, np.roll(self.old.points, -1, axis=0)
        kind = np.full(self.n, FREE)
        scale = float(np.ptp(points, axis=0).max())
        for t in range(len(self._paths)):
            both = self.old.on_tool[t] & np.roll(self.old.on_tool[t], -1)
            stretch = np.abs(self._stretch(t))
            filled = (stretch < VOID * self._chord) | self._passes_outer_corner(t)
            kind[both & filled] = TOOL + t
        for axis, name in ((0, PLANE_X), (1, PLANE_Y)):
            both = self.old.in_plane[:, axis] & np.roll(self.old.in_plane[:, axis], -1)
            kind[both & (np.abs(after[:, axis] - points[:, axis]) < 1e-9 * scale)] = name
        return kind

    def _stretch(self, t: int) -> FloatArray:
        """Return the distance along a tool's profile from each node to the next (n,) [mm], the shorter if closed."""
        stretch = np.roll(self._place[t], -1) - self._place[t]
        if self._paths[t].is_closed:
            length = self._paths[t].length
            stretch = np.mod(stretch + 0.5 * length, length) - 0.5 * length
        return np.asarray(stretch)

    def _corners_passed(self, t: int) -> list[tuple[int, float, float]]:
        """Return the corners of a tool that edges between nodes it holds pass: edge, part of it, turn."""
        corners, turns = self._paths[t].corners()
        begin, stretch = self._place[t], self._stretch(t)
        both = self.old.on_tool[t] & np.roll(self.old.on_tool[t], -1) & (stretch != 0.0)
        passed = []
        for corner, turn in zip(corners.tolist(), turns.tolist(), strict=True):
            ahead = corner - begin
            if self._paths[t].is_closed:
                length = self._paths[t].length
                ahead = np.where(stretch > 0.0, np.mod(ahead, length), -np.mod(-ahead, length))
            part = ahead / np.where(both, stretch, 1.0)
            passed += [(int(i), float(part[i]), turn) for i in np.flatnonzero(both & (part >= 0.0) & (part <= 1.0))]
        return passed

    def _passes_outer_corner(self, t: int) -> BoolArray:
        """Mark edges that lie round a corner of the tool that points into the metal (n,)."""
        passes = np.zeros(self.n, dtype=bool)
        for edge, part, turn in self._corners_passed(t):
            passes[edge] |= turn < 0.0 and 1e-9 < part < 1.0 - 1e-9
        return np.asarray(passes & (np.abs(self._stretch(t)) < 2.0 * self._chord))

    def _fit_cubics(self) -> None:
        """Fit a cubic to each row of free edges between corners and other kinds."""
        ends = (np.roll(self.kind, 1) != self.kind) | self._is_corner | self._firm
        starts = np.flatnonzero(ends & (self.kind == FREE))
        self._cubics: list[tuple[int, CubicSpline, FloatArray]] = []
        self._cubic_of = np.full(self.n, -1)
        if not len(starts) and (self.kind == FREE).all():
            starts = np.array([0])
        for start in starts.tolist():
            count = 1
            while count < self.n and not ends[(start + count) % self.n] and self.kind[(start + count) % self.n] == FREE:
                count += 1
            if count < 2:
                continue
            edges = (start + np.arange(count)) % self.n
            nodes = (start + np.arange(count + 1)) % self.n
            arc = np.concatenate([[0.0], np.cumsum(self._chord[edges])])
            cubic = CubicSpline(arc, self.old.points[nodes])
            middle = cubic(0.5 * (arc[1:] + arc[:-1])) - 0.5 * (
                self.old.points[nodes[1:]] + self.old.points[nodes[:-1]]
            )
            smooth = np.linalg.norm(middle, axis=1) < _BULGE * self._chord[edges]
            self._cubic_of[edges[smooth]] = len(self._cubics)
            self._cubics.append((start, cubic, arc))

    def at(self, places: FloatArray) -> FloatArray:
        """Return points (m, 2) at places (m,) on the line."""
        places = np.mod(places, self.n)
        edge = np.minimum(places.astype(int), self.n - 1)
        part = (places - edge)[:, None]
        after = (edge + 1) % self.n
        points = (1.0 - part) * self.old.points[edge] + part * self.old.points[after]
        for t, profile in enumerate(self._paths):
            own = self.kind[edge] == TOOL + t
            if own.any():
                points[own] = profile.at(self._place[t][edge[own]] + part[own, 0] * self._stretch(t)[edge[own]])
        for number, (start, cubic, arc) in enumerate(self._cubics):
            own = self._cubic_of[edge] == number
            index = (edge[own] - start) % self.n
            points[own] = cubic(arc[index] + part[own, 0] * (arc[index + 1] - arc[index]))
        whole = part[:, 0] == 0.0
        points[whole] = self.old.points[edge[whole]]
        return np.asarray(points)

    def is_free(self, places: FloatArray) -> BoolArray:
        """Mark places that neither a tool nor a plane holds (m,)."""
        edge = places.astype(int) % self.n
        held: BoolArray = np.asarray(self.old.on_tool.any(axis=0) | self.old.in_plane.any(axis=1))
        return np.asarray(np.where(places == edge, ~held[edge], self.kind[edge] == FREE), dtype=bool)

    def in_plane(self, places: FloatArray) -> BoolArray:
        """Mark places that a plane holds (m,)."""
        edge = places.astype(int) % self.n
        held: BoolArray = np.asarray(self.old.in_plane.any(axis=1))
        return np.asarray(np.where(places == edge, held[edge], self.kind[edge] <= PLANE_X), dtype=bool)

    def extend_contact(self, places: FloatArray, points: FloatArray, is_free: BoolArray) -> None:
        """Put free points at places within half an edge of the end of a contact onto the tool, in place.

        The last node in contact bore the pressure on half the edge beyond it. Finer nodes there must bear it, or the
        contact shrinks and the tool's force falls. Edges steeper to the tool than _STEEP stay as they are.
        """
        edge = places.astype(int) % self.n
        part, after = places - places.astype(int), (edge + 1) % self.n
        held: BoolArray = np.asarray(self.old.on_tool.any(axis=0) | self.old.in_plane.any(axis=1))
        for t, profile in enumerate(self.old.profiles):
            on = self.old.on_tool[t]
            gap, normal, *_ = _core.touch_profile(np.ascontiguousarray(profile), np.ascontiguousarray(points))
            for end, other, share in ((edge, after, part), (after, edge, 1.0 - part)):
                near = is_free & (self.kind[edge] == FREE) & on[end] & ~held[other] & (share < 0.5 + 1e-6)
                near &= (gap > 0.0) & (gap < _STEEP * np.linalg.norm(points - self.old.points[end], axis=1))
                points[near] -= gap[near, None] * normal[near]
                is_free[near] = False

    def hard_places(self) -> tuple[FloatArray, FloatArray]:
        """Return places that must be nodes, and those that shall be unless they lie close to others."""
        corners = [np.flatnonzero(self._is_corner & ~self._firm).astype(float)]
        for t in range(len(self._paths)):
            passed = [edge + part for edge, part, _ in self._corners_passed(t) if self.kind[edge] == TOOL + t]
            corners.append(np.array(passed, dtype=float))
        return np.flatnonzero(self._firm).astype(float), np.unique(np.mod(np.concatenate(corners), self.n))

    def soft_places(self) -> FloatArray:
        """Return the ends of contacts, and nodes alone in contact (m,)."""
        before = np.roll(self.kind, 1)
        alone = self.old.on_tool[: len(self._paths)].any(axis=0) & (before == FREE) & (self.kind == FREE)
        return np.flatnonzero(alone | (before != self.kind)).astype(float)

    def measure(self, size: SizeField) -> tuple[FloatArray, FloatArray]:
        """Return places all along the line, and the distance to them over the size of cells, each (m,)."""
        places = np.arange(self.n * _SAMPLES + 1) / _SAMPLES
        points = self.at(places)
        step = np.linalg.norm(np.diff(points, axis=0), axis=1)
        wanted = size(0.5 * (points[1:] + points[:-1]))
        return places, np.concatenate([[0.0], np.cumsum(step / wanted)])


def _choose_hard(hard: tuple[FloatArray, FloatArray], place: FloatArray, w: FloatArray, close: float) -> list[float]:
    """Return the hard places in order: all firm ones, and corners not too close to others."""
    firm, corners = hard
    chosen = firm.tolist()
    whole = float(w[-1])
    for corner in corners.tolist():
        apart = np.abs(np.interp(corner, place, w) - np.interp(np.array(chosen), place, w)) if chosen else np.array([])
        if not (np.minimum(apart, whole - apart) < close).any():
            chosen.append(corner)
    return sorted(chosen) or [0.0]


def _spread(place: FloatArray, w: FloatArray, first: float, last: float, soft: FloatArray) -> FloatArray:
    """Return the places of an even number of edges from one hard place to the next, the last end left out."""
    n, whole = float(place[-1]), float(w[-1])

    def measure(at: FloatArray) -> FloatArray:
        turns = np.floor(at / n)
        return np.interp(at - turns * n, place, w) + turns * whole

    ends = measure(np.array([first, last]))
    n_edges = 2 * max(1, round(0.5 * float(ends[1] - ends[0])))
    soft = np.concatenate([soft, soft + n])
    soft = soft[(soft > first) & (soft < last)]
    wanted = (measure(soft) - ends[0]) / (ends[1] - ends[0]) * n_edges
    number, which = np.unique(np.clip(np.round(wanted), 0, n_edges), return_index=True)
    inner = (number > 0) & (number < n_edges)
    number, which = number[inner], which[inner]
    known = np.concatenate([[0.0], wanted[which], [n_edges]])
    parts = np.interp(np.arange(n_edges), np.concatenate([[0.0], number, [n_edges]]), known)
    target = ends[0] + parts / n_edges * (ends[1] - ends[0])
    found = np.interp(target, np.concatenate([w, w[1:] + whole]), np.concatenate([place, place[1:] + n]))
    found[0] = first
    found[number.astype(int)] = soft[which]
    return np.asarray(found)
