# SPDX-License-Identifier: Apache-2.0
"""When to mesh a body in space anew: before its mesh is of no more use."""

from __future__ import annotations

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.notches import SHARP, measure_notch
from presswork.remesh.space.size_field import EdgeSizes, measure_sizes
from presswork.remesh.space.surface import nearest_on_segments
from presswork.remesh.space.tetrahedra import measure_quality

TOO_LONG = 2.2
"""Edge of the skin over the size wanted there."""
TOO_DEEP = 0.12
"""Depth to which a tool cuts an edge, over its length."""
BESIDE = 0.75
"""Distance of an edge's middle from a sharp edge of a tool, over its length, within which that cuts it on any mesh."""
WORSE = 1.3
"""Depth over that which a new mesh has left, and worst quality over that, beyond which another mesh is made."""


def find_flat_cell(body: OldBody, increment: FloatArray, least: float) -> str | None:
    """Describe the cell that will be flat after another increment like the last (n, 3) [mm], or is now."""
    now, then = (measure_quality(points, body.cells) for points in (body.points, body.points + increment))
    expected = np.minimum(now, then)
    worst = int(np.argmin(expected))
    if expected[worst] >= least:
        return None
    where = _name_place(body.points[body.cells[worst]].mean(axis=0))
    return f"a cell near {where} of quality {expected[worst]:.2g} after the next increment"


def find_notch(body: OldBody, sharpest: float = SHARP) -> str | None:
    """Describe where the skin is about to fold onto itself: a void that a new mesh fills is sharper than an angle."""
    angle, middle = measure_notch(body)
    return f"a notch of {angle:.2g} degrees near {_name_place(middle)}" if angle < sharpest else None


def find_long_edge(body: OldBody, sizes: EdgeSizes, *, longest: float = TOO_LONG) -> str | None:
    """Describe an edge of the skin that is too long for the tools ahead of it or the metal beneath it."""
    ratio, middle = _find_longest(body, sizes)
    return f"an edge {ratio:.2g} times too long near {_name_place(middle)}" if ratio > longest else None


def measure_edge(body: OldBody, sizes: EdgeSizes) -> float:
    """Return the longest edge of the skin over the size wanted there."""
    return _find_longest(body, sizes)[0]


def _find_longest(body: OldBody, sizes: EdgeSizes) -> tuple[float, FloatArray]:
    """Return the length over the wanted one of the edge where that is largest, and its middle (3,)."""
    ends = body.points[body.edges]
    try:
        wanted = measure_sizes(body, sizes)[body.edges].mean(axis=1)
    except MeshError:  # the budget has no shorter ones
        return 0.0, ends[0].mean(axis=0)
    ratio = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / wanted
    worst = int(np.argmax(ratio))
    return float(ratio[worst]), ends[worst].mean(axis=0)


def find_cut_edge(
    body: OldBody, *, deepest: float = TOO_DEEP, smallest: float = 0.0, sharp_counts: bool = False
) -> str | None:
    """Describe an edge of the skin that lies too deep in a tool between its nodes.

    Beside a sharp edge of a tool every edge does, on any mesh, and so it does on a radius that chords of the smallest
    length [mm] cut deeper than TOO_DEEP: unless sharp_counts, those do not count.
    """
    depth, middle, part = _find_deepest(body, smallest, sharp_counts)
    if part <= deepest:
        return None
    return f"a tool {depth:.2g} mm deep in an edge near {_name_place(middle)}"


def find_cut_face(body: OldBody, deepest: float) -> str | None:
    """Describe a face of the skin that lies too deep in a tool, as limits.penetration counts it, sharp edges included.

    A ridge narrower than a face may come in between its edges.
    """
    depth, middle, part = _find_deepest_in_faces(body)
    if part <= deepest:
        return None
    return f"a tool {depth:.2g} mm deep in a face near {_name_place(middle)}"


def find_stretched_cut(body: OldBody, start: FloatArray, deepest: float) -> str | None:
    """Describe an edge of the skin that lies too deep in a tool by its length when the mesh was made, as
    limits.penetration
    counts it: the flow may have made it longer since.

    start: where the nodes were then (n, 3) [mm].
    """
    ends = start[body.edges]
    length, depth = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), body.edge_depths.max(axis=0, initial=0.0)
    worst = int(np.argmax(depth / length))
    if depth[worst] <= deepest * length[worst]:
        return None
    middle = _name_place(body.points[body.edges[worst]].mean(axis=0))
    return f"a tool {depth[worst]:.2g} mm deep in an edge near {middle}, {length[worst]:.2g} mm long at first"


def measure_cut_face(body: OldBody) -> float:
    """Return how deep a tool lies in the middle of a face of the skin at most, over its longest side."""
    return _find_deepest_in_faces(body)[2]


def measure_cut(body: OldBody, smallest: float = 0.0, *, sharp_counts: bool = False) -> float:
    """Return how deep a tool lies in an edge of the skin at most, over its length.

    Unless sharp_counts, what no mesh with edges of the smallest length [mm] follows does not count.
    """
    return _find_deepest(body, smallest, sharp_counts)[2]


def _find_deepest(body: OldBody, smallest: float, sharp_counts: bool) -> tuple[float, FloatArray, float]:
    """Return the depth of a tool in an edge [mm], the edge's middle (3,), and the depth over its length, at worst."""
    ends = body.points[body.edges]
    middle, length = ends.mean(axis=1), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    worst = 0.0, middle[0], 0.0
    for tool, depth in zip(body.tools, body.edge_depths, strict=True):
        part = depth / length
        cut = np.flatnonzero(part > worst[2])
        tight = tool.tight_edges(smallest / (8.0 * TOO_DEEP))  # a chord c of a radius r is c^2 / 8 r deep
        if len(cut) and len(tight) and not sharp_counts:
            _, away = nearest_on_segments(tight, middle[cut], float(length[cut].max()))
            part[cut[away < BESIDE * length[cut]]] = 0.0
        deepest = int(np.argmax(part))
        if part[deepest] > worst[2]:
            worst = float(depth[deepest]), middle[deepest], float(part[deepest])
    return worst


def _find_deepest_in_faces(body: OldBody) -> tuple[float, FloatArray, float]:
    """Return the depth of a tool in a face [mm], the face's middle (3,), and the depth over its longest side."""
    corners = body.points[body.faces]
    middle = corners.mean(axis=1)
    length = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    depth = body.face_depths.max(axis=0, initial=0.0)
    deepest = int(np.argmax(depth / length))
    return float(depth[deepest]), middle[deepest], float(depth[deepest] / length[deepest])


def _name_place(place: FloatArray) -> str:
    return "(" + ", ".join(f"{c:.4g}" for c in place) + ")"
