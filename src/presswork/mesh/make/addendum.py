# SPDX-License-Identifier: Apache-2.0
"""A level flange round a part that ends at its trim edge, for a holder to press on."""

from __future__ import annotations

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IntArray

_LEVEL = 2e-3
"""Rise of an outline, over the part's size, that still counts as level."""
ON_PLANE = 1e-4
"""Distance from a symmetry plane, over the part's size, at which a node lies on it."""
_SHARPEST = 0.35
"""Least cosine of half the turn at a corner of the outline: beyond, its flange would be a spike."""


def widen(points: FloatArray, rim: IntArray, width: float, symmetry: tuple[bool, bool]) -> tuple[FloatArray, IntArray]:
    """Return the points with those of a flange behind them, and the flange's quadrilaterals (n, 4).

    points (n_points, 3) [mm], z up; rim: the outline in order, the part on its left seen from above. The flange goes
    out level by the width [mm], in rows as wide as the rim's edges are long; none is added along symmetry planes
    x = 0 | y = 0. Raises MeshError for an outline that is not level, or so hollow that the flange would overlap itself.
    """
    size = float(np.ptp(points, axis=0).max())
    low, high = float(points[rim, 2].min()), float(points[rim, 2].max())
    if high - low > _LEVEL * size:
        raise MeshError(
            f"the part's outline rises from z = {low:.4g} to {high:.4g}: an addendum is a level flange",
            "leave the addendum out, and draw the binder to the part in CAD",
        )
    on_plane = np.array([wanted & (np.abs(points[rim, i]) < ON_PLANE * size) for i, wanted in enumerate(symmetry)])
    is_cut = (on_plane & np.roll(on_plane, -1, axis=1)).any(axis=0)
    out, length = _directions(points[rim, :2], is_cut, on_plane)
    rows = max(1, round(width / float(np.median(length[~is_cut]))))
    used = ~is_cut | ~np.roll(is_cut, 1)
    number = np.full((rows + 1, len(rim)), -1)
    number[0] = rim
    number[1:, used] = len(points) + np.arange(rows * int(used.sum())).reshape(rows, -1)
    reach = width * np.arange(1, rows + 1)[:, None, None] / rows
    flange = np.empty((rows, int(used.sum()), 3))
    flange[:, :, :2] = points[rim[used], :2] + reach * out[used]
    flange[:, :, 2] = points[rim[used], 2]
    after = np.roll(number, -1, axis=1)
    quads = np.stack([number[:-1], number[1:], after[1:], after[:-1]], axis=-1)[:, ~is_cut].reshape(-1, 4)
    wide = np.concatenate([points, flange.reshape(-1, 3)])
    _check_overlap(wide, quads)
    return wide, quads.astype(np.int32)


def _directions(loop: FloatArray, is_cut: BoolArray, on_plane: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return the outward direction at corners (n, 2), longer where the outline turns, and the edges' lengths (n,)."""
    edge = np.roll(loop, -1, axis=0) - loop
    length = np.linalg.norm(edge, axis=1)
    normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / length[:, None]
    normal[is_cut] = 0.0
    before = np.roll(normal, 1, axis=0)
    out = normal + before
    out[on_plane.T] = 0.0
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-300)
    beside = np.where(np.roll(is_cut, 1)[:, None], normal, before)
    cosine = (out * beside).sum(axis=1)
    return np.asarray(out / np.maximum(cosine, _SHARPEST)[:, None]), length


def _check_overlap(points: FloatArray, quads: IntArray) -> None:
    a, b, c, d = (points[quads[:, k], :2] for k in range(4))
    corners = [_cross(b - a, d - a), _cross(c - b, a - b), _cross(d - c, b - c), _cross(a - d, c - d)]
    folded = np.min(corners, axis=0) <= 0.0
    if folded.any():
        x, y, z = points[quads[np.argmax(folded)]].mean(axis=0)
        raise MeshError(
            f"the addendum overlaps itself near ({x:.4g}, {y:.4g}, {z:.4g}), where the outline is hollow",
            "make it narrower, or draw the binder to the part in CAD",
        )


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
