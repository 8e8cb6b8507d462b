# SPDX-License-Identifier: Apache-2.0
"""A plugin of pytest by which explicit runs in space compute on the host build of the code for cards.

`pytest -p validation.on_host tests/...`; a run of which something lacks there is computed by the loop of the CPU. At
the end it says how many cycles each has computed, and in how many tests.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from presswork import _core
from presswork.explicit import space
from presswork.explicit.resident import ResidentLoop

CYCLES: Counter[str] = Counter()
TESTS: dict[str, set[str]] = {"host": set(), "cpu": set()}
NOW = [""]
LACKS: Counter[str] = Counter()


class WillingLoop(ResidentLoop):
    """Computes on the host build whatever is computed there, and all else by the loop."""

    def _lacks(self) -> str:
        return "" if self._session is not None else str(_core.find_device_lack(self.loop))

    def advance(self, *args: Any, damping: float = 0.0) -> Any:
        lack, n = self._lacks(), len(args[3])
        where = "cpu" if lack else "host"
        LACKS[lack] += 1
        CYCLES[where] += n
        TESTS[where].add(NOW[0])
        if lack:
            return self.loop.advance(*args, damping=damping)
        return super().advance(*args, damping=damping)

    def enter(self) -> Any:
        return None if self._lacks() else super().enter()

    def keep(self) -> Any:
        if not self._lacks():
            return super().keep()
        state = self.loop.state()
        return lambda: state

    def measure_energies(self, dt: float, dt_before: float, **scales: float) -> _core.Energies:
        if self._lacks():
            found: _core.Energies = self.loop.energies(dt, dt_before, **scales)
            return found
        return super().measure_energies(dt, dt_before, **scales)

    def measure_frequency(self) -> float:
        return float(self.loop.bound_frequencies().max()) if self._lacks() else super().measure_frequency()


def pytest_configure() -> None:
    """Let every run in space begin so, unless it names a device."""
    begin = space.SpaceDynamics.__init__

    def begin_on_host(self: Any, *args: Any, **how: Any) -> None:
        begin(self, *args, **how)
        if self.device == "cpu" and how.get("world") is None:
            self._resident = self._loop = WillingLoop(self._loop, "host")

    space.SpaceDynamics.__init__ = begin_on_host  # type: ignore[method-assign]


def pytest_runtest_setup(item: pytest.Item) -> None:
    NOW[0] = item.nodeid


def pytest_terminal_summary(terminalreporter: Any) -> None:
    both = TESTS["host"] & TESTS["cpu"]
    terminalreporter.write_line(
        f"cycles: {CYCLES['host']} on the host build in {len(TESTS['host'])} tests, {CYCLES['cpu']} by the loop in "
        f"{len(TESTS['cpu'])} tests, {len(both)} of them the same"
    )
    for lack, calls in LACKS.most_common():
        if lack:
            terminalreporter.write_line(f"  lacking: {lack} ({calls} calls)")
