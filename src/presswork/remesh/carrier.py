# SPDX-License-Identifier: Apache-2.0
"""What a new mesh takes from the old one: moves and fields of nodes, fields of points, values along the boundary.

Every body of a section is a part of its own, with points and blocks that no other uses. A part that keeps its mesh
keeps its values to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from presswork.model import CELLS, ELEMENTS, BoolArray, CellBlock, FloatArray, IndexArray, Mesh, take_corners
from presswork.remesh.space.transfer import FitInSpace, PointsInSpace, locate_in_tetrahedra
from presswork.remesh.transfer import (
    OldPoints,
    PeakTakers,
    Places,
    PointTransfer,
    find_peak_takers,
    interpolate_along,
    locate,
)


@dataclass(frozen=True)
class SurfacePlaces:
    """Where nodes of a new boundary line lie on the old one."""

    node: IndexArray
    """Node of the new mesh (k,)."""
    before: IndexArray
    """Node of the old mesh before it on the boundary (k,)."""
    after: IndexArray
    """And after it (k,)."""
    part: FloatArray
    """Share of the distance from the one to the other (k,)."""
    earlier: IndexArray
    """Node before the one before (k,)."""
    later: IndexArray
    """Node after the one after (k,)."""

    def carry(self, values: FloatArray) -> FloatArray:
        """Return values at the old nodes (n_old_points, ...) at the new ones (k, ...), linear between two."""
        share = self.part.reshape(-1, *(1,) * (values.ndim - 1))
        return np.asarray((1.0 - share) * values[self.before] + share * values[self.after])

    def carry_material(self, position: FloatArray, values: FloatArray) -> FloatArray:
        """Return coordinates of the material (n_old_points, m) at the new nodes (k, m), along the arc of the line.

        position: of the old nodes (n_old_points, 2) [mm].
        """
        around = np.stack([self.earlier, self.before, self.after, self.later], axis=1)
        return interpolate_along(position[around], values[around], self.part)


@dataclass(frozen=True)
class SkinPlaces:
    """Where nodes of a new skin in space lie on the old one."""

    node: IndexArray
    """Node of the new mesh (k,)."""
    corners: IndexArray
    """Corners of the face of the old skin (k, 3)."""
    share: FloatArray
    """Share of these corners (k, 3)."""
    on_tool: BoolArray
    """Which tools, then which other bodies, each node lies on (n_tools + n_others, k)."""

    def carry(self, values: FloatArray) -> FloatArray:
        """Return values at the old nodes (n_old_points, ...) at the new ones (k, ...), linear in each face."""
        return np.asarray(np.einsum("ks,ks...->k...", self.share, values[self.corners]))

    def carry_material(self, position: FloatArray, values: FloatArray) -> FloatArray:
        """Return coordinates of the material (n_old_points, m) at the new nodes (k, m), so that a face stays one."""
        return self.carry(values)


@dataclass(frozen=True)
class Part:
    """A body with its old and its new mesh."""

    old_points: range
    new_points: range
    block: int
    surface: SurfacePlaces | SkinPlaces | None
    """None: the mesh stays."""
    seams: Sequence[FloatArray] = ()
    """Where a fold was left out, and its two sides are one from now on: lines (m, 2), in space faces (m, 3) [mm]."""


@dataclass(frozen=True)
class _Sources:
    """Where the values of a remeshed part come from."""

    position: FloatArray
    """Position of all nodes of the old mesh (n_old_points, 2 | 3) [mm]."""
    old: CellBlock
    new: CellBlock
    points: FloatArray
    """Points of the new mesh, of all parts (n_new_points, 2 | 3) [mm]."""
    own: IndexArray
    """The part's new nodes."""
    like: _Sources | None = None
    """The same on a mesh beside, whose choices count: which cells and which points values come from."""

    @cached_property
    def old_cells(self) -> IndexArray:
        """Corners of the old cells (n_cells, 3 | 4)."""
        return take_corners(self.old.connectivity, self.points.shape[1]).astype(np.intp)

    @cached_property
    def places(self) -> Places:
        """Where the new nodes lie in the old mesh."""
        return self.like.places if self.like else self._locate(self.points[self.own])

    @cached_property
    def of_nodes(self) -> tuple[IndexArray, PointTransfer | FitInSpace]:
        """Nodes of the old part, and how fields at them are found at the new ones."""
        nodes, first = np.unique(self.old_cells, return_index=True)
        old, new = self._make_points(self.position[nodes], first // self.old_cells.shape[1]), self.points[self.own]
        if self.like:
            return nodes, _refit(old, new, self.like.of_nodes[1])
        return nodes, old.find_transfer(new, self.places.cell)

    @cached_property
    def of_points(self) -> PointTransfer | FitInSpace:
        """How fields at the integration points of the old cells are found at those of the new ones."""
        if self.like:
            return _refit(self.old_points, self.new_points, self.like.of_points)
        home = self._locate(self.new_points).cell
        return self.old_points.find_transfer(self.new_points, home)

    @cached_property
    def old_points(self) -> OldPoints | PointsInSpace:
        """The integration points of the old cells."""
        places, n_cells = place_points(self.old, self.position), len(self.old_cells)
        return self._make_points(places, np.repeat(np.arange(n_cells), len(places) // n_cells))

    @cached_property
    def new_points(self) -> FloatArray:
        """Where the integration points of the new cells are (n, 2 | 3) [mm]."""
        return place_points(self.new, self.points)

    @property
    def _in_space(self) -> bool:
        return bool(self.position.shape[1] == 3)

    def _locate(self, wanted: FloatArray) -> Places:
        return (locate_in_tetrahedra if self._in_space else locate)(self.position, self.old_cells, wanted)

    def _make_points(self, position: FloatArray, cell_of: IndexArray) -> OldPoints | PointsInSpace:
        if self._in_space:
            return PointsInSpace(position, cell_of, self.old_cells)
        return OldPoints(position, cell_of, self.old_cells)


class Carrier:
    """Carries arrays from an old mesh to a new one, part by part."""

    def __init__(self, old: Mesh, position: FloatArray, new: Mesh, parts: Sequence[Part]) -> None:
        """position: of the old nodes (n_old_points, 2 | 3) [mm], in which the new mesh lies."""
        self.parts, self._position = parts, position
        self._takers: dict[tuple[str, int], PeakTakers] = {}
        self._n_points = len(new.points)
        self._sources: list[_Sources | None] = []
        for part in parts:
            own = np.arange(part.new_points.start, part.new_points.stop)
            blocks = old.blocks[part.block], new.blocks[part.block]
            self._sources.append(_Sources(position, *blocks, new.points, own) if part.surface is not None else None)

    def beside(self, position: FloatArray, points: FloatArray) -> Carrier:
        """Return the carrier of meshes of the same cells that lie beside these, with the same choices.

        position: of the old nodes (n_old_points, 2 | 3) [mm]; points: of the new ones (n_new_points, 2 | 3) [mm].
        Peaks go where this carrier has taken them.
        """
        other = copy(self)
        other._position = position
        other._sources = [s and replace(s, position=position, points=points, like=s) for s in self._sources]
        return other

    def is_new(self) -> BoolArray:
        """Mark the nodes of parts whose mesh is new (n_new_points,)."""
        new = np.zeros(self._n_points, dtype=bool)
        for part in self.parts:
            new[part.new_points.start : part.new_points.stop] = part.surface is not None
        return new

    def motion(self, values: FloatArray) -> FloatArray:
        """Carry moves of the old nodes (n_old_points, m) by the shape functions of the old cells."""
        result = np.zeros((self._n_points, *values.shape[1:]))
        for part, sources in zip(self.parts, self._sources, strict=True):
            own = slice(part.new_points.start, part.new_points.stop)
            kept = values[part.old_points.start : part.old_points.stop]
            result[own] = kept if sources is None else sources.places.interpolate(values)
        return result

    def linear(self, values: FloatArray) -> FloatArray:
        """Carry a field that is linear in the old cells (n_old_points, m), within its range in each."""
        result = self.motion(values)
        for part, sources in zip(self.parts, self._sources, strict=True):
            if sources is not None:
                own, donors = slice(part.new_points.start, part.new_points.stop), values[sources.places.nodes]
                result[own] = np.clip(result[own], donors.min(axis=1), donors.max(axis=1))
        return result

    def nodes(self, values: FloatArray) -> FloatArray:
        """Carry a field given at the old nodes (n_old_points, ...)."""
        result = np.zeros((self._n_points, *values.shape[1:]))
        for part, sources in zip(self.parts, self._sources, strict=True):
            own = slice(part.new_points.start, part.new_points.stop)
            if sources is None:
                result[own] = values[part.old_points.start : part.old_points.stop]
                continue
            nodes, transfer = sources.of_nodes
            result[own] = _apply(transfer, values[nodes], (len(sources.own),))
        return result

    def material(self, values: FloatArray) -> FloatArray:
        """Carry coordinates of the material at the old nodes (n_old_points, m): on the boundary along its arc."""
        result = self.nodes(values)
        for part in self.parts:
            if part.surface is not None:
                result[part.surface.node] = part.surface.carry_material(self._position, values)
        return result

    def points(self, values: Sequence[FloatArray], at_rest: Sequence[FloatArray]) -> list[FloatArray]:
        """Carry a field at integration points, of each block (n_cells, n_points, ...); at_rest: of the new mesh.

        What holds no values stays as at rest.
        """
        result = [given.copy() for given in at_rest]
        for part, sources in zip(self.parts, self._sources, strict=True):
            given, rest = values[part.block], at_rest[part.block]
            if sources is None:
                result[part.block] = given.copy()
            if sources is None or not given.size:
                continue
            result[part.block] = _apply(sources.of_points, given.reshape(-1, *given.shape[2:]), rest.shape[:2])
        return result

    def peaks(
        self, name: str, values: Sequence[FloatArray], carried: Sequence[FloatArray], volume: Sequence[FloatArray]
    ) -> list[FloatArray]:
        """Return a field carried by `points`, of each block (n_cells, n_points), with the peaks that it had.

        name: of the field. values: of the old mesh; volume: of the new points [mm3].
        """
        result = [found.copy() for found in carried]
        for part, sources in zip(self.parts, self._sources, strict=True):
            given, found = values[part.block].ravel(), carried[part.block]
            if sources is None or not given.size:
                continue
            key = name, part.block
            if key not in self._takers:
                places = sources.old_points, sources.new_points
                self._takers[key] = find_peak_takers(given, *places, sources.of_points)
            kept = self._takers[key].keep(given, found.ravel(), volume[part.block].ravel())
            result[part.block] = kept.reshape(found.shape)
        return result

    def cells(self, values: Sequence[FloatArray], at_rest: Sequence[FloatArray]) -> list[FloatArray]:
        """Return values of the cells of each block (n_cells, ...) that stay, and those at rest of new cells."""
        result = [given.copy() for given in at_rest]
        for part in self.parts:
            if part.surface is None:
                result[part.block] = values[part.block].copy()
        return result

    def surface(self, values: FloatArray, at_rest: FloatArray) -> FloatArray:
        """Carry values at the old boundary (n_old_points, ...) along its arc; others are those at rest."""
        result = at_rest.copy()
        for part in self.parts:
            if part.surface is None:
                result[part.new_points.start : part.new_points.stop] = values[
                    part.old_points.start : part.old_points.stop
                ]
                continue
            result[part.surface.node] = part.surface.carry(values)
        return result


def place_points(block: CellBlock, position: FloatArray) -> FloatArray:
    """Return where the integration points of a block's cells are, cell after cell (n, 2 | 3) [mm]."""
    row = ELEMENTS[block.element]
    shapes = CELLS[row.cell].rules[row.points].shapes
    return np.asarray(np.einsum("qa,cak->cqk", shapes, position[block.connectivity]).reshape(-1, position.shape[1]))


def _refit(
    old: OldPoints | PointsInSpace, new: FloatArray, like: PointTransfer | FitInSpace
) -> PointTransfer | FitInSpace:
    if isinstance(old, PointsInSpace):
        assert isinstance(like, FitInSpace), "both are in space"
        return old.refit(new, like)
    assert isinstance(like, PointTransfer), "both are in the plane"
    return old.refit(new, like)


def _apply(transfer: PointTransfer | FitInSpace, values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return values (n_old, ...) at the new points, in rows of a shape; what is negative nowhere stays so."""
    flat = values.reshape(len(values), -1)
    found = transfer.apply(flat)
    never_negative = flat.min(axis=0) >= 0.0
    found[:, never_negative] = np.maximum(found[:, never_negative], 0.0)
    return found.reshape(*shape, *values.shape[1:])
