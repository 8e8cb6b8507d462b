# SPDX-License-Identifier: Apache-2.0
"""Friction of explicit solids in space that the shear flow stress of the metal limits."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.explicit.space_walls import SpaceWall
from presswork.geometry.pose import find_space_pose
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.faces import nodal_normals
from presswork.model import FloatArray, Friction, Mesh, Tool
from presswork.process.explicit.contacts import find_nodal_shear_strength

STEEPEST = 1.0
"""Largest friction of a node over its normal force: it stops the speed at which a node lands within the cycle."""


def find_coefficient(law: Friction) -> float:
    """Return the largest friction over the pressure; infinite where nothing slides."""
    if law.law == "sticking":
        return float("inf")
    if law.law == "shear":
        return STEEPEST if float(law.m) > 0.0 else 0.0
    return float(np.max(law.mu)) if law.law.startswith("coulomb") else 0.0


class ShearFriction:
    """Limits of the friction on the walls of one run: m k A, with the shear flow stress k of the cells round a node and
    A the part of its surface that faces the tool. They are those of the present state until they are set again.
    """

    def __init__(self, tools: tuple[Tool, ...], mesh: Mesh) -> None:
        self._mesh = mesh
        self._surfaces: dict[int, tuple[Tool, _core.ToolSurface]] = {
            i: (tool, make_surface(tool.surface, smooth=True))
            for i, tool in enumerate(tools)
            if tool.friction.law in ("shear", "coulomb_capped")
        }

    @property
    def is_needed(self) -> bool:
        """Whether any tool has such a friction."""
        return bool(self._surfaces)

    def set(self, walls: list[SpaceWall], position: FloatArray, flow_stress: FloatArray) -> None:
        """Set the limits; position (n_nodes, 3) [mm], flow stress of the cells (n_cells,) [MPa]."""
        shear = find_nodal_shear_strength(self._mesh, flow_stress)
        normals = nodal_normals(position, self._mesh.boundary_faces)
        reach = float(np.linalg.norm(np.ptp(position, axis=0)))
        for i, (tool, surface) in self._surfaces.items():
            pose = find_space_pose(tool, walls[i].displacement, walls[i].angle)
            out = pose.turn(surface.nearest(np.ascontiguousarray(pose.to_frame(position)), reach)[1])
            area = np.maximum(0.0, -np.einsum("ni,ni->n", normals, out))
            walls[i].limit_friction(float(tool.friction.m) * area * shear)
