# SPDX-License-Identifier: Apache-2.0
"""How far what moves and pushes in a stage of explicit solids has come by a time."""

from __future__ import annotations

import numpy as np

from presswork.explicit.motion import DrivenStroke, Motion, SmoothStroke
from presswork.model import FloatArray, Stage

SAMPLES = 401
"""Number of samples of a force over a stage that a press drives."""


def find_motion(stage: Stage, begin: float) -> Motion | None:
    """Return how long all that moves in a stage has gone at its mean velocity [s], by the time; None: evenly."""
    if stage.drive is not None:
        return DrivenStroke(stage.drive, stage.duration, begin)
    if stage.ramp == 0.0:
        return None
    return SmoothStroke(stage.duration, stage.duration, rise=stage.ramp / stage.duration, start=begin)


def find_pushes(force: FloatArray, start: float, stage: Stage, begin: float) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and forces [N] of a push in a stage that begins at a time [s].

    force: rows of part of the stage and force (n, 2); start: force as the stage begins [N].
    """
    rows = force if force[0, 0] == 0.0 else np.vstack([(0.0, start), force])
    if stage.drive is None or not stage.drive.is_prescribed:
        return begin + stage.duration * rows[:, 0], rows[:, 1]
    since = np.linspace(0.0, stage.duration, SAMPLES)
    parts = [stage.drive.part_at(float(t)) for t in since]
    return begin + since, np.interp(parts, *rows.T)
