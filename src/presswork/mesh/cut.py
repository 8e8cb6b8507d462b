# SPDX-License-Identifier: Apache-2.0
"""Cut a mesh of quadrilaterals and triangles along a closed line in its plan (x, y).

1. A node is moved onto every corner of the line, sharp or rounded within an element, in the cell that it lies in.
2. Nodes that the line passes nearby, closer than NEAR of an edge, are moved onto it along that edge. Nodes of the
   sheet's own outline move along it, and its corners stay.
3. Edges that the line still crosses get a node there; what is kept of their cells is split into quadrilaterals and
   triangles, the best shaped ones (polygon_cell.py).

So the new outline has its nodes on the line and chords between them: off a line of radius R by h^2/8R, h the size of
the cells; a corner is missed where no node can be moved to it. Everything at a node of the new mesh is a mean of what
the old nodes have; a new cell knows the old one that it lies in.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from presswork.geometry.polygon import (
    contains,
    find_corners,
    find_crossings,
    list_sides,
    measure_distance,
    sample_sides,
)
from presswork.geometry.polygon_cell import Loop, find_normal, find_weights, split_polygon
from presswork.mesh.checks import MeshError
from presswork.mesh.topology import edge_keys, find_boundary_edges, find_parts, list_cell_edges, select_edges
from presswork.model import BoolArray, FloatArray, IntArray, find_cell

NEAR = 0.3
"""Part of an edge within which a node is moved onto the line."""
HALF = 0.5
"""The same where a line divides the mesh, and both sides stay."""
SHARP = float(np.radians(20.0))
"""A line or an outline that turns by more has a corner."""
TIGHT = float(np.radians(45.0))
"""A line that turns by more within an element has a corner there too."""
FAR = 0.1
"""Part of an edge: how deep it may run on the wrong side of the line, which is curved."""
LEAST = 0.2
"""Quality that every piece round a node moved onto a corner has."""
_ON = 1e-9
"""Part of the mesh's size within which a node lies on the line."""
_NO_AREA = 1e-6
"""Quality of a piece that is nothing."""

Keep = Literal["inside", "outside"]


@dataclass(frozen=True)
class CutCells:
    """Cells of one kind after a cut."""

    connectivity: IntArray
    """(n_cells, 3 | 4)."""
    parent: IntArray
    """Block and number of the old cell that each lies in (n_cells, 2)."""
    natural: FloatArray
    """Its corners in the natural coordinates of that cell, before nodes were moved (n_cells, 3 | 4, 2)."""


@dataclass(frozen=True)
class CutMesh:
    """A mesh after a cut."""

    weights: scipy.sparse.csr_array
    """Weights of the old nodes in the new ones (n_new, n_old); each row adds up to one."""
    cells: tuple[CutCells, ...]
    """Quadrilaterals, triangles: those that there are."""
    cut_edges: IntArray
    """The new outline along the line (n, 2)."""
    off_line: float
    """The farthest that the line is from it [mm]."""


def cut_mesh(points: FloatArray, blocks: tuple[IntArray, ...], line: FloatArray, keep: Keep) -> CutMesh:
    """Cut a mesh along a closed line, and keep what lies inside or outside of it.

    points: of the nodes in space (n, 3), seen along z; blocks: connectivity (n_cells, 3 | 4) of each kind; line: its
    corners in turn (m, 2), closed by itself. Raises MeshError where the line cuts nothing, leaves nothing, or leaves
    several parts.
    """
    cutter = _Cutter(points, blocks, line, keep)
    cutter.place_corners()
    cutter.move_near_nodes(NEAR)
    return cutter.split()


def divide_mesh(
    points: FloatArray, blocks: tuple[IntArray, ...], line: FloatArray, *, with_corners: bool = True
) -> tuple[FloatArray, list[IntArray]]:
    """Return the points and the cells of each kind of a flat mesh that has its nodes on a closed line.

    Arguments as of cut_mesh; with_corners: with nodes on the corners of the line. Nodes are moved up to half an edge,
    so that hardly any are added and no cell is cut small.
    Raises MeshError where all nodes lie on one side.
    """
    cutter = _Cutter(points, blocks, line, "inside")
    if with_corners:
        cutter.place_corners()
    cutter.move_near_nodes(HALF, keeps_cells=True)
    return cutter.divide()


