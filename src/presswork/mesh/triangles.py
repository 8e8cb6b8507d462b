# SPDX-License-Identifier: Apache-2.0
"""Triangles in space: merged, mended, wound alike; their edges, parts and rims.

Triangles have shape (n, 3) over points (n_points, 3); seen from free space their corners run counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from presswork.mesh.topology import chain_edges, edge_keys, find_boundary_edges, list_cell_edges
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, find_cell


def split_quads(points: FloatArray, cells: IntArray) -> IntArray:
    """Return two triangles for each quadrilateral (n, 4), cut along its shorter diagonal; triangles as they are."""
    if find_cell(2, cells).is_simplex:
        return cells
    a, b, c, d = cells.T
    other = np.linalg.norm(points[b] - points[d], axis=1) < np.linalg.norm(points[a] - points[c], axis=1)
    first = np.where(other, (a, b, d), (a, b, c))
    second = np.where(other, (b, c, d), (a, c, d))
    return np.stack([first.T, second.T], axis=1).reshape(-1, 3).astype(np.int32)


def merge_points(points: FloatArray, cells: IntArray, tolerance: float) -> tuple[FloatArray, IntArray]:
    """Return points of which no two lie within the tolerance, and the cells over them."""
    distinct, number = np.unique(points, axis=0, return_inverse=True)
    pairs = scipy.spatial.cKDTree(distinct).query_pairs(tolerance, output_type="ndarray")
    n = len(distinct)
    graph = scipy.sparse.coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    n_groups, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
    first = np.full(n_groups, n)
    np.minimum.at(first, group, np.arange(n))
    return distinct[first], group[number.reshape(-1)[cells]].astype(np.int32)


def double_areas(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the triangles' normals times twice their area (n, 3) [mm^2]."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a), dtype=float)


def triangle_quality(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return 4 sqrt(3) area over the sum of the squared sides (n,): 1 with equal sides, 0 without area."""
    corners = points[triangles]
    squares = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    sizes = np.linalg.norm(double_areas(points, triangles), axis=1)
    return np.asarray(2.0 * np.sqrt(3.0) * sizes / np.maximum(squares, 1e-300))


