# SPDX-License-Identifier: Apache-2.0
"""Values in a row of a study's table: numbers of a run by name, from its summary, its history and its fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from presswork.case import CaseError
from presswork.case.errors import Problem
from presswork.model import FloatArray
from presswork.results import OutputError, Result, ResultError

Extreme = Literal["max", "min", "last"]
_AFTER_FORMING = ("trim", "springback")
"""Stages that come after the tools' last, as the history names them."""


@dataclass(frozen=True)
class Column:
    """A column asked for by name: `max:stress_xx`, `min:thickness`, `last:punch.force`."""

    extreme: Extreme
    """Largest, smallest, or the history's last."""
    name: str
    """A field of the results, taken at the last saved step, or a column of history.csv, taken over the whole run."""

    @property
    def title(self) -> str:
        """Heading in the table."""
        return f"{self.extreme}:{self.name}"

    def measure(self, result: Result) -> float:
        """Return its number; of a vector's length. Raises ResultError if there is no such field or column."""
        history = result.history
        if self.name in history:
            values = history[self.name]
            if values.dtype.kind not in "fi":
                raise ResultError(f"{self.name} is not a number")
        elif self.extreme == "last":
            known = ", ".join(name for name in history if name != "stage")
            raise ResultError(f"{result.folder} has no history column {self.name}; there are: {known}")
        else:
            values = result.scalar(self.name)
        if not len(values):
            raise ResultError(f"{result.folder}: {self.name} has no values")
        return float(values[-1] if self.extreme == "last" else getattr(np, self.extreme)(values))


def parse_column(text: str) -> Column:
    """Read `max:FIELD`, `min:FIELD` or `last:HISTORY`. Raises CaseError."""
    extreme, colon, name = text.partition(":")
    if not colon or not name.strip() or extreme.strip() not in get_args(Extreme):
        remedy = "write max:FIELD or min:FIELD, or last:COLUMN of history.csv, for instance max:thinning"
        raise CaseError([Problem("--column", f"unknown column `{text}`", remedy)])
    return Column(extreme.strip(), name.strip())  # type: ignore[arg-type]


def measure_run(
    folder: Path, summary: Mapping[str, Any], columns: Sequence[Column] = ()
) -> tuple[dict[str, Any], list[str]]:
    """Return the numbers of a run, and why some that were asked for by name are missing.

    Strokes and lengths [mm], forces [N], stresses [MPa]. What the run has nothing of is left out.
    """
    numbers: dict[str, Any] = _list_faults(summary) | {
        key: summary.get(key) for key in ("fraction_computed", "increments", "iterations", "cutbacks")
    }
    numbers["wall_seconds"] = summary.get("wall_seconds", {}).get("total")
    extremes = summary.get("extremes", {})
    for key in ("equivalent_plastic_strain", "effective_stress"):
        if key in extremes or not extremes:
            numbers[f"max_{key}"] = extremes.get(key, [None, None])[1]
    if "temperature" in extremes:
        numbers["min_temperature"], numbers["max_temperature"] = extremes["temperature"]
    faults = []
    try:
        result = Result(folder)
        history = result.history
    except OutputError:  # of a member that has failed
        return numbers, []
    numbers |= (
        _measure_tools(history, str(result.info.get("operations", "")).split("\n"))
        | _measure_sheet(summary)
        | _measure_draw_in(result, history)
        | _measure_blank(summary)
    )
    for column in columns:
        try:
            numbers[column.title] = column.measure(result)
        except ResultError as error:
            faults.append(f"{column.title}: {error}")
    return numbers, faults