def check_meets(points: FloatArray, line: FloatArray, keep: Keep) -> None:
    """Raise MeshError where a line (m, 2) cuts off none or all of the nodes (n, 3) of a sheet."""
    inside = contains(list_sides(line), points[:, :2])
    low, high = points.min(axis=0), points.max(axis=0)
    reach = f"the sheet lies in x {low[0]:.4g} to {high[0]:.4g}, y {low[1]:.4g} to {high[1]:.4g} mm"
    narrow = "beside the sheet, or within one element" if not inside.any() else "round all of the sheet"
    if inside.all() or not inside.any():
        if inside.all() == (keep == "inside"):
            raise MeshError(f"the line cuts nothing off, for it runs {narrow}: {reach}", "move the line")
        raise MeshError(
            f"nothing is left {keep} of the line, for it runs {narrow}: {reach}",
            "move the line, or keep the other side",
        )


class _Cutter:
    """The steps of a cut."""

    def __init__(self, points: FloatArray, blocks: tuple[IntArray, ...], line: FloatArray, keep: Keep) -> None:
        self.points, self.blocks, self.line, self.keep = points.copy(), blocks, line, keep
        self.keeps_both = False
        self.sides = list_sides(line)
        self.weights = scipy.sparse.lil_array(scipy.sparse.eye_array(len(points)))
        edges = np.concatenate([list_cell_edges(cells) for cells in blocks])
        self.edges = edges[np.unique(edge_keys(edges), return_index=True)[1]]
        extent = float(np.ptp(points[:, :2], axis=0).max())
        self.on, self.spacing = _ON * extent, 1e-2 * extent
        self.element_size = float(np.median(np.linalg.norm(np.ptp(points[edges], axis=1)[:, :2], axis=1)))
        self.samples = scipy.spatial.cKDTree(sample_sides(self.sides, self.spacing))
        check_meets(points, line, keep)
        self.side = self._find_sides(points[:, :2])
        self.boundary = find_boundary_edges(blocks)
        self.is_outline = np.zeros(len(points), dtype=bool)
        self.is_outline[self.boundary] = True
        self.outline = points[self.boundary, :2]
        self.moved = self.side == 0

    def _find_sides(self, plan: FloatArray) -> IntArray:
        """Return 1 for points (n, 2) that are kept, -1 for those cut off, 0 on the line (n,)."""
        inside = contains(self.sides, plan) == (self.keep == "inside")
        side = np.where(inside, 1, -1).astype(np.int32)
        near = np.flatnonzero(self.samples.query(plan)[0] <= self.spacing)
        side[near[measure_distance(self.sides, plan[near]) <= self.on]] = 0
        return side

    # --- 1 -----------------------------------------------------------------------------------------------------------

    def place_corners(self) -> None:
        """Move a node onto every corner of the line."""
        around: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for b, cells in enumerate(self.blocks):
            for node, cell in zip(
                cells.ravel().tolist(), np.repeat(np.arange(len(cells)), cells.shape[1]).tolist(), strict=True
            ):
                around[node].append((b, cell))
        for corner in find_corners(self.line, SHARP, TIGHT, self.element_size):
            found = self._find_cell(corner)
            if found is None:
                continue
            nodes, weights = found
            if np.linalg.norm(self.points[nodes, :2] - corner, axis=1).min() <= self.on:
                continue
            for pick in np.argsort(-weights).tolist():
                node = int(nodes[pick])
                if not (self.is_outline[node] or self.moved[node]) and self._can_move(
                    node, around[node], nodes, weights
                ):
                    self._move(node, nodes, weights)
                    break

    def _find_cell(self, place: FloatArray) -> tuple[IntArray, FloatArray] | None:
        """Return the nodes of the cell that a place (2,) of the plan lies in, and their weights there."""
        for cells in self.blocks:
            corners = self.points[cells, :2]
            near = (corners.min(axis=1) <= place).all(axis=1) & (corners.max(axis=1) >= place).all(axis=1)
            for cell in np.flatnonzero(near):
                weights = find_weights(corners[cell], place)
                if weights is not None:
                    return cells[cell], weights
        return None

    def _can_move(self, node: int, cells: list[tuple[int, int]], nodes: IntArray, weights: FloatArray) -> bool:
        """Return whether every cell around a node keeps an acceptable shape when the node moves."""
        before = self.points[node].copy()
        normals = [find_normal(self.points[self.blocks[b][cell]]) for b, cell in cells]
        self.points[node] = weights @ self.points[nodes]
        good = all(
            split_polygon(self.points[self.blocks[b][cell]], normal)[1] > LEAST
            for (b, cell), normal in zip(cells, normals, strict=True)
        )
        self.points[node] = before
        return good

    def _move(self, node: int, nodes: IntArray, weights: FloatArray) -> None:
        """Place a node at the mean of other nodes."""
        self.points[node] = weights @ self.points[nodes]
        self.weights[[node]] = scipy.sparse.csr_array(weights[None, :]) @ self.weights[nodes.tolist()].tocsr()
        self.moved[node], self.side[node] = True, 0

    # --- 2 -----------------------------------------------------------------------------------------------------------

    def move_near_nodes(self, near: float, *, keeps_cells: bool = False) -> None:
        """Move nodes that the line passes nearby, closer than part of an edge, onto it.

        keeps_cells: no cell comes to lie on the line with all its nodes.
        """
        edges, part = self._crossed_edges()
        ends = np.concatenate([edges, edges[:, ::-1]])
        parts = np.concatenate([part, 1.0 - part])
        own, other = ends.T
        on_outline = np.isin(edge_keys(ends), edge_keys(self.boundary))
        stays = self.is_outline & (self._outline_turns() > SHARP)
        allowed = ~self.moved[own] & (parts < near) & (~self.is_outline[own] | (on_outline & ~stays[own]))
        allowed |= ~self.moved[own] & (parts < _ON)
        chosen: dict[int, int] = {}
        for row in np.flatnonzero(allowed)[np.argsort(parts[allowed])].tolist():
            chosen.setdefault(int(own[row]), row)
        before, weights = self.points.copy(), self.weights.tocsr()
        for node, row in chosen.items():
            t = float(parts[row])
            self.points[node] = (1 - t) * before[node] + t * before[other[row]]
        goes = np.isin(np.arange(len(before)), list(chosen))
        goes &= ~self._leaves_its_side(goes)
        if keeps_cells:
            self._keep_cells(goes, {node: float(parts[row]) for node, row in chosen.items()})
        self.points[~goes] = before[~goes]
        self.moved |= goes
        self.side[goes] = 0
        for node in np.flatnonzero(goes).tolist():
            row = chosen[node]
            t = float(parts[row])
            self.weights[[node]] = (1 - t) * weights[[node]] + t * weights[[int(other[row])]]

    def _keep_cells(self, goes: BoolArray, parts: Mapping[int, float]) -> None:
        """Let the farthest node stay of cells all nodes of which would lie on the line.

        goes: nodes that move (n,), changed here; parts: of an edge, how far each moves.
        """
        for cells in self.blocks:
            for cell in cells[(goes | self.moved)[cells].all(axis=1)].tolist():
                moving = [node for node in cell if goes[node]]
                if moving and all(goes[node] or self.moved[node] for node in cell):
                    goes[max(moving, key=lambda node: parts[node])] = False

    def _leaves_its_side(self, moved: BoolArray) -> BoolArray:
        """Mark moved nodes from which an edge to a node on one side now runs far on the other (n,)."""
        ends = np.concatenate([self.edges, self.edges[:, ::-1]])
        ends = ends[moved[ends[:, 0]]]
        side = self.side[ends[:, 1]]
        middle = self.points[ends, :2].mean(axis=1)
        length = np.linalg.norm(self.points[ends[:, 1], :2] - self.points[ends[:, 0], :2], axis=1)
        wrong = self._find_sides(middle) * side < 0
        wrong[wrong] = measure_distance(self.sides, middle[wrong]) > FAR * length[wrong]
        return np.asarray(np.isin(np.arange(len(self.points)), ends[wrong, 0]))

    def _crossed_edges(self) -> tuple[IntArray, FloatArray]:
        """Return the edges (n, 2) with a kept first and a lost second end, and the part up to the line (n,)."""
        crossed = self.edges[self.side[self.edges[:, 0]] * self.side[self.edges[:, 1]] < 0]
        turned = self.side[crossed[:, 0]] < 0
        crossed[turned] = crossed[turned, ::-1]
        start, end = self.points[crossed[:, 0], :2], self.points[crossed[:, 1], :2]
        part = find_crossings(self.sides, start, end)
        return crossed, np.where(np.isnan(part), 0.5, part)

    def _outline_turns(self) -> FloatArray:
        """Return by how much the outline turns at each node of it (n,) [rad]."""
        first, last = self.boundary[:, :2].T
        along = self.points[last, :2] - self.points[first, :2]
        into, out = np.zeros((len(self.points), 2)), np.zeros((len(self.points), 2))
        into[last], out[first] = along, along
        cross = into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0]
        return np.asarray(np.abs(np.arctan2(cross, (into * out).sum(axis=1))))

    # --- 3 -----------------------------------------------------------------------------------------------------------

    def split(self) -> CutMesh:
        """Keep what lies on the right side, and split the cells that the line crosses."""
        at, weights = self._add_nodes()
        return self._finish(self._collect(at), weights)

    def divide(self) -> tuple[FloatArray, list[IntArray]]:
        """Keep both sides, and split the cells that the line crosses; return points (n, 3) and cells of each kind."""
        at, _ = self._add_nodes()
        self.keeps_both = True
        pieces = self._collect(at)
        self.side, self.keep = -self.side, "outside" if self.keep == "inside" else "inside"
        return self.points, [each.connectivity for each in self._collect(at, pieces).cells()]

    def _add_nodes(self) -> tuple[dict[tuple[int, int], tuple[int, float]], scipy.sparse.csr_array]:
        """Add a node where the line crosses an edge; return it and its place by edge, and the weights of all nodes."""
        edges, part = self._crossed_edges()
        n = len(self.points)
        at: dict[tuple[int, int], tuple[int, float]] = {}
        for i, ((first, last), t) in enumerate(zip(edges.tolist(), part.tolist(), strict=True)):
            at[first, last], at[last, first] = (n + i, t), (n + i, 1.0 - t)
        blend = scipy.sparse.csr_array(
            (np.column_stack([1 - part, part]).ravel(), edges.ravel(), np.arange(0, 2 * len(edges) + 1, 2)),
            shape=(len(edges), n),
        )
        self.points = np.concatenate([self.points, blend @ self.points])
        weights = scipy.sparse.vstack([self.weights.tocsr(), blend @ self.weights.tocsr()]).tocsr()
        self.side = np.concatenate([self.side, np.zeros(len(edges), dtype=np.int32)])
        return at, weights

    def _collect(self, at: dict[tuple[int, int], tuple[int, float]], before: _Pieces | None = None) -> _Pieces:
        """Return the cells on the side that is kept, whole or split at the new nodes, after others."""
        pieces = before or _Pieces()
        for b, cells in enumerate(self.blocks):
            side, natural = self.side[cells], find_cell(2, cells).places
            whole = (side > 0).all(axis=1)
            pieces.add_whole(b, cells, np.flatnonzero(whole), natural)
            for cell in np.flatnonzero(~whole & (side >= 0).any(axis=1)).tolist():
                loop, places = _insert(cells[cell], natural, at)
                normal = find_normal(self.points[cells[cell]])
                for own in self._separate(list(range(len(loop))), np.array(loop)):
                    parts, quality = split_polygon(self.points[loop][own], normal)
                    if quality > _NO_AREA:
                        pieces.add_parts(b, cell, [loop[k] for k in own], places[own], parts)
        return pieces

    def _separate(self, own: list[int], loop: IntArray) -> list[list[int]]:
        """Split a polygon along the line between nodes on it, and return the pieces that are kept."""
        side = self.side[loop[own]]
        mixed = (side > 0).any() and (side < 0).any()
        on_line = np.flatnonzero(side == 0)
        pairs = [(i, j) for i in on_line for j in on_line if 1 < j - i < len(own) - 1]
        if pairs:
            ends = self.points[loop[np.array(own)[pairs]], :2]
            miss = measure_distance(self.sides, ends.mean(axis=1)) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
            if mixed or (miss.min() < FAR and not self.keeps_both):
                i, j = pairs[int(np.argmin(miss))]
                halves = own[i : j + 1], own[j:] + own[: i + 1]
                return [piece for half in halves for piece in self._separate(half, loop)]
        sign = np.sign(side.sum()) or self._find_sides(self.points[loop[own], :2].mean(axis=0)[None])[0]
        return [own] if sign > 0 else []

    def _finish(self, pieces: _Pieces, weights: scipy.sparse.csr_array) -> CutMesh:
        """Leave out nodes that no cell has, and find the outline along the line."""
        blocks = pieces.cells()
        if not blocks:
            raise MeshError(
                f"nothing is left {self.keep} of the line", "it is narrower than an element: refine the blank"
            )
        n_parts, _ = find_parts([cells.connectivity for cells in blocks], len(self.points))
        used = np.zeros(len(self.points), dtype=bool)
        for cells in blocks:
            used[cells.connectivity] = True
        n_parts -= int((~used).sum())
        if n_parts > 1:
            raise MeshError(f"the line leaves {n_parts} parts", "draw a line that leaves one")
        number = (np.cumsum(used) - 1).astype(np.int32)
        blocks = tuple(CutCells(number[c.connectivity], c.parent, c.natural) for c in blocks)
        boundary = find_boundary_edges([cells.connectivity for cells in blocks])
        edges = select_edges(boundary, np.flatnonzero(self.side[used] == 0).astype(np.int32))
        miss = self._measure_miss(self.points[used][edges])
        return CutMesh(weights[np.flatnonzero(used)], blocks, edges, miss)

    def _measure_miss(self, edges: FloatArray) -> float:
        """Return how far the line, where it runs in the sheet, is from edges (n, 2, 3) at most [mm]."""
        narrow = "a part of the line is narrower than an element", "refine the blank, or leave that part out"
        if not len(edges):
            raise MeshError(*narrow)
        size = float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).mean())
        samples = sample_sides(self.sides, 0.25 * size)
        samples = samples[contains(self.outline, samples)]
        distance = measure_distance(edges[..., :2], samples)
        worst = int(np.argmax(distance))
        if distance[worst] > size:
            x, y = samples[worst]
            raise MeshError(f"{narrow[0]}, at ({x:.4g}, {y:.4g}) mm", narrow[1])
        return float(distance[worst])


