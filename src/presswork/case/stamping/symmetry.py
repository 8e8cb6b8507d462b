# SPDX-License-Identifier: Apache-2.0
"""Whether the symmetry planes of a blank are those of its tools from files, its beads and its trim lines, too."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from presswork import _core
from presswork.case.errors import Problem
from presswork.case.stamping.schema import StampingCase
from presswork.geometry.asymmetry import Asymmetry, HalfSpace, find_asymmetry
from presswork.geometry.polygon import measure_distance, sample_sides
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Mesh, Tool, Triangulation, TrimLine

UNLIKE = 1e-3
"""How far two halves may differ, as facets do, over the blank's size."""
UNLIKE_OF_THICKNESS = 0.15
"""The same of the thickness, where that is more."""
OVER_OF_TOOL = 0.1
"""Length of a tool beyond the plane over its reach from the plane up to which it counts as drawn for the half."""
OVER_OF_LINE = 0.5
"""The same for beads and trim lines, which are drawn less exactly."""
PIECES = 200
"""Into which a line is cut to be compared."""


def check_tool_symmetry(case: StampingCase, mesh: Mesh, tools: Sequence[Tool]) -> list[Problem]:
    """Return the problems of tools of triangles that a symmetry plane of the blank does not halve."""
    problems = []
    for tool in tools:
        if not isinstance(tool.shape, Triangulation):
            continue  # drawn about its own middle, which check_tools wants in the plane
        position, surface = np.asarray(tool.position), make_surface(tool.shape)
        places = _sample(tool.shape, position, np.abs(mesh.points[:, :2]).max(axis=0))

        measure = partial(_measure, surface, position)
        for plane, half in _list_halves(case):
            margin = OVER_OF_TOOL * max(float(half.depth(places).max()), 0.0)
            found = find_asymmetry(places, measure, half, _find_window(mesh, half), margin, _tolerance(case, mesh))
            if found is not None:
                problems.append(_explain(f"tools.{tool.name}", "tool", plane, found))
    return problems


def check_line_symmetry(case: StampingCase, mesh: Mesh, trim: Sequence[TrimLine]) -> list[Problem]:
    """Return the problems of beads and trim lines that a symmetry plane of the blank cuts, but does not halve."""
    lines = [(f"beads.{index}.points", bead.polyline()) for index, bead in enumerate(case.beads)]
    lines += [(f"trim.{each.name}", np.concatenate([each.polygon, each.polygon[:1]])) for each in trim]
    problems = []
    for key, line in lines:
        sides = np.stack([line[:-1], line[1:]], axis=1)
        places = sample_sides(sides, float(np.linalg.norm(np.ptp(line, axis=0))) / PIECES)
        for plane, half in _list_halves(case):
            reach = float(half.depth(places).max())
            if reach <= 0.0:
                continue  # beside the blank that is modelled, which other checks report
            low, high = _find_window(mesh, half)
            measure, tolerance = partial(measure_distance, sides), _tolerance(case, mesh)
            found = find_asymmetry(places, measure, half, (low[:2], high[:2]), OVER_OF_LINE * reach, tolerance)
            if found is not None:
                problems.append(_explain(key, "line", plane, found))
    return problems


def _sample(shape: Triangulation, position: FloatArray, half_size: FloatArray) -> FloatArray:
    """Return the corners of a surface, and where its edges cross the blank's box in the plan (n, 3) [mm].

    The middles of facets differ where two halves alike are cut into other triangles.
    """
    corners = shape.points + position
    ends = np.concatenate([shape.triangles[:, [0, 1]], shape.triangles[:, [1, 2]], shape.triangles[:, [2, 0]]])
    start, along = corners[ends[:, 0]], corners[ends[:, 1]] - corners[ends[:, 0]]
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = [(side * half_size - start[:, :2]) / along[:, :2] for side in (-1.0, 1.0)]
    crossed = [
        start[on] + part[on, None] * along[on]
        for each in parts
        for part in each.T
        if (on := (part > 0) & (part < 1)).any()
    ]
    return np.concatenate([corners, *crossed])


def _measure(surface: _core.ToolSurface, position: FloatArray, places: FloatArray) -> FloatArray:
    """Return the distance of places (n, 3) from a surface whose origin stands at a position (n,) [mm]."""
    return np.asarray(surface.nearest(np.ascontiguousarray(places - position))[0])


def _list_halves(case: StampingCase) -> list[tuple[str, HalfSpace]]:
    return [(plane, HalfSpace(axis, 0.0)) for axis, plane in enumerate("xy") if plane in case.blank.symmetry]


def _find_window(mesh: Mesh, half: HalfSpace) -> tuple[FloatArray, FloatArray]:
    """Return the least and largest coordinates over the blank, of both its halves along the other axis."""
    high = np.abs(mesh.points).max(axis=0) * (1.0 + 1e-9)
    high[2] = np.inf
    low = -high
    low[half.axis] = half.level
    return low, high


def _tolerance(case: StampingCase, mesh: Mesh) -> float:
    size = float(np.linalg.norm(np.ptp(mesh.points[:, :2], axis=0)))
    return max(UNLIKE * size, UNLIKE_OF_THICKNESS * case.blank.thickest)


def _explain(key: str, what: str, plane: str, found: Asymmetry) -> Problem:
    fault = f"the symmetry plane {plane} = 0 cuts this {what}, but {found.describe()}"
    remedy = f"let the plane halve it, end it there, or leave {plane} out of blank.symmetry"
    return Problem(key, fault, remedy)
