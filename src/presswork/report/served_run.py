# SPDX-License-Identifier: Apache-2.0
"""A run as a served page asks for it: header first, numbers by their addresses, news while it computes."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import numpy as np

from presswork.model import FloatArray
from presswork.post import judge_result
from presswork.post.weld_lines import find_welds
from presswork.report.choose import Shown, list_fields
from presswork.report.history import pack_history
from presswork.report.pack import Blocks, Packed
from presswork.report.parts import (
    describe_run,
    describe_saved_step,
    describe_shown,
    pack_draw_in,
    pack_interfaces,
)
from presswork.report.run_data import pack_tools
from presswork.report.surface import Surface, find_surface
from presswork.results import Result, ResultError, ResultMesh

_MESH_ARRAYS = ("triangles", "face", "lines", "boundary", "welds", "reference", "hexahedra", "owners")


class ServedRun:
    """One run; each of its methods may be called from any thread."""

    def __init__(self, folder: Path, name: str) -> None:
        """name: how addresses name the folder."""
        self.folder = folder
        self.generation = 0
        """Grows when the results are no longer a continuation of those that were seen before."""
        self._query = urlencode({"run": name})
        self._lock = threading.Lock()
        self._forget()

    def _forget(self) -> None:
        self._result = Result(self.folder)
        self._steps: list[dict[str, Any]] = []
        self._meshes: list[tuple[ResultMesh, Surface]] = []
        self._fields: list[Shown] = []
        self._extremes: dict[str, list[FloatArray]] = {}

    # --- what a page asks --------------------------------------------------------------------------------------------

    def header(self) -> dict[str, Any]:
        """Return the run's header, its arrays as addresses. Raises OutputError if results cannot be read."""
        with self._open():
            result, inline = self._result, Blocks(is_inline=True)
            return {
                **describe_run(result),
                "address": self._query,
                "fields": [describe_shown(result, shown, (0.0, 1.0)) for shown in self._fields],
                "meshes": self._describe_meshes(),
                "steps": list(self._steps),
                "tools": pack_tools(result, inline),
                "history": pack_history(result, inline),
                "draw_in": pack_draw_in(result, range(len(self._steps))),
                "notes": [],
            }

    def news(self, steps: int, rows: int) -> dict[str, Any]:
        """Return what is new to a page that knows so many saved steps and rows of the history."""
        with self._open():
            history = pack_history(self._result, Blocks(is_inline=True))
            count = history["columns"][0]["values"]["n"] if history["columns"] else 0
            return {
                "generation": self.generation,
                "steps": self._steps[steps:],
                "meshes": self._describe_meshes(),
                "summary": self._result.summary,
                "verdict": judge_result(self._result).to_data(),
                "curves": history if count != rows else None,
            }

    def array(self, what: str, step: int, field: str = "") -> Packed:
        """Return an array: `points` or `field` of a step, or one of a mesh by its number. Raises ResultError."""
        with self._open():
            blocks = Blocks(is_inline=True)
            if what in _MESH_ARRAYS:
                mesh, surface = self._meshes[self._check(step, len(self._meshes))]
                if what == "reference":
                    return blocks.add_values(surface.take_points(mesh.points))
                return blocks.add_indices(getattr(surface, "faces" if what == "face" else what))
            step = self._check(step, len(self._steps))
            if what == "field":
                return blocks.add_values(self._values(self._find(field), step))
            if what == "points":
                return blocks.add_values(self._surface(step).take_points(self._result.points(step)))
            raise ResultError(f"there is no array {what}")

    def range(self, field: str) -> list[float]:
        """Return the least and the largest value of a field over the steps seen so far."""
        with self._open():
            shown, known = self._find(field), self._extremes.setdefault(field, [])
            for step in range(len(known), len(self._steps)):
                values = self._values(shown, step)
                inside = values[np.isfinite(values)]
                known.append(np.array([inside.min(), inside.max()]) if len(inside) else np.zeros(2))
            lows, highs = np.transpose(known)
            return [float(lows.min()), float(highs.max())]

    # --- what was written --------------------------------------------------------------------------------------------

    @contextmanager
    def _open(self) -> Iterator[None]:
        """Take up the steps written since, from the first if they do not continue those known; keep the file open."""
        with self._lock:
            times, known = self._result.times, [step["time"] for step in self._steps]
            if times[: len(known)].tolist() != known:
                self._forget()
                self.generation += 1
            with self._result.kept_open():
                if not self._fields:
                    self._fields = list_fields(self._result)
                for step in range(len(self._steps), len(self._result.times)):
                    self._steps.append(self._describe_step(step))
                yield

    def _describe_step(self, step: int) -> dict[str, Any]:
        result, mesh = self._result, self._result.mesh_at(step)
        number = next((i for i, (known, _) in enumerate(self._meshes) if known is mesh), len(self._meshes))
        if number == len(self._meshes):
            self._meshes.append((mesh, find_surface(mesh, has_inside=True, welds=find_welds(result, step))))
        return {
            **describe_saved_step(result, step),
            "mesh": number,
            "points": self._address("points", step),
            "fields": [self._address("field", step, shown.name) for shown in self._fields],
            "interface": pack_interfaces(result, self._meshes[number][1], step),
        }

    def _describe_meshes(self) -> list[dict[str, Any]]:
        return [
            {
                "nodes": len(surface.nodes),
                "faces": len(surface.cells),
                **{name: self._address(name, number) for name in _MESH_ARRAYS},
            }
            for number, (_, surface) in enumerate(self._meshes)
        ]

    def _address(self, what: str, step: int, field: str = "") -> Packed:
        rest = {"what": what, "step": step, "of": self.generation, **({"field": field} if field else {})}
        return {"address": f"array?{self._query}&{urlencode(rest)}"}

    def _surface(self, step: int) -> Surface:
        number: int = self._steps[step]["mesh"]
        return self._meshes[number][1]

    def _values(self, shown: Shown, step: int) -> FloatArray:
        values, surface = shown.pick(self._result.field(shown.stored, step)), self._surface(step)
        return surface.take_points(values) if shown.kind == "point" else surface.take_cells(values)

    def _find(self, field: str) -> Shown:
        found = next((shown for shown in self._fields if shown.name == field), None)
        if found is None:
            raise ResultError(f"the run has no field {field}")
        return found

    def _check(self, number: int, count: int) -> int:
        if not 0 <= number < count:
            raise ResultError(f"there are {count} of them, no number {number}")
        return number
