# SPDX-License-Identifier: Apache-2.0
"""Area of a blank that lies below a holder."""

from __future__ import annotations

import numpy as np

from presswork.geometry.tool_surface import make_surface
from presswork.model import Mesh, Tool, Triangulation

FACING = 0.7
"""Least part along z of the normal of a face that holds: one that leans by 45 degrees."""


def find_held_area(mesh: Mesh, tool: Tool) -> float:
    """Return the area of the undeformed cells that a holder's face holds once it has closed [mm2], of what is modelled.

    Under a drawn holder these are the cells that its flat face lies on. A face of triangles may be curved, and touch a
    flat blank in a few points before it has wrapped it: there all cells below the face count.
    """
    surface, is_flat, held = make_surface(tool.surface), not isinstance(tool.shape, Triangulation), 0.0
    for block in mesh.blocks:
        corners = mesh.points[block.connectivity]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1]), axis=1)
        gap, normal = surface.nearest(corners.mean(axis=1) - np.asarray(tool.position))[:2]
        if is_flat:
            is_held = gap < gap.min() + 1e-3 * np.sqrt(area.mean())
        else:
            is_held = np.isfinite(gap) & (np.abs(normal[:, 2]) > FACING)
        held += float(area[is_held].sum())
    return held
