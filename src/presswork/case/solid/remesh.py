# SPDX-License-Identifier: Apache-2.0
"""Meshing anew in the run: the keys, and what they go with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from presswork import model
from presswork.case.errors import Problem
from presswork.case.part import Part
from presswork.case.settings import Whole
from presswork.case.units import Length, Number

if TYPE_CHECKING:
    from presswork.case.solid.schema import Case

SMALLEST = 0.25
"""Of the largest size."""


class Remesh(Part):
    """When and how finely the workpiece is meshed anew in the run."""

    size: Length | None = Field(
        default=None, gt=0, description="largest edge of cells [mm]; without it: the mean edge of the first mesh"
    )
    smallest_size: Length | None = Field(
        default=None,
        gt=0,
        description="smallest edge of cells, at sharp corners of tools and in thin flash [mm]; without it: a quarter "
        "of the largest",
    )
    max_cells: Whole = Field(default=20_000, ge=50, description="budget of cells: beyond it all become larger")
    quality: Number = Field(
        default=0.2,
        gt=0,
        lt=0.6,
        description="quality of the worst cell, expected after the next increment, below which the workpiece is meshed "
        "anew; a square has 1",
    )
    every: Number = Field(
        default=0.0, ge=0, le=1, description="part of a stage after which it is meshed anew in any case; 0: never"
    )

    def build(self, mesh: model.Mesh) -> model.Remeshing:
        """Return the Model's settings for a workpiece's first mesh."""
        if self.size is not None:
            size = self.size
        else:
            cells = np.concatenate([block.connectivity for block in mesh.blocks])
            corners = mesh.points[cells]
            size = float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean())
        smallest = SMALLEST * size if self.smallest_size is None else self.smallest_size
        return model.Remeshing(size, smallest, self.max_cells, self.quality, self.every)


def check_remesh(case: Case) -> list[Problem]:
    """Return the problems of a case that asks for new meshes with what cannot be carried to them."""
    if case.remesh is None:
        return []
    remedy = "remove it, or leave out [remesh]"
    keys = {
        "procedure": case.procedure == "explicit",
        "bodies": bool(case.bodies),
        "contacts": bool(case.contacts),
        "solver.inertia": case.solver.inertia > 0.0,
        "solver.control": case.solver.control == "arc_length",
    }
    for number, stage in enumerate(case.stages):
        for key in ("displacement", "force", "edge_force", "pressure"):
            keys[f"stages.{number}.{key}"] = bool(getattr(stage, key))
    problems = [Problem(key, "does not go together with [remesh]", remedy) for key, is_so in keys.items() if is_so]
    if not case.workpiece.element.startswith("quad4"):
        fault = f"{case.workpiece.element!r} cannot be meshed anew: new meshes are of four-node quadrilaterals"
        problems.append(Problem("workpiece.element", fault, 'use "quad4_fbar", or leave out [remesh]'))
    size, smallest = case.remesh.size, case.remesh.smallest_size
    if size is not None and smallest is not None and smallest > size:
        fault = f"smallest_size ({smallest:g} mm) exceeds size ({size:g} mm)"
        problems.append(Problem("remesh.smallest_size", fault, "make it smaller, or leave it out"))
    return problems
