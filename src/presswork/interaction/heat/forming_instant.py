# SPDX-License-Identifier: Apache-2.0
"""Bodies between tools at the end of an increment, as a procedure describes them to heat (docs/theory/heat.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from presswork.geometry.pose import ToolPose, start_centre
from presswork.model import BoolArray, FloatArray, Tool

Poses = Sequence[ToolPose]
"""Poses of Model.plane_tools; none in space."""


@dataclass(frozen=True)
class BetweenBodies:
    """How deformable bodies press on each other and slide."""

    pressure: Mapping[str, FloatArray]
    """Pressure of each contact that passes heat, at the slave's nodes (n_points,) [MPa]."""
    shear: Mapping[str, FloatArray]
    """The same of the shear, without a sign."""
    moved: FloatArray
    """Displacement of the nodes in the increment (n_points, 2) [mm]."""
    lost: float
    """Work that friction has taken in the increment [N mm]."""


@dataclass(frozen=True)
class FormingInstant:
    """Where bodies and tools are, and what an increment of an implicit run or a row of explicit cycles has made."""

    points: FloatArray
    """Points of the bodies (n_points, d) [mm]."""
    poses: Poses
    holds: BoolArray
    """Whether a tool touches a node (n_tools, n_points)."""
    push: FloatArray
    """Push of the tools on the nodes, along the normal (n_tools, n_points) [N]."""
    gap: FloatArray
    """Distance of the nodes from the tools (n_tools, n_points) [mm]; infinite where it is not asked."""
    plastic: Sequence[FloatArray]
    """Heat of plastic work at the points of each block (n_cells, p) [N mm]."""
    friction_work: FloatArray
    """Work that friction on tools has taken at the nodes (n_tools, n_points) [N mm]."""
    stage: int = 0
    """Number of the stage."""
    between: BetweenBodies = field(default_factory=lambda: BetweenBodies({}, {}, np.zeros((0, 2)), 0.0))


def find_poses(tools: Sequence[Tool], displacement: FloatArray, angle: FloatArray) -> Poses:
    """Return the poses of tools that have moved by so much (n, 2) [mm] and turned so far (n,) [rad]."""
    return [
        ToolPose(start_centre(tool), moved, float(turned))
        for tool, moved, turned in zip(tools, displacement, angle, strict=True)
    ]
