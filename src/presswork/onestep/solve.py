# SPDX-License-Identifier: Apache-2.0
"""Solve a OneStepModel: first guess, passes of friction, fields."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.mesh.addendum import ON_PLANE
from presswork.mesh.triangles import find_rims
from presswork.model import BoolArray, FloatArray, IntArray, OneStepModel
from presswork.onestep.fields import cell_means, nodal_thickness, triangle_fields
from presswork.onestep.flatten import flatten
from presswork.onestep.law import find_metric, make_law
from presswork.onestep.loads import (
    Holder,
    Tools,
    bead_friction,
    find_holder,
    find_tools,
    holder_friction,
    punch_force,
    radius_friction,
)
from presswork.onestep.newton import Friction, OneStep, OneStepProblem, OneStepSolution, lay_over
from presswork.onestep.part import OneStepError, prepare_part

_FRICTION_CHANGE = 0.01
"""Change of friction under the holder, and at the radii, from pass to pass over its sum that no longer matters."""
_MOST_PASSES = 6
_TYPICAL_STRAIN = 0.1


@dataclass(frozen=True)
class OneStepResult:
    """The blank of a part, and what becomes of it."""

    model: OneStepModel
    blank: FloatArray
    """Places of the part's nodes in the blank (n_points, 2) [mm]."""
    fields: dict[str, FloatArray]
    """Of the cells, triangles first (n_cells,)."""
    punch_force: float
    """Of the whole part [N]."""
    held_force: FloatArray
    """What tools hold the part with beside friction: along x, y [N], about z [N mm]."""
    iterations: int
    residuals: list[float]
    passes: int
    seconds: dict[str, float]


def solve_one_step(
    model: OneStepModel, *, threads: int = 0, on_iteration: Callable[[int, float], None] | None = None
) -> OneStepResult:
    """Find the blank. Raises OneStepError, MeshError."""
    if threads:
        _core.set_threads(threads)
    started = perf_counter()
    held = _held(model)
    part = prepare_part(model.points, model.triangles, model.quadrilaterals, held=held, with_bending=model.layers > 1)
    start = _first_guess(model)
    flattened = perf_counter()
    metric = find_metric(model.material, model.rolling_direction)
    law = make_law(model.material, metric)
    flow = float(law.flow_curve(np.array([_TYPICAL_STRAIN]))[0][0])
    problem = OneStepProblem(part, law, model.thickness, flow, model.layers, held)
    tools = find_tools(part, model.points[_true_rim(model, held)], model.thickness)
    share = 0.5 ** sum(model.symmetry)
    fixed: list[Friction] = []
    holder = None
    if model.holder_force:
        holder = find_holder(model.holder_force, share, model.material.young, model.thickness)
    if model.beads:
        edge = float(np.sqrt(part.areas.sum() / len(part.points)))
        fixed.append(bead_friction(part, tools, model.beads, edge))
    problem = replace(problem, friction=tuple(fixed))
    solution, passes = _iterate_friction(problem, tools, holder, model.mu, start, threads, on_iteration)
    fields = triangle_fields(problem, metric, solution.blank)
    seconds = {"flatten": flattened - started, "solve": perf_counter() - flattened}
    return OneStepResult(
        model,
        solution.blank,
        cell_means(problem, len(model.triangles), len(model.quadrilaterals), fields),
        punch_force(solution.forces, share),
        solution.held_force,
        solution.iterations,
        solution.residuals,
        passes,
        seconds,
    )


def _iterate_friction(
    problem: OneStepProblem,
    tools: Tools,
    holder: Holder | None,
    mu: float,
    start: FloatArray,
    threads: int,
    on_iteration: Callable[[int, float], None] | None,
) -> tuple[OneStepSolution, int]:
    """Solve with friction under the holder and at the radii from the pass before, until it no longer changes."""
    part, n = problem.part, len(problem.part.points)

    def press(thickness: FloatArray) -> Friction:
        if holder is None:
            return Friction(np.zeros(n), np.zeros(n))
        return holder_friction(part, tools, holder, thickness, mu)

    held = press(np.full(n, problem.thickness))
    solver = OneStep(replace(problem, friction=(*problem.friction, held)), threads=threads)
    solution = solver.solve(start, on_iteration=on_iteration)
    before = np.stack([held.force, np.zeros(n)])
    for number in range(1, _MOST_PASSES):
        if mu == 0.0:
            return solution, number
        held = press(nodal_thickness(problem, solution.blank))
        drag = radius_friction(part, tools, solution.forces, mu)
        forces = np.stack([held.force, drag.force])
        if (np.abs(forces - before).sum(axis=1) <= _FRICTION_CHANGE * forces.sum(axis=1)).all():
            return solution, number
        before = forces
        solver.set_friction((*problem.friction, held, drag))
        solver.go_on(solution, on_iteration=on_iteration)
    return solution, _MOST_PASSES


def _true_rim(model: OneStepModel, held: tuple[BoolArray, BoolArray] | None) -> IntArray:
    """Return the nodes of the outline that symmetry planes have not cut."""
    rim = model.rims[0]
    return rim if held is None else rim[~(held[0] | held[1])[rim]]


def _first_guess(model: OneStepModel) -> FloatArray:
    """Lay the whole part flat, its mirror images with it, and over the part; return the places of the nodes."""
    halves = model.quadrilaterals[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
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


def _held(model: OneStepModel) -> tuple[BoolArray, BoolArray] | None:
    """Return the nodes on the symmetry planes. Raises OneStepError if there are none on one, or some beyond it."""
    if not any(model.symmetry):
        return None
    size = float(np.ptp(model.points[:, :2], axis=0).max())
    masks = []
    for axis, wanted in enumerate(model.symmetry):
        x = model.points[:, axis]
        mask = np.abs(x) < ON_PLANE * size
        if wanted and not mask.any():
            raise OneStepError(
                f"no node lies on the symmetry plane {'xy'[axis]} = 0 (part: {x.min():.4g} to {x.max():.4g})"
            )
        if wanted and min(x.max(), -x.min()) > ON_PLANE * size:
            raise OneStepError(f"the part lies on both sides of the symmetry plane {'xy'[axis]} = 0: leave it out")
        masks.append(mask if wanted else np.zeros(len(x), dtype=bool))
    return masks[0], masks[1]
