# SPDX-License-Identifier: Apache-2.0
"""The outline of a drawn sheet, its flange."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IndexArray
from presswork.results import Result, ResultError

_NEAR = 1e-6
"""Part of the blank's size within which a node lies in a symmetry plane."""


@dataclass(frozen=True)
class OutlineLoop:
    """A closed edge of the whole sheet, the sheet on its left."""

    nodes: IndexArray
    """Nodes of the mesh in order (n,); mirror images repeat them."""
    signs: FloatArray
    """Factors on x and y of the node, -1 in a mirror image (n, 2)."""

    def place(self, points: FloatArray) -> FloatArray:
        """Return the loop's places, or its vectors, of those of all nodes (n_points, 2 | 3)."""
        found = np.array(points[self.nodes])
        found[:, :2] *= self.signs
        return found


def find_outline(result: Result, step: int = -1) -> list[OutlineLoop]:
    """Return the edges of the whole sheet, in no order.

    What symmetry planes have cut off is mirrored back. Raises ResultError for a body that is no sheet.
    """
    if not result.is_shell:
        raise ResultError(f"{result.folder} holds no sheet with an outline")
    mesh = result.mesh_at(step)
    start, edges = mesh.points, mesh.boundary_edges[:, :2].astype(np.intp)
    nodes, signs = np.arange(len(start)), np.ones((len(start), 2))
    for axis, name in enumerate("xy"):
        if name not in str(result.info.get("symmetry", "")):
            continue
        on_plane = np.abs(start[nodes][:, axis]) <= _NEAR * float(np.ptp(start, axis=0).max())
        edges = edges[~on_plane[edges].all(axis=1)]
        image = np.where(on_plane, np.arange(len(nodes)), np.arange(len(nodes)) + len(nodes))
        mirrored = signs.copy()
        mirrored[:, axis] *= -1.0
        nodes, signs = np.concatenate([nodes, nodes]), np.concatenate([signs, mirrored])
        edges = np.concatenate([edges, image[edges[:, ::-1]]])
    return [OutlineLoop(nodes[loop], signs[loop]) for loop in _chain(edges)]


def trace_outline(result: Result, step: int = -1) -> list[FloatArray]:
    """Return the edges of the whole sheet as deformed: closed loops (n, 3) [mm], the first point not repeated.

    The longest is first, then holes. What symmetry planes have cut off is mirrored back.
    Raises ResultError for a body that is no sheet.
    """
    now = result.points(step)
    loops = [loop.place(now) for loop in find_outline(result, step)]
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
