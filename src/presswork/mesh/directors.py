# SPDX-License-Identifier: Apache-2.0
"""Directors of a shell: the unit normals that its nodes carry.

Where a sheet is smooth all cells round a node share one director, the mean of their normals, and the node's rotation
about it, the drilling, means nothing. Where cells meet at more than FOLD, at an edge or a junction, each group of cells
has a director of its own, all of them turn together, and the rotation has three parts. Cells wound in the opposite
sense have the opposite director, so winding need not be uniform.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, CellBlock, FloatArray, IntArray, find_cell

FOLD = np.radians(40.0)
"""Angle between the normals of two cells at a node above which the sheet is folded there."""

PARALLEL = np.radians(1.0)
"""Angle between the lines of a node's directors below which turning about them means nothing to any of its cells."""
WARPED = np.radians(60.0)
"""Angle of a cell's normal at a node from its mean normal beyond which the cell is useless."""


@dataclass(frozen=True)
class Directors:
    """Directors of a mesh of shells."""

    vectors: FloatArray
    """Unit vectors (n_directors, 3)."""
    node: IntArray
    """Node that turns each of them (n_directors,)."""
    of_cell: list[IntArray]
    """Index into vectors of every node of every cell, per block (n_cells, n_nodes)."""
    smooth: BoolArray
    """Nodes without drilling (n_points,)."""


def cell_normals(points: FloatArray, connectivity: IntArray, slopes: FloatArray) -> FloatArray:
    """Return the normals of cells at their nodes (n_cells, n_nodes, 3), not of unit length.

    slopes: derivatives of the shape functions at the nodes (n_nodes, n_nodes, 2). At the corners of linear cells
    a normal is weighted by 1/(|e|^2 |f|^2), e and f the edges there, with which the mean over the cells round a point
    of a sphere is exact (Max 1999).
    Raises MeshError for a cell that has no normal, or is folded or warped.
    """
    x = points[connectivity]
    tangents = np.einsum("naj,cai->cnji", slopes, x)
    normals: FloatArray = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    size = np.linalg.norm(normals, axis=2)
    longest = (tangents**2).sum(axis=3).max(axis=(1, 2))
    flat = np.flatnonzero((size < 1e-6 * longest[:, None]).any(axis=1))
    if len(flat):
        x, y, z = points[connectivity[flat[0]]].mean(axis=0)
        raise MeshError(
            f"{len(flat)} cells have no area at a corner, the first near ({x:.6g}, {y:.6g}, {z:.6g}): they have "
            "no director there",
            "mend these cells in the mesher",
        )
    unit = normals / size[..., None]
    mean = unit.mean(axis=1, keepdims=True)
    worst = (unit * mean).sum(axis=2).min(axis=1) / np.maximum(np.linalg.norm(mean[:, 0], axis=1), 1e-300)
    folded = np.flatnonzero(worst < np.cos(WARPED))
    if len(folded):
        x, y, z = points[connectivity[folded[0]]].mean(axis=0)
        raise MeshError(
            f"{len(folded)} cells are folded or warped beyond use, the first near ({x:.6g}, {y:.6g}, {z:.6g}): their "
            f"normals differ by more than {np.degrees(WARPED):.0f} degrees from their mean",
            "mend these cells in the mesher; all must be convex, and nearly flat",
        )
    weight = (tangents**2).sum(axis=3).prod(axis=2) if not find_cell(2, connectivity).is_quadratic else size
    weighted: FloatArray = normals / weight[..., None]
    return weighted


def find_directors(
    points: FloatArray,
    blocks: Sequence[CellBlock],
    slopes: Sequence[FloatArray],
    normals: FloatArray | None = None,
) -> Directors:
    """Find the directors of all nodes.

    slopes: of each block's shape functions at its nodes, see cell_normals. normals: exact unit normals at the nodes
    (n_points, 3), where they are known; they replace the means where the sheet is smooth.
    Raises MeshError for cells that have no normal, and for nodes where no director can be defined.
    """
    found = [cell_normals(points, b.connectivity, s).reshape(-1, 3) for b, s in zip(blocks, slopes, strict=True)]
    weighted = np.concatenate(found)
    node = np.concatenate([b.connectivity.ravel() for b in blocks])
    unit = weighted / np.linalg.norm(weighted, axis=1, keepdims=True)
    neighbours = np.concatenate([_ring_neighbours(b.connectivity).reshape(-1, 2) for b in blocks])
    mean, is_used, plain = _find_means(len(points), node, weighted, unit, neighbours)
    vectors = [mean[plain]]
    owner = [np.flatnonzero(plain)]
    index = np.full(len(node), -1)
    place = np.cumsum(plain) - 1
    index[plain[node]] = place[node[plain[node]]]
    smooth = plain | ~is_used
    count = int(plain.sum())
    order = np.argsort(node, kind="stable")
    starts = np.searchsorted(node[order], np.arange(len(points) + 1))
    for folded in np.flatnonzero(~plain & (np.diff(starts) > 0)):
        entries = order[starts[folded] : starts[folded + 1]]
        group, sign = _group(unit[entries], neighbours[entries])
        directions = []
        for g in range(group.max() + 1):
            own = group == g
            direction = (sign[own, None] * weighted[entries[own]]).sum(axis=0)
            direction /= np.linalg.norm(direction)
            directions.append(direction)
            for side in np.unique(sign[own]):
                vectors.append((side * direction)[None])
                owner.append(np.array([folded]))
                index[entries[own & (sign == side)]] = count
                count += 1
        smooth[folded] = (np.abs(np.array(directions) @ directions[0]) > np.cos(PARALLEL)).all()
    result = np.concatenate(vectors)
    nodes = np.concatenate(owner)
    _check_defined(points, node, (result[index] * unit).sum(axis=1))
    if normals is not None:
        exact = normals[nodes] * np.sign((normals[nodes] * result).sum(axis=1))[:, None]
        result = np.where(smooth[nodes][:, None], exact, result)
    ends = np.cumsum([b.connectivity.size for b in blocks])[:-1]
    of_cell = [
        np.ascontiguousarray(part.reshape(b.connectivity.shape), dtype=np.int32)
        for part, b in zip(np.split(index, ends), blocks, strict=True)
    ]
    return Directors(np.ascontiguousarray(result), nodes.astype(np.int32), of_cell, smooth)


