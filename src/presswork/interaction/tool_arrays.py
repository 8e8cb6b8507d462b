# SPDX-License-Identifier: Apache-2.0
"""What rigid tools in the plane and in space keep in the State."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.state import ANEW, RUN, SURFACE_FORCE, Arrays, OnNewMesh

StatusArray = NDArray[np.int8]

SLIDING = 1
STUCK = 2


@dataclass
class ToolArrays(Arrays):
    """Where the tools in the plane are, and the force on them."""

    owner = "tools"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(
        ("displacement", "angle", "restart", "placed", "travel", "travel_increment", "gives", "force", "force_start"),
        RUN,
    )
    displacement: FloatArray
    """Since the start (n_tools, 2) [mm]."""
    angle: FloatArray
    """(n_tools,) [rad]."""
    restart: FloatArray
    """Part of displacement by which stages have placed tools anew, or blows have ended early (n_tools, 2) [mm]."""
    placed: FloatArray
    """Displacement at which a stage last placed each tool, from which its stroke counts (n_tools, 2) [mm]."""
    travel: FloatArray
    """Part of displacement that forces and springs have made (n_tools, 2) [mm]."""
    travel_increment: FloatArray
    """Travel in the last increment (n_tools, 2) [mm]."""
    gives: StatusArray
    """1 for a tool on a spring that is off its stop (n_tools,)."""
    force: FloatArray
    """Force of the workpiece on each tool, as modelled, and torque about its centre (n_tools, 3) [N, N, N mm]."""
    force_start: FloatArray
    """Force of the workpiece on each tool, as modelled, when the stage began (n_tools, 2) [N]."""

    @classmethod
    def at_rest(cls, n_tools: int) -> ToolArrays:
        """Return those of tools that have not moved."""
        return cls(
            displacement=np.zeros((n_tools, 2)),
            angle=np.zeros(n_tools),
            restart=np.zeros((n_tools, 2)),
            placed=np.zeros((n_tools, 2)),
            travel=np.zeros((n_tools, 2)),
            travel_increment=np.zeros((n_tools, 2)),
            gives=np.zeros(n_tools, dtype=np.int8),
            force=np.zeros((n_tools, 3)),
            force_start=np.zeros((n_tools, 2)),
        )


@dataclass
class ContactArrays(Arrays):
    """How tools in the plane hold the nodes that they may touch, the candidates."""

    owner = "contact"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "status": ANEW,
        "anchor": ANEW,
        "drag": SURFACE_FORCE,
        "shear_part": ANEW,
    }
    status: StatusArray
    """Status per face of each tool and candidate: 0 apart, 1 SLIDING, 2 STUCK; (2 n_tools, n_candidates)."""
    anchor: FloatArray
    """Where a STUCK node sits, in its tool's frame (n_candidates, 2) [mm]."""
    drag: FloatArray
    """Friction of each candidate along its tangent, a quarter turn from the normal (n_candidates,) [N]."""
    shear_part: FloatArray
    """Part of constant shear that acts at each candidate: 1, but for nodes that neither push nor lift off
    (n_candidates,)."""

    @classmethod
    def at_rest(cls, n_tools: int, n_candidates: int) -> ContactArrays:
        """Return those of nodes that nothing touches."""
        status = np.zeros((2 * n_tools, n_candidates), dtype=np.int8)
        return cls(status, np.zeros((n_candidates, 2)), np.zeros(n_candidates), np.ones(n_candidates))


@dataclass
class SpaceToolArrays(Arrays):
    """Where the tools in space are, and their force on the nodes."""

    owner = "space_tools"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        **dict.fromkeys(
            (
                "displacement",
                "angle",
                "restart",
                "placed",
                "travel",
                "travel_increment",
                "gives",
                "force_start",
                "energy",
            ),
            RUN,
        ),
        **dict.fromkeys(("force", "friction"), OnNewMesh("surface_force", axis=1)),
    }
    displacement: FloatArray
    """Since the start (n_space_tools, 3) [mm]."""
    angle: FloatArray
    """Turned about its axis (n_space_tools,) [rad]."""
    restart: FloatArray
    """Part of displacement by which stages have placed tools anew, or have ended early (n_space_tools, 3) [mm]."""
    placed: FloatArray
    """Displacement at which a stage last placed each tool, from which its stroke counts (n_space_tools, 3) [mm]."""
    travel: FloatArray
    """Part of displacement that forces and springs have made (n_space_tools, 3) [mm]."""
    travel_increment: FloatArray
    """Travel in the last increment (n_space_tools, 3) [mm]."""
    gives: StatusArray
    """1 for a tool on a spring that is off its stop (n_space_tools,)."""
    force_start: FloatArray
    """Force of the workpiece on each tool, as modelled, when the stage began (n_space_tools, 3) [N]."""
    force: FloatArray
    """Force of each tool on the nodes (n_space_tools, n_points, 3) [N]."""
    friction: FloatArray
    """The part of it along the tool, in the same form."""
    energy: float
    """Stored by the normal forces [N mm]."""

    @classmethod
    def at_rest(cls, n_tools: int, n_points: int) -> SpaceToolArrays:
        """Return those of tools that have not moved and touch nothing."""
        return cls(
            displacement=np.zeros((n_tools, 3)),
            angle=np.zeros(n_tools),
            restart=np.zeros((n_tools, 3)),
            placed=np.zeros((n_tools, 3)),
            travel=np.zeros((n_tools, 3)),
            travel_increment=np.zeros((n_tools, 3)),
            gives=np.zeros(n_tools, dtype=np.int8),
            force_start=np.zeros((n_tools, 3)),
            force=np.zeros((n_tools, n_points, 3)),
            friction=np.zeros((n_tools, n_points, 3)),
            energy=0.0,
        )
