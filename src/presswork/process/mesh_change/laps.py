# SPDX-License-Identifier: Apache-2.0
"""Laps as a run reports them: field, summary and warnings, from marks on the surface and seams inside the metal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.mesh.faces import face_areas
from presswork.mesh.topology import find_parts
from presswork.model import FloatArray, Mesh
from presswork.process.mesh_change.seams import Seams

MARKED = 0.5
"""Value of a mark from which on a node counts as part of a lap; on a new mesh marks are interpolated."""


@dataclass(frozen=True)
class Lap:
    """One lap where it is now."""

    place: FloatArray
    """Its middle (2 | 3,) [mm]."""
    extent: float
    """Its length in the plane [mm], its area in space [mm2]."""


def mark_laps(mark: FloatArray, seams: Seams) -> FloatArray:
    """Return the field of laps: 1 at nodes on the surface that touches itself, and at those beside seams (n,)."""
    marked = mark.copy()
    marked[seams.nearest()] = 1.0
    return marked


def find_laps(mesh: Mesh, position: FloatArray, mark: FloatArray, seams: Seams) -> list[Lap]:
    """Return the laps: marked nodes that sides of the surface or a seam connect.

    position: of the nodes (n_points, 2 | 3) [mm]; mark: of those on the surface (n_points,).
    """
    folded, groups = mark > MARKED, seams.groups()
    marked = mark_laps(mark, seams) > MARKED
    in_space = position.shape[1] == 3
    sides = mesh.boundary_faces if in_space else mesh.boundary_edges[:, :2]
    touching = sides[folded[sides].all(axis=1)]
    if in_space:
        extent = face_areas(position, touching).sum(axis=1)
    else:
        extent = np.linalg.norm(np.diff(position[touching], axis=1), axis=2)
    edges = np.stack([sides, np.roll(sides, -1, axis=1)], axis=-1).reshape(-1, 2)
    alone = np.repeat(np.flatnonzero(marked)[:, None], 2, axis=1)
    along = [np.column_stack([np.full(len(nodes), nodes[0]), nodes]) for nodes in groups]
    _, part = find_parts([np.concatenate([edges[marked[edges].all(axis=1)], alone, *along])], len(position))
    first = np.concatenate([touching[:, 0], [nodes[0] for nodes in groups]]).astype(np.intp)
    extents = np.concatenate([np.ravel(extent), seams.extents(position)])
    return [
        Lap(position[marked & (part == number)].mean(axis=0), float(extents[part[first] == number].sum()))
        for number in np.unique(part[marked])
    ]


def explain_laps(laps: Sequence[Lap], begun: Sequence[float]) -> list[str]:
    """Return a warning of each lap; begun: when the first began [s], negative: not so."""
    first = min((time for time in begun if time >= 0.0), default=0.0)
    warnings: list[str] = []
    for lap in laps:
        unit, near = "mm" if len(lap.place) == 2 else "mm2", ", ".join(f"{c:.4g}" for c in lap.place)
        warnings.append(
            f"the surface has folded onto itself near ({near}), over {lap.extent:.3g} {unit}, first at {first:.4g} s: "
            "a lap, a fault of the part (field lap)"
        )
    return warnings


def list_laps(laps: Sequence[Lap]) -> list[Mapping[str, float]]:
    """Return place and extent of each lap for the summary."""
    return [
        {f"{axis}_mm": float(c) for axis, c in zip("xyz", lap.place, strict=False)}
        | {"length_mm" if len(lap.place) == 2 else "area_mm2": lap.extent}
        for lap in laps
    ]