def find_flat(points: FloatArray, triangles: IntArray, tolerance: float) -> BoolArray:
    """Return which triangles have no area: less high over their longest side than the tolerance [mm]."""
    corners = points[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    flat: BoolArray = np.linalg.norm(double_areas(points, triangles), axis=1) <= tolerance * longest
    return flat


def distance_to_segments(x: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the distance of each point from its segment a b; all (n, 3) [mm]."""
    along = b - a
    share = ((x - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
    return np.asarray(np.linalg.norm(x - a - np.clip(share, 0.0, 1.0)[:, None] * along, axis=1))


def distance_to_triangles(x: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return the distance of each point from its triangle; all (n, 3) [mm]."""
    normal = np.cross(b - a, c - a)
    size = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    inside = np.ones(len(x), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(end - start, x - start) * normal).sum(axis=1) >= 0.0
    to_plane = np.abs(((x - a) * normal).sum(axis=1)) / size
    to_sides = np.min([distance_to_segments(x, *side) for side in ((a, b), (b, c), (c, a))], axis=0)
    return np.asarray(np.where(inside, to_plane, to_sides))


def flip_caps(points: FloatArray, triangles: IntArray, tolerance: float) -> IntArray:
    """Do away with triangles whose three corners lie in line, without leaving a seam, as far as that goes.

    Such a triangle a b c, b between the others, and its neighbour c a d become a b d and b c d.
    """
    triangles = triangles.copy()
    for _ in range(10):
        flat = np.flatnonzero(find_flat(points, triangles, tolerance))
        owners: dict[int, list[int]] = {}
        keys = edge_keys(list_cell_edges(triangles)).reshape(-1, 3)
        for t, row in enumerate(keys.tolist() if len(flat) else []):
            for key in row:
                owners.setdefault(key, []).append(t)
        changed: set[int] = set()
        for t in flat.tolist():
            sides = points[np.roll(triangles[t], -1)] - points[triangles[t]]
            k = int(np.argmax((sides**2).sum(axis=1)))  # the longest side, from corner k
            beside = [o for o in owners[keys[t, k]] if o != t]
            if len(beside) != 1 or t in changed or beside[0] in changed:
                continue
            a, c, b = triangles[t, k], triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
            other = triangles[beside[0]]
            i = int(np.flatnonzero(~np.isin(other, (a, c)))[0])
            d, after = other[i], other[(i + 1) % 3]
            first, last = (a, c) if after == a else (c, a)
            triangles[beside[0]], triangles[t] = (d, first, b), (d, b, last)
            changed |= {t, beside[0]}
        if not changed:
            break
    return triangles


@dataclass(frozen=True)
class Edges:
    """Edges between two triangles each."""

    triangles: IndexArray
    """(n, 2)"""
    against: BoolArray
    """(n,): the two are wound against each other."""


def find_crowded_edges(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Return the edges (n, 2) with more than two triangles, and how many those have (n,)."""
    edges = list_cell_edges(triangles)
    _, index, count = np.unique(edge_keys(edges), return_index=True, return_counts=True)
    return edges[index[count > 2]], count[count > 2].astype(np.int32)


def pair_triangles(triangles: IntArray) -> Edges:
    """Return the inner edges of triangles no edge of which has more than two."""
    edges = list_cell_edges(triangles)
    keys = edge_keys(edges)
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    one, other = order[same], order[same + 1]
    return Edges(np.column_stack([one // 3, other // 3]), np.asarray(edges[one, 0] == edges[other, 0], dtype=bool))


def find_triangle_parts(n: int, edges: Edges) -> tuple[int, IntArray]:
    """Return the number of parts that share no edge, and the part of each of n triangles."""
    first, second = edges.triangles.T
    graph = scipy.sparse.coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(n, n))
    n_parts, part = scipy.sparse.csgraph.connected_components(graph, directed=False)
    return int(n_parts), part.astype(np.int32)


def find_turned(n: int, edges: Edges, part: IntArray) -> tuple[BoolArray, BoolArray]:
    """Return masks of triangles wound against most of their part (n,), and of edges that no winding suits (n_edges,).

    The winding spreads from triangle to triangle over the edges; a part that has edges left cannot have two sides.
    """
    low, high = np.sort(edges.triangles.astype(np.int64), axis=1).T
    keys, index = np.unique(low * n + high, return_index=True)  # two triangles may share two edges
    graph = scipy.sparse.coo_array((np.ones(len(keys), dtype=np.int8), (low[index], high[index])), shape=(n, n)).tocsr()
    sign = np.zeros(n, dtype=np.int8)
    for start in np.unique(part, return_index=True)[1]:
        order, before = scipy.sparse.csgraph.breadth_first_order(graph, start, directed=False)
        sign[start] = 1
        here, came = order[1:].astype(np.int64), before[order[1:]].astype(np.int64)
        at = np.searchsorted(keys, np.minimum(here, came) * n + np.maximum(here, came))
        turns = np.where(edges.against[index[at]], -1, 1)
        for t, last, turn in zip(here.tolist(), came.tolist(), turns.tolist(), strict=True):
            sign[t] = sign[last] * turn
    votes = np.bincount(part, weights=sign)
    turned: BoolArray = sign * np.where(votes < 0.0, -1, 1)[part] < 0
    bad: BoolArray = (turned[low] ^ turned[high]) != edges.against
    return turned, bad


def enclosed_volumes(points: FloatArray, triangles: IntArray, part: IntArray) -> FloatArray:
    """Return the volume that the triangles of each part enclose, positive with normals outwards [mm^3]."""
    middle = points.mean(axis=0)
    a, b, c = (points[triangles[:, k]] - middle for k in range(3))
    return np.asarray(np.bincount(part, weights=(a * np.cross(b, c)).sum(axis=1)) / 6.0, dtype=float)


def find_rims(points: FloatArray, triangles: IntArray) -> list[IntArray]:
    """Return the loops of open edges, each as its points in order."""
    chained = chain_edges(find_boundary_edges([triangles]), points)
    breaks = np.flatnonzero(chained[1:, 0] != chained[:-1, 1]) + 1
    return [loop[:, 0] for loop in np.split(chained, breaks) if len(loop)]


def separate_parts(points: FloatArray, triangles: IntArray, part: IntArray) -> tuple[FloatArray, IntArray]:
    """Return points of which none belongs to two parts, and the triangles over them."""
    keys: NDArray[np.int64] = triangles.astype(np.int64) + len(points) * part[:, None].astype(np.int64)
    kept, number = np.unique(keys, return_inverse=True)
    return points[kept % len(points)], number.reshape(-1, 3).astype(np.int32)
