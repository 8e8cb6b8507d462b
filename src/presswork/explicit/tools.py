# SPDX-License-Identifier: Apache-2.0
"""Rigid tools of an explicit run: moved by a prescribed velocity or curve, or pushed by a force."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.motion import Motion, check_table

Array = npt.NDArray[np.float64]
Loop = _core.SpaceLoop | _core.SpaceLoopSingle
MOST_PENALTY, MOST_DAMPING = 0.2, 0.5
LEAST_MASS = 0.5
"""Mass of a pushed tool that squeezes the sheet, over the sheet's: the springs of contact sum to mass/dt^2 at most."""
DEEPEST_START = 0.05
"""Part of the thickness by which a sheet may stick in a tool when it starts."""


class RigidTool:
    """A rigid tool of a run; `add_tool` of a run makes it.

    It stands still until `velocity` is set or `follow` or `push` is called.
    """

    def __init__(self, loop: Loop, number: int, name: str, penalty: float) -> None:
        self.name = name
        self._loop, self.number, self._penalty = loop, number, penalty
        self._velocity = np.zeros(3)
        self._prescribed: tuple[Array, Motion] | None = None
        self._force: tuple[Array, Array] | None = None
        self.mass: float | None = None
        """Mass [t] of a pushed tool; None of one that is moved."""
        self.sag = 0.0
        """Depth that an edge of the sheet may begin in it [mm]."""

    @property
    def velocity(self) -> Array:
        """Prescribed translation (3) [mm/s], times `velocity_scale`; a pushed or following tool's present velocity."""
        if self._force is None and self._prescribed is None:
            return self._velocity.copy()
        return np.array(self._loop.tool_state(self.number)[1])

    @velocity.setter
    def velocity(self, value: npt.ArrayLike) -> None:
        self._refuse_second_motion("velocity")
        self._velocity = self._vector(value, "velocity")

    def follow(self, direction: npt.ArrayLike, motion: Motion) -> None:
        """Move along a direction (3), of any length, along a motion: at time t [s] at motion.position(t) [mm]."""
        self._refuse_second_motion("follow")
        self._prescribed = (self._unit(direction), motion)

    def stop(self) -> None:
        """Let it stand still where it is, whatever has moved or pushed it; then it may be moved or pushed anew."""
        self._velocity, self._prescribed, self._force, self.mass = np.zeros(3), None, None, None
        self._loop.move_tool(self.number)

    def push(
        self,
        direction: npt.ArrayLike,
        force: float | tuple[npt.ArrayLike, npt.ArrayLike],
        *,
        mass: float | None = None,
        damping: float = 0.0,
        stop: tuple[RigidTool, float] | None = None,
    ) -> None:
        """Let a force place the tool along a direction (3), of any length.

        force [N]: constant, or (times [s], forces), straight between them and constant beyond.
        mass [t]: by default that of the sheet, added mass included: light enough to follow it, and stable. damping
        [1/s] takes the share damping*dt of its momentum in a step. stop: it goes no further along direction than to
        so many mm beyond the position of another tool, which is not pushed, and stands on that.
        """
        least = max(self._penalty, LEAST_MASS if self._loop.ironing else 0.0) * self._sheet_mass()
        if mass is not None and not mass >= least:
            raise ExplicitError(
                f"tool {self.name!r}: mass = {mass:g} t, but a tool that a force places needs at least {least:.3g} t "
                f"({least / self._sheet_mass():g} of the sheet's mass) to be stable; leave it out for the sheet's mass"
            )
        if not damping >= 0:
            raise ExplicitError(f"tool {self.name!r}: damping = {damping:g} 1/s: it must not be negative")
        times, forces = force if isinstance(force, tuple) else ((0.0, 1.0), (force, force))
        self._refuse_second_motion("push")
        unit = self._unit(direction)
        self._force = check_table(times, forces, f"tool {self.name!r}: force")
        self.mass = self._sheet_mass() if mass is None else mass
        self._loop.push_tool(self.number, unit.tolist(), self.mass, damping)
        if stop is not None:
            if stop[0] is self or stop[0]._force is not None:
                raise ExplicitError(f"tool {self.name!r}: stop = {stop[0].name!r}: name another, which is not pushed")
            self._loop.stop_tool(self.number, stop[0].number, stop[1])

    @property
    def position(self) -> Array:
        """Displacement (3) [mm] of the tool's frame."""
        return np.array(self._loop.tool_state(self.number)[0])

    @position.setter
    def position(self, value: npt.ArrayLike) -> None:
        self._loop.place_tool(self.number, self._vector(value, "position").tolist())

    @property
    def force(self) -> Array:
        """Force (3) of the sheet on the tool [N]."""
        return np.array(self._loop.tool_state(self.number)[2])

    @property
    def penetration(self) -> float:
        """How deep the deepest point of contact is in the tool [mm]; 0 where none is."""
        return self._loop.deepest(self.number)[0]

    def drive(self, time: float, dt: float, velocity_scale: Array) -> None:
        """Set what the next cycles, one for each scale, do with the tool."""
        times: Array = time + dt * np.arange(len(velocity_scale) + 1, dtype=float)
        if self._force is not None:
            values = np.interp(times[:-1], *self._force)
        elif self._prescribed is not None:
            values = np.outer(np.diff(self._prescribed[1].position(times)) / dt, self._prescribed[0])
        else:
            values = np.outer(velocity_scale, self._velocity)
        self._loop.drive_tool(self.number, np.ascontiguousarray(values))

    def _sheet_mass(self) -> float:
        return float(self._loop.element_mass.sum())

    def _vector(self, value: npt.ArrayLike, name: str) -> Array:
        given = np.asarray(value, dtype=float)
        if given.shape != (3,) or not np.isfinite(given).all():
            raise ExplicitError(f"tool {self.name!r}: {name} = {value!r}: give three finite numbers")
        return given

    def _unit(self, direction: npt.ArrayLike) -> Array:
        given = self._vector(direction, "direction")
        length = float(np.linalg.norm(given))
        if not length > 0:
            raise ExplicitError(f"tool {self.name!r}: direction = {direction!r}: it has no length")
        return given / length

    def _refuse_second_motion(self, name: str) -> None:
        if self._force is not None or (self._prescribed is not None and name != "follow"):
            now = "is pushed by a force" if self._force is not None else "follows a curve"
            raise ExplicitError(f"tool {self.name!r} {now}: it cannot have {name} too")


