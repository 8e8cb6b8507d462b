# SPDX-License-Identifier: Apache-2.0
"""Tables of friction that a run leaves, or in which it never moves: most often a wrong unit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.interaction.sliding import SlidingArrays
from presswork.model import FloatArray, Model, Tool
from presswork.observe.contract import History, Measure, Observed, Observer
from presswork.observe.wear import find_pressure, list_pieces

SHARE = 95.0
"""Percentile of a quantity over the nodes that touch: single nodes at corners do not count."""
BEYOND = 1.1
"""Value over the last of a table up to which a run stays in it."""
SAME = 0.01
"""Change of a factor below which it is the same."""
UNITS = {"pressure": "MPa", "speed": "mm/s", "temperature": "degrees C", "path": "mm"}


class FrictionTables(Observer):
    """Follows the least and the largest pressure, speed, temperature and path under tools with tables of friction.

    In sheets only speed and path are followed.
    """

    def __init__(self, model: Model) -> None:
        self._tools = [tool for tool in model.tools if tool.friction is not None and _list_tables(tool)]
        self._ranges: dict[str, FloatArray] = {}
        """Least and largest value (2,) by tool and quantity."""

    def measures(self, run: Observed) -> list[Measure]:
        """Follow the values; it measures nothing of a limit."""
        if not self._tools:
            return []
        now, pieces = run.show(), list_pieces(run.mesh)
        for tool in self._tools:
            pressure = find_pressure(run, now, tool, pieces)
            touching = pressure > 0.0
            found = {"pressure": pressure[touching]}
            if now.temperature is not None:
                found["temperature"] = now.temperature[touching]
            if now.state is not None and SlidingArrays in now.state:
                sliding = now.state[SlidingArrays]
                slid = sliding.path > 0.0
                found |= {"speed": sliding.speed[slid], "path": sliding.path[slid]}
            for quantity in [name for name in _list_tables(tool) if len(found.get(name, []))]:
                self._widen(f"friction.{tool.name}.{quantity}", found[quantity])
        return []

    def _widen(self, name: str, values: FloatArray) -> None:
        low, high = np.percentile(values, [100.0 - SHARE, SHARE])
        before = self._ranges.get(name, np.array([np.inf, -np.inf]))
        self._ranges[name] = np.array([min(before[0], low), max(before[1], high)])

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the tables that the run has left, and those in which it has met one factor alone."""
        return [text for tool in self._tools for text in self._judge(tool)]

    def _judge(self, tool: Tool) -> Iterator[str]:
        for quantity, table in _list_tables(tool).items():
            name = f"friction.{tool.name}.{quantity}"
            if name not in self._ranges:
                continue
            (low, high), (at, factor) = self._ranges[name], table.T
            key, unit = f"tools.{tool.name}.friction.{quantity}", UNITS[quantity]
            met = np.interp([low, *at[(at > low) & (at < high)], high], at, factor)
            if high > BEYOND * at[-1] and abs(factor[-1] - factor[-2]) > SAME:
                yield (
                    f"{key} ends at {at[-1]:.3g} {unit}, and the run met {high:.3g}, where its last value holds; add "
                    "rows, or end it with two rows of the same factor"
                )
            elif np.ptp(met) < SAME < np.ptp(factor):
                yield (
                    f"{key} changes nothing: the run met {low:.3g} to {high:.3g} {unit}, where the factor is "
                    f"{met[0]:.3g}, and the table goes from {at[0]:.3g} to {at[-1]:.3g}; check its unit"
                )

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the least and largest values."""
        return dict(self._ranges)

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up the least and largest values."""
        self._ranges = {name: np.array(values) for name, values in arrays.items() if name.startswith("friction.")}


def _list_tables(tool: Tool) -> dict[str, FloatArray]:
    """Return the tables of a tool's friction (n, 2) by their quantities."""
    factors = tool.friction.factors if tool.friction is not None else None
    found = {} if factors is None else {name: getattr(factors, name) for name in UNITS}
    return {name: table for name, table in found.items() if table is not None}
