# SPDX-License-Identifier: Apache-2.0
"""How much of the surface of solids tools and supports hold."""

from __future__ import annotations

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays, SpaceToolArrays
from presswork.mesh.edges import edge_areas
from presswork.mesh.faces import face_areas, take_bearing
from presswork.model import BoolArray, FloatArray


def measure_held_part(procedure: ImplicitProcedure, stage: int, position: FloatArray) -> float:
    """Return the part of the surface's area that tools and supports hold in a stage.

    position: of the nodes (n_points, 2 | 3) [mm]. A side counts where all its nodes are held.
    """
    model, state = procedure.model, procedure.state
    held: BoolArray = np.array(procedure.interactions.supports.fixed(stage).any(axis=1), dtype=bool)
    if SpaceToolArrays in state:
        held |= (np.linalg.norm(state[SpaceToolArrays].force, axis=2) > 0.0).any(axis=0)
    if ContactArrays in state:
        held[procedure.interactions.tools.contact.nodes] |= (state[ContactArrays].status > 0).any(axis=0)
    if model.dimension > 2:
        sides = model.mesh.boundary_faces
        area = face_areas(position[:, :3], sides).sum(axis=1)
        bearing = take_bearing(sides)
    else:
        sides = bearing = model.mesh.boundary_edges
        area = edge_areas(position, sides, None if model.analysis == "axisymmetric" else model.depth).sum(axis=1)
    return float(area[held[bearing].all(axis=1)].sum() / area.sum())
