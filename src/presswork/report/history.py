# SPDX-License-Identifier: Apache-2.0
"""The curves of a run: columns of history.csv in the units of a workshop, and which are shown first."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.report.pack import Blocks
from presswork.results import OutputError, Result
from presswork.view.plots.history_plot import (
    find_energies,
    find_moved_sets,
    find_moving_tools,
    find_turning_tools,
    is_of_part,
)
from presswork.view.plots.press_plot import find_ram_strokes, has_ram
from presswork.view.style import name_part

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
    "speed": ("mm/s", 1.0),
    "way": ("mm", 1.0),
    "heat": ("kJ", 1e-6),
    "stress": ("MPa", 1.0),
    **dict.fromkeys(("thickness", "x", "y", "z"), ("mm", 1.0)),
}
"""Unit in the page of what a column's last part holds, and the factor from that in the file."""
_LABELS = {"ram_force_borne": "force that the press bears", "ram_stroke": "stroke of the ram's tool"}
RAM_STROKE = "ram_stroke"
"""Column of the page with the stroke of the tool that the ram moves; it has none where no ram works."""


def describe_column(name: str) -> tuple[str, str, float]:
    """Return a column's name in words, its unit in the page, and the factor to it.

    >>> describe_column("punch.force"), describe_column("iterations")
    (('punch force', 'kN', 0.001), ('iterations', '', 1.0))
    """
    quantity = name.rpartition(".")[2]
    found = next((unit for word, unit in _UNITS.items() if word in quantity.split("_")), ("", 1.0))
    return _LABELS.get(name, name.replace(".", " ").replace("_", " ")), *found


def pack_history(result: Result, blocks: Blocks) -> dict[str, Any]:
    """Return the history's columns for the page; none of a run without a history."""
    try:
        history = result.history
    except OutputError:  # one step has none
        history = {}
    find_strokes = _find_strokes_at_work if result.is_line else _find_strokes
    strokes = {} if result.is_stamping and not result.is_line else find_strokes(history)
    columns, part = [], name_part(result)
    if has_ram(history):
        stroke = np.where(history["ram_speed"] > 0.0, find_ram_strokes(history)[0], np.nan)
        history = {**history, RAM_STROKE: stroke}
    for name, values in {**history, **strokes}.items():
        if name == "stage":
            continue
        label, unit, factor = describe_column(name)
        if is_of_part(history, name) and part:
            label = f"{label} {part}"
        packed = blocks.add_numbers(np.asarray(values, dtype=np.float64) * factor)
        columns.append({"name": name, "label": label, "unit": unit, "values": packed})
    stages: list[str] = []
    for stage in history.get("stage", ()):
        if not stages or stages[-1] != str(stage):
            stages.append(str(stage))
    curves = [(name, f"{name.rpartition('.')[0]}.force") for name in strokes] or choose_curves(result, history)
    idle = _find_idle(history)
    parts = np.asarray(history.get("part", ()), dtype=np.float64)
    return {
        "columns": columns,
        "stages": stages,
        "curves": curves,
        "charts": _choose_charts(history),
        "idle": idle.tolist(),
        "begins": (np.flatnonzero(np.diff(parts) > 0.0) + 1).tolist(),
    }


def _find_idle(history: dict[str, NDArray[Any]]) -> NDArray[np.int64]:
    """Return the rows of stages in which no ram works though others have one, such as the pauses between blows."""
    if not has_ram(history):
        return np.zeros(0, dtype=np.int64)
    stages, speed = np.asarray(history["stage"]), np.asarray(history["ram_speed"], dtype=np.float64)
    working = [stage for stage in dict.fromkeys(stages.tolist()) if np.any(speed[stages == stage] > 0.0)]
    return np.flatnonzero(~np.isin(stages, working))


def _find_strokes_at_work(history: dict[str, NDArray[Any]]) -> dict[str, FloatArray]:
    """Return each tool's stroke in the stages of a press line in which it presses; nan elsewhere, where it is not."""
    stages = np.asarray(history.get("stage", ()))
    strokes = {}
    for tool in find_moving_tools(history):
        works = [stage for stage in dict.fromkeys(stages.tolist()) if np.any(history[f"{tool}.force"][stages == stage])]
        strokes[f"{tool}.way_in_operation"] = np.where(np.isin(stages, works), history[f"{tool}.stroke"], np.nan)
    return strokes


def _find_strokes(history: dict[str, NDArray[Any]]) -> dict[str, FloatArray]:
    """Return how far each tool has come in the stage in which it works, where tools of a run take turns; nan elsewhere.

    Its stroke would include its moves between operations, too. The first increment is taken to be as long as the
    second.
    """
    tools = find_moving_tools(history)
    stages = np.asarray(history["stage"]) if tools else np.zeros(0)
    works = {
        tool: [stage for stage in dict.fromkeys(stages.tolist()) if np.any(history[f"{tool}.force"][stages == stage])]
        for tool in tools
    }
    turns = [stage for own in works.values() for stage in own]
    if len(tools) < 2 or len(turns) > len(set(turns)):
        return {}
    strokes = {}
    for tool in tools:
        in_stage = np.full(len(stages), np.nan)
        for stage in works[tool]:
            rows = np.flatnonzero(stages == stage)
            stroke = np.asarray(history[f"{tool}.stroke"], dtype=np.float64)[rows]
            first = stroke[1] - stroke[0] if len(rows) > 1 else 0.0
            in_stage[rows] = np.abs(stroke - stroke[0] + first)
        strokes[f"{tool}.way_in_stage"] = in_stage
    return strokes


def _choose_charts(history: dict[str, NDArray[Any]]) -> list[dict[str, Any]]:
    """Return what is drawn below the first curves: title, abscissa and ordinates of each chart."""
    time = "process_time" if "process_time" in history else "time"
    temperatures = [name for name in history if "temperature" in name.rpartition(".")[2]]
    damage = [name for name in history if name.startswith("damage_") and np.any(history[name])]
    charts = [("Temperature", time, temperatures), ("Damage, largest", time, damage)]
    if has_ram(history):
        forces: list[str] = [name for name in ("ram_force", "ram_force_borne") if name in history]
        charts = [
            (
                "Force on the ram and what the press bears" if len(forces) > 1 else "Force on the ram",
                RAM_STROKE,
                forces,
            ),
            ("Speed of the ram", time, ["ram_speed"]),
            *charts,
        ]
    charts.append(("Energy", "time", list(find_energies(history))))
    if "iterations" in history:
        charts.append(("Convergence: iterations an increment", "time", ["iterations"]))
    return [{"title": title, "over": over, "columns": names} for title, over, names in charts if names]


def choose_curves(result: Result, history: dict[str, Any]) -> list[tuple[str, str]]:
    """Return pairs of columns, abscissa and ordinate: force against stroke, or what comes nearest to it.

    For heat alone these are the temperatures over time.
    """
    moving, turning = find_moving_tools(history), find_turning_tools(history)
    if turning:
        return [(f"{tool}.angle", f"{tool}.{what}") for tool in turning for what in ("force", "torque")]
    if result.is_stamping and moving and not result.is_line:  # holders hardly move: all over one stroke
        main = max(moving, key=lambda tool: float(np.abs(history[f"{tool}.stroke"]).max()))
        return [(f"{main}.stroke", f"{tool}.force") for tool in moving]
    temperatures = [("time", name) for name in history if name.startswith("temperature_")]
    forces = [(f"{tool}.stroke", f"{tool}.force") for tool in moving] or find_moved_sets(history)
    return forces or temperatures
