# SPDX-License-Identifier: Apache-2.0
"""Rigid motions of bodies: which of them something prevents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.interaction.cyclic import hold_rigid_motions
from presswork.model import Body, BodyContact, BoolArray, FloatArray, IndexArray, IntArray, Model

FREE = 1e-12
"""Part of the largest eigenvalue below which a combination of rigid motions is free."""
NAMED = 0.3
"""Component of a unit vector above which it is named in a motion."""
IN_SPACE = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")
NAMES = {"axisymmetric": ("y",), "plane_strain": ("x", "y", "rotation")}

Held = tuple[IndexArray | IntArray, FloatArray]
"""Nodes (n,) and unit vectors (n, d) along which something holds them."""


def name_motions(model: Model) -> tuple[str, ...]:
    """Return the names of the rigid motions of each body."""
    return NAMES.get(model.analysis, IN_SPACE)


def name_body(model: Model, body: Body) -> str:
    """Return how a message names a body."""
    if model.bodies and body.name != model.bodies[0].name:
        return f"the body {body.name!r}"
    return {"shell": "the shell", "stamping": "the blank"}.get(model.analysis, "the workpiece")


def count_freedoms(model: Model) -> int:
    """Return the displacements and rotations of a point in rigid motions."""
    return 2 if model.dimension == 2 else 6


@dataclass(frozen=True)
class RigidMotions:
    """The rigid motions of a model's bodies about one point.

    Moves of a rotation are over a size, so that all motions are of one magnitude.
    """

    model: Model
    middle: FloatArray
    """(d,) [mm]."""
    size: float
    """[mm]"""

    def move(self, points: FloatArray) -> FloatArray:
        """Return displacement and rotation of points (n, d) in the motions (n, freedoms, n_motions)."""
        arm = (points - self.middle) / self.size
        if self.model.analysis == "axisymmetric":
            return np.tile(np.array([[[0.0], [1.0]]]), (len(points), 1, 1))
        if self.model.dimension == 2:
            modes = np.zeros((len(points), 2, 3))
            modes[:, :, :2] = np.eye(2)
            modes[:, 0, 2], modes[:, 1, 2] = -arm[:, 1], arm[:, 0]
            return modes
        modes = np.zeros((len(points), 6, 6))
        modes[:, :3, :3] = np.eye(3)
        modes[:, 3:, 3:] = np.eye(3)
        modes[:, :3, 3:] = np.cross(np.eye(3)[None], arm[:, None]).transpose(0, 2, 1)
        return modes


def about_points(model: Model, points: FloatArray) -> RigidMotions:
    """Return the rigid motions about the middle of points (n, d) [mm]."""
    middle = points.mean(axis=0)
    return RigidMotions(model, middle, float(np.abs(points - middle).max()))


def hold_by_supports(
    motions: RigidMotions, points: FloatArray, fixed: BoolArray, slanted: Sequence[Held]
) -> list[Held]:
    """Return nodes (n,) and what supports feel there of the rigid motions (n, n_motions).

    points: (n_points, d) [mm]. fixed: what is held (n_points, freedoms); slanted: what is held beside x, y and z.
    """
    nodes, components = np.nonzero(fixed[:, : count_freedoms(motions.model)])
    rows: list[Held] = [(nodes, _take(motions.move(points[nodes]), components))]
    rows += [hold_along(motions, points, held) for held in slanted]
    cyclic, mesh = motions.model.cyclic, motions.model.mesh
    if cyclic is not None:
        rows.append(hold_rigid_motions(cyclic, mesh, motions.move(points)[:, :3]))
    return rows


def hold_along(motions: RigidMotions, points: FloatArray, held: Held) -> Held:
    """Return nodes (n,), and what of the rigid motions is felt there along unit vectors (n, n_motions)."""
    nodes, directions = held
    d = directions.shape[1]
    return nodes, np.einsum("ni,nij->nj", directions, motions.move(points[nodes])[:, :d])


def _take(modes: FloatArray, components: IndexArray) -> FloatArray:
    return np.asarray(modes[np.arange(len(modes)), components])


def spread(bodies: Sequence[Body], rows: Sequence[Held], n_motions: int) -> FloatArray:
    """Return what is felt at nodes of the rigid motions of all bodies (n, n_bodies, n_motions)."""
    parts = [np.zeros((0, len(bodies), n_motions))]
    for at, row in rows:
        part = np.zeros((len(at), len(bodies), n_motions))
        for number, body in enumerate(bodies):
            inside = (at >= body.points.start) & (at < body.points.stop)
            part[inside, number] = row[inside]
        parts.append(part)
    return np.concatenate(parts)


def spread_contact(
    motions: RigidMotions, n_bodies: int, contact: BodyContact, places: FloatArray, directions: FloatArray
) -> FloatArray:
    """Return what two bodies feel of each other's rigid motions where they touch (n, n_bodies, n_motions).

    places: where they touch (n, d) [mm]; directions: unit vectors along which they hold each other there (n, d).
    """
    row = np.einsum("ni,nij->nj", directions, motions.move(places)[:, : directions.shape[1]])
    part = np.zeros((len(row), n_bodies, row.shape[1]))
    part[:, contact.slave] += row
    part[:, contact.master] -= row
    return part


def find_free(held: FloatArray) -> FloatArray:
    """Return combinations of rigid motions (n_bodies, n_motions, k) that rows (n, n_bodies, n_motions) leave free."""
    rows = held.reshape(len(held), held.shape[1] * held.shape[2])
    values, vectors = np.linalg.eigh(rows.T @ rows)
    free = vectors[:, values < FREE * max(float(values.max()), 1.0)]
    return free.reshape(*held.shape[1:], -1)


def find_named(free: FloatArray) -> BoolArray:
    """Mark the motions that take part in free ones (n_bodies, n_motions)."""
    return np.asarray(np.abs(free).max(axis=2, initial=0.0) > NAMED)
