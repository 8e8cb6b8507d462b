# SPDX-License-Identifier: Apache-2.0
"""What supports and prescribed displacements make of an increment: prescribed freedoms, and frames for rotations.

Solids have two or three displacements a node, taken along x, y and z; pressures are never prescribed. Shells have six
freedoms; their rotations are taken in a frame of the node's own, so that any set of them can be prescribed: those about
x, y, z that supports hold, and, where the sheet is smooth, the drilling about the director, which means nothing there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.interaction.contract import Constraints, Interaction, Point
from presswork.interaction.cyclic import hold_rigid_motions
from presswork.model import Body, BodyContact, BoolArray, FloatArray, IndexArray, IntArray, Model
from presswork.outcome import StartError
from presswork.state import State

SAME = 1e-6
"""Sine of the angle below which an axis lies in the plane of others."""


class NotHeldError(StartError):
    """Nothing holds the workpiece in some direction: it would move as a rigid body."""


def check_held_in_space(
    model: Model,
    fixed: BoolArray,
    touched: tuple[IndexArray, FloatArray] | None = None,
    touching: Sequence[tuple[BodyContact, FloatArray, FloatArray]] = (),
) -> None:
    """Refuse bodies in space that are free to move as rigid ones: `fixed` (n_points, freedoms) marks what is held.

    touched: nodes (n,) that tools hold too, and along which unit vectors (n, 3). touching: contacts of bodies, with
    places (n, 3) where they touch and unit vectors (n, 3) along which they hold each other there.
    """
    middle = model.mesh.points.mean(axis=0)
    modes = _rigid_modes(model.mesh.points, middle)
    nodes, components = np.nonzero(fixed)
    rows: list[tuple[IndexArray | IntArray, FloatArray]] = [(nodes, modes[nodes, components])]
    for support in model.supports:
        if support.normal is not None:
            own = model.mesh.node_sets[support.node_set]
            rows.append((own, np.einsum("i,nij->nj", np.array(support.normal), modes[own, :3])))
    if model.cyclic is not None:
        rows.append(hold_rigid_motions(model.cyclic, model.mesh, modes[:, :3]))
    if touched is not None:
        nodes, directions = touched
        rows.append((nodes, np.einsum("ni,nij->nj", directions, modes[nodes, :3])))
    whole = Body("workpiece" if model.analysis == "solid" else "shell", range(len(modes)), range(0))
    bodies = model.bodies or (whole,)
    parts = []
    for at, row in rows:  # each body has six rigid motions of its own
        part = np.zeros((len(at), len(bodies), 6))
        for number, body in enumerate(bodies):
            inside = (at >= body.points.start) & (at < body.points.stop)
            part[inside, number] = row[inside]
        parts.append(part)
    size = float(np.abs(model.mesh.points - middle).max())
    for contact, places, directions in touching:
        row = np.einsum("ni,nij->nj", directions, _rigid_modes(places, middle, size)[:, :3])
        part = np.zeros((len(row), len(bodies), 6))
        part[:, contact.slave] += row
        part[:, contact.master] -= row
        parts.append(part)
    _refuse_loose(bodies, np.concatenate(parts))


def _rigid_modes(points: FloatArray, middle: FloatArray, size: float | None = None) -> FloatArray:
    """Return displacement and rotation of each point (n_points, 6) in the six rigid motions, about the middle.

    Shape (n_points, 6, 6); the moves of a rotation are over the size of the body, without it that of the points.
    """
    from_middle = points - middle
    modes = np.zeros((len(points), 6, 6))
    modes[:, :3, :3] = np.eye(3)
    modes[:, 3:, 3:] = np.eye(3)
    size = float(np.abs(from_middle).max()) if size is None else size
    modes[:, :3, 3:] = np.cross(np.eye(3)[None], from_middle[:, None] / size).transpose(0, 2, 1)
    return modes


def _refuse_loose(bodies: Sequence[Body], held: FloatArray) -> None:
    """Raise NotHeldError for rigid motions of bodies that the rows of `held` (n, n_bodies, 6) do not prevent."""
    rows = held.reshape(len(held), 6 * len(bodies))
    values, vectors = np.linalg.eigh(rows.T @ rows)
    loose = vectors[:, values < 1e-12 * max(float(values.max()), 1.0)]
    if loose.shape[1] == 0:
        return
    names = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")
    most = np.abs(loose).max(axis=1).reshape(-1, 6)
    number = int(most.max(axis=1).argmax())
    free = " and ".join(name for name, part in zip(names, most[number], strict=True) if part > 0.3)
    which = f"body {bodies[number].name!r}" if number else bodies[0].name
    others = " and no other body that is held touches it there" if len(bodies) > 1 else ""
    raise NotHeldError(
        f"nothing holds the {which} against {loose.shape[1]} rigid motion{'s' * (loose.shape[1] > 1)} ({free}){others}"
        ". Add a [boundary] entry"
    )


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
        self._supported = np.zeros((n, self.freedoms), dtype=bool)
        self.slanted: list[tuple[IndexArray, FloatArray]] = []
        """Nodes (n,) that are held along unit vectors (n, 3) beside x, y and z."""
        for support in model.supports:
            nodes = model.mesh.node_sets[support.node_set]
            if support.normal is None:
                self._supported[nodes, : len(support.fix)] |= np.asarray(support.fix)
            else:
                self.slanted.append((nodes.astype(np.intp), np.tile(np.array(support.normal), (len(nodes), 1))))
        self._identity = np.tile(np.eye(model.dimension), (n, 1, 1))

    def fixed(self, stage: int) -> BoolArray:
        """Return the components that supports and prescribed displacements hold in a stage (n_points, freedoms)."""
        fixed = self._supported.copy()
        for p in self._model.stages[stage].prescribed:
            fixed[self._model.mesh.node_sets[p.node_set], p.component] = True
        return fixed

    def free_part(self, stage: int, force: FloatArray) -> FloatArray:
        """Return nodal forces (n_points, freedoms) [N, N mm] without what is held in a stage takes."""
        if not self.slanted:
            return np.where(self.fixed(stage)[:, : force.shape[1]], 0.0, force)
        held = self._hold_slanted(self.fixed(stage), np.zeros_like(force))
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
        if self.slanted:
            return self._hold_slanted(fixed, target - increment)
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

    def _hold_slanted(self, fixed: BoolArray, missing: FloatArray) -> Constraints:
        """Return what is prescribed where planes of symmetry are normal to none of x, y and z.

        A node there has a frame of its own, whose first axes span the directions in which it is held.
        """
        n = len(fixed)
        held: FloatArray = np.einsum("ni,ij->nij", fixed.astype(float), np.eye(3))
        turned = np.zeros(n, dtype=np.uint8)
        for nodes, normals in self.slanted:
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
