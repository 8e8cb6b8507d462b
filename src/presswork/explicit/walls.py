# SPDX-License-Identifier: Apache-2.0
"""Rigid walls of an explicit run in the plane (cpp/explicit/plane/rigid_wall.hpp)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError

Array = npt.NDArray[np.float64]


class Wall:
    """A rigid profile that no node passes."""

    def __init__(self, loop: _core.PlaneLoop, number: int, name: str) -> None:
        self._loop, self._number, self.name = loop, number, name
        self._velocity = (0.0, 0.0)

    @property
    def velocity(self) -> tuple[float, float]:
        """Prescribed velocity [mm/s], times the velocity_scale of each cycle."""
        return self._velocity

    @velocity.setter
    def velocity(self, value: tuple[float, float]) -> None:
        x, y = (float(v) for v in value)
        if not np.isfinite([x, y]).all():
            raise ExplicitError(f"velocity of wall {self.name} = {value}: it must be two finite numbers")
        self._velocity = (x, y)
        self._loop.move_wall(self._number, self._velocity)

    @property
    def displacement(self) -> Array:
        """Displacement since the start (2,) [mm]."""
        return np.array(self._loop.wall_offset(self._number))

    @property
    def impulse(self) -> Array:
        """Impulse of the solids on the wall since the start (2,) [N s]: its change over a time is the mean force."""
        return -np.array(self._loop.wall_impulse(self._number))

    @property
    def nodal_force(self) -> Array:
        """Forces of the wall on the nodes in the last cycle (n_nodes, 2) [N]; of the whole ring in axisymmetry."""
        return self._loop.wall_force(self._number)

    def begin_sums(self) -> None:
        """Sum up `pressed` and `friction_work` anew."""
        self._loop.begin_wall_sums(self._number)

    @property
    def pressed(self) -> Array:
        """Impulse of the wall's pressure on the nodes since begin_sums (n_nodes,) [N s]; of whole rings."""
        return self._loop.wall_pressed(self._number)

    @property
    def friction_work(self) -> Array:
        """Work that friction on the wall has taken at the nodes since begin_sums (n_nodes,) [N mm]."""
        return self._loop.wall_rubbed(self._number)

    @property
    def force(self) -> Array:
        """Force of the solids on the wall in the last cycle (2,) [N]."""
        return np.asarray(-self.nodal_force.sum(axis=0))
