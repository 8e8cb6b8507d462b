# SPDX-License-Identifier: Apache-2.0
"""Cracks in the outline of a section: narrow slits along a path, with two faces.

The metal lies on the left of every loop. A slit that ends inside the metal makes a loop longer, one from loop to loop
joins them, and one from a loop to itself divides it: then there are two pieces. One that meets no loop is a loop of its
own, round a hole. A slit has its full width where it leaves a loop and none at its tip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IndexArray

SHARP, NARROW = np.radians(45.0), 0.7
"""Angle of a spike of metal, and its width over the size of cells, below which its end goes."""
LEAST_NODES = 8
"""Nodes of a loop that are left in any case."""


@dataclass(frozen=True)
class Mouth:
    """Where a slit leaves the outline: it opens a node."""

    node: int
    is_tip: bool = False
    """Whether the node is the tip of a slit that goes on."""


@dataclass(frozen=True)
class Slit:
    """A crack to be cut."""

    path: FloatArray
    """From its beginning to its end (m, 2) [mm], at least two points."""
    width: float
    """[mm]"""
    begin: Mouth | None = None
    """None: it begins inside the metal."""
    end: Mouth | None = None


@dataclass(frozen=True)
class Outline:
    """The loops of a section."""

    points: FloatArray
    """All nodes, then those of slits (n, 2) [mm]."""
    loops: tuple[IndexArray, ...]
    """Numbers of points in order."""
    firm: tuple[int, ...] = ()
    """Mouths and tips of slits, which stay nodes."""


def cut_outline(outline: Outline, slit: Slit) -> Outline:
    """Return an outline with a slit more. Raises MeshError where it has no room."""
    return _Cut(outline, slit).make()


def place_mouth(outline: Outline, place: FloatArray, allowed: BoolArray) -> Mouth:
    """Return the mouth of a slit at the node nearest to a place (2,) [mm].

    allowed: nodes that may be one (n,). Raises MeshError where there is none.
    """
    nodes = np.concatenate(outline.loops)
    nodes = nodes[allowed[nodes]]
    if not len(nodes):
        raise MeshError("no node at which a crack could begin", "a free surface")
    return Mouth(int(nodes[np.argmin(np.linalg.norm(outline.points[nodes] - place, axis=1))]))


def blunt_spikes(outline: Outline, size: float) -> Outline:
    """Return an outline without the ends of spikes of metal too thin for cells of a size [mm].

    Nodes go from the end of a spike on while it is sharper than SHARP and narrower than NARROW sizes.
    """
    loops = []
    for loop in outline.loops:
        left = loop.tolist()
        at = 0
        while at < len(left) and len(left) > LEAST_NODES:
            before, here, after = (outline.points[left[(at + k) % len(left)]] for k in (-1, 0, 1))
            back, ahead = before - here, after - here
            turn = float(np.arctan2(ahead[0] * back[1] - ahead[1] * back[0], ahead @ back))  # from ahead through metal
            if 0.0 <= turn < SHARP and np.linalg.norm(after - before) < NARROW * size:
                del left[at]
                at = max(at - 2, 0)
            else:
                at += 1
        loops.append(np.array(left, dtype=np.intp))
    kept = np.concatenate(loops)
    return Outline(outline.points, tuple(loops), tuple(node for node in outline.firm if node in kept))


class _Cut:
    """One slit and the outline that it is cut into."""

    def __init__(self, outline: Outline, slit: Slit) -> None:
        self._loops, self._slit = [loop.tolist() for loop in outline.loops], slit
        self._points, self._firm = [*outline.points], [*outline.firm]

    def make(self) -> Outline:
        """Return the outline with the slit."""
        slit, path = self._slit, self._slit.path
        along = np.gradient(path, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        left = np.column_stack([-along[:, 1], along[:, 0]])
        half = self._find_half_widths()[:, None] * left
        inner = slice(1, -1)
        left_face, right_face = self._add(path[inner] + half[inner]), self._add(path[inner] - half[inner])
        first, last = self._open(slit.begin, path[0], half[0]), self._open(slit.end, path[-1], -half[-1])
        forth = [*first.before, *left_face, *last.after]  # with the void on the right
        back = [*last.before, *right_face[::-1], *first.after]
        if first.loop is None and last.loop is None:
            self._loops.append([*forth, *back])
        elif last.loop is None or first.loop is None:
            end = first if last.loop is None else last
            assert end.loop is not None
            inside = [*forth, *back] if last.loop is None else [*back, *forth]
            self._loops[end.loop] = [*end.rest, *inside]
        elif first.loop == last.loop:
            self._divide(first, last, forth, back)
        else:
            self._loops[first.loop] = [*first.rest, *forth, *last.rest, *back]
            del self._loops[last.loop]
        return Outline(
            np.array(self._points), tuple(np.array(loop, dtype=np.intp) for loop in self._loops), tuple(self._firm)
        )

    def _find_half_widths(self) -> FloatArray:
        """Return half of the width along the path (m,) [mm]."""
        slit = self._slit
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(slit.path, axis=0), axis=1))])
        share = length / length[-1]
        if slit.begin is not None and slit.end is not None:
            return np.full(len(share), 0.5 * slit.width)
        if slit.begin is None and slit.end is None:
            return np.asarray(2.0 * slit.width * share * (1.0 - share))
        return np.asarray(0.5 * slit.width * (share if slit.begin is None else 1.0 - share))

    def _add(self, places: FloatArray) -> list[int]:
        """Return the numbers of further points (n, 2)."""
        first = len(self._points)
        self._points += [*places]
        return list(range(first, len(self._points)))

    def _open(self, mouth: Mouth | None, place: FloatArray, half: FloatArray) -> _End:
        """Return one end of the slit; half: half of its width, to the side that the loop comes from (2,) [mm]."""
        if mouth is None:
            tip = self._add(place[None])
            self._firm += tip
            return _End(None, [], tip, [])
        number = next(i for i, loop in enumerate(self._loops) if mouth.node in loop)
        loop = self._loops[number]
        at = loop.index(mouth.node)
        node = self._points[mouth.node]
        if mouth.is_tip:
            first, second = node + half, node - half
        else:
            wide = float(np.linalg.norm(half))
            first, second = (
                node + wide * (of - node) / np.linalg.norm(of - node)
                for of in (self._points[loop[at - 1]], self._points[loop[(at + 1) % len(loop)]])
            )
        before, after = self._add(np.stack([first, second]))
        self._firm += [before, after]
        return _End(number, [before], [after], [*loop[at + 1 :], *loop[:at]])

    def _divide(self, first: _End, last: _End, forth: list[int], back: list[int]) -> None:
        """Put two loops in the place of one that the slit divides."""
        assert first.loop is not None
        slit = self._slit
        assert slit.begin is not None
        assert slit.end is not None
        if slit.begin.node == slit.end.node:
            raise MeshError("a crack begins and ends at one node of the outline", "smaller cells there")
        at = first.rest.index(slit.end.node)
        self._loops[first.loop] = [*first.rest[:at], *back]
        self._loops.append([*first.rest[at + 1 :], *forth])


@dataclass(frozen=True)
class _End:
    """One end of a slit."""

    loop: int | None
    """Loop that it opens; None: it lies inside."""
    before: list[int]
    """Points at which the loop comes to the mouth."""
    after: list[int]
    """And at which it goes on; the tip of a slit that ends inside."""
    rest: list[int]
    """The loop from behind the mouth round to it."""
