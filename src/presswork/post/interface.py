# SPDX-License-Identifier: Apache-2.0
"""The contact surface: contact nodes in the order in which they lie along it, with their contact stresses."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.post.tool_profile import distance_to_profile, trace_profile
from presswork.results import Result

_NEAR = 5e-3
"""Largest distance of a touching node from the tool's polyline, over the size of the body."""


@dataclass(frozen=True)
class Interface:
    """Contact nodes along the deformed boundary; all arrays have shape (n,) or (n, 2)."""

    nodes: NDArray[np.int64]
    patch: NDArray[np.int64]
    """0, 1, ... for each connected part of the contact surface."""
    points: FloatArray
    """Deformed coordinates [mm]."""
    arc_length: FloatArray
    """Arc length along the deformed boundary from the patch's end with the smaller x [mm]."""
    contact_pressure: FloatArray
    """[MPa], positive in compression."""
    contact_shear: FloatArray
    """[MPa]."""
    friction_limit: FloatArray
    """The largest shear that the tool's friction law allows [MPa]; zero without friction, or if it was not saved."""


def trace_interface(result: Result, tool: str | None = None, step: int = -1) -> Interface:
    """Return the contact surface at a saved step, of one tool or of all.

    A node is in contact if it has a contact force, pressure or shear; it belongs to the tool nearest to it. No contact
    gives empty arrays. Raises ResultError for an unknown tool or step, or if no contact pressure was saved.
    """
    points = result.points(step)
    pressure, shear = result.field("contact_pressure", step), result.field("contact_shear", step)
    touching = (pressure != 0) | (shear != 0)
    if "contact_force" in result.field_names:
        force = result.field("contact_force", step)
        touching |= np.any(force.reshape(len(force), -1) != 0, axis=1)
    if tool is not None:
        reach = _NEAR * float(np.ptp(points, axis=0).max())
        touching[touching] = _nearest_tool(result, points[touching], tool, step, reach)
    patches = order_along_boundary(points, result.mesh_at(step).boundary_edges, touching)
    nodes = np.concatenate([np.zeros(0, dtype=np.int64), *patches])
    has_limit = "friction_limit" in result.field_names
    limit = result.field("friction_limit", step) if has_limit else np.zeros(len(points))
    lengths = [_arc_length(points[patch]) for patch in patches]
    return Interface(
        nodes=nodes,
        patch=np.repeat(np.arange(len(patches)), [len(patch) for patch in patches]),
        points=points[nodes],
        arc_length=np.concatenate([np.zeros(0), *lengths]),
        contact_pressure=pressure[nodes],
        contact_shear=shear[nodes],
        friction_limit=limit[nodes],
    )


def order_along_boundary(
    points: FloatArray, edges: NDArray[np.integer], chosen: NDArray[np.bool_]
) -> list[NDArray[np.int64]]:
    """Return the chosen nodes of the boundary in order, a list for each connected part, parts by growing x.

    `points` (n_points, 2); `edges` (n_edges, 2 | 3) as in Mesh.boundary_edges; `chosen` (n_points,). Two nodes are
    connected if all nodes of the edge between them are chosen. Each part begins at the end with the smaller x
    (the smaller y if they are equal); a closed part at its leftmost node.
    """
    following = _successors(edges, chosen)
    on_boundary = [int(node) for node in np.unique(edges) if chosen[node]]
    starts = sorted(set(on_boundary) - set(following.values()))
    parts: list[list[int]] = []
    seen: set[int] = set()
    leftmost = sorted(on_boundary, key=lambda node: tuple(points[node]))
    for start in [*starts, *leftmost]:
        part: list[int] = []
        node: int | None = start
        while node is not None and node not in seen:
            seen.add(node)
            part.append(node)
            node = following.get(node)
        if part:
            parts.append(part)
    for part in parts:
        if tuple(points[part[-1]]) < tuple(points[part[0]]):
            part.reverse()
    return [np.array(part, dtype=np.int64) for part in sorted(parts, key=lambda part: tuple(points[part[0]]))]


def _successors(edges: NDArray[np.integer], chosen: NDArray[np.bool_]) -> dict[int, int]:
    """Return which node comes after which along the boundary; a mid-side node lies between the ends of its edge."""
    following: dict[int, int] = {}
    for edge in edges[chosen[edges].all(axis=1)].tolist():
        order = edge if len(edge) == 2 else (edge[0], edge[2], edge[1])
        following.update(pairwise(order))
    return following


def _arc_length(points: FloatArray) -> FloatArray:
    """Return the length from the first point to each."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def _nearest_tool(result: Result, points: FloatArray, tool: str, step: int, reach: float) -> NDArray[np.bool_]:
    """Return which points lie on this tool, nearer than to any other; contact elsewhere is that of bodies."""
    distance = {
        name: distance_to_profile(points, trace_profile(result.placed_tool(name, step)))
        for name in {tool, *result.tools}  # an unknown name raises
    }
    nearest = np.all([distance[tool] <= other for other in distance.values()], axis=0)
    return np.asarray((distance[tool] < reach) & nearest, dtype=np.bool_)
