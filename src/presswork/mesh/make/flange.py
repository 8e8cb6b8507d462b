# SPDX-License-Identifier: Apache-2.0
"""Area of a blank that lies below a holder."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.model import Mesh


def find_held_area(
    mesh: Mesh, surface: _core.ToolSurface, position: tuple[float, float, float], uneven: float = 0.0
) -> float:
    """Return the area of the undeformed cells over which a holder's face lies nearest [mm2], of what is modelled.

    surface, position: of the holder where it starts. uneven: by how much its face may bend away and still hold [mm].
    """
    held = 0.0
    for block in mesh.blocks:
        corners = mesh.points[block.connectivity]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1]), axis=1)
        gap = surface.nearest(corners.mean(axis=1) - np.asarray(position))[0]
        held += float(area[gap < gap.min() + uneven + 1e-3 * np.sqrt(area.mean())].sum())
    return held
