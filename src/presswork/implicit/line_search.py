# SPDX-License-Identifier: Apache-2.0
"""How much of a correction of Newton's method is taken: as far as what is out of balance does work along it.

Within an increment the forces of plastic metal nearly have a potential, which is convex. Where it falls along a
correction and rises again before its end, the correction is shortened to where the work vanishes. Else iterations throw
nodes to and fro, as beside the edge of a contact, where metal yields and unloads in turn.
"""

from __future__ import annotations

OVERSHOOT = 0.8
"""Work left along a correction, over that at its start, above which the correction is shortened."""
ENOUGH = 0.5
"""The same, below which it has been shortened enough."""
MOST_PARTS = 5
"""Times that a correction is shortened."""
_ENDS = 0.1
"""Of a bracket, within which no part is taken at either end."""


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