class _Pieces:
    """The part that is kept, cell by cell."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[IntArray, IntArray, FloatArray]]] = {"quad4": [], "tri3": []}

    def add_whole(self, block: int, cells: IntArray, numbers: NDArray[np.intp], natural: FloatArray) -> None:
        """Keep cells of a block as they are."""
        parent = np.column_stack([np.full(len(numbers), block), numbers]).astype(np.int32)
        places = np.broadcast_to(natural, (len(numbers), *natural.shape))
        self._rows[find_cell(2, cells).name].append((cells[numbers], parent, places))

    def add_parts(self, block: int, cell: int, loop: list[int], places: FloatArray, parts: list[Loop]) -> None:
        """Keep parts of a cell, each some corners of a loop."""
        for part in parts:
            own = list(part)
            row = (np.array([[loop[k] for k in own]], np.int32), np.array([[block, cell]], np.int32), places[own][None])
            self._rows[find_cell(2, row[0]).name].append(row)

    def cells(self) -> tuple[CutCells, ...]:
        """Return the cells of each kind, in the order of their parents."""
        found = []
        for rows in self._rows.values():
            if sum(len(cells) for cells, _, _ in rows) == 0:
                continue
            connectivity = np.concatenate([row[0] for row in rows]).astype(np.int32)
            parent = np.concatenate([row[1] for row in rows])
            natural = np.concatenate([row[2] for row in rows])
            order = np.lexsort((parent[:, 1], parent[:, 0]))
            found.append(CutCells(connectivity[order], parent[order], natural[order]))
        return tuple(found)


def _insert(
    nodes: IntArray, natural: FloatArray, at: dict[tuple[int, int], tuple[int, float]]
) -> tuple[list[int], FloatArray]:
    """Return a cell's nodes with those new on its edges, and their natural coordinates.

    at: by edge the new node, and its place as a share of the edge.
    """
    loop: list[int] = []
    places: list[FloatArray] = []
    for i, node in enumerate(nodes.tolist()):
        j = (i + 1) % len(nodes)
        loop.append(node)
        places.append(natural[i])
        found = at.get((node, int(nodes[j])))
        if found is not None:
            loop.append(found[0])
            places.append((1 - found[1]) * natural[i] + found[1] * natural[j])
    return loop, np.array(places)
