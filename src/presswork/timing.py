# SPDX-License-Identifier: Apache-2.0
"""Wall time by phase."""

from __future__ import annotations

from time import perf_counter


class Timing:
    """Sums of wall time [s] by phase."""

    def __init__(self, *phases: str) -> None:
        self.seconds = dict.fromkeys((*phases, "output"), 0.0)
        self._started = perf_counter()

    def add(self, phase: str, started: float) -> None:
        """Add the time since `started` (a perf_counter reading) to a phase."""
        self.seconds[phase] += perf_counter() - started

    def add_seconds(self, phase: str, seconds: float) -> None:
        """Add seconds that have been measured elsewhere to a phase."""
        self.seconds[phase] += seconds

    def go_on_from(self, before: Timing) -> None:
        """Count on from where another of the same phases has come."""
        self._started = before._started
        for phase, seconds in before.seconds.items():
            self.seconds[phase] += seconds

    def shares(self) -> str:
        """Describe which share of the time each phase has taken, the largest first."""
        total = self.total()
        largest_first = sorted(self.seconds.items(), key=lambda item: -item[1])
        return ", ".join(f"{phase} {100 * seconds / total:.0f} %" for phase, seconds in largest_first if seconds)

    def total(self) -> float:
        """Wall time since the start [s]."""
        return perf_counter() - self._started
