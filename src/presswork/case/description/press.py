# SPDX-License-Identifier: Apache-2.0
"""The ram of a press in words, for `presswork check`."""

from __future__ import annotations

import math

from presswork.model import Blow, Crank, Drive


def describe_drive(drive: Drive) -> str:
    """Describe how the ram moves in a stage."""
    who = f"press {drive.press}" if drive.press else "ram"
    distance, motion = f"{drive.travel:g} mm", drive.motion
    if isinstance(motion, Blow):
        return (
            f"{who}: blow {motion.number}, {1e-6 * motion.energy:.4g} kJ for the workpiece, {motion.velocity:.4g} mm/s "
            f"at the start, at most {distance}"
        )
    if isinstance(motion, Crank):
        speeds = " to ".join(f"{motion.speed_at(s):.4g}" for s in (0.0, drive.travel))
        angle = math.degrees(motion.angle_at(0.0))
        return f"{who}: {distance} from {angle:.4g} degrees before bottom dead centre on, {speeds} mm/s"
    speeds = " to ".join(f"{v:.4g}" for v in dict.fromkeys(motion.rows[:, 1].tolist()))
    limits = [f"stops at {1e-3 * drive.force:.4g} kN"] if math.isfinite(drive.force) else []
    limits += [f"at most {1e-6 * drive.power:.4g} kW"] if math.isfinite(drive.power) else []
    return ", ".join([f"{who}: {distance} at {speeds} mm/s", *limits])
