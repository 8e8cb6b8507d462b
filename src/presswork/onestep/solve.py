# SPDX-License-Identifier: Apache-2.0
"""Solve a OneStepModel: first guess, passes of friction, fields."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.mesh.checks import MeshError
from presswork.mesh.make.addendum import ON_PLANE
from presswork.mesh.triangles import find_rims
from presswork.model import CELLS, FloatArray, IntArray, OneStepModel
from presswork.onestep.fields import cell_means, triangle_fields
from presswork.onestep.flatten import flatten
from presswork.onestep.loads import punch_force
from presswork.onestep.newton import lay_over
from presswork.onestep.part import OneStepError
from presswork.onestep.process import Process
from presswork.onestep.stages import Stages, has_deep_walls


@dataclass(frozen=True)
class OneStepResult:
    """The blank of a part, and what becomes of it."""

    model: OneStepModel
    blank: FloatArray
    """Places of the part's nodes in the blank (n_points, 2) [mm]."""
    fields: dict[str, FloatArray]
    """Fields of the cells, triangles first (n_cells,)."""
    punch_force: float
    """Punch force of the whole part [N]."""
    held_force: FloatArray
    """What tools hold the part with beside friction: along x, y [N], about z [N mm]."""
    iterations: int
    residuals: list[float]
    passes: int
    seconds: dict[str, float]
    stages: int
    """Number of stages that the sheet went through."""
    notes: tuple[str, ...] = ()
    """What a user should know of the stages."""


def solve_one_step(
    model: OneStepModel, *, threads: int = 0, on_iteration: Callable[[int, float], None] | None = None
) -> OneStepResult:
    """Find the blank over the model's stages. Raises OneStepError, MeshError."""
    if threads:
        _core.set_threads(threads)
    started = perf_counter()
    process = Process(model, threads=threads, on_iteration=on_iteration)
    part = process.shape(model.points)
    start = _first_guess(model)
    flattened = perf_counter()
    found = process.find_blank(part, start)
    residuals = found.solution.residuals
    notes: tuple[str, ...] = ()
    gone_through = 1
    if model.stages > 1:
        try:
            stages = Stages(process, part, lambda points: _lay_under(replace(model, points=points)))
            found = stages.find_blank(found.solution.blank)
            residuals = residuals + stages.residuals
            gone_through = model.stages
        except (OneStepError, MeshError) as error:
            notes = (f"the stages were left out, the blank is that of one step: {error}",)
    elif has_deep_walls(process, part):
        notes = (
            "the part is deep, and one step ignores the path that its metal took: process.stages = 3 "
            "(--stages 3) follows it, and found the blank of a square cup 25 mm deep within 0.9 in place of 2.1 mm",
        )
    solution = found.solution
    fields = triangle_fields(found.problem, process.metric, solution.blank)
    seconds = {"flatten": flattened - started, "solve": perf_counter() - flattened}
    return OneStepResult(
        model,
        solution.blank,
        cell_means(found.problem, len(model.triangles), len(model.quadrilaterals), fields),
        punch_force(solution.forces, process.share),
        solution.held_force,
        len(residuals),
        residuals,
        found.passes,
        seconds,
        gone_through,
        notes,
    )


def _lay_under(model: OneStepModel) -> FloatArray:
    """Lay the part flat, and under itself; return the places of the nodes."""
    flat = _first_guess(model)
    return flat if any(model.symmetry) else lay_over(flat, model.points[:, :2], np.ones(len(flat)))


def _first_guess(model: OneStepModel) -> FloatArray:
    """Lay the whole part flat, its mirror images with it, and over the part; return the places of the nodes."""
    halves = model.quadrilaterals[:, CELLS["quad4"].simplices].reshape(-1, 3)
    points, triangles = model.points, np.concatenate([model.triangles, halves])
    if not any(model.symmetry):
        return flatten(points, triangles, model.rims[0])
    for axis, wanted in enumerate(model.symmetry):
        if wanted:
            points, triangles = mirror_part(points, triangles, axis)
    rims = sorted(find_rims(points, triangles), key=len)
    flat = flatten(points, triangles, rims[-1])
    return lay_over(flat, points[:, :2], np.ones(len(points)))[: len(model.points)]


def mirror_part(points: FloatArray, triangles: IntArray, axis: int) -> tuple[FloatArray, IntArray]:
    """Add the image across the plane through the origin; the given nodes keep their numbers."""
    size = float(np.ptp(points, axis=0).max())
    apart = np.abs(points[:, axis]) >= ON_PLANE * size
    number = np.arange(len(points))
    number[apart] = len(points) + np.arange(int(apart.sum()))
    image = points[apart].copy()
    image[:, axis] *= -1.0
    turned = number[triangles][:, ::-1].astype(np.int32)
    return np.concatenate([points, image]), np.concatenate([triangles, turned])
