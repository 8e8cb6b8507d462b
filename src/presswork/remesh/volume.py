# SPDX-License-Identifier: Apache-2.0
"""The volume inside a boundary line, and the offset of its free nodes that gives it back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray

LARGEST_OFFSET = 0.25
"""Largest offset that gives the volume back, over the mean free edge."""
_ROUNDS = 8


def enclosed_volume(line: FloatArray, *, ring: bool) -> float:
    """Return the area within a closed line (n, 2) [mm2], or the volume that it encloses about x = 0 [mm3]."""
    after = np.roll(line, -1, axis=0)
    rise = after[:, 1] - line[:, 1]
    if ring:
        square = line[:, 0] ** 2 + line[:, 0] * after[:, 0] + after[:, 0] ** 2
        return float(np.pi / 3.0 * (square * rise).sum())
    return float(0.5 * ((line[:, 0] + after[:, 0]) * rise).sum())


def restore_volume(
    points: FloatArray, is_free: BoolArray, target: float, profiles: Sequence[FloatArray], *, ring: bool
) -> tuple[FloatArray, BoolArray, float]:
    """Return nodes (n, 2), which are free (n,) and the offset [mm] with which the line encloses a target volume.

    Free nodes move by the offset along their normals; those that would end in tools are put onto them. Raises MeshError
    where the offset exceeds LARGEST_OFFSET.
    """
    points, is_free, total = points.copy(), is_free.copy(), 0.0
    for _ in range(_ROUNDS):
        is_free &= ~put_on_tools(points, is_free, profiles)
        if not is_free.any() or abs(enclosed_volume(points, ring=ring) / target - 1.0) < 1e-12:
            break
        offset = _find_offset(points, is_free, target, ring=ring)
        points += offset * _normals(points) * is_free[:, None]
        total += offset
    edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    own = is_free & np.roll(is_free, -1)
    if own.any() and abs(total) > LARGEST_OFFSET * float(edges[own].mean()):
        raise MeshError(
            f"an offset of {total:.3g} mm of the free surface would be needed to keep the volume", "smaller cells"
        )
    return points, is_free, total


def put_on_tools(points: FloatArray, is_free: BoolArray, profiles: Sequence[FloatArray]) -> BoolArray:
    """Put free points that lie inside tools onto them, in place; return which."""
    inside = np.zeros(len(points), dtype=bool)
    for profile in profiles:
        gap, normal, *_ = _core.touch_profile(np.ascontiguousarray(profile), np.ascontiguousarray(points))
        own = is_free & (gap < 0.0) & ~inside
        points[own] -= gap[own, None] * normal[own]
        inside |= own
    return inside


def _normals(line: FloatArray) -> FloatArray:
    """Return unit normals outwards (n, 2)."""
    along: FloatArray = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    return np.asarray(np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True))


def _find_offset(points: FloatArray, is_free: BoolArray, target: float, *, ring: bool) -> float:
    """Return the offset of the free nodes with which the line encloses the volume asked for [mm]."""
    normals = _normals(points) * is_free[:, None]

    def lack(offset: float) -> float:
        return enclosed_volume(points + offset * normals, ring=ring) - target

    size = float(np.ptp(points, axis=0).max())
    a, b = 0.0, 1e-6 * size
    fa, fb = lack(a), lack(b)
    for _ in range(20):
        if fb == fa or abs(fb) < 1e-14 * abs(target):
            break
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = lack(b)
    return b if abs(fb) < abs(fa) else a
