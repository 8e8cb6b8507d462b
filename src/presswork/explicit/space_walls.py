# SPDX-License-Identifier: Apache-2.0
"""Rigid tools that hold solids in space off, and how they move (rigid_wall.hpp, wall_motion.hpp in C++)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError

Array = npt.NDArray[np.float64]
DRAG = 0.4
"""Damping of a tool on a spring: twice the fraction of critical damping."""


@dataclass(frozen=True)
class WallStart:
    """How a tool stands at the start, and about what it turns later."""

    rotation: Sequence[Sequence[float]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """Rotation from its own frame to space (3, 3)."""
    centre: Sequence[float] = (0.0, 0.0, 0.0)
    """A point of the axis about which it turns, in space (3,) [mm]."""
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    """Unit vector in space (3,)."""
    turns: bool = False
    """Whether it is turned at the start or later."""


NOT_TURNED = WallStart()


class SpaceWall:
    """A rigid tool that no node of the body's surface enters."""

    def __init__(self, loop: _core.SpaceLoop, number: int, name: str, nodes: npt.NDArray[np.intp]) -> None:
        self.name = name
        self._loop, self._number, self._nodes = loop, number, nodes
        self._velocity, self._spin = (0.0, 0.0, 0.0), 0.0
        self._push: tuple[Array, Array] | None = None

    @property
    def velocity(self) -> tuple[float, float, float]:
        """Prescribed translation (3,) [mm/s], times `velocity_scale`."""
        return self._velocity

    @velocity.setter
    def velocity(self, value: Sequence[float]) -> None:
        x, y, z = (float(v) for v in value)
        if not np.isfinite([x, y, z]).all():
            raise ExplicitError(f"velocity of tool {self.name} = {value}: it must be three finite numbers")
        self._velocity = (x, y, z)
        self._loop.move_wall(self._number, self._velocity, self._spin)

    @property
    def spin(self) -> float:
        """Prescribed angular velocity about its axis [rad/s], times `velocity_scale`."""
        return self._spin

    @spin.setter
    def spin(self, value: float) -> None:
        self._spin = float(value)
        self._loop.move_wall(self._number, self._velocity, self._spin)

    def push(
        self, direction: Sequence[float], force: tuple[npt.ArrayLike, npt.ArrayLike], *, mass: float, drag: float = 0.0
    ) -> None:
        """Let a force move it along a unit vector (3,), besides: times [s] and forces [N], straight between them.

        mass [t]: at least that of the nodes that it touches; drag: mass damping [1/s].
        """
        times, forces = (np.asarray(values, dtype=float) for values in force)
        self._float(direction, mass, drag=drag)
        self._push = (times, forces)

    def rest_on_spring(self, direction: Sequence[float], stiffness: float, preload: float, *, mass: float) -> None:
        """Let it stand on a spring [N/mm] with a preload [N], which the body pushes back along a unit vector (3,).

        Its velocity is that of the spring's foot. mass [t]: at least that of the nodes that it touches.
        """
        self._float(direction, mass, stiffness, DRAG * float(np.sqrt(stiffness / mass)), rests=True)
        self._push = (np.zeros(1), np.array([-preload]))

    def _float(
        self, direction: Sequence[float], mass: float, stiffness: float = 0.0, drag: float = 0.0, *, rests: bool = False
    ) -> None:
        x, y, z = (float(v) for v in direction)
        self._loop.float_wall(self._number, (x, y, z), mass=mass, drag=drag, stiffness=stiffness, rests=rests)

    def hold(self) -> None:
        """Let no force and no spring move it any more."""
        if self._push is not None:
            self._push = None
            self._loop.hold_wall(self._number)

    def drive(self, time: float) -> None:
        """Push with the force of a time [s] from now on."""
        if self._push is not None:
            self._loop.push_wall(self._number, float(np.interp(time, *self._push)))

    def place(self, displacement: npt.ArrayLike) -> None:
        """Put it elsewhere, by a displacement since the start (3,) [mm]."""
        x, y, z = np.asarray(displacement, dtype=float).tolist()
        self._loop.place_wall(self._number, (x, y, z))

    def limit_friction(self, limit: Array) -> None:
        """Let friction be no larger on the nodes (n_nodes,) [N] from now on."""
        self._loop.limit_wall_friction(self._number, np.ascontiguousarray(limit[self._nodes]))

    @property
    def displacement(self) -> Array:
        """Displacement since the start (3,) [mm], of the centre of one that turns."""
        return np.array(self._loop.wall_offset(self._number))

    @property
    def angle(self) -> float:
        """Return the angle by which it has turned about its axis since the start [rad]."""
        return self._loop.wall_angle(self._number)

    @property
    def travel(self) -> float:
        """How far forces or a spring have moved it since the start [mm]."""
        return self._loop.wall_travel(self._number)

    @property
    def impulse(self) -> Array:
        """Impulse of the body on the tool since the start (3,) [N s]: its change over a time is the mean force."""
        return -np.array(self._loop.wall_impulse(self._number)[:3])

    @property
    def impulse_of_moment(self) -> float:
        """The same of the moment about its axis [N mm s]."""
        return -float(self._loop.wall_impulse(self._number)[3])

    @property
    def nodal_force(self) -> Array:
        """Forces of the tool on the nodes in the last cycle (n_nodes, 3) [N]."""
        return self._by_node(self._loop.wall_force(self._number))

    @property
    def force(self) -> Array:
        """Force of the body on the tool in the last cycle (3,) [N]."""
        return np.asarray(-self.nodal_force.sum(axis=0))

    def begin_sums(self) -> None:
        """Sum up `pressed` and `friction_work` anew."""
        self._loop.begin_wall_sums(self._number)

    @property
    def pressed(self) -> Array:
        """Impulse of the tool's pressure on the nodes since begin_sums (n_nodes,) [N s]."""
        return self._by_node(self._loop.wall_pressed(self._number))

    @property
    def friction_work(self) -> Array:
        """Work that friction on the tool has taken at the nodes since begin_sums (n_nodes,) [N mm]."""
        return self._by_node(self._loop.wall_rubbed(self._number))

    def _by_node(self, inside: npt.ArrayLike) -> Array:
        given = np.asarray(inside)
        out = np.empty_like(given)
        out[self._nodes] = given
        return out
