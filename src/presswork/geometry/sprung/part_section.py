# SPDX-License-Identifier: Apache-2.0
"""The line along which an upright plane cuts a sheet, as places of the material, and places below a point of the plan.

A place of the material is two or three nodes with weights, so that it is found again after the sheet has moved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray


@dataclass(frozen=True)
class Places:
    """Places of the material (n,)."""

    nodes: IntArray
    """(n, k)."""
    weight: FloatArray
    """(n, k); they sum to 1."""

    def take(self, values: FloatArray) -> FloatArray:
        """Return nodal values (n_points, m) there (n, m)."""
        return np.asarray(np.einsum("nk,nkm->nm", self.weight, values[self.nodes]))


def cut_part(
    points: FloatArray, cells: IntArray, start: tuple[float, float], angle: float, length: float = np.inf
) -> list[Places]:
    """Cut a sheet by the upright plane through `start` (x, y) [mm] at an angle from x [rad].

    points (n_points, 3) [mm]; cells (n, 4), of triangles the last node twice. Returns lines of places, each in the
    order of its distance from the start, the line that begins first coming first. length: of the section from its start
    on [mm]; infinite: the plane has no end on either side.
    """
    out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    off = (points[:, :2] - start) @ across
    off = np.where(off == 0.0, 1e-9 * max(float(np.ptp(points, axis=0).max()), 1e-300), off)
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1)
    crossed = off[sides[..., 0]] * off[sides[..., 1]] < 0.0
    cut = sides[crossed.sum(axis=1) == 2][crossed[crossed.sum(axis=1) == 2]].reshape(-1, 2)
    if not len(cut):
        return []
    keys, number = np.unique(np.sort(cut, axis=1), axis=0, return_inverse=True)
    part = off[keys[:, 0]] / (off[keys[:, 0]] - off[keys[:, 1]])
    whole = Places(keys.astype(np.int32), np.column_stack([1.0 - part, part]))
    along = (whole.take(points)[:, :2] - start) @ out
    lines = []
    for chain in _chain(number.astype(np.int32).reshape(-1, 2), along):
        inside = np.isfinite(along[chain]) & ((along[chain] >= 0.0) & (along[chain] <= length) | np.isinf(length))
        ends = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
        for first, last in ends.reshape(-1, 2):
            if last - first > 1:
                own = chain[first:last]
                lines.append(Places(whole.nodes[own], whole.weight[own]))
    return sorted(lines, key=lambda line: float(((line.take(points)[:, :2] - start) @ out).min()))


def _chain(pieces: IntArray, along: FloatArray) -> list[IntArray]:
    """Return chains of the ends of pieces (n, 2); a chain runs from its end with the smaller distance."""
    beside: dict[int, list[int]] = {}
    for a, b in pieces.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    left, chains = set(beside), []
    for begin in sorted(beside, key=lambda end: (len(beside[end]) != 1, along[end])):  # rings have no end
        if begin not in left:
            continue
        chain, at = [begin], begin
        left.discard(begin)
        while (following := next((each for each in beside[at] if each in left), None)) is not None:
            chain.append(following)
            left.discard(following)
            at = following
        chains.append(np.array(chain if along[chain[0]] <= along[chain[-1]] else chain[::-1]))
    return chains


def find_below(points: FloatArray, triangles: IntArray, x: float, y: float) -> Places | None:
    """Return the uppermost place (1,) of a sheet of triangles (n, 3) at a point of the plan; None off it."""
    a, b, c = points[triangles][:, :, :2].swapaxes(0, 1)
    p = np.array([x, y])
    double = _cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = np.stack([_cross(b - p, c - p), _cross(c - p, a - p), _cross(a - p, b - p)], axis=1) / double[:, None]
        inside = np.isfinite(weight).all(axis=1) & (weight >= -1e-9).all(axis=1)
    if not inside.any():
        return None
    found = np.flatnonzero(inside)
    height = np.einsum("nk,nk->n", weight[found], points[triangles[found]][:, :, 2])
    best = found[np.argmax(height)]
    return Places(triangles[[best]], weight[[best]])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
