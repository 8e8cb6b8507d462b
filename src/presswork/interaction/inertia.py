# SPDX-License-Identifier: Apache-2.0
"""Inertia and damping of the nodes in the implicit procedure: they steady what statics leaves free.

With the velocity v = du / dt of an increment, each node of mass m resists by f = m ((v - v_n) / dt + c v), c the mass
damping: backward Euler. What moves on evenly feels c m v alone; what snaps, or nothing holds, is held by m / dt^2 and
c m / dt, the more so the smaller the increment. The scheme itself loses m |v - v_n|^2 / 2 in each increment, so
oscillations that it does not resolve die out at once. The mass is lumped: shells share it equally among a cell's nodes
and rotations have none, solids by the diagonal of the consistent matrix (Hinton, Rock & Zienkiewicz 1976).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.space.sheet_contact import share_surface
from presswork.mesh.make.box import node_volumes
from presswork.model import CellBlock, FloatArray, Model, find_cell, take_corners
from presswork.state import Arrays, State


@dataclass
class InertiaArrays(Arrays):
    """What the next increment needs to know of the motion."""

    owner = "inertia"
    velocity: FloatArray
    """Mean of the last increment (n_points, 2), in space (n_points, 3) [mm/s]."""
    force: FloatArray
    """Resistance of the nodes to their acceleration, in the same form [N]."""


@dataclass(frozen=True)
class InertiaForces(Forces):
    """Less the resistance of the nodes (n_points, d) [N], and its derivative: d coordinates and f freedoms a node."""

    velocity: FloatArray
    """(n_points, d) [mm/s]."""


class Inertia(Interaction):
    """The masses of one run; velocities lie in the State."""

    is_driving = True

    def __init__(self, model: Model) -> None:
        self._damping = model.solver.damping
        self._freedoms, self._moving = model.freedoms, model.dimension
        self._mass = np.zeros(len(model.mesh.points))
        for block in model.mesh.blocks:
            self._mass += model.solver.inertia * model.materials[block.material].density * share_volume(model, block)
        nodes = np.arange(len(self._mass), dtype=np.int32)
        self._pairs = np.column_stack([nodes, nodes])

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return velocities and forces of zero."""
        shape = (len(self._mass), self._moving)
        return (InertiaArrays(np.zeros(shape), np.zeros(shape)),)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> InertiaForces:
        """Return the resistance to an increment."""
        d, dt = self._moving, guess.dt
        velocity, velocity_n = guess.increment[:, :d] / dt, state_n[InertiaArrays].velocity
        resistance = self._mass[:, None] * ((velocity - velocity_n) / dt + self._damping * velocity)
        blocks = np.zeros((len(self._mass), self._freedoms, self._freedoms))
        blocks[:, :d, :d] = (self._mass * (1.0 / dt + self._damping) / dt)[:, None, None] * np.eye(d)
        return InertiaForces(-resistance, self._pairs, blocks, velocity)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep velocity and resistance."""
        moving = trial[InertiaArrays]
        moving.velocity, moving.force = own.velocity, -own.force

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return the work against inertia and damping [N mm]."""
        resistance = state_n[InertiaArrays].force + trial[InertiaArrays].force
        moved = trial.nodes.increment[:, : resistance.shape[1]]
        return {"inertia_work": 0.5 * float((resistance * moved).sum())}


def share_volume(model: Model, block: CellBlock) -> FloatArray:
    """Return the volume of a block's cells that each node stands for (n_points,) [mm3]."""
    return _share_sheet(model, block) if block.section else _share_solid(model, block)


def _share_sheet(model: Model, block: CellBlock) -> FloatArray:
    """Return the volume of a sheet that each node stands for (n_points,) [mm3]."""
    if block.own_thickness is None:
        assert block.section is not None
        return block.section.thickness * share_surface(model.mesh.points, block.connectivity)
    return share_surface(model.mesh.points, block.connectivity, block.own_thickness)


def _share_solid(model: Model, block: CellBlock) -> FloatArray:
    """Return the volume of a solid that each node stands for (n_points,) [mm3]; of full rings in axisymmetry."""
    if model.dimension == 3:
        share = np.zeros(len(model.mesh.points))
        np.add.at(share, block.connectivity, node_volumes(model.mesh.points, block.connectivity))
        return share
    x, y = np.moveaxis(model.mesh.points[take_corners(block.connectivity)], -1, 0)
    cross = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    if model.analysis == "axisymmetric":  # 2 pi int r dA of a polygon
        volume = 2.0 * np.pi * ((x + np.roll(x, -1, axis=1)) * cross).sum(axis=1) / 6.0
    else:
        volume = model.depth * 0.5 * cross.sum(axis=1)
    share = np.zeros(len(model.mesh.points))
    np.add.at(share, block.connectivity, volume[:, None] * find_cell(2, block.connectivity).mass_shares)
    return share
