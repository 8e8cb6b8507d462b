# SPDX-License-Identifier: Apache-2.0
"""The loop in space whose cycles ranks share: what it has beside that in the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.divided import Array, DividedLoop
from presswork.explicit.input_checks import ExplicitError
from presswork.ranks.parts import Part
from presswork.ranks.world import World


class DividedSpaceLoop(DividedLoop):
    """A whole loop in space, and the rank's own loop on a part of it."""

    sums_of_wall = 4
    pulled = frozenset({"position", "thickness", "stress", "history", "pressure", "deepest"})

    def __init__(self, whole: Any, own: Any, part: Part, world: World, *, width: int) -> None:
        self._pushed: set[int] = set()
        self._tools = self._beads = 0
        super().__init__(whole, own, part, world, width=width)
        own.ironing = whole.ironing

    @property
    def _forces(self) -> Array:
        """Return the forces of a sheet on its tools (tools, 3) [N]."""
        return self._sums[: 3 * self._tools].reshape(-1, 3)

    @property
    def _restraints(self) -> Array:
        """Return the restraining forces of drawbeads (beads,) [N]."""
        return self._sums[3 * self._tools :]

    def help(self, what: tuple[Any, ...]) -> None:
        """Give rank 0 what it asks for; all ranks call this."""
        if what[0] == "deepest":
            self._pulled[what] = self._find_deepest(*what[1:])
        else:
            super().help(what)

    def _find_deepest(self, tool: int) -> tuple[float, int]:
        """Return how deep the deepest point of all ranks is in a tool [mm], and which."""
        depth, point = self._own.deepest(tool)
        own = np.array([depth, self._name_point(point) if point >= 0 else np.inf])
        rows = self._world.gather(own, np.full(self._world.size, 2, dtype=np.int32)).reshape(-1, 2)
        depth, point = min(rows.tolist(), key=lambda row: (-row[0], row[1]))
        return depth, -1 if np.isinf(point) else int(point)

    # --- cycles ---------------------------------------------------------------------------------------------------

    def _enter(self) -> None:
        if self._own_is_old:
            self._whole.place_beads()
        super()._enter()

    def _prepare(self) -> None:
        """Let walls that turn know how far the nodes of all ranks are from their centres."""
        turning = [wall for wall in range(self._walls) if self._own.wall_radius(wall) >= 0.0]
        if not turning:
            return
        own = np.array([self._own.wall_radius(wall) for wall in turning])
        counts = np.full(self._world.size, len(turning), dtype=np.int32)
        farthest = self._world.gather(own, counts).reshape(self._world.size, -1).max(axis=0)
        for wall, radius in zip(turning, farthest.tolist(), strict=True):
            self._own.set_wall_radius(wall, radius)

    def _find_lost(self) -> float:
        lost = self._own.lost_point
        return self._name_point(lost) if lost >= 0 else np.inf

    def _list_forces(self) -> list[float]:
        own = self._own
        forces = [force for tool in range(self._tools) for force in own.tool_state(tool)[2]]
        return [*forces, *(own.bead_restraint(bead) for bead in range(self._beads))]

    def _report(self, failed: int, status: _core.LawStatus, cycle: int) -> None:
        super()._report(failed, status, cycle)
        if self._tools:  # energies of pushed tools, which rank 0 counts, need the whole force
            self._own.set_tool_forces(self._forces * (self._world.rank == 0))

    @property
    def lost_point(self) -> int:
        """A point that has gone through a tool; -1: none."""
        first = np.inf if self._where == "all" else self._reported[:, 3].min()
        return -1 if np.isinf(first) else int(first)

    def _name_point(self, point: int) -> int:
        """Return the number in the whole loop of a node, or of the number of nodes + an edge."""
        nodes = self._part.nodes
        if point < len(nodes):
            return int(nodes[point])
        return len(self._part.owner) + int(self._state.find_edges()[1][point - len(nodes)])

    # --- calls on both loops --------------------------------------------------------------------------------------

    def _call_both(self, name: str, *given: Any, **named: Any) -> None:
        if name in ("push_tool", "move_tool", "remove_tool"):
            self._pushed = (self._pushed | {given[0]}) if name == "push_tool" else self._pushed - {given[0]}
        super()._call_both(name, *given, **named)

    def _count_sums(self) -> int:
        return 3 * self._tools + super()._count_sums() if self._pushed or self._walls else 0

    def _count_tools(self) -> int:
        return self._tools + self._walls

    def hold_along(self, node: npt.NDArray[np.int32], along: Array, velocity: Array) -> None:
        """Prescribe velocities (k,) of nodes (k,), rising, along unit vectors (k, 3)."""
        self._whole.hold_along(node, along, velocity)
        mine = np.isin(node, self._part.nodes)
        own = np.searchsorted(self._part.nodes, node[mine]).astype(np.int32)
        self._own.hold_along(own, np.ascontiguousarray(along[mine]), np.ascontiguousarray(velocity[mine]))

    def inherit(self, other: DividedLoop, *given: Any) -> None:
        """Begin with the state of another loop, some elements of which are split here."""
        other.bring_together()
        self._whole.inherit(other._whole, *given)
        self._own_is_old = True

    def tie(self, pairs: npt.NDArray[np.int32], angle: float) -> None:
        """Let the second nodes of pairs (n, 2), which the parts know, follow the first, turned about z [rad]."""
        self._whole.tie(pairs, angle)
        self._own.tie(self._part.number(pairs[np.isin(pairs[:, 1], self._part.nodes)]), angle)
        self._own_is_old = True

    def add_tool(self, surface: _core.ToolSurface, **grip: Any) -> int:
        """Add a rigid tool that a sheet touches; return its number."""
        self._refuse_more()
        if self._tools == 0:
            self._own.sheet_sizes = self._whole.sheet_sizes
        self._own.add_tool(surface, **grip)
        self._tools += 1
        self._own_is_old = True
        return int(self._whole.add_tool(surface, **grip))

    def add_wall(self, surface: _core.ToolSurface, touching: npt.NDArray[np.uint8], **motion: Any) -> None:  # type: ignore[override]
        """Let a rigid tool hold the nodes marked (n_nodes,) off."""
        self._refuse_more()
        self._whole.add_wall(surface, touching, **motion)
        self._own.add_wall(surface, touching[self._part.nodes], **motion)
        self._count_wall()

    def limit_wall_friction(self, wall: int, limit: Array) -> None:
        """Limit the friction of a wall on each node (n_nodes,) [N]."""
        self._whole.limit_wall_friction(wall, limit)
        self._own.limit_wall_friction(wall, np.ascontiguousarray(limit[self._part.nodes]))

    def add_shell_contact(self, undeformed: Array, **grip: float) -> None:
        """Let shells touch shells: each rank computes all that touches, and all exchange what is near."""
        self.bring_together()
        self._whole.add_shell_contact(undeformed, **grip)
        elements = self._part.list_elements()
        self._own.share_shell_contact(self._whole, undeformed, self._list_places(), elements, **grip)
        self._own_is_old = True

    def deepest_in_shell(self) -> tuple[float, int, int]:
        """Return the overlap of the node that is deepest in a shell [mm], it and the shell; every rank knows it."""
        asked = self._own if self._where == "parts" else self._whole
        return asked.deepest_in_shell()  # type: ignore[no-any-return]

    def _list_places(self) -> npt.NDArray[np.int32]:
        """Return the number in the rank's own loop of each node of the whole one, -1: it is not there."""
        of_own = np.full(len(self._part.owner), -1, dtype=np.int32)
        of_own[self._part.nodes] = np.arange(len(self._part.nodes))
        return of_own

    def add_bead(self, place: Array, across: Array, length: Array, *, force: float, tool: int) -> int:
        """Add a drawbead; return its number."""
        self.bring_together()
        if self._beads == 0:
            self._own.share_beads(self._whole, self._list_places(), self._part.list_elements())
        self._own.add_bead(place, across, length, force=force, tool=tool)
        self._beads += 1
        self._own_is_old = True
        return int(self._whole.add_bead(place, across, length, force=force, tool=tool))

    def add_pressure(self, *given: Any, **named: Any) -> int:
        """Refuse a pressure on the sheet, whose volume no rank knows."""
        raise ExplicitError("ranks do not share pressure on a sheet: compute the case without mpiexec")

    def drive_bead(self, bead: int, share: Array) -> None:
        """Set the share of its force that a drawbead has in the next cycles."""
        self._own.drive_bead(bead, share)

    def bead_restraint(self, bead: int) -> float:
        """Return the restraining force of a drawbead [N]."""
        return float(self._whole.bead_restraint(bead) if self._where == "all" else self._restraints[bead])

    def force_of_tool(self, tool: int) -> Array:
        """Return the forces of a tool on the nodes (n_nodes, 3) [N]."""
        if self._where == "parts" and not self._world.leads:
            found = self._state.gather_nodes(self._own.force_of_tool(tool), to_all=True)
        else:
            self.bring_together()
            found = self._whole.force_of_tool(tool)
        return np.asarray(found)

    def drive_tool(self, tool: int, drive: Array) -> None:
        """Set what the next cycles do with a tool."""
        self._own.drive_tool(tool, drive)

    def tool_state(self, tool: int) -> tuple[Any, Any, Any]:
        """Return displacement [mm], velocity [mm/s] and the sheet's force [N] of a tool."""
        if self._where == "all":
            return self._whole.tool_state(tool)  # type: ignore[no-any-return]
        place, velocity, _ = self._own.tool_state(tool)
        return place, velocity, self._forces[tool]
