# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies in an explicit run that goes on with another mesh.

Pressure is the penetration times the stiffness of a spring. So new skins are fitted to each other with the penetration
that gives the pressure that was, and the joint goes on pressing as it did. The springs keep shear, which goes along.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.explicit.arrays import BodyContactArrays
from presswork.explicit.body_contacts import BodyContactOfRun
from presswork.mesh.faces import face_areas
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model
from presswork.process.mesh_change.carrying import copy_to_facing
from presswork.remesh.carrier import Carrier
from presswork.state import Arrays, State

DEEPEST = 0.05
"""Largest penetration with which a new mesh begins, over the mean edge."""
COVERED = 0.25
"""Least share of the surface round a node that must face the other body for its penetration to be chosen. Two nodes at
the edge of a contact whose rows cover the same sliver can have different ones, which only a distorted skin has.
"""


RunOnMesh = tuple[Model, Sequence[BodyContactOfRun], FloatArray]
"""A model on one mesh, its contacts there, and where the nodes are (n_points, d) [mm]."""


@dataclass(frozen=True)
class Traction:
    """What one contact passes, at the nodes of its slave on a new mesh."""

    pressure: FloatArray
    """(n_points,) [MPa]."""
    shear: FloatArray
    """Shear on the slave (n_points, 3) [MPa]."""


def carry_tractions(old: RunOnMesh, after: Model, carrier: Carrier) -> list[Traction]:
    """Return what each contact passes, at the nodes of the slaves of another mesh.

    after: the model on it, where another body may be the slave.
    """
    before, added, position = old
    found = []
    for contact_n, contact, each in zip(before.contacts, after.contacts, added, strict=True):
        n, slots = len(position), each.slots
        pressure, shear = np.zeros(n), np.zeros((n, 3))
        pressure[slots], shear[slots] = each.pressure, each.shear
        if contact.slave != contact_n.slave:
            sides = before.mesh.boundary_faces
            for values in (pressure, shear):
                copy_to_facing(values, slots, position, sides)
        at_rest = np.zeros(len(after.mesh.points))
        found.append(Traction(carrier.surface(pressure, at_rest), carrier.surface(shear, np.zeros((len(at_rest), 3)))))
    return found


def find_depths(
    after: Model, added: Sequence[BodyContactOfRun], tractions: Sequence[Traction], step: float
) -> list[FloatArray]:
    """Return how deep the nodes of slaves lie in the other body where contacts press so, of each (n_points,) [mm].

    NaN at nodes of whose surface too little faces the other body. after: the model where its nodes are; added: contacts
    of a run on that mesh, which are to be stable with a step [s].
    """
    found, areas = [], _measure_areas(after, after.mesh.points)
    for each, traction in zip(added, tractions, strict=True):
        each.set_step(step)
        stiffness, slots = each.find_stiffness(), each.slots
        depth = np.full(len(areas), np.nan)
        depths = np.minimum(traction.pressure[slots] / np.maximum(stiffness, 1e-300), DEEPEST * each.edge)
        depth[slots] = np.where(each.area[slots] > COVERED * areas[slots], depths, np.nan)
        found.append(depth)
    return found


def find_rows(added: Sequence[BodyContactOfRun], arrays: Arrays, name: str) -> list[IndexArray] | None:
    """Return the nodes that the rows of an array stand for, contact after contact; None: it is not of contacts."""
    if not isinstance(arrays, BodyContactArrays):
        return None
    return [each.slots if name in ("pressure", "shear") else each.nodes for each in added]


def turn_impulses(state: State, before: Model, after: Model) -> None:
    """Turn round what a slave has given to a master where each is the other now."""
    for number, (contact_n, contact) in enumerate(zip(before.contacts, after.contacts, strict=True)):
        if contact.slave != contact_n.slave:
            state[BodyContactArrays].impulse[number] *= -1.0


def find_pushed(model: Model, added: Sequence[BodyContactOfRun]) -> BoolArray:
    """Mark the nodes that another body pushes (n_points,)."""
    pushed = np.zeros(len(model.mesh.points), dtype=bool)
    for contact, each in zip(model.contacts, added, strict=True):
        if contact.slave != contact.master:
            pushed |= (each.push != 0.0).any(axis=1)
    return pushed


def _measure_areas(model: Model, position: FloatArray) -> FloatArray:
    """Return the area of the boundary round each node (n_points,) [mm2]."""
    faces: IntArray = model.mesh.boundary_faces
    areas = face_areas(position, faces)
    return np.asarray(np.bincount(faces.ravel(), areas.ravel(), minlength=len(position)), dtype=float)
