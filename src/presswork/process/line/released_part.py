# SPDX-License-Identifier: Apache-2.0
"""A formed part without its tools: how it was cut, how far it has sprung, and the summary of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from presswork.geometry.best_fit import measure_deviation
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, Mesh, Springback
from presswork.process.line.springback_report import ReleasedShape, report_shape
from presswork.process.mesh_change.trim import Cut, explain_beside

TRIM = "trim"
"""Name of the cut in the summary and in a checkpoint."""
WORTH_A_WARNING = 0.2
"""Distance by which the trimmed outline misses its line, over the size of an element, from which on a warning reports
it."""


@dataclass(frozen=True)
class Released:
    """The part without its tools."""

    implicit: ImplicitProcedure
    cut: Cut | None
    formed: FloatArray
    """Displacement when it was released (n_points, 3) [mm]."""
    elastic: float
    """Energy stored then [N mm]."""
    heated: Mapping[str, FloatArray] = field(default_factory=dict)
    """Temperatures and phases, as in SheetState.heated."""

    @property
    def moved(self) -> FloatArray:
        """Displacement of springback (n_points, 3) [mm]."""
        return np.asarray(self.implicit.state.nodes.displacement[:, :3] - self.formed)

    def find_deviation(self, mesh: Mesh, symmetry: tuple[bool, bool]) -> FloatArray:
        """Return how far nodes lie off the shape in the tools (n_points,) [mm]; symmetry: planes x = 0 and y = 0."""
        formed = mesh.points + self.formed
        cells = [block.connectivity for block in mesh.blocks]
        return measure_deviation(formed + self.moved, formed, cells, symmetry)

    def summarise_cut(self, mesh: Mesh) -> tuple[dict[str, Any], list[str]]:
        """Return the summary of trimming, and its warnings; empty for a part that was not cut."""
        if self.cut is None:
            return {}, []
        miss = self.cut.off_line
        summary = {
            "cells": sum(len(block.connectivity) for block in mesh.blocks),
            "off_line_mm": miss,
            "beside_sheet": {name: asdict(each) for name, each in self.cut.beside.items()},
        }
        warnings = [*explain_beside(self.cut)]
        if miss > WORTH_A_WARNING * self.cut.element_size:
            warnings.append(f"the trimmed outline is up to {miss:.3g} mm off its line: refine the blank there")
        return {TRIM: summary}, warnings

    def summarise_springback(
        self, mesh: Mesh, symmetry: tuple[bool, bool], asked: Springback
    ) -> tuple[dict[str, Any], list[str]]:
        """Return the summary of springback, the displacements of the points that the case names, and warnings."""
        distance = np.linalg.norm(self.moved, axis=1)
        at, deviation = int(np.argmax(distance)), self.find_deviation(mesh, symmetry)
        progress = self.implicit.state[Progress]
        place = mesh.points[at] + self.implicit.state.nodes.displacement[at, :3]
        formed = mesh.points + self.formed
        cells = [block.connectivity for block in mesh.blocks]
        shape, warnings = report_shape(ReleasedShape(formed, formed + self.moved, cells, symmetry), asked)
        summary = {
            "largest_mm": float(distance[at]),
            "at_mm": [float(x) for x in place],
            "at_blank_mm": [float(x) for x in mesh.points[at]],
            "deviation_mm": [float(deviation.min()), float(deviation.max())],
            "increments": progress.increments,
            "iterations": progress.iterations,
            "cutbacks": progress.cutbacks,
            **shape,
        }
        return summary, warnings
