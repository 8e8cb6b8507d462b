# SPDX-License-Identifier: Apache-2.0
"""Bodies in space that nothing but tools holds: where tools leave such a body, it stays on the tool that stands.

While one tool leaves the body and none comes towards it, the nodes that lie on tools which stand, or leave less than
half as fast as the fastest, hang on these tools by springs of a millionth of those of contact, unloaded where the
increment begins. In the plane those nodes are released last (tool_contact.py).
"""

from __future__ import annotations

import numpy as np

from presswork.model import BoolArray, FloatArray, Model

SOFT = 1e-6
"""Stiffness of such a spring over that of contact."""
NEAR = 0.02
"""Gap, over the root of a node's share of the surface, within which it lies on a tool."""
SLOWER = 0.5
"""Speed over that of the tool that leaves fastest below which a body stays on a tool."""
AXES = {"plane_strain": "xy", "axisymmetric": "y", "solid": "xyz"}
"""Axes along which a body may move as a whole."""


def find_loose(model: Model) -> list[str]:
    """Return the axes along which nothing but tools holds a solid."""
    if not (model.plane_tools or model.space_tools) or any(s.normal is not None for s in model.supports):
        return []
    held = {"xyz"[axis] for support in model.lasting_supports for axis, fixed in enumerate(support.fix[:3]) if fixed}
    held |= {"xyzuvw"[moved.component] for stage in model.stages for moved in stage.prescribed}
    return [axis for axis in AXES.get(model.analysis, "") if axis not in held]


class RestingBody:
    """Finds the tools that a body rests on in an increment."""

    def __init__(self, n_tools: int, n_points: int) -> None:
        self._lies = np.zeros((n_tools, n_points), dtype=bool)
        self._normal = np.zeros((n_tools, n_points, 3))
        self._nearest = np.zeros(n_tools, dtype=np.intp)

    def take(self, tool: int, gap: FloatArray, normal: FloatArray, length: FloatArray) -> None:
        """Take what the outer nodes see of a tool when an increment begins, (n_points,) and (n_points, 3).

        gap: infinite inside the body; length: root of a node's share of the surface.
        """
        self._lies[tool] = gap <= NEAR * length
        self._normal[tool] = normal
        self._nearest[tool] = int(np.argmin(gap))

    def find_holds(self, moved: FloatArray) -> BoolArray:
        """Return which nodes hang on which tool (n_tools, n_points), as tools have moved (n_tools, 3) [mm]."""
        none = np.zeros_like(self._lies)
        if not moved.any():
            return none
        speed = np.array([self._leave(t, movement) for t, movement in enumerate(moved)])
        if speed.min() < 0.0 or not speed.max() > 0.0:
            return none
        return np.asarray(self._lies & (speed < SLOWER * speed.max())[:, None])

    def _leave(self, tool: int, movement: FloatArray) -> float:
        """Return how far a tool leaves the node that it leaves fastest; below zero where it comes nearer [mm]."""
        nodes = np.flatnonzero(self._lies[tool])
        seen = nodes if len(nodes) else self._nearest[tool, None]
        return -float((self._normal[tool, seen] @ movement).min()) + 0.0
