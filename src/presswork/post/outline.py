# SPDX-License-Identifier: Apache-2.0
"""The outline of a drawn sheet, its flange."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IndexArray
from presswork.results import Result, ResultError

_NEAR = 1e-6
"""Part of the blank's size within which a node lies in a symmetry plane."""


def trace_outline(result: Result, step: int = -1) -> list[FloatArray]:
    """Return the edges of the whole sheet as deformed: closed loops (n, 3) [mm], the first point not repeated.

    The longest is first, then holes. What symmetry planes have cut off is mirrored back.
    Raises ResultError for a body that is no sheet.
    """
    if not result.is_shell:
        raise ResultError(f"{result.folder} holds no sheet with an outline")
    mesh, now = result.mesh_at(step), result.points(step)
    start, edges = mesh.points, mesh.boundary_edges[:, :2].astype(np.intp)
    nodes = np.arange(len(start))
    for axis, name in enumerate("xy"):
        if name not in str(result.info.get("symmetry", "")):
            continue
        on_plane = np.abs(start[nodes][:, axis]) <= _NEAR * float(np.ptp(start, axis=0).max())
        edges = edges[~on_plane[edges].all(axis=1)]
        image = np.where(on_plane, np.arange(len(nodes)), np.arange(len(nodes)) + len(nodes))
        mirrored = now.copy()
        mirrored[:, axis] *= -1.0
        now, nodes = np.concatenate([now, mirrored]), np.concatenate([nodes, nodes])
        edges = np.concatenate([edges, image[edges[:, ::-1]]])
    loops = [now[loop] for loop in _chain(edges)]
    return sorted(loops, key=lambda loop: -float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum()))


def _chain(edges: IndexArray) -> list[IndexArray]:
    """Join directed edges (n, 2) of which one leaves every node to closed loops of nodes."""
    after = dict(edges.tolist())
    loops = []
    while after:
        first, node = after.popitem()
        loop = [first]
        while node != first:
            loop.append(node)
            node = after.pop(node)
        loops.append(np.array(loop, dtype=np.intp))
    return loops
