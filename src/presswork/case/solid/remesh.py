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
        size = self.find_size(mesh)
        smallest = SMALLEST * size if self.smallest_size is None else self.smallest_size
        return model.Remeshing(size, smallest, self.max_cells, self.quality, self.every)

    def find_size(self, mesh: model.Mesh) -> float:
        """Return the largest edge of cells [mm]."""
        if self.size is not None:
            return self.size
        corners = mesh.points[np.concatenate([block.connectivity for block in mesh.blocks])]
        return float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean())


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
        "solver.displacements": case.solver.displacements == "small",
    }
    for number, stage in enumerate(case.stages):
        for key in ("displacement", "force", "edge_force", "pressure"):
            keys[f"stages.{number}.{key}"] = bool(getattr(stage, key))
    problems = [Problem(key, "does not go together with [remesh]", remedy) for key, is_so in keys.items() if is_so]
    if not case.workpiece.element.startswith("quad4"):
        fault = f"{case.workpiece.element!r} cannot be meshed anew: new meshes are of four-node quadrilaterals"
        problems.append(Problem("workpiece.element", fault, 'use "quad4_fbar", or leave out [remesh]'))
    return problems


def check_sizes(remesh: Remesh, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of sizes that do not fit each other or the workpiece."""
    size, smallest, problems = remesh.find_size(mesh), remesh.smallest_size, []
    if smallest is not None and smallest > size:
        fault = f"smallest_size ({smallest:g} mm) exceeds the largest edge of cells ({size:g} mm)"
        problems.append(Problem("remesh.smallest_size", fault, "make it smaller, or leave it out"))
    extent = float(np.ptp(mesh.points, axis=0).min())
    if remesh.size is not None and size > extent:
        fault = f"size ({size:g} mm) exceeds the least extent of the workpiece ({extent:g} mm)"
        problems.append(Problem("remesh.size", fault, "make it smaller, or leave it out"))
    edges = mesh.points[mesh.boundary_edges[:, :2]]
    round_it = float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum())
    if round_it > 10 * size * remesh.max_cells:
        fault = f"size ({size:g} mm) is too small for max_cells = {remesh.max_cells}: the boundary has {round_it:g} mm"
        problems.append(Problem("remesh.size", fault, "make it larger, or leave it out"))
    return problems
