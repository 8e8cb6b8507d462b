# SPDX-License-Identifier: Apache-2.0
"""Notches in the skin of a body: where two faces of it have nearly closed on each other, a new mesh is made without.

A fold begins as one: an edge of the skin at which two faces look at each other across a narrow void. Cells there turn
inside out, nodes at its root have hardly a surface that a tool could push, and no mesh follows what closes within one
cell. So the void is filled with tetrahedra, from its root outwards, before the body is meshed anew, and its two sides
are one from then on: a lap. A void that a tool fills stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import CELLS, BoolArray, FloatArray, IndexArray
from presswork.remesh.space.body import FLAT, OldBody
from presswork.remesh.space.fill import FilledBody
from presswork.remesh.space.tetrahedra import area_vectors, measure_volumes
from presswork.remesh.space.tools import PlacedTool

Plane = tuple[int, float, BoolArray]
"""Axis, coordinate [mm], and which numbers of faces lie in it (n_numbers,)."""

SHARP, FILLED = 30.0, 60.0
"""Angle of the void below which it counts as a fold and a new mesh is asked for, and below which a new mesh fills it
[degrees]."""
IN_TOOL = 0.2
"""How far the middle of a void may lie in a tool, over the void's width: more than chords of a round do, less than in a
ridge."""
THIN = 1e-6
"""Volume of a filling over the cube of its longest edge, below which it is too flat to be meshed."""
_ROUNDS = 20
_INSIDE = 1e-6


@dataclass(frozen=True)
class Notches:
    """Edges of a skin at which two of its faces look at each other, the sharpest first."""

    corners: IndexArray
    """The edge's nodes a and b, and those opposite to it: faces (a, b, c) and (b, a, d) (n, 4)."""
    faces: IndexArray
    """These faces (n, 2)."""
    angle: FloatArray
    """Angle of the void between them (n,) [degrees]."""


@dataclass(frozen=True)
class Filling:
    """A body without its notches."""

    body: FilledBody
    seam: FloatArray
    """Corners of the faces that were the two sides of a fold and lie inside now, three of a face after the other
    (3 k, 3) [mm]."""
    added: int
    """Tetrahedra that fill them."""


def find_notches(points: FloatArray, faces: IndexArray, widest: float) -> Notches:
    """Return the edges of a closed skin (k, 3) whose void has less than an angle [degrees, below 90]."""
    ends = faces[:, CELLS["tri3"].edges].reshape(-1, 2)
    n = int(faces.max(initial=0)) + 1
    key, reverse = ends[:, 0] * n + ends[:, 1], ends[:, 1] * n + ends[:, 0]
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], reverse), len(key) - 1)
    other = order[place]
    own = np.flatnonzero((ends[:, 0] < ends[:, 1]) & (key[other] == reverse))
    across = faces[:, [2, 0, 1]].reshape(-1)
    corners = np.column_stack([ends[own], across[own], across[other[own]]])
    pair = np.column_stack([own, other[own]]) // 3
    normal = area_vectors(points, faces)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    cosine = -np.einsum("ni,ni->n", normal[pair[:, 0]], normal[pair[:, 1]])
    ahead = points[corners[:, 3]] - points[corners[:, 0]]
    opens = np.einsum("ni,ni->n", ahead, normal[pair[:, 0]]) > 0.0
    found = np.flatnonzero(opens & (cosine > np.cos(np.radians(widest))))
    found = found[np.argsort(-cosine[found], kind="stable")]
    return Notches(corners[found], pair[found], np.degrees(np.arccos(np.minimum(cosine[found], 1.0))))


def list_planes(body: OldBody) -> list[Plane]:
    """Return the planes of symmetry of a body, by the numbers of its faces."""
    _, table = body.references
    return [(axis, level, table[:, column]) for column, (axis, level, _) in enumerate(body.planes)]


def measure_notch(body: OldBody) -> tuple[float, FloatArray]:
    """Return the angle of the sharpest void that a new mesh would fill [degrees], and where it is (3,)."""
    notches = find_notches(body.points, body.faces, FILLED)
    if not len(notches.angle):
        return 180.0, np.zeros(3)
    present = FilledBody(body.points, body.cells, body.faces, body.references[0])
    filler = _Filler(present, list_planes(body), body.obstacles)
    for corners, faces, angle in zip(notches.corners, notches.faces, notches.angle, strict=True):
        if filler.may_fill(corners, faces):
            return float(angle), body.points[corners[:2]].mean(axis=0)
    return 180.0, np.zeros(3)


def fill_notches(body: FilledBody, planes: Sequence[Plane], obstacles: Sequence[PlacedTool]) -> Filling:
    """Return a body whose notches are filled where no obstacle lies in them."""
    if not len(find_notches(body.points, body.faces, FILLED).angle):
        return Filling(body, np.zeros((0, 3)), 0)
    filler = _Filler(body, planes, obstacles)
    for _ in range(_ROUNDS):
        if not filler.fill_once():
            break
    return filler.make()


