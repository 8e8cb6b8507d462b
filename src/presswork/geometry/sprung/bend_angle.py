# SPDX-License-Identifier: Apache-2.0
"""Bends of a section before and after springback: the angles that their legs enclose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray

_ROUND = 0.2
"""Radius over the length of a section up to which it is bent, not merely curved."""
_NOISE, _LAST, _LEAST = 0.3, 1.0, 5.0
"""Turn from piece to piece below which it is none, from which on it ends a bend beside it, and of a bend [degree]."""
_GAP = 2
"""Straight joints within a bend at most."""


@dataclass(frozen=True)
class Bend:
    """One bend of a section."""

    middle: int
    """Index of the point in its middle."""
    formed: float
    """Angle that its legs enclose as formed [degree], 180 for a flat sheet."""
    free: float
    """After springback [degree]."""


def measure_bends(formed: FloatArray, free: FloatArray) -> tuple[Bend, ...]:
    """Return the bends of a section in its order.

    formed, free: its points (n, 2) [mm], the same material. A bend turns one way by 5 degrees at least, round a radius
    up to a fifth of the section's length. The direction of a leg is that of the third of it beside the bend.
    """
    pieces = np.diff(formed, axis=0)
    length = np.linalg.norm(pieces, axis=1)
    if len(length) < 3 or not (length > 0.0).all():
        return ()
    turn = np.diff(np.unwrap(np.arctan2(pieces[:, 1], pieces[:, 0])))
    beside = 0.5 * (length[1:] + length[:-1])
    bent = np.abs(turn) > np.maximum(beside / (_ROUND * length.sum()), np.radians(_NOISE))
    runs = [run for run in _find_runs(bent, turn) if abs(turn[run[0] : run[1]].sum()) > np.radians(_LEAST)]
    found = []
    for k, (first, last) in enumerate(runs):
        start = runs[k - 1][1] if k else 0
        end = runs[k + 1][0] + 1 if k + 1 < len(runs) else len(length)
        before, after = _third(start, first + 1, at_end=True), _third(last, end, at_end=False)
        if len(before) and len(after):
            angles = [_enclosed(line, before, after) for line in (formed, free)]
            found.append(Bend((first + last + 1) // 2, *angles))
    return tuple(found)


def _find_runs(bent: BoolArray, turn: FloatArray) -> list[tuple[int, int]]:
    """Return first and last + 1 of runs of bent joints (n,) that turn one way."""
    runs: list[tuple[int, int]] = []
    for joint in np.flatnonzero(bent).tolist():
        if runs and joint - runs[-1][1] <= _GAP and turn[joint] * turn[runs[-1][0]] > 0.0:
            runs[-1] = (runs[-1][0], joint + 1)
        else:
            runs.append((joint, joint + 1))
    ends = np.abs(turn) > np.radians(_LAST)  # a chord of the radius beside the longer pieces of a leg
    for k, (first, last) in enumerate(runs):
        alike = ends & (turn * turn[first] > 0.0)
        runs[k] = (first - int(first > 0 and alike[first - 1]), last + int(last < len(turn) and alike[last]))
    return runs


def _third(start: int, end: int, *, at_end: bool) -> IntArray:
    """Return the third of the pieces start to end - 1 of a leg that lies at its end or its beginning."""
    count = -(-(end - start) // 3)
    first = end - count if at_end else start
    return np.arange(first, first + count, dtype=np.int32)


def _enclosed(line: FloatArray, before: IntArray, after: IntArray) -> float:
    """Return the angle that two legs of a line enclose [degree], from the numbers of their pieces."""
    one, other = (line[part[-1] + 1] - line[part[0]] for part in (before, after))
    turn = np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)
    return 180.0 - abs(float(np.degrees(turn)))
