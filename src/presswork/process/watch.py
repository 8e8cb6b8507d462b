# SPDX-License-Identifier: Apache-2.0
"""What a run remembers of its way: limits passed, the first crack, the largest forces, the extremes of every field."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import describe_field, split_components, to_scalar
from presswork.model import FloatArray, Limits, Mesh
from presswork.observe.damage import Peak
from presswork.observe.limits import NEVER_PASSED, Watched, explain_breach, find_breach
from presswork.process.run import Snapshot

STROKE, FORCE = ".stroke", ".force"


class Watch:
    """Looks at every report and every saved step of one run."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._nearest: dict[str, dict[str, Any]] = {}
        self._passed: dict[str, str] = {}
        self._first_crack: dict[str, Any] | None = None
        self._damage: dict[str, dict[str, Any]] = {}
        self._news: list[str] = []
        self._fields: dict[str, dict[str, dict[str, Any]]] = {}

    def look(self, watched: Watched, row: Mapping[str, Any]) -> str | None:
        """Measure a converged state; return why the run must stop, if it must.

        row: of the history, which says when this is.
        """
        margin = watched.margin
        if margin is not None and margin.value < 0.0 and self._first_crack is None:
            place = [float(x) for x in margin.place]
            self._first_crack = {**describe_instant(row), "margin": margin.value, "cell": margin.cell, "at_mm": place}
        for peak in watched.damage:
            self._take_peak(peak, row)
        for measure in watched.measures:
            if measure.limit not in self._nearest or measure.value > self._nearest[measure.limit]["largest"]:
                limit = getattr(self._limits, measure.limit)
                so_far = {"largest": measure.value, "limit": limit, "fact": measure.fact, **describe_instant(row)}
                self._nearest[measure.limit] = so_far
        breach = find_breach(self._limits, watched.measures)
        if breach is None:
            return None
        if not self._limits.stop:
            final = find_breach(self._limits, [m for m in watched.measures if m.limit in NEVER_PASSED])
            breach = breach if final is None else final
        reason = f"{_describe_when(row)}{explain_breach(breach, self._limits, row)}"
        self._passed.setdefault(breach.limit, reason)
        return reason if self._limits.stop or breach.limit in NEVER_PASSED else None

    def _take_peak(self, peak: Peak, row: Mapping[str, Any]) -> None:
        """Remember the largest damage by a criterion, at a point and as a mean, and when and where a crack begins."""
        place = {"cell": peak.cell, "point": peak.point, "at_mm": list(peak.place)}
        largest = {"value": peak.value, **place, **describe_instant(row)}
        around = {"cell": peak.mean.cell, "at_mm": list(peak.mean.place)}
        mean = {"value": peak.mean.value, "length_mm": peak.mean.length, **around, **describe_instant(row)}
        known = self._damage.setdefault(
            peak.name, {"largest": largest, "largest_mean": mean, "critical": peak.critical}
        )
        for key, now in (("largest", largest), ("largest_mean", mean)):
            if now["value"] > known[key]["value"]:
                known[key] = now
        if peak.mean.is_beyond and "first_exceeded" not in known:
            known["first_exceeded"] = {**mean, "critical": peak.mean.critical}
            self._news.append(_explain_crack(peak.name, known["first_exceeded"]))

    def take_news(self) -> list[str]:
        """Return what the log has not been told yet."""
        news, self._news = self._news, []
        return news

    def note_step(self, number: int, mesh: Mesh, snapshot: Snapshot) -> None:
        """Take up the extremes of the fields of a saved step, counted from 0; places are those of the deformed body."""
        space = np.zeros((len(mesh.points), 3))
        space[:, : mesh.points.shape[1]] = mesh.points
        space += snapshot.point_data.get("displacement", 0.0)
        centres = np.concatenate([space[block.connectivity].mean(axis=1) for block in mesh.blocks])
        for data, places in ((snapshot.point_data, space), (snapshot.cell_data, centres)):
            for name, values in data.items():
                for each, numbers in _scalars(name, np.asarray(values)).items():
                    self._take(each, numbers, places, {"step": number, "time_s": snapshot.time})

    def _take(self, name: str, values: FloatArray, places: FloatArray, when: Mapping[str, float]) -> None:
        finite = np.isfinite(values)
        if not finite.any():
            return
        own = slice(None) if finite.all() else np.flatnonzero(finite)
        known, numbers = self._fields.setdefault(name, {}), np.arange(len(values))[own]
        for key, sign, find in (("smallest", -1.0, np.argmin), ("largest", 1.0, np.argmax)):
            at = int(numbers[find(values[own])])
            value = float(values[at])
            if key not in known or sign * value > sign * known[key]["value"]:
                known[key] = {"value": value, "at_mm": [float(x) for x in places[at]], **when}

    def warnings(self) -> list[str]:
        """Return the limits that were passed by a run that went on, and the cracks that damage tells."""
        cracks = [
            _explain_crack(name, known["first_exceeded"])
            for name, known in self._damage.items()
            if "first_exceeded" in known
        ]
        return [*cracks, *([] if self._limits.stop else self._passed.values())]

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return how near limits came, the first crack, largest forces and the extremes of fields, for summary.json."""
        forces = find_largest_forces(history)
        found: dict[str, Any] = {"limits": self._nearest, "largest_forces": forces, "fields": self._fields}
        if self._damage:
            found = {"damage": self._damage, **found}
        return found if self._first_crack is None else {"first_crack": self._first_crack, **found}

    def to_text(self) -> str:
        """Return all that is remembered, for a checkpoint."""
        return json.dumps([self._nearest, self._passed, self._first_crack, self._fields, self._damage])

    def from_text(self, text: str) -> None:
        """Take up what to_text gave."""
        self._nearest, self._passed, self._first_crack, self._fields, self._damage = json.loads(text)


def describe_instant(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return time [s], stage and strokes [mm] of the tools that have moved, of a row of the history.

    >>> describe_instant({"time": 0.5, "stage": "draw", "punch.stroke": 12.0, "punch.force": 8.0, "die.stroke": 0.0})
    {'time_s': 0.5, 'stage': 'draw', 'strokes_mm': {'punch': 12.0}}
    """
    strokes = {name.removesuffix(STROKE): float(row[name]) for name in row if name.endswith(STROKE)}
    return {
        "time_s": float(row.get("time", 0.0)),
        "stage": str(row.get("stage", "")),
        "strokes_mm": {tool: stroke for tool, stroke in strokes.items() if stroke},
    }


