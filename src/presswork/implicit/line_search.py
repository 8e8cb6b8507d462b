# SPDX-License-Identifier: Apache-2.0
"""How much of a correction of Newton's method is taken: as far as what is out of balance does work along it.

Within an increment the forces of plastic metal nearly have a potential, which is convex. Where it falls along a
correction and rises again before its end, the correction is shortened to where the work vanishes. Else iterations throw
nodes to and fro, as beside the edge of a contact, where metal yields and unloads in turn.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.implicit.linear.system import Balance
from presswork.interaction.contract import Point, turn
from presswork.model import FloatArray
from presswork.outcome import BadGuess

SMALLEST_PART = 0.1
"""Smallest part of a correction: down to it the correction is halved where it turns a cell inside out."""
DRIVEN = 0.3
"""Part of the largest correction by which constraints drive a node, above which none is shortened."""
OVERSHOOT = 0.8
"""Work left along a correction, over that at its start, above which the correction is shortened."""
ENOUGH = 0.5
"""The same, below which it has been shortened enough."""
MOST_PARTS = 5
"""Most times that a correction is shortened."""
_ENDS = 0.1
"""Part of a bracket at either end within which no point is taken."""


class LineSearch:
    """A bracket round the part of a correction at which the work vanishes, by regula falsi (Dowell & Jarratt 1971)."""

    def __init__(self, before: float, after: float, part: float) -> None:
        """before, after: work of what is out of balance [N mm] at the start and with a part of the correction."""
        self._start = before
        self._low, self._high = 0.0, part
        self._before, self._after = before, after

    @property
    def has_overshot(self) -> bool:
        """Whether the part that was taken leaves too much work."""
        return abs(self._after) > OVERSHOOT * abs(self._start)

    @property
    def is_closed(self) -> bool:
        """Whether the work vanishes between the ends."""
        return self._before * self._after < 0.0

    def find_part(self) -> float:
        """Return the part of the correction to try next."""
        width = self._high - self._low
        share = self._before / (self._before - self._after) if self._before != self._after else 0.5
        return self._low + width * min(max(share, _ENDS), 1.0 - _ENDS)

    def note(self, part: float, work: float) -> bool:
        """Take note of the work at a part between the ends; return whether it is small enough."""
        if work * self._before > 0.0:
            self._low, self._before = part, work
            self._after *= 0.5
        else:
            self._high, self._after = part, work
            self._before *= 0.5
        return abs(work) <= ENOUGH * abs(self._start)


def take_correction(
    go: Callable[[FloatArray, FloatArray], Point | BadGuess],
    point: Point,
    balance: Balance,
    correction: FloatArray,
    travel: FloatArray,
    sense: FloatArray | None,
) -> Point | BadGuess:
    """Return the point after a correction, or after the part of it that keeps cells whole and does not overshoot.

    go: finds the point after a change of the nodes (n_points, freedoms) [mm, rad], and moves what interactions own by
    so much further. travel: of these. sense: of the work of each freedom (freedoms,); None: there is no line search.
    """
    part, gone = 1.0, 0.0
    while True:
        found = go(part * correction, (part - gone) * travel)
        gone = part
        if not isinstance(found, BadGuess) or part < SMALLEST_PART or found.is_final:
            break
        part *= 0.5
    driven = max(_largest(balance.constraints.value * balance.length), _largest(travel))
    if isinstance(found, BadGuess) or sense is None or driven > DRIVEN * _largest(correction * balance.length):
        return found
    before, after = (_find_work(balance, each, correction * sense) for each in (point, found))
    search = LineSearch(before, after, part)
    if not search.has_overshot or (sense[-1] < 0.0 and _comes_nearer(balance, found)):
        return found
    for tried in range(MOST_PARTS):
        if tried and not search.is_closed:
            break
        part = search.find_part()
        found = go(part * correction, (part - gone) * travel)
        gone = part
        if isinstance(found, BadGuess) or search.note(part, _find_work(balance, found, correction * sense)):
            break
    return found


def _largest(change: FloatArray) -> float:
    return float(np.abs(change).max(initial=0.0))


def _find_work(balance: Balance, point: Point, correction: FloatArray) -> float:
    """Return the work of what is out of balance along a correction, of freedoms that are not prescribed [N mm]."""
    lacking = turn(balance.constraints, balance.drag - point.reaction)
    work = lacking * turn(balance.constraints, correction)
    return float(work[balance.constraints.mask == 0].sum())


def _comes_nearer(balance: Balance, found: Point) -> bool:
    """Return whether a correction of pressures alone, which do no work, has brought equilibrium nearer."""
    lacking = turn(balance.constraints, balance.drag - found.reaction)
    lacking[balance.constraints.mask == 1] = 0.0
    return _largest(lacking / balance.length) <= OVERSHOOT * balance.largest_lacking