class ToolsOfRun:
    """What an explicit run does with its tools."""

    _loop: Loop
    _nodes: npt.NDArray[np.intp]
    _reference: tuple[float, float] | None
    touches_itself: bool
    cycle: int
    time: float
    dt: float

    def _start_tools(self) -> None:
        self.tools: dict[str, RigidTool] = {}
        self._new_tools: list[RigidTool] = []
        self._contact_step = 0.0

    def add_tool(
        self,
        name: str,
        surface: _core.ToolSurface,
        *,
        mu: float = 0.0,
        penalty: float = 0.1,
        damping: float = 0.1,
        edges: bool = True,
        thickness: bool = True,
        sag: float = 0.0,
    ) -> RigidTool:
        """Let the sheet touch a rigid tool from now on.

        mu: Coulomb's coefficient. penalty: contact stiffness over nodal mass/dt^2. damping: of contact, over critical.
        edges: where the tool turns by more than 29 degrees within half the sheet's mean edge, edges touch between
        their nodes, too. thickness: the sheet touches with its surface, half the present thickness off the mid-surface,
        and not with that. sag: depth [mm] that an edge between nodes may begin in the tool, as far as the chord of a
        bent sheet lies off its surface; it is spared that depth. Raises ExplicitError.
        """
        check_grip(name, list(self.tools), mu, penalty, damping)
        number = self._loop.add_tool(
            surface, friction=mu, penalty=penalty, damping=damping, edges=edges, thickness=thickness
        )
        tool = RigidTool(self._loop, number, name, penalty)
        tool.sag = sag
        self.tools[name] = tool
        self._new_tools.append(tool)
        self._reference = None
        return tool

    def remove_tool(self, name: str) -> None:
        """Take a tool away."""
        tool = self.tools.pop(name)
        self._new_tools = [new for new in self._new_tools if new is not tool]
        self._loop.remove_tool(tool.number)

    @property
    def contact_force(self) -> Array:
        """Forces of the tools on the nodes (n_nodes, 3) [N]."""
        inside = self._loop.contact_force
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    def force_of(self, tool: RigidTool) -> Array:
        """Return the forces of one tool on the nodes (n_nodes, 3) [N]."""
        inside: Array = self._loop.force_of_tool(tool.number)
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    def _prepare_tools(self, velocity_scale: Array) -> None:
        if (self.tools or self.touches_itself) and (self.dt > self._contact_step or self._new_tools):
            self._contact_step = max(self.dt, self._contact_step)
            self._loop.set_contact_stiffness(self._contact_step)
        for tool in self._new_tools:
            depth, point = self._loop.deepest(tool.number)
            spared = tool.sag if point >= len(self._nodes) else 0.0
            if depth > DEEPEST_START * float(self._loop.thickness(0).min()) + spared:
                raise ExplicitError(
                    f"the sheet starts in tool {tool.name!r}: {self._name_point(point)} is {depth:.4g} mm deep, half "
                    "the thickness counted; move the tool or the sheet by that"
                )
        if self._new_tools:
            self._loop.start_contact()
            self._new_tools = []
        for tool in self.tools.values():
            tool.drive(self.time, self.dt, velocity_scale)

    def _check_tools(self) -> None:
        lost = self._loop.lost_point
        if lost >= 0:
            raise ExplicitError(
                f"{self._name_point(lost)} has gone through a tool by cycle {self.cycle} (t = {self.time:g} s): drive "
                "the tools slower, push them less hard, or refine the mesh"
            )

    def _name_point(self, point: int) -> str:
        n = len(self._nodes)
        if point < n:
            return f"node {self._nodes[point]}"
        a, b = sorted(int(self._nodes[i]) for i in self._loop.edge_nodes(point - n))
        return f"the edge between nodes {a} and {b}"


def check_grip(name: str, taken: list[str], mu: float, penalty: float, damping: float) -> None:
    """Raise ExplicitError for properties that no tool can have."""
    if name in taken:
        raise ExplicitError(f"tool {name!r} is there already: give each a name of its own")
    if not 0 <= mu < np.inf:
        raise ExplicitError(f"tool {name!r}: mu = {mu:g}: Coulomb's coefficient is not negative")
    if not 0 < penalty <= MOST_PENALTY:
        raise ExplicitError(
            f"tool {name!r}: penalty = {penalty:g}: it must be above 0 and at most {MOST_PENALTY:g} for a stable step"
        )
    if not 0 <= damping <= MOST_DAMPING:
        raise ExplicitError(
            f"tool {name!r}: damping = {damping:g}: it lies between 0 and {MOST_DAMPING:g} of critical, for a stable "
            "step"
        )
