# SPDX-License-Identifier: Apache-2.0
"""A mesh with its nodes and cells in another order, and the transfer of a State to it: nothing is lost on the way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.evolution.points import EvolvedArrays
from presswork.implicit.epochs import Epoch, NextMesh
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import IndexArray, IntArray, Mesh


def renumber(mesh: Mesh, *, seed: int = 3) -> NextMesh:
    """Return the change to a mesh of one block whose nodes and cells are shuffled."""
    order = np.random.default_rng(seed)
    nodes, cells = order.permutation(len(mesh.points)), order.permutation(len(mesh.blocks[0].connectivity))
    number = np.argsort(nodes).astype(np.int32)  # of the old nodes in the new mesh
    block = replace(mesh.blocks[0], connectivity=np.ascontiguousarray(number[mesh.blocks[0].connectivity[cells]]))
    other = replace(
        mesh,
        points=mesh.points[nodes],
        blocks=(block,),
        node_sets={name: np.sort(number[own]) for name, own in mesh.node_sets.items()},
        edge_sets={name: number[own] for name, own in mesh.edge_sets.items()},
        boundary_edges=number[mesh.boundary_edges],
    )

    def transfer(before: Epoch, after: Epoch) -> None:
        carry(before, after, nodes, cells)

    return NextMesh(other, transfer, reason="renumbered")


def carry(before: Epoch, after: Epoch, nodes: IndexArray, cells: IndexArray) -> None:
    """Fill a State from another; nodes, cells: the old numbers of the new ones."""
    old, new = before.state, after.state
    for name in ("displacement", "increment", "reaction", "external_force"):
        setattr(new.nodes, name, getattr(old.nodes, name)[nodes])
    for name in ("stress", "eqps", "history", "temperature", "hourglass"):
        values = getattr(old.cells, name)[0]
        setattr(new.cells, name, [values[cells] if len(values) else values.copy()])
    for name, blocks in old[EvolvedArrays].values.items():
        new[EvolvedArrays].values[name] = [blocks[0][cells]]
    if ContactArrays not in old:
        return
    place = np.searchsorted(touching(before.mesh), nodes[touching(after.mesh)])
    held, held_after = old[ContactArrays], new[ContactArrays]
    held_after.status = held.status[:, place]
    for name in ("anchor", "drag", "shear_part"):
        setattr(held_after, name, getattr(held, name)[place])


def touching(mesh: Mesh) -> IntArray:
    """The nodes that may touch tools, in the order of the State."""
    return np.unique(mesh.boundary_edges)
