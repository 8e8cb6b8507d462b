# SPDX-License-Identifier: Apache-2.0
"""The curves of a run: columns of history.csv in the units of a workshop, and which are shown first."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.report.pack import Blocks
from presswork.results import OutputError, Result
from presswork.view.history_plot import find_energies, find_moved_sets, find_moving_tools, find_turning_tools

_UNITS = {
    "force": ("kN", 1e-3),
    "moment": ("N m", 1e-3),
    "torque": ("N m", 1e-3),
    "energy": ("J", 1e-3),
    "work": ("J", 1e-3),
    "stroke": ("mm", 1.0),
    "displacement": ("mm", 1.0),
    "rotation": ("degrees", 1.0),
    "angle": ("degrees", 1.0),
    "time": ("s", 1.0),
    "temperature": ("°C", 1.0),
    "heat": ("kJ", 1e-6),
    "stress": ("MPa", 1.0),
    **dict.fromkeys(("thickness", "x", "y", "z"), ("mm", 1.0)),
}
"""Unit in the page of what a column's last part holds, and the factor from that in the file."""


def describe_column(name: str) -> tuple[str, str, float]:
    """Return a column's name in words, its unit in the page, and the factor to it.

    >>> describe_column("punch.force"), describe_column("iterations")
    (('punch force', 'kN', 0.001), ('iterations', '', 1.0))
    """
    quantity = name.rpartition(".")[2]
    found = next((unit for word, unit in _UNITS.items() if word in quantity.split("_")), ("", 1.0))
    return name.replace(".", " ").replace("_", " "), *found


def pack_history(result: Result, blocks: Blocks) -> dict[str, Any]:
    """Return the history's columns for the page; none of a run without a history."""
    try:
        history = result.history
    except OutputError:  # one step has none
        history = {}
    columns = []
    for name, values in history.items():
        if name == "stage":
            continue
        label, unit, factor = describe_column(name)
        packed = blocks.add_numbers(np.asarray(values, dtype=np.float64) * factor)
        columns.append({"name": name, "label": label, "unit": unit, "values": packed})
    stages: list[str] = []
    for stage in history.get("stage", ()):
        if not stages or stages[-1] != str(stage):
            stages.append(str(stage))
    curves = _choose_curves(result, history)
    return {"columns": columns, "stages": stages, "curves": curves, "energies": find_energies(history)}


def _choose_curves(result: Result, history: dict[str, Any]) -> list[tuple[str, str]]:
    """Return pairs of columns, abscissa and ordinate: force against stroke, or what comes nearest to it.

    Of heat alone these are the temperatures over time.
    """
    moving, turning = find_moving_tools(history), find_turning_tools(history)
    if turning:
        return [(f"{tool}.angle", f"{tool}.{what}") for tool in turning for what in ("force", "torque")]
    if result.is_stamping and moving:  # holders hardly move: all over the stroke of the one that does
        main = max(moving, key=lambda tool: float(np.abs(history[f"{tool}.stroke"]).max()))
        return [(f"{main}.stroke", f"{tool}.force") for tool in moving]
    temperatures = [("time", name) for name in history if name.startswith("temperature_")]
    forces = [(f"{tool}.stroke", f"{tool}.force") for tool in moving] or find_moved_sets(history)
    return forces or temperatures
