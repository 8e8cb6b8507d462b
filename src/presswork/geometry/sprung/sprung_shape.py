# SPDX-License-Identifier: Apache-2.0
"""How a released sheet has changed: the turn of a section, the twist of a long part, a part in its gauge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.best_fit import fit_rigidly
from presswork.geometry.sprung.part_section import Places
from presswork.model import FloatArray, IntArray

_ENDS = 0.1
"""Length of each end of a part over which its turn is measured, over the part's length."""
_LONG = 1.2
"""Length over width from which on a part has a long direction."""
_HELD = 1e-4
"""Weight of the whole part's best fit beside that of a clamp."""
_ROUNDS = 20
_NONE = (False, False)


@dataclass(frozen=True)
class Twist:
    """Turn of a part's far end against its near end."""

    angle: float
    """[rad], by the right-hand rule about the axis."""
    length: float
    """Length between the middles of both ends [mm]."""
    axis: FloatArray
    """Unit vector along the part (3,), its largest component positive."""


def measure_turn(formed: FloatArray, free: FloatArray) -> float:
    """Return by how much a section of points (n, 2) has turned [rad], counter-clockwise, by least squares."""
    weight = np.linalg.norm(np.diff(formed, axis=0), axis=1)
    weight = np.concatenate([weight, [0.0]]) + np.concatenate([[0.0], weight])
    before, now = (x - weight @ x / weight.sum() for x in (formed, free))
    sine = weight @ (before[:, 0] * now[:, 1] - before[:, 1] * now[:, 0])
    return float(np.arctan2(sine, weight @ (before * now).sum(axis=1)))


def measure_twist(formed: FloatArray, free: FloatArray, weight: FloatArray) -> Twist | None:
    """Return the twist between both ends of a part (n_points, 3) [mm]; None of one that has no long direction.

    weight: area round each node (n_points,). Each end is a tenth of the length, and turns as a rigid body by least
    squares.
    """
    middle = weight @ formed / weight.sum()
    sizes, axes = np.linalg.eigh(((formed - middle) * weight[:, None]).T @ (formed - middle))
    if sizes[2] < _LONG**2 * sizes[1]:
        return None
    axis = axes[:, 2] * np.sign(axes[np.argmax(np.abs(axes[:, 2])), 2])
    along = (formed - middle) @ axis
    low, high = along.min(), along.max()
    near, far = along <= low + _ENDS * (high - low), along >= high - _ENDS * (high - low)
    if min(near.sum(), far.sum()) < 3:
        return None
    turns = [_find_turn(formed[end], free[end], weight[end]) for end in (near, far)]
    at = [float(weight[end] @ along[end] / weight[end].sum()) for end in (near, far)]
    turn = turns[0].T @ turns[1]  # seen from the part as formed, however it has moved as a whole
    vector = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    size, cosine = np.linalg.norm(vector), float(np.trace(turn)) - 1.0
    angle = float(np.arctan2(size, cosine)) * (vector @ axis) / size if size > 0.0 else 0.0
    return Twist(float(angle), at[1] - at[0], axis)


def _find_turn(start: FloatArray, goal: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) that takes points (n, 3) to their goals by least squares (Kabsch 1976)."""
    before, now = (x - weight @ x / weight.sum() for x in (start, goal))
    u, _, vt = np.linalg.svd((now * weight[:, None]).T @ before)
    return np.asarray((u * [1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt)


def place_in_gauge(
    formed: FloatArray,
    free: FloatArray,
    weight: FloatArray,
    clamps: Places,
    normals: FloatArray,
    planes: tuple[bool, bool] = _NONE,
) -> FloatArray:
    """Return a part (n_points, 3) [mm] in the place that it takes in a gauge, moved as a rigid body.

    formed: its shape in the tools, which is that of the gauge; free: after springback; weight: area round each node;
    clamps: where it is held; normals: of the gauge there (n, 3); planes: symmetry planes x = 0 and y = 0. The clamps'
    distances along the normals are least, for three of them zero. Along the surface the whole part fits best.
    """
    now = fit_rigidly(free, formed, weight, planes)
    fixed = np.zeros(6, dtype=bool)  # shifts, then turns about x, y, z
    for axis in (0, 1):
        if planes[axis]:
            fixed[[axis, 5, 4 - axis]] = True
    goal, share = clamps.take(formed), _HELD * np.sqrt(weight / weight.sum())
    for _ in range(_ROUNDS):
        middle = weight @ now / weight.sum()
        at, off = clamps.take(now), clamps.take(now) - goal
        rows = np.hstack([normals, np.cross(at - middle, normals)])
        whole = np.hstack([np.tile(np.eye(3), (len(now), 1)), _cross_rows(now - middle)]) * np.repeat(share, 3)[:, None]
        left = np.concatenate([(off * normals).sum(axis=1), ((now - formed) * share[:, None]).ravel()])
        step = np.zeros(6)
        step[~fixed] = np.linalg.lstsq(np.vstack([rows, whole])[:, ~fixed], -left, rcond=None)[0]
        now = middle + (now - middle) @ _rotation(step[3:]).T + step[:3]
        if np.abs(step).max() < 1e-12 * max(float(np.ptp(formed)), 1.0):
            break
    return np.asarray(now)


def _cross_rows(arm: FloatArray) -> FloatArray:
    """Return the matrices (3 n, 3) that take a small turn to the movements of points at these arms (n, 3)."""
    x, y, z = arm.T
    zero = np.zeros_like(x)
    return np.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=1).reshape(-1, 3)


def _rotation(vector: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) about a vector by its length [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k)


def normals_at(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the unit normals of triangles (n, 3) of points."""
    a, b, c = points[triangles].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))
