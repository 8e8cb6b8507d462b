# SPDX-License-Identifier: Apache-2.0
"""What supports and prescribed displacements make of an increment: prescribed freedoms, and frames for rotations.

Solids have two or three displacements a node, taken along x, y and z; pressures are never prescribed. Shells have six
freedoms; their rotations are taken in a frame of the node's own, so that any set of them can be prescribed: those about
x, y, z that supports hold, and, where the sheet is smooth, the drilling about the director, which means nothing there.
"""

from __future__ import annotations

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.interaction.contract import Constraints, Interaction, Point
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model
from presswork.outcome import StartError
from presswork.state import State

SAME = 1e-6
"""Sine of the angle below which an axis lies in the plane of others."""


class NotHeldError(StartError):
    """Nothing holds the workpiece in some direction: it would move as a rigid body."""


class Supports(Interaction):
    """Supports of one model; `smooth` marks the nodes of shells without drilling, `director_node` who turns each
    director.
    """

    def __init__(self, model: Model, smooth: BoolArray | None = None, director_node: IntArray | None = None) -> None:
        self._model = model
        self._smooth = np.zeros(0, dtype=bool) if smooth is None else smooth
        self._director_node = np.zeros(0, dtype=np.int32) if director_node is None else director_node
        n = len(model.mesh.points)
        self.freedoms = model.freedoms
        self._frames_of: tuple[State, int] | None = None
        self._frames, self._held = np.zeros((0, 3, 3)), np.zeros((0, 3), dtype=bool)
        self._identity = np.tile(np.eye(model.dimension), (n, 1, 1))

    def fixed(self, stage: int) -> BoolArray:
        """Return the components that supports and prescribed displacements hold in a stage (n_points, freedoms)."""
        fixed = np.zeros((len(self._model.mesh.points), self.freedoms), dtype=bool)
        for support in self._model.supports_in(stage):
            if support.normal is None:
                fixed[self._model.mesh.node_sets[support.node_set], : len(support.fix)] |= np.asarray(support.fix)
        for p in self._model.stages[stage].prescribed:
            fixed[self._model.mesh.node_sets[p.node_set], p.component] = True
        return fixed

    def slanted(self, stage: int) -> list[tuple[IndexArray, FloatArray]]:
        """Return nodes (n,) that supports hold in a stage along unit vectors (n, 3) beside x, y and z."""
        found = []
        for support in self._model.supports_in(stage):
            if support.normal is not None:
                nodes = self._model.mesh.node_sets[support.node_set].astype(np.intp)
                found.append((nodes, np.tile(np.array(support.normal), (len(nodes), 1))))
        return found

    def free_part(self, stage: int, force: FloatArray) -> FloatArray:
        """Return nodal forces (n_points, freedoms) [N, N mm] without what is held in a stage takes."""
        slanted = self.slanted(stage)
        if not slanted:
            return np.where(self.fixed(stage)[:, : force.shape[1]], 0.0, force)
        held = self._hold_slanted(self.fixed(stage), slanted, np.zeros_like(force))
        along = np.where(held.mask, 0.0, np.einsum("nij,nj->ni", held.frames, force))
        return np.asarray(np.einsum("nij,ni->nj", held.frames, along))

    def constrain(self, state_n: State, trial: State, point: Point, held: Constraints) -> Constraints:
        """Return what is prescribed at a guess; nothing is held before."""
        step = point.guess.step
        return self.prescribe(state_n, step.stage, step.fraction - step.fraction_n, point.guess.increment)

    def prescribe(self, state_n: State, stage: int, part: float, increment: FloatArray) -> Constraints:
        """Return what is prescribed, and the correction still missing from `increment`.

        part: of the stage, from state_n to the end of the increment.
        """
        fixed = self.fixed(stage)
        target = np.zeros_like(increment)
        for p in self._model.stages[stage].prescribed:
            nodes = self._model.mesh.node_sets[p.node_set]
            target[nodes, p.component] = p.value * part
        mask = fixed.astype(np.uint8)
        if slanted := self.slanted(stage):
            return self._hold_slanted(fixed, slanted, target - increment)
        if self.freedoms < 6:
            value = np.where(mask, target - increment, 0.0)
            return Constraints(mask, value, np.zeros(len(mask), dtype=np.uint8), self._identity)
        if self._frames_of is None or self._frames_of[0] is not state_n or self._frames_of[1] != stage:
            self._frames, self._held = self._rotation_frames(fixed[:, 3:], state_n[ShellArrays].director)
            self._frames_of = (state_n, stage)
        frames = self._frames
        mask[:, 3:] = self._held
        missing = target - increment
        missing[:, 3:] = np.einsum("nij,nj->ni", frames, missing[:, 3:])
        value = np.where(mask, missing, 0.0)
        return Constraints(mask, value, np.ones(len(mask), dtype=np.uint8), frames)

    def _hold_slanted(
        self, fixed: BoolArray, slanted: list[tuple[IndexArray, FloatArray]], missing: FloatArray
    ) -> Constraints:
        """Return what is prescribed where planes of symmetry are normal to none of x, y and z.

        A node there has a frame of its own, whose first axes span the directions in which it is held.
        """
        n = len(fixed)
        held: FloatArray = np.einsum("ni,ij->nij", fixed.astype(float), np.eye(3))
        turned = np.zeros(n, dtype=np.uint8)
        for nodes, normals in slanted:
            held[nodes] += np.einsum("ni,nj->nij", normals, normals)
            turned[nodes] = 1
        frames, mask = self._identity.copy(), fixed.astype(np.uint8)
        own = np.flatnonzero(turned)
        values, vectors = np.linalg.eigh(held[own])
        frames[own] = vectors[:, :, ::-1].transpose(0, 2, 1)
        mask[own] = values[:, ::-1] > SAME**2
        missing = np.einsum("nij,nj->ni", frames, missing)
        return Constraints(mask, np.where(mask, missing, 0.0), turned, frames)

    def _rotation_frames(self, fixed: BoolArray, director: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return the nodes' frames (n_points, 3, 3), prescribed axes first, and which axes are prescribed."""
        n = len(fixed)
        axes = np.zeros((n, 4, 3))
        axes[:, :3] = np.eye(3) * fixed[:, :, None]
        own = self._smooth[self._director_node]
        axes[self._director_node[own], 3] = director[own]
        # the prescribed space is spanned by the axes; its complement is left free
        values, vectors = np.linalg.eigh(np.einsum("nai,naj->nij", axes, axes))
        order = vectors[:, :, ::-1]
        frames = np.ascontiguousarray(order.transpose(0, 2, 1))
        held: BoolArray = values[:, ::-1] > SAME**2
        unused = ~np.isin(np.arange(n), self._director_node)
        held[unused] = True
        return frames, held
