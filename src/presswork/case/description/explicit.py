# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about a solid by the explicit procedure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import model
from presswork.mesh.faces import list_cell_faces


def describe_explicit(problem: model.Model, settings: model.ExplicitSolid) -> Iterator[str]:
    """Describe the start, the steps through time and what computing takes, a line per fact."""
    names = [body.name for body in problem.bodies] or ["workpiece"]
    for number, velocity in enumerate((settings.velocity, *settings.velocity_of_others)):
        block = problem.mesh.blocks[problem.bodies[number].blocks.start if problem.bodies else 0]
        density = problem.materials[block.material].density
        velocities = ", ".join(f"{part:g}" for part in velocity)
        yield f"explicit procedure: the {names[number]} starts at ({velocities}) mm/s, density {density:g} t/mm3"
    for tool in problem.tools:
        if not any(any(stage.tool_motion.get(tool.name, model.ToolMotion()).move) for stage in problem.stages):
            yield f"tool {tool.name} stands still"
    if settings.damping:
        yield f"mass damping {settings.damping:g} 1/s"
    yield f"output: {problem.output.rows} rows of history and {problem.output.steps} saved steps a stage"
    materials = problem.materials
    crossings = [
        _shortest_side(problem.mesh.points, block.connectivity) / _wave_speed(materials[block.material])
        for block in problem.mesh.blocks
    ]
    step = settings.safety * min(crossings)
    how = "cells that are flattened need shorter ones"
    if settings.target_step is not None and settings.target_step > step:
        step, how = settings.target_step, "by adding mass"
    cycles = sum(stage.duration for stage in problem.stages) / step
    yield f"time steps: about {step:.2g} s at first, {how}; so {cycles:.2g} cycles or more"


def describe_ramp(stage: model.Stage) -> Iterator[str]:
    """Describe how motions and loads of an explicit stage start and stop; for a press its drive describes that."""
    moves = stage.prescribed or any(any(motion.move) for motion in stage.tool_motion.values())
    if moves and stage.drive is None:
        yield f"{stage.ramp:.3g} s to start and to stop" if stage.ramp else "at full velocity from the first cycle on"


def _shortest_side(points: model.FloatArray, connectivity: model.IntArray) -> float:
    """Return the shortest side of cells in the plane, or of the faces of cells in space [mm]."""
    rings = connectivity if points.shape[1] == 2 else model.take_corners(list_cell_faces(connectivity))
    return float(np.linalg.norm(points[rings] - points[np.roll(rings, 1, axis=1)], axis=2).min())


def _wave_speed(material: model.Material) -> float:
    """Return the speed of elastic compression waves [mm/s]."""
    nu = material.poisson
    return float(np.sqrt(material.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / material.density))
