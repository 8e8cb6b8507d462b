# SPDX-License-Identifier: Apache-2.0
"""What stays the same whatever shape the sheet has: its law, and what holds it back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from presswork.mesh.make.addendum import ON_PLANE
from presswork.model import BoolArray, FloatArray, IntArray, OneStepModel
from presswork.onestep.fields import nodal_thickness
from presswork.onestep.law import find_metric, make_law
from presswork.onestep.loads import (
    Tools,
    bead_friction,
    find_holder,
    find_tools,
    holder_friction,
    radius_friction,
)
from presswork.onestep.newton import Friction, OneStep, OneStepProblem, OneStepSolution
from presswork.onestep.part import OneStepError, PartSurface, prepare_part

_FRICTION_CHANGE = 0.01
"""Change of friction under the holder, and at the radii, from pass to pass over its sum that no longer matters."""
MOST_PASSES = 6
_TYPICAL_STRAIN = 0.1

OnIteration = Callable[[int, float], None] | None


@dataclass
class Found:
    """A blank in equilibrium on a shape."""

    problem: OneStepProblem
    solution: OneStepSolution
    passes: int


class Process:
    """The sheet of a model and what holds it back, on any shape that the model's mesh takes."""

    def __init__(self, model: OneStepModel, *, threads: int = 0, on_iteration: OnIteration = None) -> None:
        """Take a model. Raises OneStepError for symmetry planes that do not cut it."""
        self.model, self._threads, self._on_iteration = model, threads, on_iteration
        self.held = _held(model)
        self.metric = find_metric(model.material, model.rolling_direction)
        self._law = make_law(model.material, self.metric)
        self._flow = float(self._law.flow_curve(np.array([_TYPICAL_STRAIN]))[0][0])
        self.share = 0.5 ** sum(model.symmetry)
        """Share of the whole part that is modelled."""
        rim = model.rims[0]
        self._rim: IntArray = rim if self.held is None else rim[~(self.held[0] | self.held[1])[rim]]

    def shape(self, points: FloatArray, normals: FloatArray | None = None) -> PartSurface:
        """Return the model's mesh on a shape: points (n_nodes, 3), normals as prepare_part takes them."""
        model = self.model
        bent = model.layers > 1
        cells = (model.triangles, model.quadrilaterals)
        return prepare_part(points, *cells, held=self.held, with_bending=bent, normals=normals)

    def find_tools(self, part: PartSurface) -> Tools:
        """Return what tools the model's mesh touches on a shape."""
        return find_tools(part, self._rim, self.model.thickness)

    def pose(self, part: PartSurface, formed: FloatArray | None = None) -> OneStepProblem:
        """Return the problem of a shape. formed: what the sheet has gone through before, as OneStepProblem has it."""
        model = self.model
        return OneStepProblem(part, self._law, model.thickness, self._flow, model.layers, self.held, formed=formed)

    def stretch(self, part: PartSurface, start: FloatArray) -> FloatArray:
        """Return the blank of a sheet that stays elastic on a shape (n_nodes, 2), from a first guess."""
        return OneStep(self.pose(part), threads=self._threads).stretch(start, on_iteration=self._on_iteration).blank

    def find_blank(
        self, part: PartSurface, start: FloatArray, formed: FloatArray | None = None, most_passes: int = MOST_PASSES
    ) -> Found:
        """Find the blank of a shape with friction under the holder and at the radii from the pass before.

        start: a first guess (n_nodes, 2); where the sheet was formed before it is taken as near. Raises OneStepError.
        """
        model, n, mu = self.model, len(part.points), self.model.mu
        tools = self.find_tools(part)
        fixed: tuple[Friction, ...] = ()
        holder = None
        if model.holder_force:
            holder = find_holder(model.holder_force, self.share, model.material.young, model.thickness)
        if model.beads:
            edge = float(np.sqrt(part.areas.sum() / n))
            fixed = (bead_friction(part, tools, model.beads, edge),)
        problem = self.pose(part, formed)

        def press(thickness: FloatArray) -> Friction:
            if holder is None:
                return Friction(np.zeros(n), np.zeros(n))
            return holder_friction(part, tools, holder, thickness, mu)

        held = press(np.full(n, model.thickness) if formed is None else nodal_thickness(problem, start))
        solver = OneStep(replace(problem, friction=(*fixed, held)), threads=self._threads)
        if formed is None:
            solution = solver.solve(start, on_iteration=self._on_iteration)
        else:
            solution = OneStepSolution(start.copy(), np.zeros((n, 3)), np.zeros(3))
            solver.go_on(solution, on_iteration=self._on_iteration)
        before = np.stack([held.force, np.zeros(n)])
        for number in range(1, most_passes):
            if mu == 0.0:
                return Found(problem, solution, number)
            held = press(nodal_thickness(problem, solution.blank))
            drag = radius_friction(part, tools, solution.forces, mu)
            forces = np.stack([held.force, drag.force])
            if (np.abs(forces - before).sum(axis=1) <= _FRICTION_CHANGE * forces.sum(axis=1)).all():
                return Found(problem, solution, number)
            before = forces
            solver.set_friction((*fixed, held, drag))
            solver.go_on(solution, on_iteration=self._on_iteration)
        return Found(problem, solution, most_passes)


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
