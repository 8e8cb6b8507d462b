# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` says of a solid by the explicit procedure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import model
from presswork.case.description.press import describe_drive

SECONDS = 0.1e-6
"""Of one core for a cell and a cycle, about."""
SAFETY = 0.9
"""Time step over its stable bound."""


def describe_explicit(problem: model.Model, settings: model.ExplicitSolid) -> Iterator[str]:
    """Describe the start, the steps through time and what computing takes, a line per fact."""
    x, y = settings.velocity
    material = problem.materials[problem.mesh.blocks[0].material]
    yield f"explicit procedure: the workpiece starts at ({x:g}, {y:g}) mm/s, density {material.density:g} t/mm3"
    for tool in problem.tools:
        if not any(any(stage.tool_motion.get(tool.name, model.ToolMotion()).move) for stage in problem.stages):
            yield f"tool {tool.name} stands still"
    for number, stage in enumerate(problem.stages, start=1):
        if stage.prescribed or any(any(motion.move) for motion in stage.tool_motion.values()):
            how = (
                f"{stage.ramp:.3g} s to start and to stop" if stage.ramp else "at full velocity from the first cycle on"
            )
            how = how if stage.drive is None else describe_drive(stage.drive)
            yield f'stage {number} "{stage.name}", {stage.duration:.4g} s: {how}'
    if settings.damping:
        yield f"mass damping {settings.damping:g} 1/s"
    yield f"output: {problem.output.rows} rows of history and {problem.output.steps} saved steps a stage"
    step = SAFETY * _shortest_side(problem.mesh) / _wave_speed(material)
    how = "cells that are flattened need shorter ones"
    if settings.target_step is not None and settings.target_step > step:
        step, how = settings.target_step, "by adding mass"
    cycles = sum(stage.duration for stage in problem.stages) / step
    cells = sum(len(block.connectivity) for block in problem.mesh.blocks)
    yield f"time steps: about {step:.2g} s at first, {how}; so {cycles:.2g} cycles or more"
    yield f"time: about {cycles * cells * SECONDS:.2g} s on one core (an estimate)"


def _shortest_side(mesh: model.Mesh) -> float:
    """Return the shortest side of the cells [mm]."""
    sides = [
        np.linalg.norm(mesh.points[b.connectivity] - mesh.points[np.roll(b.connectivity, 1, axis=1)], axis=2).min()
        for b in mesh.blocks
    ]
    return float(min(sides))


def _wave_speed(material: model.Material) -> float:
    """Return the speed of elastic compression waves [mm/s]."""
    nu = material.poisson
    return float(np.sqrt(material.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / material.density))
