# SPDX-License-Identifier: Apache-2.0
"""Rails of known shape before and after springback: opened, curled and twisted by numbers that are drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray

BOTTOM, WALL, FLANGE = 40.0, 50.0, 30.0


@dataclass(frozen=True)
class Rail:
    """A hat along x whose section is that of `trace`."""

    formed: FloatArray
    free: FloatArray
    cells: IntArray


def trace(opening: float, closing: float, radius: float, pieces: int = 24) -> FloatArray:
    """Return half a section (n, 2): bottom from the middle, wall, flange.

    opening: of the angle between bottom and wall over 90 degrees; closing: of that between wall and flange [rad];
    radius: of the wall's curl, infinite for a straight one [mm].
    """
    turn = 0.0 if np.isinf(radius) else WALL / radius
    wall = 0.5 * np.pi - opening + turn * (np.arange(pieces) + 0.5) / pieces
    flange = 0.5 * np.pi - opening + turn - 0.5 * np.pi - closing
    angle = np.concatenate([np.zeros(pieces), wall, np.full(pieces, flange)])
    length = np.repeat([0.5 * BOTTOM / pieces, WALL / pieces, FLANGE / pieces], pieces)
    chord = np.ones(3 * pieces)
    chord[pieces : 2 * pieces] = np.sinc(turn / pieces / (2.0 * np.pi))
    steps = (length * chord)[:, None] * np.column_stack([np.cos(angle), -np.sin(angle)])
    return np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])


def make_rail(
    opening: float, closing: float, radius: float, twist: float, *, length: float = 300.0, seed: int = 0
) -> Rail:
    """Return a rail that opens, curls, and turns about x by `twist` [rad] from end to end, moved at random as a whole.

    As formed its walls are upright and straight.
    """
    rng = np.random.default_rng(seed)
    stations = np.linspace(0.0, length, 31)

    def sweep(half: FloatArray) -> FloatArray:
        line = np.vstack([half[:0:-1] * [-1.0, 1.0], half])
        return np.concatenate([np.column_stack([np.full(len(line), x), line]) for x in stations])

    formed, free = sweep(trace(0.0, 0.0, np.inf)), sweep(trace(opening, closing, radius))
    angle = twist * free[:, 0] / length
    y, z = free[:, 1].copy(), free[:, 2].copy()
    free[:, 1], free[:, 2] = np.cos(angle) * y - np.sin(angle) * z, np.sin(angle) * y + np.cos(angle) * z
    turn = np.linalg.qr(np.eye(3) + 0.05 * rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.diag(turn))
    width = len(formed) // len(stations)
    first = (np.arange(len(stations) - 1)[:, None] * width + np.arange(width - 1)).ravel()
    cells = np.column_stack([first, first + width, first + width + 1, first + 1]).astype(np.int32)
    return Rail(formed, free @ turn.T + rng.normal(size=3), cells)
