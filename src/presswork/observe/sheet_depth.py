# SPDX-License-Identifier: Apache-2.0
"""How deep tools are in the surface of a sheet: in its nodes, where contact is, and in the middles of its cells.

A cell that is long beside the radius that it is bent round lies as a chord in the tool: the part has not taken the
tool's shape, however well its nodes lie on it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray
from presswork.observe.contract import History, Measure, Observed, Observer

SUNK = 0.5
"""Part of the sheet's thickness by which the middle of a cell may lie in a tool without a warning, and"""
BENT = 0.1
"""part of the cell's longest side: fewer than some two cells go round a quarter of a circle there."""
EVERY = 10
"""Increments or intervals from one look at the middles of the cells to the next."""
CHORDS = "sheet_chords"
"""Name in a checkpoint."""


@dataclass(frozen=True)
class _Chord:
    """The middle of a cell that lies deepest in a tool, by the length of the cell."""

    tool: int
    """Number of the tool."""
    depth: float
    """[mm]"""
    side: float
    """Longest side of the cell [mm]."""
    x: float
    y: float
    z: float
    """Place [mm]."""


class SheetDepth(Observer):
    """The depth of every tool in a sheet, by its thickness at the start."""

    def __init__(self) -> None:
        self._surfaces: dict[str, _core.ToolSurface] = {}
        self._deepest: _Chord | None = None

    def measures(self, run: Observed) -> list[Measure]:
        """Return the depths in nodes."""
        if run.number % EVERY == 0:
            self._look(run)
        return [
            Measure(
                "penetration",
                depth / (thickness := run.model.thickest),
                f"the tool {name} is {depth:.3g} mm deep in the surface of the sheet of {thickness:g} mm",
            )
            for name, depth in run.tool_depths().items()
        ]

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return a warning where cells are too long for the tools that they are bent round."""
        chord = self._deepest
        if chord is None:
            return []
        tool = run.model.tools[chord.tool].name
        return [
            f"the tool {tool} lies {chord.depth:.3g} mm deep in the middle of a shell of {chord.side:.3g} mm at "
            f"({chord.x:.4g}, {chord.y:.4g}, {chord.z:.4g}) mm: contact is at nodes, and these shells are too long to "
            "follow the tool; set blank.element_size lower, or blank.refine"
        ]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the deepest middle."""
        return {CHORDS: np.array(astuple(self._deepest))} if self._deepest else {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        if CHORDS in arrays:
            tool, *rest = (float(value) for value in arrays[CHORDS])
            self._deepest = _Chord(int(tool), *rest)

    def _look(self, run: Observed) -> None:
        """Keep the middle of a cell that lies deepest in a tool, of those beyond both limits."""
        depths = run.tool_depths()
        if not depths:
            return
        points, moved = run.positions(), run.tool_displacements()
        found = zip(run.mesh.blocks, run.model.find_relief(), strict=True)
        thickness = np.concatenate([block.thickness + relief for block, relief in found])
        corners = [points[block.connectivity] for block in run.mesh.blocks]
        middles = np.ascontiguousarray(np.concatenate([c.mean(axis=1) for c in corners]))
        sides = np.concatenate([np.linalg.norm(c - np.roll(c, 1, axis=1), axis=2).max(axis=1) for c in corners])
        for number, tool in enumerate(run.model.tools):
            place = np.asarray(tool.position) + moved[tool.name]
            depth = 0.5 * thickness - self._surface(run, number).nearest(np.ascontiguousarray(middles - place))[0]
            share: FloatArray = np.where(depth > SUNK * thickness + depths[tool.name], depth / sides, 0.0)
            at = int(np.argmax(share))
            worst = self._deepest
            if share[at] > max(BENT, worst.depth / worst.side if worst else 0.0):
                self._deepest = _Chord(number, float(depth[at]), float(sides[at]), *(float(v) for v in middles[at]))

    def _surface(self, run: Observed, number: int) -> _core.ToolSurface:
        tool = run.model.tools[number]
        if tool.name not in self._surfaces:
            self._surfaces[tool.name] = make_surface(tool.surface)
        return self._surfaces[tool.name]