def _list_faults(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the number of laps, the stroke [mm] and the time [s] of the first crack, and the warnings as one text.

    A crack is one by damage or by the forming limit; the stroke is that of the tool that had moved farthest.
    """
    found: dict[str, Any] = {"laps": len(summary["laps"])} if "laps" in summary else {}
    cracks = [known["first_exceeded"] for known in summary.get("damage", {}).values() if "first_exceeded" in known]
    cracks += [summary["first_crack"]] if "first_crack" in summary else []
    if cracks:
        first = min(cracks, key=lambda crack: float(crack["time_s"]))
        if first["strokes_mm"]:
            found["first_crack_stroke"] = max(map(abs, first["strokes_mm"].values()))
        found["first_crack_time"] = first["time_s"]
    return found | {"warnings": " | ".join(summary.get("warnings", []))}


def _measure_tools(history: Mapping[str, NDArray[Any]], operations: Sequence[str] = ()) -> dict[str, float]:
    """Return last stroke, last force and largest force of every tool that moves.

    operations: of a press line; its tools have the stroke and force of the end of their own operation, before the part
    is released.
    """
    own, stages = [_find_operation(str(stage), operations) for stage in history.get("stage", ())], history.get("stage")
    found = {}
    for column, values in history.items():
        tool, _, quantity = column.rpartition(".")
        if quantity == "stroke" and len(values) and np.any(values != 0):
            force, operation, last = history[f"{tool}.force"], _find_operation(tool, operations), -1
            if operation and stages is not None:
                forming = [not str(stage).endswith(("_springback", "_trim", "_laid")) for stage in stages]
                rows = [i for i, name in enumerate(own) if name == operation and forming[i]]
                last = rows[-1] if rows else -1
            found[column] = float(values[last])
            found[f"{tool}.force"] = float(force[last])
            found[f"{tool}.max_force"] = float(force[np.argmax(np.abs(force))])
    return found


def _find_operation(name: str, operations: Sequence[str]) -> str:
    """Return the operation whose name a tool's or a stage's begins with; empty without one."""
    return max((each for each in operations if each and name.startswith(f"{each}_")), key=len, default="")


def _measure_sheet(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return thinning [%], least margin to the forming limit and cells beyond it, wrinkles and springback [mm]."""
    found: dict[str, Any] = {}
    if verdict := summary.get("formability"):
        found["max_thinning_percent"] = verdict["largest_thinning_percent"]["value"]
        if fold := verdict.get("largest_fold_ratio"):
            found |= {"max_fold_ratio": fold["value"], "folds": verdict["folds"]}
        if margin := verdict["least_margin"]:
            found |= {"min_forming_limit_margin": margin["value"], "cracked_cells": verdict["failing_cells"]}
        for name in ("polar", "stress"):
            if worst := verdict.get(f"least_margin_{name}"):
                found[f"min_forming_limit_margin_{name}"] = worst["value"]
        if (passed := verdict.get("failing_cells_by_path")) is not None:
            found["cracked_cells_by_path"] = passed
    if wrinkles := summary.get("wrinkles"):
        found["wrinkle_height"] = wrinkles["height_mm"]
    if sprung := summary.get("springback"):
        low, high = sprung["deviation_mm"]
        found |= {"max_springback": sprung["largest_mm"], "min_deviation": low, "max_deviation": high}
    return found


def _measure_draw_in(result: Result, history: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Return least and largest draw-in of a drawn blank's edge [mm], before trimming and springback."""
    if not result.is_stamping or not len(history["time"]):
        return {}
    from presswork.post import measure_draw_in_around

    forming = ~np.isin(history["stage"], _AFTER_FORMING)
    end = history["time"][forming if forming.any() else ...][-1]
    draw_in = measure_draw_in_around(result, _first_step_at(result.times, float(end)))[:, 1]
    return {"min_draw_in": float(draw_in.min()), "max_draw_in": float(draw_in.max())} if len(draw_in) else {}


def _first_step_at(times: FloatArray, end: float) -> int:
    """Return the first saved step at a time or later; the last if none is."""
    late = np.flatnonzero(times >= end * (1.0 - 1e-12))
    return int(late[0]) if len(late) else len(times) - 1


def _measure_blank(summary: Mapping[str, Any]) -> dict[str, float]:
    """Return punch force [N], the blank's area [mm2] and the use of the strip of a one-step run."""
    if "punch_force_kN" not in summary:
        return {}
    blank = summary["blank"]
    return {
        "punch.force": 1e3 * summary["punch_force_kN"],
        "blank_area": blank["area_mm2"],
        "strip_utilisation_percent": blank["strip"]["utilisation_percent"],
    }
