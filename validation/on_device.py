# SPDX-License-Identifier: Apache-2.0
"""A plugin of pytest by which explicit runs in space compute on a device: the host build of its code, or a card.

`pytest -p validation.on_device tests/...` takes the host build, with `--on-device cuda` the first NVIDIA card, for
which tests that name the host build take the card, too. A run of which something lacks there is computed by the loop
of the CPU. At the end it says how many cycles each has computed, and in how many tests.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from presswork import _core
from presswork.explicit import space
from presswork.explicit.device import Device
from presswork.explicit.resident import ResidentLoop

CYCLES: Counter[str] = Counter()
TESTS: dict[str, set[str]] = {"device": set(), "cpu": set()}
NOW = [""]
OF_DEVICES = "/test_device"
"""In the names of tests that choose their devices themselves: what they compare stays with the CPU's loop."""
LACKS: Counter[str] = Counter()


def count(where: str, cycles: int) -> None:
    """Count cycles of the present test."""
    CYCLES[where] += cycles
    TESTS[where].add(NOW[0])


class WillingLoop(ResidentLoop):
    """Computes on its device whatever is computed there, and all else by the loop."""

    def _lacks(self) -> str:
        return "" if self._session is not None else str(_core.find_device_lack(self.loop))

    def advance(self, *args: Any, damping: float = 0.0) -> Any:
        lack = self._lacks()
        if not lack:
            return super().advance(*args, damping=damping)
        LACKS[lack] += 1
        count("cpu", len(args[3]))
        return self.loop.advance(*args, damping=damping)

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


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--on-device", choices=["host", "cuda"], default="host", help="of runs that name none")


def pytest_configure(config: pytest.Config) -> None:
    """Let every run in space begin so that is not divided over ranks."""
    device: Device = config.getoption("--on-device")
    begin, make, advance = space.SpaceDynamics.__init__, ResidentLoop.__init__, ResidentLoop.advance

    def begin_on_device(self: Any, *args: Any, **how: Any) -> None:
        begin(self, *args, **how)
        if self.device == "cpu" and how.get("world") is None and OF_DEVICES not in NOW[0]:
            self._resident = self._loop = WillingLoop(self._loop, device)

    def make_on_device(self: ResidentLoop, loop: Any, named: Device) -> None:
        make(self, loop, device if named == "host" else named)

    def advance_on_device(self: ResidentLoop, *args: Any, **how: Any) -> Any:
        count("device", len(args[3]))
        return advance(self, *args, **how)

    space.SpaceDynamics.__init__ = begin_on_device  # type: ignore[method-assign]
    ResidentLoop.__init__ = make_on_device  # type: ignore[method-assign]
    ResidentLoop.advance = advance_on_device  # type: ignore[method-assign]


def pytest_runtest_setup(item: pytest.Item) -> None:
    NOW[0] = item.nodeid


def pytest_terminal_summary(terminalreporter: Any) -> None:
    both = TESTS["device"] & TESTS["cpu"]
    terminalreporter.write_line(
        f"cycles: {CYCLES['device']} on the device in {len(TESTS['device'])} tests, {CYCLES['cpu']} by the loop in "
        f"{len(TESTS['cpu'])} tests, {len(both)} of them the same"
    )
    for lack, calls in LACKS.most_common():
        terminalreporter.write_line(f"  lacking: {lack} ({calls} calls)")
