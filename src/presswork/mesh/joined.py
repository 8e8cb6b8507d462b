# SPDX-License-Identifier: Apache-2.0
"""One mesh of several bodies that share no node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from presswork.model import Body, CellBlock, IntArray, Mesh


def join_meshes(parts: Mapping[str, Mesh]) -> tuple[Mesh, tuple[Body, ...]]:
    """Put meshes into one, bodies in the order given; return it and which points and blocks are whose.

    The first body's sets keep their names, those of the others are called BODY.SET. Raises ValueError if some bodies
    have straight edges of two nodes and others edges of three.
    """
    if len({mesh.boundary_edges.shape[1] for mesh in parts.values()}) > 1:
        raise ValueError("bodies with linear and with quadratic elements do not go together")
    blocks: list[CellBlock] = []
    node_sets: dict[str, IntArray] = {}
    edge_sets: dict[str, IntArray] = {}
    bodies: list[Body] = []
    edges = []
    first = 0
    for name, mesh in parts.items():
        prefix = f"{name}." if bodies else ""
        points = range(first, first + len(mesh.points))
        bodies.append(Body(name, points, range(len(blocks), len(blocks) + len(mesh.blocks))))
        blocks += [replace(b, connectivity=(b.connectivity + first).astype(np.int32)) for b in mesh.blocks]
        node_sets |= {f"{prefix}{key}": (nodes + first).astype(np.int32) for key, nodes in mesh.node_sets.items()}
        edge_sets |= {f"{prefix}{key}": (pairs + first).astype(np.int32) for key, pairs in mesh.edge_sets.items()}
        edges.append((mesh.boundary_edges + first).astype(np.int32))
        first = points.stop
    joined = np.concatenate([mesh.points for mesh in parts.values()])
    return Mesh(joined, tuple(blocks), node_sets, edge_sets, np.concatenate(edges)), tuple(bodies)
