# SPDX-License-Identifier: Apache-2.0
"""How far the weld lines of a welded blank have moved, in the history and the summary.

A line moves along its normal in the plan of the undeformed blank; into its zone counts positive. The largest movement
of its nodes counts, with its sign.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.mesh.weld_edges import find_weld_edges, find_weld_normals
from presswork.model import FloatArray, IntArray, Model
from presswork.observe.contract import History, Observed, Observer, Row


class WeldLines(Observer):
    """The weld lines of a model, on its present mesh."""

    def __init__(self, model: Model) -> None:
        blocks = model.mesh.blocks
        kinds, zones = [block.connectivity for block in blocks], [block.zone for block in blocks]
        self._lines: list[tuple[str, IntArray, FloatArray]] = []
        for number, name in enumerate(model.zones):
            edges = find_weld_edges(kinds, zones, number) if number else np.zeros((0, 2), dtype=np.int32)
            if len(edges):
                self._lines.append((name, *find_weld_normals(model.mesh.points, edges)))

    def columns(self, run: Observed) -> list[str]:
        """Return one for each zone [mm]."""
        return [f"{name}.weld_movement" for name, *_ in self._lines]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the largest movement of each zone's weld line."""
        return {f"{name}.weld_movement": value for name, (value, _) in self._measure(run).items()}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the largest movement of each zone's weld line and the largest each way, with their places."""
        found = {}
        for name, (value, ends) in self._measure(run).items():
            named = zip(("out_of_zone", "into_zone"), ends, strict=True)
            found[name] = {"movement_mm": value} | {key: {"mm": mm, "place": place} for key, (mm, place) in named}
        return {"weld_lines": found} if found else {}

    def _measure(self, run: Observed) -> dict[str, tuple[float, list[tuple[float, list[float]]]]]:
        """Return the largest movement of each line, then least and largest with the places of their nodes now [mm]."""
        if not self._lines:
            return {}
        now, found = run.positions(), {}
        moved = now[:, :2] - run.model.mesh.points[:, :2]
        for name, nodes, normals in self._lines:
            along = (moved[nodes] * normals).sum(axis=1)
            rows = [int(np.argmin(along)), int(np.argmax(along))]
            ends = [(float(along[row]), [float(x) for x in now[nodes[row]]]) for row in rows]
            found[name] = max(along[rows].tolist(), key=abs), ends
        return found
