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

    def total(self) -> float:
        """Wall time since the start [s]."""
        return perf_counter() - self._started
