# SPDX-License-Identifier: Apache-2.0
"""One mesh of several bodies that share no node, and the bodies' own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswork.model import Body, CellBlock, IntArray, Mesh


def join_meshes(parts: Mapping[str, Mesh]) -> tuple[Mesh, tuple[Body, ...]]:
    """Put meshes into one, bodies in the order given; return it and which points and blocks are whose.

    The first body's sets keep their names, those of the others are called BODY.SET. Raises ValueError if some bodies
    have straight edges of two nodes and others edges of three, or faces of three nodes and others faces of four.
    """
    if len({mesh.boundary_edges.shape[1] for mesh in parts.values()}) > 1:
        raise ValueError("bodies with linear and with quadratic elements do not go together")
    if len({mesh.boundary_faces.shape[1] for mesh in parts.values()}) > 1:
        raise ValueError("bodies of hexahedra and of tetrahedra do not go together")
    blocks: list[CellBlock] = []
    node_sets: dict[str, IntArray] = {}
    edge_sets: dict[str, IntArray] = {}
    face_sets: dict[str, IntArray] = {}
    bodies: list[Body] = []
    edges, faces = [], []
    first = 0
    for name, mesh in parts.items():
        prefix = f"{name}." if bodies else ""
        points = range(first, first + len(mesh.points))
        bodies.append(Body(name, points, range(len(blocks), len(blocks) + len(mesh.blocks))))
        blocks += [replace(b, connectivity=(b.connectivity + first).astype(np.int32)) for b in mesh.blocks]
        node_sets |= {f"{prefix}{key}": (nodes + first).astype(np.int32) for key, nodes in mesh.node_sets.items()}
        edge_sets |= {f"{prefix}{key}": (pairs + first).astype(np.int32) for key, pairs in mesh.edge_sets.items()}
        face_sets |= {f"{prefix}{key}": (nodes + first).astype(np.int32) for key, nodes in mesh.face_sets.items()}
        edges.append((mesh.boundary_edges + first).astype(np.int32))
        faces.append((mesh.boundary_faces + first).astype(np.int32))
        first = points.stop
    joined = Mesh(
        np.concatenate([mesh.points for mesh in parts.values()]),
        tuple(blocks),
        node_sets,
        edge_sets,
        np.concatenate(edges),
        face_sets=face_sets,
        boundary_faces=np.concatenate(faces),
    )
    return joined, tuple(bodies)


def split_mesh(mesh: Mesh, bodies: Sequence[Body]) -> list[Mesh]:
    """Return the mesh of each body, its nodes counted from 0; every set keeps its name, empty where it has no part."""
    parts = []
    for body in bodies:
        first, points = body.points.start, mesh.points[body.points.start : body.points.stop]
        blocks = tuple(
            replace(mesh.blocks[i], connectivity=(mesh.blocks[i].connectivity - first).astype(np.int32))
            for i in body.blocks
        )
        node_sets = {
            name: (nodes[(nodes >= first) & (nodes < body.points.stop)] - first).astype(np.int32)
            for name, nodes in mesh.node_sets.items()
        }
        edge_sets = {name: (edges[body.owns(edges)] - first).astype(np.int32) for name, edges in mesh.edge_sets.items()}
        boundary = (mesh.boundary_edges[body.owns(mesh.boundary_edges)] - first).astype(np.int32)
        parts.append(Mesh(points, blocks, node_sets, edge_sets, boundary))
    return parts


def join_parts(parts: Sequence[Mesh]) -> Mesh:
    """Return the mesh of bodies that split_mesh() has given, one or the other of them replaced by now."""
    firsts = np.cumsum([0, *(len(part.points) for part in parts)])[:-1].tolist()
    pairs = list(zip(parts, firsts, strict=True))

    def join(arrays: list[IntArray]) -> IntArray:
        return np.concatenate(arrays).astype(np.int32)

    return Mesh(
        np.concatenate([part.points for part in parts]),
        tuple(
            replace(b, connectivity=(b.connectivity + first).astype(np.int32))
            for part, first in pairs
            for b in part.blocks
        ),
        {name: join([part.node_sets[name] + first for part, first in pairs]) for name in parts[0].node_sets},
        {name: join([part.edge_sets[name] + first for part, first in pairs]) for name in parts[0].edge_sets},
        join([part.boundary_edges + first for part, first in pairs]),
    )
