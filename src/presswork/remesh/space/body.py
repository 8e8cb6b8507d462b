# SPDX-License-Identifier: Apache-2.0
"""What a new mesh of a body in space is made from, and the new mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.tetrahedra import area_vectors, find_skin, list_edges, measure_volumes
from presswork.remesh.space.tools import PlacedTool

FLAT = 1e-9
"""Nodes that lie closer to a plane than that lie in it, over the body's size."""


@dataclass(frozen=True)
class Topology:
    """What of a body of tetrahedra stays as long as its mesh does."""

    cells: IndexArray
    """(m, 4)."""

    @cached_property
    def faces(self) -> IndexArray:
        """Its skin (k, 3), counter-clockwise seen from outside."""
        return find_skin(self.cells)[0]

    @cached_property
    def edges(self) -> IndexArray:
        """Edges of its skin (e, 2)."""
        return list_edges(self.faces)


@dataclass(frozen=True)
class OldBody:
    """A deformed body of tetrahedra."""

    points: FloatArray
    """Where its nodes are (n, 3) [mm]."""
    cells: IndexArray
    """(m, 4)."""
    on_tool: BoolArray
    """Which tools touch a node, then which of the others (n_tools + n_others, n)."""
    held: BoolArray
    """Components that supports hold (n, 3)."""
    sets: Mapping[str, IndexArray]
    """Faces of places that the new mesh must have (n, 3)."""
    tools: Sequence[PlacedTool]
    lost: float = 0.0
    """Part of the volume that was lost so far, and is given back."""
    others: Mapping[int, PlacedTool] = field(default_factory=dict)
    """Skins of the bodies that it may touch, by their numbers."""
    topology: Topology | None = None
    """Topology of its cells, where it is known from an increment before."""

    @property
    def obstacles(self) -> list[PlacedTool]:
        """What its skin may lie on: tools, then other bodies."""
        return [*self.tools, *self.others.values()]

    @cached_property
    def _topology(self) -> Topology:
        return self.topology or Topology(self.cells)

    @property
    def faces(self) -> IndexArray:
        """Its skin (k, 3), counter-clockwise seen from outside."""
        return self._topology.faces

    @cached_property
    def normals(self) -> FloatArray:
        """Unit normals of its faces outwards (k, 3)."""
        area = area_vectors(self.points, self.faces)
        return np.asarray(area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300))

    @cached_property
    def volume(self) -> float:
        """[mm3]."""
        return float(measure_volumes(self.points, self.cells).sum())

    @cached_property
    def planes(self) -> list[tuple[int, float, BoolArray]]:
        """Planes in which supports hold whole faces: axis, coordinate [mm], which faces (k,)."""
        scale, found = float(np.ptp(self.points, axis=0).max()), []
        for axis in range(3):
            at = self.points[self.faces, axis]
            flat = self.held[self.faces, axis].all(axis=1) & (np.ptp(at, axis=1) < FLAT * scale)
            while flat.any():
                level = float(at[np.argmax(flat), 0])
                own = flat & (np.abs(at - level) < FLAT * scale).all(axis=1)
                found.append((axis, level, own))
                flat &= ~own
        return found

    @cached_property
    def in_plane(self) -> BoolArray:
        """Faces in one of the planes (k,)."""
        marked = np.zeros(len(self.faces), dtype=bool)
        for _, _, own in self.planes:
            marked |= own
        return marked

    @cached_property
    def skin_tree(self) -> cKDTree:
        """Nodes and middles of faces of its skin."""
        middles = self.points[self.faces].mean(axis=1)
        return cKDTree(np.concatenate([self.points[np.unique(self.faces)], middles]))

    @property
    def edges(self) -> IndexArray:
        """Edges of its skin (e, 2)."""
        return self._topology.edges

    @cached_property
    def edge_depths(self) -> FloatArray:
        """How deep the middle of each edge lies in each tool (n_tools, e) [mm]."""
        return self._find_depths(self.points[self.edges].mean(axis=1))

    @cached_property
    def face_depths(self) -> FloatArray:
        """The same of the middle of each face (n_tools, k) [mm]."""
        return self._find_depths(self.points[self.faces].mean(axis=1))

    def _find_depths(self, places: FloatArray) -> FloatArray:
        gaps = [np.minimum(tool.touch(places, 0.0)[0], 0.0) for tool in self.tools]
        return -np.array(gaps).reshape(len(self.tools), len(places))

    @cached_property
    def references(self) -> tuple[IndexArray, BoolArray]:
        """A number for each face (k,), the same for faces in the same planes and sets; for each number the planes,
        then the sets, in which its faces lie (n_numbers, n_planes + n_sets)."""
        columns = [own for _, _, own in self.planes]
        columns += [_are_among(self.faces, own) for own in self.sets.values()]
        if not columns:
            return np.zeros(len(self.faces), dtype=np.intp), np.zeros((1, 0), dtype=bool)
        table, number = np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)
        return number.ravel().astype(np.intp), table


def _are_among(faces: IndexArray, own: IndexArray) -> BoolArray:
    """Return which faces (k, 3) are among others (n, 3)."""
    both = np.sort(np.concatenate([own, faces]), axis=1)
    _, number = np.unique(both, axis=0, return_inverse=True)
    number = number.ravel()
    return np.isin(number[len(own) :], number[: len(own)])


@dataclass(frozen=True)
class NewBody:
    """The new mesh in the deformed place."""

    points: FloatArray
    """(n, 3) [mm]."""
    cells: IndexArray
    """(m, 4)."""
    faces: IndexArray
    """Its skin (k, 3), counter-clockwise seen from outside."""
    sets: Mapping[str, IndexArray]
    """Faces of the places of the old body (n, 3)."""
    on_tool: BoolArray
    """Which tools, then which other bodies, nodes lie on, to round-off (n_tools + n_others, n)."""
    skin: IndexArray
    """Nodes of its skin (s,)."""
    corners: IndexArray
    """Corners of the face of the old skin on which each of them lay (s, 3)."""
    share: FloatArray
    """Share of those corners (s, 3)."""
    offset: float
    """Offset by which free nodes were moved outwards to give the volume back [mm]."""
    seam: FloatArray
    """Corners of the faces of the old skin that lie inside now, three of a face after the other (3 k, 3) [mm]."""
