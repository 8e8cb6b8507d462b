# SPDX-License-Identifier: Apache-2.0
"""Whether stages form a solid at strain rates that the law of its material was fitted to: a slip of time or speed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.model import Model

FAR = 10.0
"""How far beyond a law's window the mean rate must be: in flash and rounds metal flows some ten times as fast."""


def warn_of_rates(model: Model) -> Iterator[str]:
    """Yield the stages whose tools go so slowly, or so fast, that the rate lies far outside the window of a law."""
    if model.analysis == "stamping":
        return
    dimension = model.mesh.points.shape[1]
    used = {block.material for block in model.mesh.blocks}
    for index, stage in enumerate(model.stages):
        moves = [np.asarray(motion.move)[:dimension] for motion in stage.tool_motion.values() if motion.push is None]
        travel = max(moves, key=lambda move: float(np.linalg.norm(move)), default=np.zeros(dimension))
        length = float(np.linalg.norm(travel))
        if length == 0.0 or stage.duration <= 0.0:
            continue
        rate = length / (float(np.ptp(model.mesh.points @ (travel / length))) * stage.duration)
        for number in sorted(used):
            material = model.materials[number]
            window = None if material.hardening is None else material.hardening.window
            if window is None or window[1][0] / FAR <= rate <= window[1][1] * FAR:
                continue
            low, high = window[1]
            units = {f'"{stage.duration:g} ms"': 1e3, f'"{stage.duration:g} min"': 1.0 / 60.0}
            fits = next((f": are {text} meant?" for text, each in units.items() if low <= rate * each <= high), "")
            yield (
                f"stages.{index}: its tools travel {length:.4g} mm in {stage.duration:.4g} s, a rate of about "
                f"{rate:.2g} 1/s, and the law of {material.name} was fitted from {low:g} to {high:g}; plain numbers "
                f"are s and mm/s{fits}"
            )
