# SPDX-License-Identifier: Apache-2.0
"""The direction along which a tool works: its stroke and force are measured in it."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, Model, Profile, Tool


def find_working_direction(model: Model, tool: Tool) -> FloatArray | None:
    """Return the unit vector along which a tool works (2,) in the plane, (3,) in space; None if it has none.

    Its own, or that of its first motion or push.
    """
    if tool.working_direction is not None:
        return np.asarray(tool.working_direction)
    size = 2 if isinstance(tool.shape, Profile) else 3
    for stage in model.stages:
        motion = stage.tool_motion.get(tool.name)
        if motion is None:
            continue
        if motion.push is not None:
            return np.asarray(motion.push.direction, dtype=np.float64)
        move = np.asarray(motion.move[:size], dtype=np.float64)
        if move.any():
            return np.asarray(move / np.linalg.norm(move), dtype=np.float64)
    return None
