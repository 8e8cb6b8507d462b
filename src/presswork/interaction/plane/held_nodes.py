# SPDX-License-Identifier: Apache-2.0
"""What faces of tools in the plane do to the nodes that they hold: their forces and their constraints."""

from __future__ import annotations

import numpy as np

from presswork.interaction.contract import Constraints
from presswork.interaction.tool_arrays import STUCK, StatusArray
from presswork.model import BoolArray, FloatArray, IntArray, MaskArray


def find_normal_forces(
    nodes: IntArray, normal: FloatArray, status: StatusArray, reaction: FloatArray, fixed: BoolArray
) -> FloatArray:
    """Return the push of every held face on its node (n_faces, n) [N]; negative pulls.

    nodes: candidates (n,); normal: of the faces there (n_faces, n, 2); status (n_faces, n); reaction [N], fixed: of all
    nodes (n_points, 2).
    """
    push, held = np.zeros(status.shape), status > 0
    count = held.sum(axis=0)
    force = reaction[nodes] * ~fixed[nodes]
    direction = normal * ~fixed[nodes]
    square = (direction**2).sum(axis=2)
    single = held & (count == 1)
    along = np.einsum("fni,ni->fn", direction, force)
    push[single] = along[single] / np.maximum(square[single], 1e-12)
    for node in np.nonzero(count == 2)[0]:
        faces = np.nonzero(held[:, node])[0]
        axes = direction[faces, node].T
        push[faces, node] = np.linalg.lstsq(axes, force[node], rcond=None)[0]
    return push


def prescribe_held(
    nodes: IntArray,
    normal: FloatArray,
    status: StatusArray,
    closing: FloatArray,
    missing: FloatArray,
    supports: Constraints,
) -> Constraints:
    """Return the constraints of supports with those of held nodes.

    nodes, normal, status: as in find_normal_forces. closing: along the normal (n_faces, n) [mm]; missing: where nodes
    are stuck (n, 2) [mm].
    """
    mask, value = supports.mask.copy(), supports.value.copy()
    turned, frames = supports.turned.copy(), supports.frames.copy()
    held = status > 0
    held[:, mask[nodes].all(axis=1)] = False  # supports hold the node in both directions
    count = held.sum(axis=0)
    stuck = (status == STUCK).any(axis=0) & (count > 0)
    own = nodes[stuck]
    value[own] = np.where(mask[own] == 1, value[own], missing[stuck])
    mask[own] = 1
    alone = (count == 1) & ~stuck & ~mask[nodes].any(axis=1)
    places = np.nonzero(alone)[0]
    faces = held[:, places].argmax(axis=0)
    along, own = normal[faces, places], nodes[places]
    turned[own] = 1
    frames[own, 0], frames[own, 1] = along, np.column_stack([-along[:, 1], along[:, 0]])
    mask[own, 0], value[own, 0] = 1, closing[faces, places]
    for i in np.nonzero((count > 0) & ~stuck & ~alone)[0]:
        faces = np.nonzero(held[:, i])[0]
        _pin(int(nodes[i]), normal[faces, i], closing[faces, i], mask, value)
    return Constraints(mask, value, turned, frames)


def _pin(node: int, axes: FloatArray, closing: FloatArray, mask: MaskArray, value: FloatArray) -> None:
    """Two faces, or a face and a support: both freedoms follow from the gaps."""
    free = mask[node] == 0
    rest, own = closing - axes[:, ~free] @ value[node, ~free], axes[:, free]
    if own.shape == (1, 1):  # by hand, which is quicker; nothing where the face ends before it
        value[node, free] = rest / own[0] if own[0, 0] else 0.0
    else:
        value[node, free] = np.linalg.lstsq(own, rest, rcond=None)[0]
    mask[node] = 1
