# SPDX-License-Identifier: Apache-2.0
"""Inertia and damping of the nodes of a shell in the implicit procedure: they steady what statics leaves free.

With the velocity v = du / dt of an increment, each node of mass m resists by f = m ((v - v_n) / dt + c v), c the mass
damping: backward Euler. What moves on evenly feels c m v alone; what snaps, or nothing holds, is held by m / dt^2 and
c m / dt, the more so the smaller the increment. The scheme itself loses m |v - v_n|^2 / 2 in each increment, so
oscillations that it does not resolve die out at once. The mass is lumped, and rotations have none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray, Model
from presswork.procedure.sheet_contact import share_surface
from presswork.state import State


@dataclass(frozen=True)
class InertiaForces:
    """Resistance of the nodes (n_points, 3) [N], and its derivative as node pairs (n, 2) and blocks (n, 6, 6)."""

    resistance: FloatArray
    velocity: FloatArray
    """(n_points, 3) [mm/s]."""
    pairs: IntArray
    blocks: FloatArray


class Inertia:
    """The masses of one run; velocities lie in the State."""

    def __init__(self, model: Model) -> None:
        self.is_needed = model.solver.inertia > 0.0
        self._damping = model.solver.damping
        self._mass = np.zeros(len(model.mesh.points))
        for block in model.mesh.blocks if self.is_needed else ():
            assert block.section is not None, "shells have sections"
            density = model.solver.inertia * model.materials[block.material].density
            self._mass += density * block.section.thickness * share_surface(model.mesh.points, block.connectivity)
        nodes = np.arange(len(self._mass), dtype=np.int32)
        self._pairs = np.column_stack([nodes, nodes])

    def evaluate(self, state_n: State, increment: FloatArray, dt: float) -> InertiaForces:
        """Return the resistance to an increment (n_points, 6) over dt [s]."""
        velocity = increment[:, :3] / dt
        resistance = self._mass[:, None] * ((velocity - state_n.velocity) / dt + self._damping * velocity)
        blocks = np.zeros((len(self._mass), 6, 6))
        blocks[:, :3, :3] = (self._mass * (1.0 / dt + self._damping) / dt)[:, None, None] * np.eye(3)
        return InertiaForces(resistance, velocity, self._pairs, blocks)
