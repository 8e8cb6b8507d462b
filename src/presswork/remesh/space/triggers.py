# SPDX-License-Identifier: Apache-2.0
"""When to mesh a body in space anew: before its mesh is of no more use."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.size_field import EdgeSizes, measure_sizes
from presswork.remesh.space.surface import nearest_on_segments
from presswork.remesh.space.tetrahedra import list_edges, measure_quality

TOO_LONG = 2.2
"""Edge of the skin over the size wanted there."""
TOO_DEEP = 0.08
"""Depth to which a tool cuts an edge, over its length."""
BESIDE = 0.75
"""Distance of an edge's middle from a sharp edge of a tool, over its length, within which that cuts it on any mesh."""
OF_SHARP = 2.0
"""Times the depth that is allowed beside sharp edges of tools."""


def find_flat_cell(body: OldBody, increment: FloatArray, least: float) -> str | None:
    """Say which cell will be flat after another increment like the last (n, 3) [mm], or is now."""
    now, then = (measure_quality(points, body.cells) for points in (body.points, body.points + increment))
    expected = np.minimum(now, then)
    worst = int(np.argmin(expected))
    if expected[worst] >= least:
        return None
    where = _name_place(body.points[body.cells[worst]].mean(axis=0))
    return f"a cell near {where} of quality {expected[worst]:.2g} after the next increment"


def find_long_edge(body: OldBody, sizes: EdgeSizes, *, longest: float = TOO_LONG) -> str | None:
    """Say which edge of the skin is too long for the tools ahead of it or the metal beneath it."""
    edges = list_edges(body.faces)
    ends = body.points[edges]
    wanted = measure_sizes(body, sizes)[edges].mean(axis=1)
    ratio = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / wanted
    worst = int(np.argmax(ratio))
    if ratio[worst] <= longest:
        return None
    return f"an edge {ratio[worst]:.2g} times too long near {_name_place(ends[worst].mean(axis=0))}"


def find_cut_edge(body: OldBody, *, deepest: float = TOO_DEEP, sharp_counts: bool = False) -> str | None:
    """Say which edge of the skin lies too deep in a tool between its nodes.

    Round a sharp edge of a tool every edge does, until a new mesh has nodes on it: unless sharp_counts, OF_SHARP times
    as much is allowed there.
    """
    edges = list_edges(body.faces)
    ends = body.points[edges]
    middle, length = ends.mean(axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    for tool in body.tools:
        gap, _ = tool.touch(middle, float(length.max()))
        depth = np.where(np.isfinite(gap), -gap / length, 0.0)
        cut = np.flatnonzero(depth > deepest)
        if len(cut) and len(tool.sharp_edges) and not sharp_counts:
            _, away = nearest_on_segments(tool.sharp_edges, middle[cut], float(length[cut].max()))
            shallow = depth[cut] < OF_SHARP * deepest
            depth[cut[shallow & (away < BESIDE * length[cut])]] = 0.0
        worst = int(np.argmax(depth))
        if depth[worst] > deepest:
            return f"a tool {-gap[worst]:.2g} mm deep in an edge near {_name_place(middle[worst])}"
    return None


def _name_place(place: FloatArray) -> str:
    return "(" + ", ".join(f"{c:.4g}" for c in place) + ")"
