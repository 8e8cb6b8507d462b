# SPDX-License-Identifier: Apache-2.0
"""Maps on the part: at each node or cell the mean of a field over all runs, and how often it passes a limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswork.model import FloatArray
from presswork.results import OutputError, Result, ResultError
from presswork.study.scatter.statistics import find_capability, is_beyond
from presswork.study.scatter.study_file import Map

MOST_CPK = 10.0
"""Shown of places that hardly scatter."""


class ResultWithMaps(Result):
    """The results of a run with values of a study at the places of the last step."""

    def __init__(self, folder: Path, maps: Mapping[str, FloatArray], kind: str) -> None:
        super().__init__(folder)
        self._maps, self._map_kind = maps, kind

    def scalar(self, name: str, step: int = -1) -> FloatArray:
        """Return a map or a field (n,)."""
        return self._maps[name] if name in self._maps else super().scalar(name, step)

    def unit(self, name: str) -> str:
        """Return a field's unit; maps are pure numbers."""
        return "1" if name in self._maps else super().unit(name)

    def kind(self, name: str) -> str:
        """Return whether a field or map lives on the "point"s or the "cell"s."""
        return self._map_kind if name in self._maps else super().kind(name)


@dataclass(frozen=True)
class FieldMap:
    """A field place by place."""

    of: Map
    unit: str
    """Unit of the field."""
    share: FloatArray
    """Part of the runs beyond the limit at each place (n,)."""
    cpk: FloatArray
    """Capability at each place (n,), at most MOST_CPK."""
    counted: int
    """Runs that have the mesh of the first."""
    left_out: int
    """Runs that have another, or no results."""
    worst: int
    """Place where most runs are beyond the limit, of these that of the least capability."""
    at: tuple[float, ...]
    """Coordinates of the worst place in the first run [mm]."""

    def to_data(self) -> dict[str, Any]:
        """Return what robust.json has of it."""
        limit = {name: getattr(self.of, name) for name in ("at_most", "at_least") if getattr(self.of, name) is not None}
        found = {
            "field": self.of.field,
            "unit": self.unit,
            **limit,
            "runs": self.counted,
            "runs_left_out": self.left_out,
        }
        worst = {"share_beyond": float(self.share[self.worst]), "cpk": float(self.cpk[self.worst])}
        return found | {"worst_place": {"at_mm": list(self.at), **worst}}


def map_field(of: Map, folders: Sequence[Path]) -> tuple[FieldMap | None, str]:
    """Return the map of a field over runs, or None and why there is none."""
    values: list[FloatArray] = []
    first: Result | None = None
    fault, left_out = "no run has results", 0
    for folder in folders:
        try:
            result = Result(folder)
            found = result.scalar(of.field)
        except (OutputError, ResultError) as error:
            fault, left_out = str(error), left_out + 1
            continue
        first = first or result
        if len(values) and len(found) != len(values[0]):
            left_out += 1
            continue
        values.append(found)
    if first is None or len(values) < 2:
        return None, fault
    limit, table = of.limit(), np.array(values)
    share = is_beyond(table.ravel(), limit).reshape(table.shape).mean(axis=0)
    cpk = np.array([min(find_capability(place, limit).cpk, MOST_CPK) for place in table.T])
    worst = int(np.lexsort((cpk, -share))[0])
    at = _find_place(first, of.field, worst)
    return FieldMap(of, first.unit(of.field), share, cpk, len(values), left_out, worst, at), ""


def _find_place(result: Result, field: str, number: int) -> tuple[float, ...]:
    """Return where a node or the middle of a cell is at the end [mm]."""
    points = result.points()
    if result.kind(field) == "point":
        return tuple(float(x) for x in points[number])
    for block in result.mesh_at().blocks:
        if number < len(block.connectivity):
            return tuple(float(x) for x in points[block.connectivity[number]].mean(axis=0))
        number -= len(block.connectivity)
    raise AssertionError("a cell of some block")


def draw_map(found: FieldMap, folder: Path, path: Path) -> Path | None:
    """Draw the share of runs beyond the limit on the part of a run; None without matplotlib."""
    try:
        from presswork.view import plot_mesh
        from presswork.view.plots.shell_plot import plot_shell
        from presswork.view.style import bare_figure, save_picture
    except ImportError:
        return None
    name = f"share of runs with {found.of.field} beyond its limit"
    result = ResultWithMaps(folder, {name: found.share}, Result(folder).kind(found.of.field))
    figure = bare_figure()
    if result.is_shell or result.is_space_solid:
        plot_shell(result, name, value_range=(0.0, max(float(found.share.max()), 1e-3)), figure=figure)
    else:
        plot_mesh(result, name, ax=figure.subplots())
    return save_picture(figure, path)
