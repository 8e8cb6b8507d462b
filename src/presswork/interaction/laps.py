# SPDX-License-Identifier: Apache-2.0
"""Laps: places where the surface of a body has folded onto itself, which is a fault of the part.

They exert no force. A node is marked when its body touches itself there (contact of a body with itself), or where a new
mesh has left out a loop in which the surface crossed itself. Marks go with the material.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork.interaction.body_contact import BodyContacts
from presswork.interaction.body_interface import InterfaceArrays
from presswork.interaction.contract import Interaction
from presswork.mesh.topology import find_parts
from presswork.model import FloatArray, IndexArray, IntArray, Mesh, Model
from presswork.state import RUN, SURFACE, Arrays, OnNewMesh, State

MARKED = 0.5
"""Of a mark, from which on a node counts as part of a lap; on a new mesh marks are interpolated."""


@dataclass
class LapArrays(Arrays):
    """Where laps are."""

    owner = "laps"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"mark": SURFACE, "begun": RUN}
    mark: FloatArray
    """1 at nodes on a lap, 0 elsewhere (n_points,)."""
    begun: float
    """Time of the first [s]; -1: there is none."""


class LapMarks(Interaction):
    """The laps of one run; what persists lies in the State."""

    def __init__(self, model: Model, bodies: BodyContacts) -> None:
        self._n_points, self._bodies = len(model.mesh.points), bodies

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of bodies without laps."""
        return (LapArrays(np.zeros(self._n_points), -1.0),)

    def commit(self, state_n: State, trial: State, step: Any) -> None:
        """Mark the nodes at which bodies touch themselves."""
        for interface in self._bodies.interfaces:
            if interface.is_self:
                pushes = trial[InterfaceArrays].pressure[interface.places] > 0.0
                mark_lap(trial, interface.nodes[pushes], step.time_n)


def mark_lap(state: State, nodes: IntArray | IndexArray, time: float) -> None:
    """Mark nodes (n,) as part of a lap, in place; time: now [s]."""
    if not len(nodes):
        return
    laps = state[LapArrays]
    laps.mark[nodes] = 1.0
    laps.begun = time if laps.begun < 0.0 else laps.begun


def list_laps(state: State, mesh: Mesh) -> list[FloatArray]:
    """Return the middle of each lap where it is now (2 | 3,) [mm]: of marked nodes that edges connect."""
    if LapArrays not in state:
        return []
    marked = state[LapArrays].mark > MARKED
    points = mesh.points + state.nodes.moved
    sides = mesh.boundary_edges[:, :2]
    if points.shape[1] == 3:
        sides = np.stack([mesh.boundary_faces, np.roll(mesh.boundary_faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = sides[marked[sides].all(axis=1)]
    alone = np.repeat(np.flatnonzero(marked)[:, None], 2, axis=1)
    _, part = find_parts([np.concatenate([edges, alone])], len(points))
    return [points[marked & (part == number)].mean(axis=0) for number in np.unique(part[marked])]