def _row_of(instant: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row of the history that describe_instant describes so."""
    return {"stage": instant["stage"]} | {f"{tool}{STROKE}": stroke for tool, stroke in instant["strokes_mm"].items()}


def _explain_crack(name: str, first: Mapping[str, Any]) -> str:
    """Say when and where the mean of which damage has passed its critical value."""
    at = ", ".join(f"{x:.4g}" for x in first["at_mm"])
    mean = f"{first['value']:.4g} in the mean over {first['length_mm']:.3g} mm round ({at}) mm"
    return (
        f"{_describe_when(_row_of(first))}the {describe_field(name)} is {mean}, beyond the critical "
        f"{first['critical']:.4g}: a crack begins there"
    )


def _describe_when(row: Mapping[str, Any]) -> str:
    """Return the beginning of a sentence on a row of the history."""
    now = describe_instant(row)
    parts = [f"stage {now['stage']!r}", *(f"{tool} at {stroke:.4g} mm" for tool, stroke in now["strokes_mm"].items())]
    return f"{', '.join(parts)}: "


def find_largest_forces(history: Mapping[str, NDArray[Any]]) -> dict[str, dict[str, Any]]:
    """Return the largest force of every tool, bead and contact [N], either way, with when it was."""
    found = {}
    for column in (name for name in history if name.endswith(FORCE) and len(history[name])):
        at = int(np.argmax(np.abs(history[column])))
        row = {name: values[at] for name, values in history.items()}
        found[column.removesuffix(FORCE)] = {"force_n": float(row[column]), **describe_instant(row)}
    return found


def _scalars(name: str, values: FloatArray) -> dict[str, FloatArray]:
    """Return a field as scalars: the components of a tensor, the length of a vector."""
    one = to_scalar(name, values)
    return split_components(name, values) if one is None else {name: one}
