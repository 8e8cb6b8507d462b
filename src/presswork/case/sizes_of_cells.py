# SPDX-License-Identifier: Apache-2.0
"""How large the cells of new meshes are: keys of bodies in the plane and in space."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from presswork import model
from presswork.case.errors import Problem
from presswork.case.part import Part
from presswork.case.units import Length
from presswork.mesh.topology import list_cell_edges
from presswork.remesh.space.tetrahedra import list_edges

SMALLEST = 0.25
"""Smallest size over the largest."""


class SizesOfCells(Part):
    """The largest and the smallest edge of cells."""

    size: Length | None = Field(
        default=None, gt=0, description="largest edge of cells [mm]; without it: the mean edge of the first mesh"
    )
    smallest_size: Length | None = Field(
        default=None,
        gt=0,
        description="smallest edge of cells, at sharp corners and small radii of tools and in thin flash [mm]; in the "
        "plane cells have half of it where the surface lands on a tool; without it: a quarter of the largest",
    )

    def find_size(self, mesh: model.Mesh) -> float:
        """Return the largest edge of cells [mm]."""
        return _measure_mean_edge(mesh) if self.size is None else self.size

    def find_sizes(self, mesh: model.Mesh) -> tuple[float, float]:
        """Return the largest and the smallest edge of cells [mm]."""
        size = self.find_size(mesh)
        return size, SMALLEST * size if self.smallest_size is None else self.smallest_size

    def check_sizes(self, mesh: model.Mesh, key: str) -> list[Problem]:
        """Return the problems of sizes that do not fit each other or the body's first mesh; key: of the table."""
        size, problems = self.find_size(mesh), []
        if self.smallest_size is not None and self.smallest_size > size:
            fault = f"smallest_size ({self.smallest_size:g} mm) exceeds the largest edge of cells ({size:g} mm)"
            problems.append(Problem(f"{key}.smallest_size", fault, "make it smaller, or leave it out"))
        extent = float(np.ptp(mesh.points, axis=0).min())
        if self.size is not None and size > extent:
            fault = f"size ({size:g} mm) exceeds the least extent of the body ({extent:g} mm)"
            problems.append(Problem(f"{key}.size", fault, "make it smaller, or leave it out"))
        return problems


def _measure_mean_edge(mesh: model.Mesh) -> float:
    """Return the mean edge of cells [mm]; in space of tetrahedra, each edge once."""
    if mesh.points.shape[1] == 3:
        edges = list_edges(np.concatenate([block.connectivity for block in mesh.blocks]))
    else:
        edges = np.concatenate([list_cell_edges(block.connectivity)[:, :2] for block in mesh.blocks])
    return float(np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1).mean())
