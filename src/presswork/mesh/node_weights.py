# SPDX-License-Identifier: Apache-2.0
"""Weight of the nodes of a mesh under gravity, consistent with the shape functions of its cells."""

from __future__ import annotations

import numpy as np

from presswork.model import CellBlock, FloatArray, Model, find_cell


def find_weights(model: Model) -> FloatArray:
    """Return the weight of each node of what is modelled (n_points, d) [N]; of full rings in axisymmetry."""
    mass = np.zeros(len(model.mesh.points))
    for block in model.mesh.blocks:
        volumes = find_node_volumes(model, block)
        np.add.at(mass, block.connectivity, model.materials[block.material].density * volumes)
    return np.asarray(mass[:, None] * np.asarray(model.gravity))


def find_node_volumes(model: Model, block: CellBlock) -> FloatArray:
    """Return int N dV of the nodes of each cell (n_cells, n_nodes) [mm3], by the cells' largest quadrature rule."""
    x = model.mesh.points[block.connectivity]
    cell = find_cell(2 if block.section or model.dimension == 2 else 3, block.connectivity)
    rule = cell.rules[max(cell.rules)]
    tangents = np.einsum("qaj,eai->eqij", rule.slopes, x)  # of cell coordinates (n_cells, n_qp, d, dimension)
    if block.section:
        normal = np.cross(tangents[..., 0], tangents[..., 1])
        size = block.thickness[:, None] * np.linalg.norm(normal, axis=-1)
    else:
        size = np.linalg.det(tangents)
    if model.analysis == "axisymmetric":
        size = 2.0 * np.pi * size * np.einsum("qa,ea->eq", rule.shapes, x[..., 0])
    elif model.dimension == 2:
        size = model.depth * size
    return np.asarray(np.einsum("eq,q,qa->ea", size, rule.weights, rule.shapes))
