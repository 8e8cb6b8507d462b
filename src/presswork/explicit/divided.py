# SPDX-License-Identifier: Apache-2.0
"""An explicit loop whose cycles ranks share, called like a loop of the core.

Each rank advances a loop on its part of the mesh (`ranks.parts`). Between calls the whole state is brought together on
every rank, in a whole loop, as soon as all ranks ask anything of it: every rank then reads the same, and takes the same
decisions. What is changed in the whole loop goes to the parts before the next cycles. While rank 0 does something
alone, such as a row of the history, it asks the others for the arrays that it reads, and they come to it alone. Both
loops number nodes and elements in the same order, so forces have the same bits for any number of ranks.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.shared_state import SharedState
from presswork.ranks.channel import Channel
from presswork.ranks.parts import Part
from presswork.ranks.world import World

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.intp]
MOST_TOOLS = 64
CHANGES = {"restore", "scale_mass", "set_contact_stiffness", "set_layers", "start_contact", "place_tool"}
"""Calls that change the state of the whole loop."""
FOR_BOTH = {
    "begin_wall_sums", "float_wall", "hold_wall", "move_tool", "move_wall", "place_wall", "push_tool", "push_wall",
    "remove_tool", "set_slower", "stop_tool",
}  # fmt: skip
"""Calls that say the same to the whole loop and to parts."""
PULLED = {"position", "thickness", "stress", "history", "pressure", "deepest"}
"""What rank 0 asks for by itself; where it reads anything else, the whole state comes to it."""
STATE = "state"
ENERGIES = ("kinetic", "internal", "hourglass", "external", "damping", "contact", "friction")
ARRAYS = ("velocity", "force", "internal_force")
"""Properties of the whole loop (n_nodes, freedoms) that are set, and then handed out."""


class DividedLoop:
    """A whole loop, and the rank's own loop on a part of it."""

    def __init__(self, whole: Any, own: Any, part: Part, world: World) -> None:
        """whole, own: loops with their blocks; own has part's nodes and elements, without the blocks that have none."""
        self._whole, self._own, self._part, self._world = whole, own, part, world
        self._state = SharedState(whole, own, part, world)
        sent, ghosts = (dict(sorted(of.items())) for of in (part.sent, part.ghosts))
        self._channel = Channel(world, _count(sent), _count(ghosts), 4 * MOST_TOOLS)
        own.join(
            self._channel,
            _join(sent),
            _join(ghosts),
            out=self._channel.out,
            into=self._channel.into,
            shared=self._channel.shared,
            leads=world.rank == 0,
        )
        own.ironing = whole.ironing
        self._pushed: set[int] = set()
        self._tools = self._walls = self._beads = 0
        self._where: Literal["all", "lead", "parts"] = "all"
        """Which whole loops have the present state: of all ranks, of rank 0, or none."""
        self._own_is_old = True
        self._pulled: dict[tuple[Any, ...], Any] = {}
        self._shapes: dict[tuple[Any, ...], tuple[int, ...]] = {}
        self._number = world.register(self)
        self._told: Array = np.zeros((0, 0))
        self._forces, self._restraints = np.zeros((0, 3)), np.zeros(0)

    def __getattr__(self, name: str) -> Any:
        """Return what the whole loop has, brought up to date."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name in FOR_BOTH:
            return partial(self._tell_both, name)
        if name in PULLED and self._world.leads and self._where == "parts":
            return self._pull(name) if name == "position" else partial(self._pull, name)
        self.bring_together()
        found = getattr(self._whole, name)
        self._own_is_old = self._own_is_old or name in CHANGES
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an array of the whole loop, to be handed out."""
        if name not in ARRAYS:
            object.__setattr__(self, name, value)
            return
        self.bring_together()
        setattr(self._whole, name, value)
        self._own_is_old = True

    def bring_together(self) -> None:
        """Let the whole loop have the present state; all ranks call this, or rank 0 while it leads, for itself."""
        if self._world.leads:
            if self._where == "parts":
                self._world.ask(self._number, (STATE,))
        elif self._where != "all":
            self._where = "all"
            self._state.bring_together(to_all=True)

    # --- what rank 0 asks for -------------------------------------------------------------------------------------

    def _pull(self, *what: Any) -> Any:
        """Return what rank 0 reads: a name, and the arguments of a method."""
        if what not in self._pulled:
            self._world.ask(self._number, what)
        found = self._pulled[what]
        return found.copy() if isinstance(found, np.ndarray) else found

    def help(self, what: tuple[Any, ...]) -> None:
        """Give rank 0 what it asks for; all ranks call this."""
        name, *given = what
        if name == STATE:
            self._where = "lead"
            self._state.bring_together(to_all=False)
        elif name == "position":
            self._pulled[what] = self._state.gather_nodes(self._own.position)
        elif name == "deepest":
            self._pulled[what] = self._find_deepest(*given)
        else:
            if what not in self._shapes:
                self._shapes[what] = getattr(self._whole, name)(*given).shape[1:]
            read: Callable[[int], Array] = getattr(self._own, name)
            self._pulled[what] = self._state.gather_elements(given[0], read, self._shapes[what])

    def _find_deepest(self, tool: int) -> tuple[float, int]:
        """Return how deep the deepest point of all ranks is in a tool [mm], and which."""
        depth, point = self._own.deepest(tool)
        own = np.array([depth, self._name_point(point) if point >= 0 else np.inf])
        rows = self._world.gather(own, np.full(self._world.size, 2, dtype=np.int32)).reshape(-1, 2)
        depth, point = min(rows.tolist(), key=lambda row: (-row[0], row[1]))
        return depth, -1 if np.isinf(point) else int(point)

    def energies(self, dt: float, dt_before: float, **scales: float) -> _core.Energies:
        """Return the energies as a loop of the core does, of which each rank counts a share."""
        if self._where == "all" or self._walls or self._world.leads:
            self.bring_together()
            found: _core.Energies = self._whole.energies(dt, dt_before, **scales)
            return found
        share = self._own.energies(dt, dt_before, **scales)
        own = np.array([getattr(share, name) for name in ENERGIES])
        rows = self._world.gather(own, np.full(self._world.size, len(own), dtype=np.int32))
        return _core.Energies(*rows.reshape(self._world.size, -1).sum(axis=0).tolist())

    def keep(self) -> Callable[[], dict[str, dict[str, Array]]]:
        """Keep the present state; return what goes back to it and gives it, which all ranks call."""
        self._enter()
        own, told = self._own.state(), (self._told, self._forces, self._restraints)

        def give() -> dict[str, dict[str, Array]]:
            self._own.restore(own)
            self._told, self._forces, self._restraints = told
            self._where = "parts"
            self.bring_together()
            found: dict[str, dict[str, Array]] = self._whole.state()
            return found

        return give

    # --- cycles ---------------------------------------------------------------------------------------------------

    def advance(
        self, time: float, dt: float, dt_before: float, force_scale: Array, velocity_scale: Array, *, damping: float
    ) -> tuple[int, _core.LawStatus, int]:
        """Advance as a loop of the core does; return the first failure of all ranks."""
        self._enter()
        self._agree_on_radii()
        failed, status, cycle = self._own.advance(time, dt, dt_before, force_scale, velocity_scale, damping=damping)
        self._where = "parts"
        self._pulled.clear()
        self._tell(failed, status, cycle)
        when, element, told = min((row[:3] for row in self._told.tolist()), key=lambda row: (row[0], row[1]))
        if np.isinf(when):
            return -1, _core.LawStatus.done, -1
        return int(element), _core.LawStatus(int(told)), int(when)

    def _enter(self) -> None:
        """Let the rank's own loop have its part of the present state."""
        if self._own_is_old:
            self._own_is_old = False
            self._whole.place_beads()
            self._state.hand_out()

    def _agree_on_radii(self) -> None:
        """Let walls that turn know how far the nodes of all ranks are from their centres."""
        turning = [wall for wall in range(self._walls) if self._own.wall_radius(wall) >= 0.0]
        if not turning:
            return
        own = np.array([self._own.wall_radius(wall) for wall in turning])
        counts = np.full(self._world.size, len(turning), dtype=np.int32)
        farthest = self._world.gather(own, counts).reshape(self._world.size, -1).max(axis=0)
        for wall, radius in zip(turning, farthest.tolist(), strict=True):
            self._own.set_wall_radius(wall, radius)

    def _tell(self, failed: int, status: _core.LawStatus, cycle: int) -> None:
        """Let all ranks know what came of cycles on each: a row (6 + 3 for each tool) by rank."""
        own = self._own
        lost, mine = own.lost_point, self._part.owner[self._part.nodes] == self._world.rank
        failure = (cycle, self._name_element(failed), status.value) if failed >= 0 else (np.inf, 0, 0)
        row = [
            *failure,
            self._name_point(lost) if lost >= 0 else np.inf,
            np.isfinite(own.position[mine]).all(),
            own.bound_frequencies().max(),
        ]
        forces = [force for tool in range(self._tools) for force in own.tool_state(tool)[2]]
        forces += [own.bead_restraint(bead) for bead in range(self._beads)]
        counts = np.full(self._world.size, len(row) + len(forces), dtype=np.int32)
        self._told = self._world.gather(np.array([*row, *forces], dtype=float), counts).reshape(self._world.size, -1)
        sums = self._told[:, len(row) :].sum(axis=0)  # of multiples of 2^-25 N: exact
        self._forces, self._restraints = sums[: 3 * self._tools].reshape(-1, 3), sums[3 * self._tools :]
        if self._tools:  # energies of pushed tools, which rank 0 counts, need the whole force
            own.set_tool_forces(self._forces * (self._world.rank == 0))

    @property
    def highest_frequency(self) -> float:
        """Bound of the squared highest frequency of all elements [1/s2]."""
        told = self._whole.bound_frequencies() if self._where == "all" else self._told[:, 5]
        return float(told.max())

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers after the last cycles."""
        return bool(self._told[:, 4].all())

    @property
    def lost_point(self) -> int:
        """A point that has gone through a tool; -1: none."""
        first = np.inf if self._where == "all" else self._told[:, 3].min()
        return -1 if np.isinf(first) else int(first)

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """Wall time of this rank's cycles [s]."""
        found: tuple[float, float, float, float] = self._own.seconds
        return found

    def _name_element(self, element: int) -> int:
        """Return the number in the whole loop of an element of the rank's own."""
        return int(self._part.list_elements()[element])

    def _name_point(self, point: int) -> int:
        """Return the number in the whole loop of a node, or of the number of nodes + an edge."""
        nodes = self._part.nodes
        if point < len(nodes):
            return int(nodes[point])
        return len(self._part.owner) + int(self._state.find_edges()[1][point - len(nodes)])

    # --- what is said to both loops ---------------------------------------------------------------------------------

    def _tell_both(self, name: str, *given: Any, **named: Any) -> None:
        for loop in (self._whole, self._own):
            getattr(loop, name)(*given, **named)
        if name in ("push_tool", "move_tool", "remove_tool"):
            self._pushed = (self._pushed | {given[0]}) if name == "push_tool" else self._pushed - {given[0]}
        self._channel.sums = 3 * self._tools + 4 * self._walls if self._pushed or self._walls else 0

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms (n_nodes, freedoms) [N s]; nan where rank 0 alone knows it."""
        if self._where == "all" or self._walls or self._world.leads:
            self.bring_together()
            found: Array = self._whole.reaction_impulse
            return found
        own = self._own.reaction_impulse
        found_by_lead = self._state.gather_nodes(own)
        return np.full((len(self._part.owner), own.shape[1]), np.nan) if found_by_lead is None else found_by_lead

    @reaction_impulse.setter
    def reaction_impulse(self, value: Array) -> None:
        self._whole.reaction_impulse = value
        self._own.reaction_impulse = value[self._part.nodes]

    def prescribe(self, fixed: npt.NDArray[np.uint8], velocity: Array) -> None:
        """Prescribe velocities of freedoms (n_nodes, freedoms)."""
        self._whole.prescribe(fixed, velocity)
        self._own.prescribe(fixed[self._part.nodes], velocity[self._part.nodes])

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

    def set_temperature(self, block: int, temperature: Array) -> None:
        """Give the points of a block's elements temperatures (n, ...) [degrees C]."""
        self._whole.set_temperature(block, temperature)
        if block in self._state.blocks:
            part = np.ascontiguousarray(temperature[self._part.elements[block]])
            self._own.set_temperature(self._state.blocks.index(block), part)

    def add_damage(self, block: int, *law: Any, **start: Any) -> None:
        """Let damage grow at the points of a block."""
        self._whole.add_damage(block, *law, **start)
        if block in self._state.blocks:
            self._own.add_damage(self._state.blocks.index(block), *law, **start)
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

    def add_wall(self, surface: _core.ToolSurface, touching: npt.NDArray[np.uint8], **motion: Any) -> None:
        """Let a rigid tool hold the nodes marked (n_nodes,) off."""
        self._refuse_more()
        self._whole.add_wall(surface, touching, **motion)
        self._own.add_wall(surface, touching[self._part.nodes], **motion)
        self._walls += 1
        self._state.n_walls = self._walls
        self._own_is_old = True
        self._channel.sums = 3 * self._tools + 4 * self._walls

    def _refuse_more(self) -> None:
        self.bring_together()
        if self._tools + self._walls == MOST_TOOLS:
            raise ExplicitError(f"ranks share at most {MOST_TOOLS} tools: compute the case without mpiexec")

    def limit_wall_friction(self, wall: int, limit: Array) -> None:
        """Limit the friction of a wall on each node (n_nodes,) [N]."""
        self._whole.limit_wall_friction(wall, limit)
        self._own.limit_wall_friction(wall, np.ascontiguousarray(limit[self._part.nodes]))

    def add_bead(self, place: Array, across: Array, length: Array, *, force: float, tool: int) -> int:
        """Add a drawbead; return its number."""
        self.bring_together()
        if self._beads == 0:
            of_own = np.full(len(self._part.owner), -1, dtype=np.int32)
            of_own[self._part.nodes] = np.arange(len(self._part.nodes))
            self._own.share_beads(self._whole, of_own, self._part.list_elements())
        self._own.add_bead(place, across, length, force=force, tool=tool)
        self._beads += 1
        self._own_is_old = True
        return int(self._whole.add_bead(place, across, length, force=force, tool=tool))

    def drive_bead(self, bead: int, share: Array) -> None:
        """Say what share of its force a drawbead has in the next cycles."""
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
        """Say what the next cycles do with a tool."""
        self._own.drive_tool(tool, drive)

    def tool_state(self, tool: int) -> tuple[Any, Any, Any]:
        """Return displacement [mm], velocity [mm/s] and the sheet's force [N] of a tool."""
        if self._where == "all":
            return self._whole.tool_state(tool)  # type: ignore[no-any-return]
        place, velocity, _ = self._own.tool_state(tool)
        return place, velocity, self._forces[tool]


def _join(lists: dict[int, Numbers]) -> npt.NDArray[np.int32]:
    return np.concatenate([np.zeros(0, np.intp), *lists.values()]).astype(np.int32)


def _count(lists: dict[int, Numbers]) -> dict[int, int]:
    return {rank: len(nodes) for rank, nodes in lists.items()}