class _Filler:
    """A skin to which tetrahedra are added one by one."""

    def __init__(self, body: FilledBody, planes: Sequence[Plane], obstacles: Sequence[PlacedTool]) -> None:
        self._body, self._points, self._planes, self._obstacles = body, body.points, planes, obstacles
        self._faces: list[tuple[int, int, int] | None] = [(int(a), int(b), int(c)) for a, b, c in body.faces]
        self._number = body.number.tolist()
        self._face_at = {edge: f for f, face in enumerate(body.faces.tolist()) for edge in _list_ends(face)}
        self._added: list[tuple[int, int, int, int]] = []
        self._folded: set[int] = set()
        self._skin = np.unique(body.faces)

    def fill_once(self) -> bool:
        """Fill the notches of the present skin, the sharpest first; return whether there were any."""
        kept = np.array([f for f, face in enumerate(self._faces) if face is not None])
        faces = np.array([self._faces[f] for f in kept])
        notches = find_notches(self._points, faces, FILLED)
        before = len(self._added)
        for corners, pair, angle in zip(notches.corners, kept[notches.faces], notches.angle, strict=True):
            if self.may_fill(corners, pair):
                self._fill(*corners.tolist(), *pair.tolist())
                self._folded |= set(pair.tolist()) if angle < SHARP else set()
        return len(self._added) > before

    def may_fill(self, corners: IndexArray, pair: IndexArray) -> bool:
        """Return whether the void between two faces can be filled, and no tool fills it."""
        first, second = pair.tolist()
        if self._faces[first] is None or self._faces[second] is None:
            return False
        if any(own[self._number[first]] or own[self._number[second]] for _, _, own in self._planes):
            return False
        _, _, c, d = corners.tolist()
        closes = any(self._find_opposite(face) is not None for face in _list_walls(*corners.tolist()))
        if not closes and ((c, d) in self._face_at or (d, c) in self._face_at):
            return False
        x = self._points[corners]
        size = float(np.linalg.norm(x - x[[1, 2, 0, 0]], axis=1).max())
        if float(measure_volumes(x, np.arange(4)[None])[0]) < THIN * size**3:
            return False
        middle, width = x[2:].mean(axis=0)[None], float(np.linalg.norm(x[3] - x[2]))
        if any(tool.touch(middle, size)[0][0] < -IN_TOOL * width for tool in self._obstacles):
            return False
        return not self._holds_nodes(corners)

    def _holds_nodes(self, corners: IndexArray) -> bool:
        """Return whether another node of the skin lies in a tetrahedron."""
        x = self._points[corners]
        others = np.setdiff1d(self._skin, corners)
        inner = np.linalg.solve((x[1:] - x[0]).T, (self._points[others] - x[0]).T)
        return bool(((inner > -_INSIDE).all(axis=0) & (inner.sum(axis=0) < 1.0 + _INSIDE)).any())

    def _find_opposite(self, face: tuple[int, int, int]) -> int | None:
        """Return the face of the skin that looks at a new one across no void."""
        found = self._face_at.get((face[1], face[0]))
        if found is None:
            return None
        return found if set(self._faces[found] or ()) == set(face) else None

    def _fill(self, a: int, b: int, c: int, d: int, first: int, second: int) -> None:
        number = self._number[first]
        for face in (first, second):
            self._drop(face)
        for wall in _list_walls(a, b, c, d):
            opposite = self._find_opposite(wall)
            if opposite is not None:
                self._drop(opposite)
                continue
            self._number.append(self._find_number_in_plane(wall, number))
            self._faces.append(wall)
            for edge in _list_ends(wall):
                self._face_at[edge] = len(self._faces) - 1
        self._added.append((a, b, c, d))

    def _drop(self, face: int) -> None:
        corners = self._faces[face]
        assert corners is not None
        for edge in _list_ends(corners):
            if self._face_at.get(edge) == face:
                del self._face_at[edge]
        self._faces[face] = None

    def _find_number_in_plane(self, wall: tuple[int, int, int], number: int) -> int:
        """Return the number of a new face: that of the face beside it where both lie in a plane."""
        scale = float(np.ptp(self._points, axis=0).max())
        for axis, level, own in self._planes:
            if (np.abs(self._points[list(wall), axis] - level) < FLAT * scale).all():
                beside = [self._face_at.get((b, a)) for a, b in _list_ends(wall)]
                found = [self._number[f] for f in beside if f is not None and own[self._number[f]]]
                return found[0] if found else int(np.argmax(own))
        return number

    def make(self) -> Filling:
        """Return the body as it is now."""
        body, first = self._body, len(self._body.faces)
        kept = [f for f, face in enumerate(self._faces) if face is not None]
        cells = np.concatenate([body.cells, np.array(self._added, dtype=body.cells.dtype).reshape(-1, 4)])
        faces = np.array([self._faces[f] for f in kept], dtype=body.faces.dtype)
        number = np.array([self._number[f] for f in kept], dtype=np.intp)
        sides = body.faces[sorted(f for f in self._folded if f < first)]
        seam = body.points[sides].reshape(-1, 3)
        return Filling(FilledBody(body.points, cells, faces, number), seam, len(self._added))


def _list_walls(a: int, b: int, c: int, d: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Return the faces of a filling (a, b, c, d) that may become skin, counter-clockwise seen from outside."""
    return (b, c, d), (c, a, d)


def _list_ends(face: tuple[int, ...] | list[int]) -> list[tuple[int, int]]:
    return [(face[0], face[1]), (face[1], face[2]), (face[2], face[0])]
