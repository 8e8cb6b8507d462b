# SPDX-License-Identifier: Apache-2.0
"""Find where the triangles of a surface pass through each other, or lie on each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray

CHUNK = 1_000_000
"""Pairs of triangles that are looked at together."""
INSIDE = 1e-6
"""Margin over the size of edges and triangles: what lies nearer to their ends and sides touches only."""


@dataclass(frozen=True)
class CrossingFacets:
    """Two triangles that meet where they should not."""

    first: int
    second: int
    place: FloatArray
    """Where (3,) [mm]."""


def find_crossing_facets(points: FloatArray, triangles: IntArray) -> CrossingFacets | None:
    """Return the first two triangles (n, 3) without a common point that cross, or lie on each other in part."""
    for pairs in _list_near_pairs(points, triangles):
        first, second = points[triangles[pairs[:, 0]]], points[triangles[pairs[:, 1]]]
        found = []
        for a, b in ((first, second), (second, first)):
            for k in range(3):
                hit, place = _pierce(a[:, k], a[:, (k + 1) % 3], b)
                found += [(int(pair), place[pair]) for pair in np.flatnonzero(hit)[:1]]
            meets, place = _find_on_triangle(a, b)
            found += [(int(pair), place[pair]) for pair in np.flatnonzero(meets)[:1]]
        if found:
            pair, place = min(found, key=lambda one: one[0])
            return CrossingFacets(int(pairs[pair, 0]), int(pairs[pair, 1]), place)
    return None


def _list_near_pairs(points: FloatArray, triangles: IntArray) -> Iterator[IntArray]:
    """Yield pairs (n, 2) of triangles whose boxes overlap and that share no point."""
    corners = points[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    sweep = int(np.ptp(points, axis=0).argmax())
    order = np.argsort(low[:, sweep], kind="stable")
    ends = np.searchsorted(low[order, sweep], high[order, sweep], side="right")
    counts = np.maximum(ends - np.arange(len(order)) - 1, 0)
    start = 0
    while start < len(order):
        stop = max(start + 1, int(np.searchsorted(np.cumsum(counts[start:]), CHUNK)) + start)
        own = np.repeat(np.arange(start, stop), counts[start:stop])
        first = np.concatenate([[0], np.cumsum(counts[start:stop])[:-1]])
        other = own + 1 + np.arange(len(own)) - np.repeat(first, counts[start:stop])
        pairs = np.column_stack([order[own], order[other]])
        a, b = pairs.T
        pairs = pairs[((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)]
        shares = (triangles[pairs[:, 0]][:, :, None] == triangles[pairs[:, 1]][:, None, :]).any(axis=(1, 2))
        yield pairs[~shares]
        start = stop


def _pierce(start: FloatArray, end: FloatArray, triangle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return which lines from start to end (n, 3) pass through triangles (n, 3, 3), and where (Moeller & Trumbore)."""
    one, two, along = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0], end - start
    across = np.cross(along, two)
    volume = np.einsum("ni,ni->n", one, across)
    size = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1) * np.linalg.norm(along, axis=1)
    flat = np.abs(volume) <= 1e-9 * size
    scale = 1.0 / np.where(flat, 1.0, volume)
    off = start - triangle[:, 0]
    turned = np.cross(off, one)
    u, v, t = (scale * np.einsum("ni,ni->n", p, q) for p, q in ((off, across), (along, turned), (two, turned)))
    inside = (u > INSIDE) & (v > INSIDE) & (u + v < 1.0 - INSIDE) & (t > INSIDE) & (t < 1.0 - INSIDE)
    return inside & ~flat, start + t[:, None] * along


def _find_on_triangle(own: FloatArray, triangle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return which triangles (n, 3, 3) lie in the plane of others with their middles on them, and where."""
    one, two = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    normal = np.cross(one, two)
    area = np.linalg.norm(normal, axis=1)
    length = np.sqrt(area)
    height = np.einsum("nki,ni->nk", own - triangle[:, :1], normal / area[:, None])
    middle = own.mean(axis=1)
    off = middle - triangle[:, 0]
    u = np.einsum("ni,ni->n", np.cross(off, two), normal) / area**2
    v = np.einsum("ni,ni->n", np.cross(one, off), normal) / area**2
    inside = (u > INSIDE) & (v > INSIDE) & (u + v < 1.0 - INSIDE)
    return (np.abs(height).max(axis=1) <= 1e-7 * length) & inside, middle
