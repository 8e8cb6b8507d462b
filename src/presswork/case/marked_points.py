# SPDX-License-Identifier: Apache-2.0
"""Marked points of a case: points of the material that the history follows."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.mesh.simplices import find_simplices

DESCRIPTION = (
    "points of the material by name, where each is at the start [mm]: the history has its path, stress, strain and "
    "temperature"
)
OUTSIDE = 1e-3
"""How far a point may lie outside the body, over the body's size."""


def build_points(
    points: Mapping[str, Sequence[float]], mesh: model.Mesh, taken: Collection[str]
) -> tuple[tuple[model.MarkedPoint, ...], list[Problem]]:
    """Return the points of a mesh, and the problems of those outside it or with a name that is taken."""
    problems = [
        Problem(f"points.{name}", "the history has this name already", "take another", name)
        for name in points
        if name in taken
    ]
    if not points:
        return (), problems
    places = np.array(list(points.values()), dtype=float)
    nodes, share, outside = find_simplices(mesh, mesh.points, places)
    reach = OUTSIDE * float(np.ptp(mesh.points, axis=0).max())
    for name, place, own, part, distance in zip(points, places, nodes, share, outside, strict=True):
        if distance > reach:
            held = np.clip(part, 0.0, None)
            nearest = (held / held.sum()) @ mesh.points[own]
            remedy = f"for instance [{', '.join(f'{x:.4g}' for x in nearest)}]"
            problems.append(Problem(f"points.{name}", "lies outside the workpiece", remedy, place.tolist()))
    return tuple(model.MarkedPoint(name, tuple(map(float, place))) for name, place in points.items()), problems