def _find_means(
    n_points: int, node: IntArray, weighted: FloatArray, unit: FloatArray, neighbours: IntArray
) -> tuple[FloatArray, BoolArray, BoolArray]:
    """Return the mean normal at each point (n_points, 3), which points cells use, and where all normals are near it."""
    total = np.zeros((n_points, 3))
    np.add.at(total, node, weighted)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    mean = total / np.where(length > 0, length, 1.0)
    apart = (unit * mean[node]).sum(axis=1) < np.cos(0.5 * FOLD)
    plain = np.ones(n_points, dtype=bool)
    plain[node[apart]] = False
    plain[_nodes_of_turned_cells(node, neighbours[:, 1])] = False
    is_used = length[:, 0] > 0
    return mean, is_used, plain & is_used


def _check_defined(points: FloatArray, node: IntArray, cosine: FloatArray) -> None:
    """Refuse a director far off the normals of its own cells: at the tip of a spike they leave no direction between.

    cosine: of the angle between every cell's normal at each of its nodes and its director there.
    """
    lost = np.unique(node[~(cosine > np.cos(WARPED))])
    if len(lost):
        x, y, z = points[lost[0]]
        raise MeshError(
            f"no director can be defined at {len(lost)} nodes, the first at ({x:.6g}, {y:.6g}, {z:.6g}): cells meet "
            f"there in a tip, and their normals lie more than {np.degrees(WARPED):.0f} degrees off their mean",
            "cut the tip off, or round it with smaller cells",
        )


def _ring_neighbours(connectivity: IntArray) -> IntArray:
    """Return the nodes before and after each node along its cell's boundary (n_cells, n_nodes, 2); -1 at a centre."""
    ring = find_cell(2, connectivity).ring
    neighbours = np.full((*connectivity.shape, 2), -1, dtype=np.int32)
    for place, node in enumerate(ring):
        neighbours[:, node, 0] = connectivity[:, ring[place - 1]]
        neighbours[:, node, 1] = connectivity[:, ring[(place + 1) % len(ring)]]
    return neighbours


def _nodes_of_turned_cells(node: IntArray, after: IntArray) -> IntArray:
    """Return the nodes of edges that two cells run through in the same direction: one is wound in reverse."""
    on_ring = after >= 0
    keys = (node[on_ring].astype(np.int64) << 32) | after[on_ring]
    found, count = np.unique(keys, return_counts=True)
    twice = found[count > 1]
    return np.concatenate([twice >> 32, twice & 0xFFFFFFFF]).astype(np.int32)


def _group(normals: FloatArray, neighbours: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the group of each cell at a node, and whether its normal is that of the group (1) or opposite (-1).

    Cells belong together that share an edge there, with normals, taken in the same sense, at most FOLD apart.
    """
    before, after = neighbours.T
    turned = (after[:, None] == after) & (after[:, None] >= 0) | (before[:, None] == before) & (before[:, None] >= 0)
    facing = (after[:, None] == before) & (after[:, None] >= 0) | (before[:, None] == after) & (before[:, None] >= 0)
    cosine = normals @ normals.T
    linked = np.where(facing & (cosine >= np.cos(FOLD)), 1.0, 0.0)
    linked -= np.where(turned & (-cosine >= np.cos(FOLD)), 1.0, 0.0)
    np.fill_diagonal(linked, 1.0)
    group, sign = np.full(len(normals), -1, dtype=np.int32), np.ones(len(normals))
    count = 0
    for start in range(len(normals)):
        if group[start] >= 0:
            continue
        queue = [start]
        group[start] = count
        while queue:
            here = queue.pop()
            for other in np.flatnonzero(linked[here]):
                if group[other] < 0:
                    group[other], sign[other] = count, sign[here] * linked[here, other]
                    queue.append(int(other))
        count += 1
    return group, sign
