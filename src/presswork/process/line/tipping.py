# SPDX-License-Identifier: Apache-2.0
"""A rigid part sinks and tips until its weight rests on dies.

Where it lies its centre of mass is as low as the dies allow. Around a pose the gaps change linearly with the height of
the centre and with two angles, so each move is the answer of a linear programme within small bounds; rotations are
applied exactly. The part does not slide: its centre stays over the same point of the dies.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog

from presswork import _core
from presswork.geometry.pose import turn_about
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Tool

UP = np.array([0.0, 0.0, 1.0])
Placed = tuple[_core.ToolSurface, FloatArray]
"""A surface and the position of its origin."""
STEEPEST = np.radians(30.0)
"""Angle beyond which a part has fallen off."""
FIRST_MOVE = 0.02
"""Part of the size of the part by which its rim may move at once."""
STICKS = 1e-4
"""Part of its size by which the centre must sink per angle before the part turns."""
LAST_MOVE = 1e-7
MOST_MOVES = 300
NEAR = 3.0
"""Moves within which points count that may touch."""


class TippingError(ValueError):
    """A part that finds no rest on its dies."""


def tip_part(
    points: FloatArray, half: FloatArray, mass: FloatArray, dies: Sequence[Tool], free: tuple[bool, bool]
) -> tuple[FloatArray, FloatArray]:
    """Return rotation (3, 3) and shift (3,) that lay a part on dies: points @ rotation.T + shift.

    points: that may touch (n, 3) [mm]; half: half the thickness there (n,) [mm]; mass: share of each point (n,), in any
    unit, 0 where a point has none; free: whether it may turn about x and y. Raises TippingError.
    """
    surfaces = [(make_surface(die.surface), np.asarray(die.position)) for die in dies]
    centre = mass @ points / mass.sum()
    arms = points - centre
    size = float(np.linalg.norm(arms, axis=1).max())
    rotation, at, move = np.eye(3), centre.copy(), FIRST_MOVE * size
    for _ in range(MOST_MOVES):
        turned = arms @ rotation.T
        gap, slope = _linear_gaps(surfaces, turned, at, half, NEAR * move)
        step = _find_move(gap, slope, move, move / size * np.asarray(free), STICKS * size)
        turn = np.asarray(turn_about(np.array([step[1], step[2], 0.0])))
        after = _least_gap(surfaces, arms @ (turn @ rotation).T, at + step[0] * UP, half)
        before = float(gap.min()) if len(gap) else np.inf
        if after < min(0.0, before) - 0.1 * move:  # curved tools: shorter moves
            move *= 0.5
            continue
        rotation, at = turn @ rotation, at + step[0] * UP
        if np.arccos(np.clip(rotation[2, 2], -1.0, 1.0)) > STEEPEST or centre[2] - at[2] > 10.0 * size:
            raise TippingError("its weight lies beyond what it rests on, so it tips off: support it, or leave tip out")
        went = max(abs(step[0]), size * abs(step[1]), size * abs(step[2]))
        move = 0.5 * move if went < 0.5 * move else min(2.0 * move, FIRST_MOVE * size)
        if move < LAST_MOVE * size:
            return rotation, at - rotation @ centre
    raise TippingError("it finds no rest on the dies: give place.move, or leave tip out")


def _find_move(gap: FloatArray, slope: FloatArray, move: float, turn: FloatArray, sticks: float) -> FloatArray:
    """Return the move within bounds that lets the centre sink most: its height [mm], angles about x and y [rad].

    gap, slope: as _linear_gaps gives them. turn: bounds of the angles (2,) [rad]. sticks: loss of height per
    angle below which it does not turn [mm].
    """
    if not len(gap):
        return np.array([-move, 0.0, 0.0])
    cost = [1.0, *4 * [sticks]]  # each angle is a difference of two, which are not negative
    limits = [(-move, move), *((0.0, each) for each in (*turn, *turn))]
    found = linprog(cost, A_ub=-np.hstack([slope, -slope[:, 1:]]), b_ub=gap, bounds=limits)
    if found.x is None:  # it lies in a die: up
        return np.array([move, 0.0, 0.0])
    return np.array([found.x[0], found.x[1] - found.x[3], found.x[2] - found.x[4]])


def _linear_gaps(
    surfaces: Sequence[Placed], arms: FloatArray, at: FloatArray, half: FloatArray, near: float
) -> tuple[FloatArray, FloatArray]:
    """Return gaps (m,) [mm] of points that are nearer than this, and by how much they open.

    They open (m, 3) with the height of the centre [1] and with angles about x and y [mm].
    """
    gaps, slopes = [], []
    for surface, origin in surfaces:
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(arms + at - origin))
        close = gap - half < near
        lever, n = arms[close], normal[close]
        turned = np.cross(lever, n)
        gaps.append((gap - half)[close])
        slopes.append(np.column_stack([n[:, 2], turned[:, 0], turned[:, 1]]))
    return np.concatenate(gaps), np.concatenate(slopes)


def _least_gap(surfaces: Sequence[Placed], arms: FloatArray, at: FloatArray, half: FloatArray) -> float:
    found = [
        float((surface.nearest(np.ascontiguousarray(arms + at - origin))[0] - half).min())
        for surface, origin in surfaces
    ]
    return min(found)
