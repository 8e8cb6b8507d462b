# SPDX-License-Identifier: Apache-2.0
"""What a new mesh of tetrahedra needs beside carried arrays: pressures, and forces of tools where nodes lie on them."""

from __future__ import annotations

import numpy as np

from presswork.body.solids import Mechanics
from presswork.implicit.epochs import Epoch
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.remesh.carrier import Carrier, SkinPlaces


def carry_pressures(before: Epoch, after: Epoch, carrier: Carrier) -> None:
    """Give new nodes their pressures, new cells those of their nodes, as every increment does, and how fast flow
    relaxes their bubbles.
    """
    nodes_n, nodes = before.state.nodes, after.state.nodes
    scale = _find_scale(before) / _find_scale(after)
    nodes.displacement[:, 3:] = scale * carrier.linear(nodes_n.displacement[:, 3:])
    nodes.increment[:, 3:] *= scale
    cells, model = after.state.cells, after.run.model
    rates = carrier.points(*([each[:, None] for each in of.hourglass] for of in (before.state.cells, cells)))
    cells.hourglass = [np.ascontiguousarray(rate[:, 0]) for rate in rates]
    pressure = _find_scale(after) * nodes.displacement[:, 3]
    for part in carrier.parts:
        block = after.mesh.blocks[part.block]
        if part.surface is None or model.materials[block.material].umat is not None:
            continue
        stress, wanted = cells.stress[part.block], pressure[block.connectivity].mean(axis=1)
        stress[..., :3] += (wanted[:, None] - stress[..., :3].mean(axis=2))[..., None]


def hold_on_tools(after: ImplicitProcedure, carrier: Carrier) -> None:
    """Let forces act at nodes of a new mesh that lie on tools alone, pushes along the tools' normals and friction along
    them, in place.
    """
    space_tools = after.interactions.space_tools
    if space_tools is None:
        return
    arrays, points = after.state[SpaceToolArrays], after.model.mesh.points
    for part in carrier.parts:
        if not isinstance(part.surface, SkinPlaces):
            continue
        own = slice(part.new_points.start, part.new_points.stop)
        for t, lies in enumerate(part.surface.on_tool[: len(arrays.force)]):
            nodes = part.surface.node[lies]
            push = np.linalg.norm(arrays.force[t, nodes] - arrays.friction[t, nodes], axis=1)
            _, normal = space_tools.contact.placed(t, arrays).nearest(points[nodes], np.inf)
            drag = arrays.friction[t, nodes]
            drag -= np.einsum("ni,ni->n", drag, normal)[:, None] * normal
            arrays.force[t, own], arrays.friction[t, own] = 0.0, 0.0
            arrays.friction[t, nodes] = drag
            arrays.force[t, nodes] = push[:, None] * normal + drag


def _find_scale(epoch: Epoch) -> float:
    """Return the pressure that counts as a length [MPa/mm], which depends on the mesh."""
    assert isinstance(epoch.run.mechanics, Mechanics)
    return epoch.run.mechanics.pressure_scale
